"""The pulse stream of a simulated run: every step of both motors.

CSV, a line a step: number, time from the start of the program (us), axis, direction, whether it is
a step of the path or takes up play; then, of a ring distributor, which phases of x and y carry
current, of a port that drives the motors its word.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.simulate.motion import Motion, Setup
from wedmcam.simulate.process import WAYS, Way
from wedmcam.simulate.record import Record
from wedmcam.simulate.ring import PATTERNS, TURN
from wedmcam.simulate.state import State

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

HEADER = "pulse,time_us,axis,direction,kind,"
_AXES = np.array(["x", "y"], dtype=object)
_SIGNS = np.array(["-", "+"], dtype=object)
_KINDS = np.array(["step", "take-up"], dtype=object)
_PHASES = np.array(PATTERNS, dtype=object)
#: Kinds of ways, as `process.WAYS` counts them, on which the generator is on.
_GENERATOR_ON = [WAYS.index(way) for way in (Way.CUT, Way.SERVO_FEED)]


def pulse_lines(record: Record) -> Iterator[str]:
    """Yield the text of a run's pulse stream, piece by piece."""
    drive = record.controller.drive
    yield f"{HEADER}{'x,y' if drive is None else drive[0]}\n"
    number = 1
    ends = [*(one.began for one in record.sessions[1:]), record.state]
    for one, end in zip(record.sessions, ends, strict=True):
        motors = np.array([axis.motor for axis in one.began.axes])
        began = one.began.time_s
        for part in record.parts_of(one):
            text, count = _piece(part, motors, began, record, number)
            yield text
            number += count
            motors, began = part.motor[-1], float(part.time[-1])
        text, count = _cut_take_up(motors, end, began, record.setup, number)
        yield text
        number += count


def _piece(
    part: Motion, motors: Ints, began: float, record: Record, number: int
) -> tuple[str, int]:
    """Return the lines of a part of a run, and how many there are.

    Args:
        part: the part.
        motors: both, before it.
        began: when it begins, s.
        record: of the run.
        number: of its first pulse.
    """
    counts = part.ups + 1
    row = np.repeat(np.arange(len(counts)), counts)
    nth = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
    last = nth == counts[row]
    start = np.concatenate([[began], part.time[:-1]])[row]
    time = np.where(last, part.time[row], start + nth * record.setup.take_up_s)
    sign, axis = part.sign.astype(np.int64)[row], part.axis[row]
    before = np.concatenate([motors[None], part.motor[:-1]])[row]
    phases = [before[:, k] + np.where(axis == k, sign * nth, 0) for k in range(2)]
    shown: list[Any] = [_PHASES[motor % TURN] for motor in phases]
    if record.controller.drive is not None:
        cutting = np.isin(part.ways[row], _GENERATOR_ON)
        shown = [map(str, record.controller.drive[1](axis, sign, cutting).tolist())]
    return _lines(number, time, axis, sign, ~last, shown), len(row)


def _cut_take_up(
    motors: Ints, end: State, began: float, setup: Setup, number: int
) -> tuple[str, int]:
    """Return the lines of a take-up within which the power failed, and how many there are."""
    ways = np.array([axis.motor for axis in end.axes]) - motors
    axis = int(abs(ways).argmax())
    count, sign = int(abs(ways[axis])), int(np.sign(ways[axis]))
    nth = np.arange(1, count + 1)
    time = began + nth.astype(np.float64) * setup.take_up_s
    phases = [motors[k] + (sign * nth if k == axis else 0 * nth) for k in range(2)]
    whole = np.ones(count, np.int64)
    shown = [_PHASES[motor % TURN] for motor in phases]
    return _lines(number, time, axis * whole, sign * whole, whole == 1, shown), count


def _lines(
    number: int,
    time: Floats,
    axis: NDArray[Any],
    sign: Ints,
    is_take_up: NDArray[np.bool_],
    shown: Sequence[Any],
) -> str:
    """Return the lines of pulses; ``number``: of the first, ``shown``: the last columns."""
    columns = (
        map(str, range(number, number + len(time))),
        map(str, np.rint(time * 1e6).astype(np.int64).tolist()),
        _AXES[axis],
        _SIGNS[(sign > 0).astype(np.int64)],
        _KINDS[is_take_up.astype(np.int64)],
        *shown,
    )
    return "".join(f"{','.join(line)}\n" for line in zip(*columns, strict=True))
