"""The state of a controller as a file: what is saved when the power fails, and read to go on.

The paper saves it on tape [S]. Here it is a text, one field a line, so that who reads it sees what
a machine has to remember. It ends with a sum of all above. A damaged one is refused with the line,
and so is one that the program contradicts: block, F and J must be those of its step.
"""

from __future__ import annotations

import json
import re
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from wedmcam.diag import Diagnostic, FileSpan, TextSpan, error
from wedmcam.simulate.axis import AxisState
from wedmcam.simulate.process import Mode, Stand, steps_back
from wedmcam.simulate.ring import pattern
from wedmcam.simulate.route import Reading, Route

#: What a file opens with.
TITLE = "state of a controller"
#: More bytes than this are no state.
MOST_BYTES = 10_000
#: Largest number of a field.
_MOST = 10**12


@dataclass(frozen=True, slots=True)
class State:
    """All of a machine between two steps of its motors.

    Attributes:
        controller: which.
        program: `Route.digest` of the program.
        stand: of the process.
        reading: what the controller holds: block, place in it, F, J.
        axes: of both axes: direction, what is left of a take-up, motor, and the slack of the table.
        backlash, play, approach, true_approach: as in `Setup`.
        dry_ms: delay of a dry run; None for cutting.
        time_s: since the start of the program.
    """

    controller: str
    program: str
    stand: Stand
    reading: Reading
    axes: tuple[AxisState, AxisState]
    backlash: tuple[int, int]
    play: tuple[int, int]
    approach: tuple[int, int]
    true_approach: tuple[int, int]
    dry_ms: int | None
    time_s: float


def state_bytes(state: State) -> bytes:
    """Return the file of a state."""
    x, y = state.axes
    both = (x, y)
    fields: dict[str, Any] = {
        "wedmcam": TITLE,
        "controller": state.controller,
        "program": state.program,
        "mode": str(state.stand.mode),
        "step": state.stand.step,
        "target": state.stand.target,
        "made": state.stand.made,
        "short": state.stand.short,
        "goes_on": state.stand.goes_on,
        "front": state.stand.front,
        "unread": state.stand.unread,
        **state.reading._asdict(),
        "direction": [axis.direction for axis in both],
        "left": [axis.left for axis in both],
        "motor": [axis.motor for axis in both],
        "phase": [pattern(axis.motor) for axis in both],
        "slack": [axis.slack for axis in both],
        "backlash": list(state.backlash),
        "play": list(state.play),
        "approach": list(state.approach),
        "true_approach": list(state.true_approach),
        "dry_ms": state.dry_ms,
        "time_s": state.time_s,
    }
    lines = [f'"{name}": {json.dumps(value)}' for name, value in fields.items()]
    lines.append(f'"sum": "{_sum(lines)}"')
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode("ascii")


def _sum(lines: list[str]) -> str:
    # A damaged file may hold what no state holds: its sum is another one.
    return f"{zlib.crc32(chr(10).join(lines).encode()):08x}"


def _whole(low: int, high: int = _MOST) -> Callable[[Any], bool]:
    return lambda v: type(v) is int and low <= v <= high


