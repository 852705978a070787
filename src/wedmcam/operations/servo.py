"""Compare the laws of a gap servo: the same part, the same gap model, the same seeds.

What a law costs and gains shows in time, in pulses that did nothing, in ways back, and in how
steadily it holds the gap. One run says little, so each law runs with several seeds, and the table
shows the mean with its standard deviation.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from wedmcam.simulate.feeding import PULSES_HZ, feeding_of
from wedmcam.simulate.gap import Workpiece
from wedmcam.simulate.laws import LAWS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Way
from wedmcam.simulate.record import Record
from wedmcam.simulate.route import Route
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, scenario_of
from wedmcam.simulate.zd065 import ZD065

_FORWARD = [list(Way).index(way) for way in (Way.CUT, Way.MOVE)]


@dataclass(frozen=True, slots=True)
class Trial:
    """One run of one law.

    Attributes:
        servo: the law.
        seed: of the run.
        steps: of the path that were cut.
        seconds: with the generator on.
        pulses: power pulses.
        open_percent, short_percent: of them that were open, and short circuits.
        retreats: ways back.
        back_steps: of them.
        longest: of them, steps behind the farthest place.
        alarms: ways back that the controller ended; an operator cleared them.
        gap_um: mean gap.
        spread_um: standard deviation of the gap: how steadily it is held.
        exact: whether the path cut was that without faults, step by step.
    """

    servo: str
    seed: int
    steps: int
    seconds: float
    pulses: int
    open_percent: float
    short_percent: float
    retreats: int
    back_steps: int
    longest: int
    alarms: int
    gap_um: float
    spread_um: float
    exact: bool


#: Heading of a column, the field of `Trial`, and its decimals.
_COLUMNS = (
    ("time s", "seconds", 1),
    ("open %", "open_percent", 2),
    ("short %", "short_percent", 2),
    ("retreats", "retreats", 1),
    ("alarms", "alarms", 1),
    ("gap um", "gap_um", 2),
    ("spread um", "spread_um", 2),
)


@dataclass(frozen=True, slots=True)
class Comparison:
    """Runs of several laws.

    Attributes:
        input: name of the program.
        hz: power pulses a second.
        trials: in the order of laws, then of seeds.
    """

    input: str
    hz: float
    trials: tuple[Trial, ...]

    @property
    def table(self) -> str:
        """A line a law: mean and standard deviation over its seeds."""
        rows = [["servo", *(heading for heading, _, _ in _COLUMNS)]]
        for servo in dict.fromkeys(trial.servo for trial in self.trials):
            mine = [trial for trial in self.trials if trial.servo == servo]
            rows.append([servo, *(_spread(mine, name, digits) for _, name, digits in _COLUMNS)])
        widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        lines = [
            "  ".join(
                cell.ljust(width) if k == 0 else cell.rjust(width)
                for k, (cell, width) in enumerate(zip(row, widths, strict=True))
            )
            for row in rows
        ]
        return "\n".join(lines) + "\n"

    @property
    def summary(self) -> dict[str, Any]:
        """Everything in numbers, for JSON."""
        return {
            "input": self.input,
            "pulses_hz": self.hz,
            "exact": all(trial.exact for trial in self.trials),
            "trials": [asdict(trial) for trial in self.trials],
        }


def compare_servos(
    route: Route,
    name: str,
    *,
    servos: Sequence[str] = tuple(LAWS),
    seeds: Iterable[int] = range(5),
    steps: int | None = None,
    hz: float = PULSES_HZ,
    piece: Workpiece | None = None,
) -> Comparison:
    """Run laws on a program with the same seeds.

    Args:
        route: of the program, as a ZD-065 runs it.
        name: of the program.
        servos: which laws.
        seeds: each law runs once with each.
        steps: of the path to cut; None for all.
        hz: power pulses a second.
        piece: the gap model; None for the usual one.

    Raises:
        WrongUse: no law has such a name, or there are no pulses.
    """
    seeds = tuple(seeds)
    trials = [_trial(route, servo, seed, steps, hz, piece) for servo in servos for seed in seeds]
    return Comparison(name, hz, tuple(trials))


def _trial(
    route: Route, servo: str, seed: int, steps: int | None, hz: float, piece: Workpiece | None
) -> Trial:
    feeding = feeding_of(servo, seed, hz=hz, piece=piece)
    last = route.steps if steps is None else min(steps, route.steps)
    ends = scenario_of([Fault(Trouble.POWER, last)])
    still = Setup(backlash=(0, 0), play=(0, 0))
    record, _ = run(ZD065, route, ends, still, stop_at_power=True, feeder=feeding)
    assert record is not None, "the power may fail at each step of a route"
    return Trial(seed=seed, steps=last, exact=cut_in_order(record, last), **feeding.figures)


def cut_in_order(record: Record, last: int) -> bool:
    """Whether a run came to each place of its path, in their order, as if nothing had gone wrong.

    Args:
        record: of the run.
        last: number of the place to which it was to come.
    """
    reached = 0
    for part in record.motions():
        off = (part.table != record.route.place[part.step]).any(axis=1)
        if off[part.ways != list(Way).index(Way.SHORTEST)].any():
            return False
        ahead = part.step[np.isin(part.ways, _FORWARD)]
        farthest = np.maximum.accumulate(np.concatenate([[reached], ahead]))
        if (np.diff(farthest) > 1).any():
            return False
        reached = int(farthest[-1])
    return reached == last


def _spread(trials: Sequence[Trial], name: str, digits: int) -> str:
    """Return the mean of a field with its standard deviation, for people."""
    values = np.array([getattr(trial, name) for trial in trials], dtype=np.float64)
    mean = f"{values.mean():,.{digits}f}"
    return mean if len(values) == 1 else f"{mean} ± {values.std(ddof=1):,.{digits}f}"
