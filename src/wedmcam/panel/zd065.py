"""The panel of the ZD-065 as a state machine: which key does what, and when it is locked.

The paper's software locks the eight keys against each other, so that operations come in their
order: a key that is out of it shows an error, and does nothing [S]. Which key does what is not in
the source; the table here is ours [R]. A function key chooses a group, a digit a function of it;
then its numbers are keyed in, digit by digit. A function key in the middle gives an entry up.

A line is keys (``U5 0 0012 0015``) or one of these, in virtual time::

    run            until the machine stops         short 60     the wire touches, free 60 um back
    run 500        so many steps                   break        the wire breaks
    run to block 7                                 power off    power on
    wait 5s                                        # a comment
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from wedmcam.diag import Diagnostic
from wedmcam.operations import memory
from wedmcam.panel.entry import Entry, Field
from wedmcam.panel.keys import DIGITS, keys_in
from wedmcam.panel.machine import Denied, Machine
from wedmcam.panel.script import NUMBER, Line, Shown, happening

Deed = Callable[..., list[Shown]]


class Mode(StrEnum):
    """What the machine is about."""

    READY = "ready"  # nothing is run
    RUNNING = "running"  # it cuts or draws
    HALTED = "halted"  # at a thread point or a pause, or returned to one
    ALARM = "alarm"  # still shorted after the way back
    BROKEN = "broken"  # the wire is broken
    OFF = "off"  # no power
    SAVED = "saved"  # power again; the state is on the tape


#: What the machine does in a mode, behind "while".
WHILE = {
    Mode.READY: "nothing is run",
    Mode.RUNNING: "the machine runs",
    Mode.HALTED: "the machine waits at a thread point or pause",
    Mode.ALARM: "the machine stands with an alarm",
    Mode.BROKEN: "the wire is broken",
    Mode.OFF: "there is no power",
    Mode.SAVED: "the state is on the tape",
}


HOW = (
    "keys are 0 to F and U0 to U7; else: run, run N, run to block N, short UM, break, power off, "
    "power on, wait 5s"
)
_HAPPENS = (
    (re.compile(r"run"), "run_on"),
    (re.compile(rf"run {NUMBER}"), "run"),
    (re.compile(rf"run to block {NUMBER}"), "run_to_block"),
    (re.compile(rf"short {NUMBER}"), "short"),
    (re.compile(r"break"), "break_wire"),
    (re.compile(r"power off"), "cut_power"),
    (re.compile(r"power on"), "restore_power"),
    (re.compile(rf"wait {NUMBER} ?s"), "wait"),
)


@dataclass(frozen=True, slots=True)
class Function:
    """What a function key and a digit do.

    Attributes:
        name: for people.
        modes: in which it is not locked.
        fields: numbers that are keyed in first.
        deed: name of the method of `Panel` that does it.
    """

    name: str
    modes: frozenset[Mode]
    fields: tuple[Field, ...] = ()
    deed: str = ""


def _address(name: str) -> Field:
    return Field(name, 4, is_hex=True, most=0xFFFF)


def _sign(name: str) -> Field:
    return Field(name, 1, most=1)


_IDLE = frozenset({Mode.READY})
_GAP = (Field("the gap, um,", 4, most=7999), Field("r of corners, um (0000: the gap),", 4))
_UM = 999_999
#: Function key -> digit -> what they do.
FUNCTIONS: dict[str, dict[str, Function]] = {
    "U0": {
        "0": Function("enter bytes", _IDLE, (_address("the first address"),), "enter"),
        "1": Function("recognise the data", _IDLE, (), "recognise"),
    },
    "U1": {
        "0": Function("find a block", _IDLE, (Field("the number", 4),), "find"),
        "1": Function(
            "move data",
            _IDLE,
            (_address("the first address"), _address("the last one"), _address("the new one")),
            "move",
        ),
        "2": Function(
            "show a range",
            _IDLE,
            (_address("the first address"), _address("the last one"), Field("ms a group", 4)),
            "show",
        ),
    },
    "U2": {
        "0": Function(
            "translate",
            _IDLE,
            (
                Field("copies", 2),
                _sign("the sign of x, 0 plus, 1 minus,"),
                Field("x, um,", 6, most=_UM),
                _sign("the sign of y, 0 plus, 1 minus,"),
                Field("y, um,", 6, most=_UM),
            ),
            "translate",
        ),
        "1": Function("x symmetry completes the figure", _IDLE, (), "x_symmetry"),
        "2": Function("y symmetry completes the figure", _IDLE, (), "y_symmetry"),
        "3": Function("mirror in the 45 degree line", _IDLE, (), "mirror_45"),
        "4": Function("mirror in the 135 degree line", _IDLE, (), "mirror_135"),
    },
    "U3": {
        "0": Function(
            "rotate the figure",
            _IDLE,
            (Field("copies", 2), Field("the exponent of the angle", 2), Field("the angle", 8)),
            "rotate",
        ),
    },
    "U4": {
        "0": Function("compensate, punch", _IDLE, _GAP, "punch"),
        "1": Function("compensate, die", _IDLE, _GAP, "die"),
    },
    "U5": {
        "0": Function(
            "enter the backlash",
            _IDLE,
            (Field("the backlash of x, um,", 4), Field("the backlash of y, um,", 4)),
            "backlash",
        ),
        "1": Function(
            "enter the last directions",
            _IDLE,
            (_sign("x, 0 plus, 1 minus,"), _sign("y, 0 plus, 1 minus,")),
            "approach",
        ),
    },
    "U6": {
        "0": Function("draw dry", _IDLE, (Field("ms a step", 4),), "draw"),
        "1": Function("cut", _IDLE, (), "cut"),
    },
    "U7": {
        "0": Function(
            "return to the thread point", frozenset({Mode.ALARM, Mode.BROKEN}), (), "to_thread"
        ),
        "1": Function(
            "return to the start of a block",
            frozenset({Mode.ALARM, Mode.BROKEN}),
            (Field("the number", 4),),
            "to_block",
        ),
        "2": Function("go on", frozenset({Mode.HALTED, Mode.ALARM, Mode.SAVED}), (), "go_on"),
    },
}


def unlocked(mode: Mode) -> list[str]:
    """Return the functions that are not locked in a mode, as they are keyed: U0 0.

    >>> unlocked(Mode.BROKEN)
    ['U7 0', 'U7 1']
    """
    return [
        f"{key} {digit}"
        for key, group in FUNCTIONS.items()
        for digit, function in group.items()
        if mode in function.modes
    ]


class Panel:
    """The panel with the machine behind it.

    Attributes:
        machine: what stands behind it.
        mode: what it is about.
        digits: what the six digits show.
    """

    controller = "zd065"
    greeting = "the panel of a ZD-065; help, quit"
    how = HOW

    def __init__(self, machine: Machine | None = None) -> None:
        self.machine = machine or Machine()
        self.mode = Mode.READY
        self.digits = " " * 6
        self._before_off = Mode.READY
        self._group: str | None = None
        self._function: Function | None = None
        self._entry: Entry | None = None
        self._address: int | None = None
        self._half = ""

    # --- lines ----------------------------------------------------------------------------------

    @property
    def prompt(self) -> str:
        """See `script.Panel`."""
        return f"[{self.digits}] {self.mode}> "

    def load(self, data: bytes, name: str) -> list[Diagnostic]:
        """See `script.Panel`."""
        image, findings = memory.read_image(data, name=name)
        if image is not None:
            self.machine.image = image
        return findings

    def play(self, text: str) -> Line | None:
        """See `script.Panel`; keys behind one that shows an error are not pressed."""
        plain = " ".join(text.partition("#")[0].split())
        shown: list[Shown] = []
        keys = keys_in(plain)
        if keys is not None:
            for key in keys:
                new = self.press(key)
                shown += [one for one in new if one.text]
                if new and new[-1].digits.startswith("E"):
                    break
        elif plain:
            happens = happening(_HAPPENS, plain)
            if happens is None:
                return None
            shown += self._happen(*happens)
        return Line(
            " ".join(text.split()),
            tuple(shown),
            self.waits_for,
            str(self.mode),
            self.machine.time_s,
        )

    def _happen(self, name: str, numbers: list[int]) -> list[Shown]:
        deed: Deed = getattr(self, name)
        try:
            return deed(*numbers)
        except Denied as why:
            return [Shown(self.digits, f"nothing happens: {why}")]

    def help_lines(self) -> Iterator[str]:
        """See `script.Panel`."""
        yield HOW
        for name in unlocked(self.mode):
            key, digit = name.split()
            yield f"{name}  {FUNCTIONS[key][digit].name}"

    def saved(self) -> tuple[bytes | None, list[Diagnostic]]:
        """See `script.Panel`."""
        return self.machine.image.data, []

    # --- keys -----------------------------------------------------------------------------------

    def press(self, key: str) -> list[Shown]:
        """Press a key; return what the digits show then, the last of it stays.

        An error begins with E: then nothing was done.
        """
        try:
            shown = self._press(key)
        except Denied as why:
            self._give_up()
            shown = [Shown(f"E   {why.number:02d}", f"error {why.number}: {why}")]
        if shown:
            self.digits = shown[-1].digits
        return shown

    @property
    def waits_for(self) -> str:
        """What is keyed in next; empty where nothing was begun."""
        if self._address is not None:
            return f"bytes from {self._address:04X} on; U0 ends"
        if self._group is not None:
            return f"{self._group}: a digit"
        if self._entry is not None and self._entry.field is not None:
            field = self._entry.field
            return f"{field.name} {field.digits - len(self._entry.typed)} digits"
        return ""

    def _press(self, key: str) -> list[Shown]:
        if key in FUNCTIONS:
            return self._press_function(key)
        assert key in DIGITS, key
        if self._address is not None:
            return self._press_byte(key)
        if self._group is not None:
            return self._choose(self._group, key)
        if self._entry is None:
            raise Denied(1)
        entry = self._entry.with_digit(key)
        if isinstance(entry, str):
            raise Denied(3, entry)
        self._entry = entry
        if entry.field is not None:
            return [Shown(entry.typed.rjust(6)[-6:], "")] if entry.typed else []
        return self._do(entry.values)

    def _press_function(self, key: str) -> list[Shown]:
        if self._address is not None and key == "U0":
            if self._half:
                raise Denied(3, "half a byte is no byte")
            end, self._address = self._address, None
            return [Shown(f"  {end:04X}", "entered up to before this address")]
        given_up = bool(self.waits_for)
        self._give_up()
        if not any(self.mode in function.modes for function in FUNCTIONS[key].values()):
            raise Denied(1, f"{key} is locked while {WHILE[self.mode]}")
        self._group = key
        return [Shown("      ", "the entry is given up")] if given_up else []

    def _choose(self, group: str, digit: str) -> list[Shown]:
        function = FUNCTIONS[group].get(digit)
        if function is None:
            raise Denied(2, f"{group} has no function {digit}")
        if self.mode not in function.modes:
            raise Denied(1, f"{group} {digit} is locked while {WHILE[self.mode]}")
        self._give_up()
        self._function = function
        self._entry = Entry(function.fields)
        return [] if function.fields else self._do(())

    def _press_byte(self, key: str) -> list[Shown]:
        assert self._address is not None
        self._half += key
        if len(self._half) < 2:
            return []
        address, byte = self._address, int(self._half, 16)
        self.machine.poke(address, byte)
        self._half, self._address = "", address + 1
        return [Shown(f"{address:04X}{byte:02X}", "")]

    def _do(self, values: tuple[int, ...]) -> list[Shown]:
        function = self._function
        assert function is not None
        self._give_up()
        deed: Deed = getattr(self, f"_{function.deed}")
        return deed(*values)

    def _give_up(self) -> None:
        self._group = self._function = self._entry = self._address = None
        self._half = ""

    # --- what functions do ----------------------------------------------------------------------

    def _enter(self, address: int) -> list[Shown]:
        image = self.machine.image
        if not image.base <= address <= image.last:
            raise Denied(9, f"the memory has {image.base:04X} to {image.last:04X}")
        self._address = address
        return [Shown(f"{address:04X}  ", "key in bytes; U0 ends")]

    def _recognise(self) -> list[Shown]:
        return self.machine.recognise()

    def _find(self, number: int) -> list[Shown]:
        return self.machine.find(number)

    def _move(self, first: int, last: int, to: int) -> list[Shown]:
        return self.machine.move(first, last, to)

    def _show(self, first: int, last: int, ms: int) -> list[Shown]:
        return self.machine.show(first, last, ms)

    def _translate(self, copies: int, minus_x: int, x: int, minus_y: int, y: int) -> list[Shown]:
        dx, dy = (-um / 1000 if minus else um / 1000 for minus, um in ((minus_x, x), (minus_y, y)))
        return self.machine.transform(f"translate ({dx:.3f}, {dy:.3f}) copies {copies}")

    def _x_symmetry(self) -> list[Shown]:
        return self.machine.transform("with symmetry x")

    def _y_symmetry(self) -> list[Shown]:
        return self.machine.transform("with symmetry y")

    def _mirror_45(self) -> list[Shown]:
        return self.machine.transform("mirror 45")

    def _mirror_135(self) -> list[Shown]:
        return self.machine.transform("mirror 135")

    def _rotate(self, copies: int, exponent: int, significand: int) -> list[Shown]:
        angle = significand * 10.0 ** (exponent - 8)
        if not 0 < angle <= 360:
            raise Denied(3, f"an angle of {angle:g} degrees: it is 0 to 360")
        return self.machine.rotate(copies, angle)

    def _punch(self, gap: int, corner: int) -> list[Shown]:
        return self.machine.compensate(gap, True, corner)

    def _die(self, gap: int, corner: int) -> list[Shown]:
        return self.machine.compensate(gap, False, corner)

    def _backlash(self, x: int, y: int) -> list[Shown]:
        return self.machine.enter_backlash(x, y)

    def _approach(self, x: int, y: int) -> list[Shown]:
        return self.machine.enter_approach(x, y)

    def _draw(self, ms: int) -> list[Shown]:
        if not ms:
            raise Denied(3, "a step takes 1 to 9999 ms")
        return self._begun(self.machine.begin(ms))

    def _cut(self) -> list[Shown]:
        return self._begun(self.machine.begin())

    def _begun(self, shown: list[Shown]) -> list[Shown]:
        self.mode = Mode.RUNNING
        return shown

    def _to_thread(self) -> list[Shown]:
        return self._returned(self.machine.come_back(None))

    def _to_block(self, number: int) -> list[Shown]:
        return self._returned(self.machine.come_back(number))

    def _returned(self, shown: list[Shown]) -> list[Shown]:
        self.mode = Mode.HALTED
        return shown

    def _go_on(self) -> list[Shown]:
        shown = []
        if self.mode is Mode.SAVED:
            shown = self.machine.load()
            self.mode = self._before_off
            if self.mode is not Mode.RUNNING:
                return shown
        self.mode = Mode.RUNNING
        return [*shown, self.machine.shown("goes on")]

    # --- what happens around the machine --------------------------------------------------------

    def run_on(self) -> list[Shown]:
        """Let the machine run until it stops."""
        return self.run(None)

    def run(self, steps: int | None) -> list[Shown]:
        """Let the machine run so many steps, or until it stops."""
        self._need(Mode.RUNNING)
        shown, stopped = self.machine.run(steps)
        if stopped == "halt":
            self.mode = Mode.HALTED
        elif stopped == "end":
            self.mode = Mode.READY
        return self._seen(shown)

    def run_to_block(self, number: int) -> list[Shown]:
        """Let the machine run to the start of a block."""
        self._need(Mode.RUNNING)
        route, state = self.machine.route, self.machine.state
        assert route is not None
        assert state is not None
        if not 1 <= number <= len(route.program.blocks):
            raise Denied(8, f"there is no block {number}")
        steps = route.start_of(number) - state.stand.place
        if steps <= 0:
            raise Denied(8, f"block {number} lies behind the machine")
        return self.run(steps)

    def short(self, length: int) -> list[Shown]:
        """Let the wire touch the work; it is free so many um back."""
        self._need(Mode.RUNNING)
        shown, stopped = self.machine.short(length)
        if stopped:
            self.mode = Mode.ALARM
        return self._seen(shown)

    def break_wire(self) -> list[Shown]:
        """Let the wire break: the machine stops with an alarm."""
        self._need(Mode.RUNNING)
        self.machine.may_fail()
        self.mode = Mode.BROKEN
        return self._seen([self.machine.shown("ALARM: the wire is broken")])

    def cut_power(self) -> list[Shown]:
        """Let the power fail: what is run goes to tape."""
        if self.mode is Mode.OFF:
            raise Denied(1, "there is no power already")
        self._give_up()
        if self.machine.state is not None:
            self.machine.save()
            self._before_off = self.mode
        elif self.mode is Mode.READY:
            self._before_off = Mode.READY
        self.mode = Mode.OFF
        return self._seen([Shown("      ", "no power")])

    def restore_power(self) -> list[Shown]:
        """Let the power come back."""
        self._need(Mode.OFF)
        saved = self.machine.tape is not None
        self.mode = Mode.SAVED if saved else Mode.READY
        text = "the state is on the tape: U7 2 goes on" if saved else "ready"
        return self._seen([Shown("000000", text)])

    def wait(self, seconds: float) -> list[Shown]:
        """Let time pass."""
        self.machine.time_s += seconds
        return []

    def _need(self, mode: Mode) -> None:
        if self.mode is not mode:
            raise Denied(1, WHILE[self.mode])

    def _seen(self, shown: list[Shown]) -> list[Shown]:
        if shown:
            self.digits = shown[-1].digits
        return shown