def _pair(good: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda v: isinstance(v, list) and len(v) == 2 and all(map(good, v))


_SIGN = _pair(lambda v: type(v) is int and v in (1, -1))
_LENGTHS = _pair(_whole(0, 9999))
#: Field -> what its value has to be.
_FIELDS: dict[str, Callable[[Any], bool]] = {
    "wedmcam": lambda v: v == TITLE,
    "controller": lambda v: isinstance(v, str) and v.isascii(),
    "program": lambda v: isinstance(v, str) and bool(re.fullmatch("[0-9a-f]{64}", v)),
    "mode": lambda v: isinstance(v, str) and v in set(Mode) - {Mode.END},
    "step": _whole(0),
    "target": _whole(0),
    "made": _whole(0),
    "short": lambda v: isinstance(v, bool),
    "goes_on": lambda v: isinstance(v, bool),
    "front": _whole(-1),
    "unread": _whole(0),
    "block": _whole(1),
    "x": _whole(-_MOST),
    "y": _whole(-_MOST),
    "f": _whole(-(10**18), 10**18),
    "j": _whole(0),
    "direction": _SIGN,
    "left": _LENGTHS,
    "motor": _pair(_whole(-_MOST)),
    "phase": _pair(lambda v: isinstance(v, str)),
    "slack": _LENGTHS,
    "backlash": _LENGTHS,
    "play": _LENGTHS,
    "approach": _SIGN,
    "true_approach": _SIGN,
    "dry_ms": lambda v: v is None or _whole(1, 9999)(v),
    "time_s": lambda v: type(v) in (int, float) and 0 <= v < 1e15,
    "sum": lambda v: isinstance(v, str),
}


def read_state(data: bytes, name: str) -> tuple[State | None, list[Diagnostic]]:
    """Return the state that a file holds, or what is wrong with it, with its line.

    Args:
        data: any bytes; never raises.
        name: for the spans.
    """
    text = data[: MOST_BYTES + 1].decode("ascii", "replace")
    if len(text) > MOST_BYTES or not text.lstrip().startswith("{"):
        return None, [error("bad-state", "this is no state of a controller", FileSpan(name))]
    try:
        fields = json.loads(text)
    except json.JSONDecodeError as wrong:
        span = TextSpan(name, wrong.lineno, wrong.colno)
        return None, [error("bad-state", "the state is damaged: {reason}", span, reason=wrong.msg)]
    except (ValueError, RecursionError):
        return None, [error("bad-state", "this is no state of a controller", FileSpan(name))]
    findings = _wrong_fields(fields, text, name)
    if not findings and fields["sum"] != _sum(_lines(text)[:-1]):
        why = "the state is damaged: its sum is not {sum}"
        findings = [error("bad-state", why, _span(text, "sum", name), sum=fields["sum"])]
    return (None if findings else _state(fields)), findings


def check_state(
    state: State, controller: str, route: Route, text: str, name: str
) -> list[Diagnostic]:
    """Return in what a state and the program contradict each other, with the line.

    Args:
        state: as it was read.
        controller: name of the one that is to go on.
        route: of the program with which it is to go on.
        text: of its file.
        name: of its file.
    """
    if state.controller != controller:
        mine = "the state is one of the controller {held}, not of {controller}"
        span = _span(text, "controller", name)
        return [error("bad-state", mine, span, held=state.controller, controller=controller)]
    if state.program != route.digest:
        span = _span(text, "program", name)
        return [error("other-program", "the state belongs to another program", span)]
    stand = state.stand
    if stand.step > route.steps:
        long = "the program makes {steps} steps, and the state is at step {step}"
        span = _span(text, "step", name)
        return [error("bad-state", long, span, steps=route.steps, step=stand.step)]
    back = stand.mode not in (Mode.FORWARD, Mode.ALARM)
    target = stand.target if back else 0
    if not stand.step <= max(stand.front, 0) <= route.steps:
        front = "front is {front}: from step {step} on, up to the {steps} of the program"
        span = _span(text, "front", name)
        return [
            error("bad-state", front, span, front=stand.front, step=stand.step, steps=route.steps)
        ]
    block = stand.unread
    if block and (block > route.blocks + 1 or route.start_of(block) <= stand.front):
        unread = "unread is {block}: no block that begins behind step {front}"
        span = _span(text, "unread", name)
        return [error("bad-state", unread, span, block=block, front=stand.front)]
    if target > stand.step or (back and stand.made > steps_back(route, stand)):
        far = "no way back from step {step} ends at {target}"
        span = _span(text, "target", name)
        return [error("bad-state", far, span, step=stand.step, target=stand.target)]
    return _wrong_reading(state, route, text, name) or _wrong_axes(state, text, name)


def _wrong_reading(state: State, route: Route, text: str, name: str) -> list[Diagnostic]:
    """Return where block, place, F or J is not that of the step."""
    step = state.stand.step
    right = route.reading(step)
    for field, held, value in zip(Reading._fields, state.reading, right, strict=True):
        if held != value:
            why = "{field} is {held}; at step {step} of the program it is {value}"
            span = _span(text, field, name)
            return [error("bad-state", why, span, field=field, held=held, step=step, value=value)]
    return []


def _wrong_axes(state: State, text: str, name: str) -> list[Diagnostic]:
    """Return where more play is left than there is."""
    for k, axis in enumerate(state.axes):
        for field, held, most in (
            ("left", axis.left, state.backlash[k]),
            ("slack", axis.slack, state.play[k]),
        ):
            if held > most:
                why = "{field} is {held} steps on {axis}; the most is {most}"
                span = _span(text, field, name)
                return [
                    error("bad-state", why, span, field=field, held=held, axis="xy"[k], most=most)
                ]
    return []


def _wrong_fields(fields: Any, text: str, name: str) -> list[Diagnostic]:
    """Return the first thing that is wrong with the fields by themselves."""
    if not isinstance(fields, dict) or fields.get("wedmcam") != TITLE:
        return [error("bad-state", "this is no state of a controller", FileSpan(name))]
    for field in fields:
        if field not in _FIELDS:
            span = _span(text, field, name)
            return [error("bad-state", "a state has no field {field}", span, field=field)]
    for field, good in _FIELDS.items():
        if field not in fields:
            return [error("bad-state", "the field {field} is missing", FileSpan(name), field=field)]
        if not good(fields[field]):
            span = _span(text, field, name)
            return [error("bad-state", "the value of {field} cannot be", span, field=field)]
    for k, held in enumerate(fields["phase"]):
        right = pattern(fields["motor"][k])
        if held != right:
            why = "the phase of {axis} is {held}; behind {motor} steps it is {right}"
            span, motor = _span(text, "phase", name), fields["motor"][k]
            return [
                error("bad-state", why, span, axis="xy"[k], held=held, motor=motor, right=right)
            ]
    return []


def _state(fields: dict[str, Any]) -> State:
    x, y = (
        AxisState(*(fields[name][k] for name in ("direction", "left", "motor", "slack")))
        for k in range(2)
    )
    names = ("step", "target", "made", "short", "goes_on", "front", "unread")
    return State(
        controller=fields["controller"],
        program=fields["program"],
        stand=Stand(Mode(fields["mode"]), *(fields[name] for name in names)),
        reading=Reading(*(fields[name] for name in Reading._fields)),
        axes=(x, y),
        backlash=tuple(fields["backlash"]),
        play=tuple(fields["play"]),
        approach=tuple(fields["approach"]),
        true_approach=tuple(fields["true_approach"]),
        dry_ms=fields["dry_ms"],
        time_s=float(fields["time_s"]),
    )


def _lines(text: str) -> list[str]:
    """Return the lines of the fields, without the commas between them."""
    return [line.rstrip(",") for line in text.splitlines() if line.startswith('"')]


def _span(text: str, field: str, name: str) -> TextSpan | FileSpan:
    """Return the line of a field."""
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith(json.dumps(field)):
            return TextSpan(name, number, 1)
    return FileSpan(name)
