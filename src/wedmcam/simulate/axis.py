"""One axis: a motor, a screw with play, and a table; and what the controller does about the play.

Backlash compensation (齿隙补偿) [S]: when an axis reverses against its last direction, the backlash
count is stepped out in the new direction first. The table stands where the motor does, or up to the
play above it: turned forwards, the motor pushes the table at 0; backwards, it pulls it at the play.
With backlash = play and the true direction of approach the table is exact at every step of the path
[M]. Lengths are um, one step of the motor is 1 um.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class AxisState:
    """Where an axis stands.

    Attributes:
        direction: of the last approach as the controller has it, +1 or -1.
        left: what is left of taking up the play in that direction, steps.
        motor: steps, net, since the start of the program.
        slack: how far the table lies above the motor, um, 0 to the play.
    """

    direction: int
    left: int
    motor: int
    slack: int


def at_start(approach: int, true_approach: int, play: int) -> AxisState:
    """Return an axis at the start of the program.

    Args:
        approach: direction of the last approach as it was entered, +1 or -1.
        true_approach: as it was.
        play: of the screw, um.
    """
    return AxisState(approach, 0, 0, 0 if true_approach > 0 else play)


def take_ups(state: AxisState, signs: Ints, backlash: int) -> Ints:
    """Return how many steps the controller makes before each step of a path, on one axis.

    Args:
        state: before the first of them.
        signs: of the steps on this axis in their order, +1 or -1.
        backlash: as entered, steps.
    """
    out = np.zeros(len(signs), np.int64)
    if len(signs):
        out[1:] = backlash * (signs[1:] != signs[:-1])
        # Play that is half taken up in one direction is given back by as much in the other.
        out[0] = state.left if signs[0] == state.direction else backlash - state.left
    return out


def drive(
    state: AxisState, signs: Ints, backlash: int, play: int
) -> tuple[Ints, Ints, Ints, AxisState]:
    """Return what an axis does along the steps of a path.

    Args:
        state: before them.
        signs: of the steps on this axis in their order, +1 or -1.
        backlash: as entered, steps.
        play: of the screw, um.

    Returns:
        Take-up steps before each, the motor and the slack after each, and the state at the end.
    """
    ups = take_ups(state, signs, backlash)
    if not len(signs):
        return ups, ups, ups, state
    motor = state.motor + np.cumsum(signs * (ups + 1))
    slack = _slacks(state, signs, motor, play)
    end = AxisState(int(signs[-1]), 0, int(motor[-1]), int(slack[-1]))
    return ups, motor, slack, end


def part_taken(state: AxisState, sign: int, count: int, backlash: int, play: int) -> AxisState:
    """Return an axis that was stopped within a take-up, after ``count`` of its steps."""
    up = int(take_ups(state, np.array([sign]), backlash)[0])
    assert 0 <= count <= up, (count, up)
    slack = min(max(state.slack - sign * count, 0), play)
    return AxisState(sign, up - count, state.motor + sign * count, slack)


def _slacks(state: AxisState, signs: Ints, motor: Ints, play: int) -> Ints:
    """Return the slack after each step.

    Within a run of one direction the motor moves the slack towards 0 or the play, and no further.
    """
    begin = np.flatnonzero(np.diff(signs, prepend=0))
    before = np.concatenate([[state.motor], motor[begin[1:] - 1]])
    end = np.concatenate([motor[begin[1:] - 1], motor[-1:]])
    slack, starts = state.slack, []
    for way in (end - before).tolist():
        starts.append(slack)
        slack = min(max(slack - way, 0), play)
    length = np.diff(begin, append=len(signs))
    made = motor - np.repeat(before, length)
    slacks: Ints = np.minimum(np.maximum(np.repeat(np.array(starts), length) - made, 0), play)
    return slacks
