"""The motors and the table along a walk: every step with its take-up of play, place and time.

Arrays over the steps of a walk, in their order, back and forth. Steps from the start of the
program; seconds.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import BLOCK
from wedmcam.simulate.axis import AxisState, at_start, drive
from wedmcam.simulate.process import WAYS, Leg, Mode, Stand, Way
from wedmcam.simulate.route import Route

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

#: Of every kind of way: whether the feed signal sets its pace; whether it goes forward.
_FED = np.array([way in (Way.CUT, Way.SERVO_FEED) for way in WAYS])
_AHEAD = _FED | np.array([way is Way.MOVE for way in WAYS])
#: Steps computed at a time: some 100 MB.
BATCH = 1_000_000


@dataclass(frozen=True, slots=True)
class Setup:
    """What is entered before a program is run, and what the machine is like.

    Attributes:
        backlash: of x and y as entered, steps.
        play: of the screws, steps; with a true model the same.
        approach: directions of the last approach as entered, +1 or -1.
        true_approach: as they were.
        feed: of the generator's signal, steps a second.
        return_ms: delay of a step on a way back, on a move, and of taking up play.
        dry_ms: delay of a step in a dry run; None for cutting.
    """

    backlash: tuple[int, int]
    play: tuple[int, int]
    approach: tuple[int, int] = (1, 1)
    true_approach: tuple[int, int] = (1, 1)
    feed: float = 40.0
    return_ms: int = 5
    dry_ms: int | None = None

    @property
    def take_up_s(self) -> float:
        """Delay of a step that takes up play, s."""
        return (self.dry_ms or self.return_ms) / 1000

    def at_start(self) -> tuple[AxisState, AxisState]:
        """Return both axes at the start of the program."""
        x, y = (at_start(self.approach[k], self.true_approach[k], self.play[k]) for k in range(2))
        return x, y


@dataclass(frozen=True, eq=False, slots=True)
class Motion:
    """What the machine does on a walk; one entry a step.

    Attributes:
        axis: `Axis`.
        sign: +1 or -1.
        step: number of the place on the route behind it; while it goes straight to a thread point,
            of the place where it left the path.
        ways: of every step, the index of its kind in `WAYS`.
        ups: take-up steps that are made before it.
        commanded: where the controller has it, shape (n, 2).
        motor: steps of the motors, net, shape (n, 2).
        table: where the table stands, shape (n, 2).
        time: when it is made, s from the start of the walk.
        axes: both axes at the end.
    """

    axis: NDArray[np.uint8]
    sign: NDArray[np.int8]
    step: Ints
    ways: NDArray[np.uint8]
    ups: Ints
    commanded: Ints
    motor: Ints
    table: Ints
    time: Floats
    axes: tuple[AxisState, AxisState]


def move(
    route: Route,
    legs: Sequence[Leg],
    axes: tuple[AxisState, AxisState],
    setup: Setup,
    feeds: Sequence[tuple[int, float]] = (),
) -> Motion:
    """Return what the machine does along legs.

    Args:
        route: of the program.
        legs: of a walk, in their order.
        axes: before them.
        setup: of the machine.
        feeds: from which step on the feed signal has another frequency, steps a second.
    """
    lengths = np.array([leg.steps for leg in legs], dtype=np.int64)
    leg = np.repeat(np.arange(len(legs)), lengths)
    axis, sign, step, commanded = _steps(route, legs, lengths, leg)
    ups = np.zeros(len(axis), np.int64)
    motor, table, ends = np.zeros((len(axis), 2), np.int64), np.zeros((len(axis), 2), np.int64), []
    for k, state in enumerate(axes):
        rows = np.flatnonzero(axis == k)
        made, turned, slack, end = drive(
            state, sign[rows].astype(np.int64), setup.backlash[k], setup.play[k]
        )
        ups[rows] = made
        seen = np.cumsum(axis == k)
        motor[:, k] = np.concatenate([[state.motor], turned])[seen]
        at = np.concatenate([[state.motor + state.slack], turned + slack])[seen]
        # The table is at 0 at the start of the program, whichever end of the play it came from.
        table[:, k] = at - (0 if setup.true_approach[k] > 0 else setup.play[k])
        ends.append(end)
    ways = np.array([WAYS.index(one.way) for one in legs], dtype=np.uint8)[leg]
    seconds = _durations(route, ways, step, ups, setup, feeds)
    time = np.cumsum(_as_served(legs, lengths, seconds, ups, setup))
    return Motion(axis, sign, step, ways, ups, commanded, motor, table, time, (ends[0], ends[1]))


def batches(
    route: Route,
    legs: Sequence[Leg],
    axes: tuple[AxisState, AxisState],
    setup: Setup,
    feeds: Sequence[tuple[int, float]] = (),
) -> Iterator[Motion]:
    """Yield what the machine does along legs, some `BATCH` steps at a time: times go on.

    Arguments as of `move`. A run that goes back and forth a thousand times needs no more memory
    than one that does not.
    """
    time, first = 0.0, 0
    pieces = [piece for leg in legs for piece in leg.pieces(BATCH)]
    while first < len(pieces):
        last, steps = first, 0
        while last < len(pieces) and (last == first or steps + pieces[last].steps <= BATCH):
            steps += pieces[last].steps
            last += 1
        part = move(route, pieces[first:last], axes, setup, feeds)
        yield replace(part, time=part.time + time)
        time, axes, first = time + float(part.time[-1]), part.axes, last


def commanded_at(route: Route, stand: Stand) -> tuple[int, int]:
    """Return where the controller has the machine, steps from the start of the program."""
    x, y = route.place[stand.step].tolist()
    if stand.mode is Mode.SHORTEST and stand.made:
        leg = Leg(Way.SHORTEST, stand.step, stand.target, 0, stand.made)
        x, y = _straight(route, leg)[2][-1].tolist()
    return x, y


def _steps(
    route: Route, legs: Sequence[Leg], lengths: Ints, leg: Ints
) -> tuple[NDArray[np.uint8], NDArray[np.int8], Ints, Ints]:
    """Return axis, sign, number and commanded place of every step."""
    first = np.array([one.first for one in legs], dtype=np.int64)
    last = np.array([one.last for one in legs], dtype=np.int64)
    straight = np.array([one.way is Way.SHORTEST for one in legs], dtype=bool)
    up = np.where(last > first, 1, -1)
    nth = np.arange(len(leg)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
    step = first[leg] + up[leg] * (nth + 1)
    # Step k leads from place k - 1 to place k; back from place k it is undone.
    row = np.where(up[leg] > 0, step - 1, step)
    on_path = ~straight[leg]
    row = np.where(on_path, row, 0)
    axis = route.axis[row] if route.steps else np.zeros(0, np.uint8)
    sign = route.sign[row] * up[leg].astype(np.int8) if route.steps else np.zeros(0, np.int8)
    step = np.where(on_path, step, first[leg])
    commanded = route.place[step]
    ends = np.cumsum(lengths)
    for k in np.flatnonzero(straight).tolist():
        rows = slice(int(ends[k] - lengths[k]), int(ends[k]))
        axis[rows], sign[rows], commanded[rows] = _straight(route, legs[k])
    return axis, sign, step.astype(np.int64), commanded


def _straight(route: Route, leg: Leg) -> tuple[NDArray[np.uint8], NDArray[np.int8], Ints]:
    """Return axis, sign and place of the steps of a straight leg."""
    start = route.place[leg.first]
    way = route.place[leg.last] - start
    block = np.zeros(1, BLOCK)
    block["x"], block["y"] = way
    block["axis"], block["count"] = MIRROR.line_count(way[:1], way[1:])
    place: Ints = MIRROR.trace(block)[0]
    place = place[leg.made : leg.made + leg.count + 1]
    step = np.diff(place, axis=0)
    axis = (step[:, 0] == 0).astype(np.uint8)
    return axis, step.sum(axis=1).astype(np.int8), start + place[1:]


def _as_served(
    legs: Sequence[Leg], lengths: Ints, seconds: Floats, ups: Ints, setup: Setup
) -> Floats:
    """Return how long every step takes, where a servo says so for whole legs as it says."""
    ends = np.cumsum(lengths)
    for leg, end in zip(legs, ends.tolist(), strict=True):
        if leg.seconds is not None:
            rows = slice(end - leg.steps, end)
            seconds[rows] = leg.seconds + ups[rows] * (setup.return_ms / 1000)
    return seconds


def _durations(
    route: Route,
    ways: NDArray[np.uint8],
    step: Ints,
    ups: Ints,
    setup: Setup,
    feeds: Sequence[tuple[int, float]],
) -> Floats:
    """Return how long every step takes, with its take-up, s."""
    if setup.dry_ms is not None:
        return (ups + 1).astype(np.float64) * (setup.dry_ms / 1000)
    rates = np.array([setup.feed, *(rate for _, rate in feeds)])
    since = np.array([at for at, _ in feeds], dtype=np.int64)
    delay = setup.return_ms / 1000
    # Step k is the first one with a feed that is stated from place k - 1 on.
    feed = rates[np.searchsorted(since, step - 1, side="right")]
    own = np.where(_FED[ways], 1.0 / feed, delay)
    if route.seconds is not None:
        own = np.where(_AHEAD[ways], route.seconds[np.maximum(step - 1, 0)], delay)
    return np.float64(delay) * ups + own
