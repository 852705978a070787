"""Under what a run takes place, as far as it is stated: by options, by a scenario file, by a state.

Each may leave out what another says, and what none says is as usual. `setup_of` returns the machine
that follows from it.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from wedmcam.controllers.nby15.data import Switches
from wedmcam.diag.run import WrongUse
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.scenario import Fault

Pair = tuple[int, int]

#: Steps a second of the feed signal where none is stated: 2.4 mm a minute.
FEED = 40.0
#: Delay of a step on a way back, ms, where none is stated.
RETURN_MS = 5
#: Backlash and play have four digits, and so have delays [S].
LARGEST = 9999
#: Steps a second that a feed signal may have.
FEEDS = (0.001, 100_000.0)
#: Random faults that a run may have.
MOST_RANDOM = 9999


@dataclass(frozen=True, slots=True)
class Conditions:
    """What is stated of a run; None where it is not.

    Attributes:
        backlash: of x and y as entered, um.
        play: of the screws, um.
        approach: directions of the last approach as entered, +1 or -1.
        true_approach: as they were.
        feed: of the generator's signal, steps a second.
        return_ms: delay of a step on ways back and moves, and of taking up play.
        dry_ms: delay of a step of a dry run.
        random: how many random faults, and the seed.
        servo: which law feeds the wire, and the seed of its gap.
        profile: a built-in one of the controller's format.
        switches: as set at an NBY-15.
        run_off: what its corrector is not safe for is run all the same, into its limit switches.
        faults: what goes wrong.
        feeds: from which step on the feed signal has another frequency.
    """

    backlash: Pair | None = None
    play: Pair | None = None
    approach: Pair | None = None
    true_approach: Pair | None = None
    feed: float | None = None
    return_ms: int | None = None
    dry_ms: int | None = None
    random: Pair | None = None
    servo: tuple[str, int] | None = None
    profile: str | None = None
    switches: Switches | None = None
    run_off: bool | None = None
    faults: tuple[Fault, ...] = ()
    feeds: tuple[tuple[int, float], ...] = ()

    def over(self, other: Conditions) -> Conditions:
        """Return these conditions, and another's where these say nothing; faults of both."""
        values: dict[str, Any] = {}
        for one in fields(self):
            mine, theirs = getattr(self, one.name), getattr(other, one.name)
            if isinstance(mine, tuple) and one.name in ("faults", "feeds"):
                values[one.name] = (*theirs, *mine)
            else:
                values[one.name] = theirs if mine is None else mine
        return Conditions(**values)


def setup_of(c: Conditions, backlash: Pair, step_um: int = 1) -> Setup:
    """Return the machine of a run.

    Args:
        c: what is stated.
        backlash: what is entered, um, or goes for entered: a dry run takes up no play by itself.
        step_um: one step of the motors.

    Raises:
        WrongUse: a length that is no whole number of steps.
    """
    approach = c.approach or (1, 1)
    return Setup(
        backlash=_in_steps("backlash", backlash, step_um),
        play=_in_steps("play", c.play or backlash, step_um),
        approach=approach,
        true_approach=c.true_approach or approach,
        feed=c.feed or FEED,
        return_ms=c.return_ms or RETURN_MS,
        dry_ms=c.dry_ms,
    )


def _in_steps(what: str, um: Pair, step_um: int) -> Pair:
    if um[0] % step_um or um[1] % step_um:
        raise WrongUse(f"{what} {um[0]},{um[1]} um: a step of the motors is {step_um} um")
    return um[0] // step_um, um[1] // step_um
