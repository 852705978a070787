"""The terminal of Eindhoven's microcomputer: the command line of MAIN, and what it answers.

The report states the routines that take a line in and read numbers from it
(`controllers.eindhoven.terminal`), and that MAIN takes in place, new place, t(i), t(p) and cutting
speed; the rest was 'still in development' [S]. So the commands here are ours [R]: a record as it
stands in a ``.d15``, and one letter for everything else.

Priorities are the report's [S]: an emergency above the timers, the timers above the keyboard. While
a vector runs, a typed line waits for its end; an emergency does not.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from wedmcam.controllers.eindhoven import terminal as line_of
from wedmcam.controllers.eindhoven.terminal import Buffer, Line, Lost, Number
from wedmcam.diag import Diagnostic, has_errors
from wedmcam.formats import dem15
from wedmcam.panel import script
from wedmcam.panel.microcomputer import NAME, Machine, NotDone
from wedmcam.panel.script import NUMBER, Shown, happening
from wedmcam.simulate.scenario import Trouble


class Mode(StrEnum):
    """What the machine is about."""

    STANDBY = "stand-by"  # nothing is run
    RUNNING = "running"  # the timers step
    HALTED = "halted"  # at a pause, or between two vectors
    EMERGENCY = "emergency"  # a run was broken off: safe, places kept


#: What the machine does in a mode, behind "while".
WHILE = {
    Mode.STANDBY: "nothing is run",
    Mode.RUNNING: "the machine runs",
    Mode.HALTED: "the machine is halted",
    Mode.EMERGENCY: "the machine stands after an emergency",
}
HOW = (
    "lines are typed (? lists commands), or happen: run, run N, run to record N, stop, limit, "
    "break, short UM, wait 5s"
)
_HAPPENS = (
    (re.compile(r"run"), "run_on"),
    (re.compile(rf"run {NUMBER}"), "run"),
    (re.compile(rf"run to record {NUMBER}"), "run_to_record"),
    (re.compile(r"stop"), "stop"),
    (re.compile(r"limit"), "limit"),
    (re.compile(r"break"), "break_wire"),
    (re.compile(rf"short {NUMBER}"), "short"),
    (re.compile(rf"wait {NUMBER} ?s"), "wait"),
)
#: How characters that do not print are written in scripts and transcripts.
_KEYS = {
    "<BS>": line_of.BACKSPACE,
    "<DEL>": line_of.DELETE,
    "<^U>": line_of.CANCEL,
    "<^R>": line_of.RETYPE,
}
_WRITTEN = {chr(code): name for name, code in _KEYS.items()}
_VOLT_T_I, _VOLT_T_P = dem15.VOLTS_T_I / dem15.CONTROL, dem15.VOLTS_T_P / dem15.CONTROL
#: Records that D lists at a time: a screen.
SCREEN = 16


@dataclass(frozen=True, slots=True)
class Command:
    """What a word of a line does.

    Attributes:
        name: for people.
        deed: name of the method of `Terminal` that does it.
        modes: in which it is done.
        numbers: what follows it.
        least: so many of them have to be there.
        hexadecimal: they are read by GNUMHX, else by GETNUM.
    """

    name: str
    deed: str
    modes: frozenset[Mode]
    numbers: tuple[str, ...] = ()
    least: int = 0
    hexadecimal: bool = False


_IDLE = frozenset({Mode.STANDBY})
_STOPPED = frozenset({Mode.HALTED, Mode.EMERGENCY})
_ALL = frozenset(Mode)
#: Word -> what it does; a line that begins with a digit is a record.
COMMANDS: dict[str, Command] = {
    "UM": Command("positions count um", "count_um", _IDLE),
    "STEPS": Command("positions count steps", "count_steps", _IDLE),
    dem15.PAUSE: Command("a pause in the program", "pause", _IDLE),
    dem15.END: Command("the end of the program", "end", _IDLE),
    "B": Command("take the last record back", "take_back", _IDLE),
    "N": Command("a new program", "new", _IDLE),
    "D": Command("list the program", "list", _ALL, ("the first record",)),
    "S": Command("save the program on tape", "save", _ALL),
    "L": Command("load the program of the tape", "load_tape", _IDLE),
    "A": Command("state where the wire stands", "at", _IDLE, ("x", "y"), 2),
    "G": Command("go: run the program", "go", _IDLE),
    "V": Command("run one vector", "vector", _IDLE | _STOPPED),
    "H": Command("halt at the end of the vector", "halt", frozenset({Mode.RUNNING})),
    "C": Command("continue", "go_on", _STOPPED),
    "K": Command("give the run up", "give_up", _STOPPED),
    "W": Command("where the wire stands", "where", _ALL),
    "O": Command("the ports", "ports", _ALL, ("the address",), 0, True),
    "?": Command("list the commands", "help", _ALL),
}


class Refused(Exception):  # noqa: N818 - a line is refused; it is no error of ours
    """Nothing was done.

    Attributes:
        at: which character of the line is why, from 0.
        length: how many are.
        hint: what to do; None where nothing is to be said.
    """

    def __init__(self, why: str, at: int, length: int = 1, hint: str | None = None) -> None:
        super().__init__(why)
        self.at = at
        self.length = length
        self.hint = hint


class Terminal:
    """The terminal with the machine behind it.

    Attributes:
        machine: what stands behind it.
        mode: what that is about.
    """

    controller = "eindhoven"
    greeting = "the terminal of Eindhoven's microcomputer at a DEM-15; help, quit"
    how = HOW

    def __init__(self, machine: Machine | None = None) -> None:
        self.machine = machine or Machine()
        self.mode = Mode.STANDBY
        self._line = Line()
        self._waiting: bytes | None = None
        self._one_vector = False

    # --- lines ----------------------------------------------------------------------------------

    @property
    def prompt(self) -> str:
        """See `script.Panel`."""
        return f"{self.mode}> "

    def load(self, data: bytes, name: str) -> list[Diagnostic]:
        """See `script.Panel`."""
        return self.machine.load(data, name)

    def saved(self) -> tuple[bytes | None, list[Diagnostic]]:
        """See `script.Panel`: the program is read back first."""
        data = self.machine.data
        findings = self.machine.read(data, NAME)[1]
        return (None if has_errors(findings) else data), findings

    def help_lines(self) -> Iterator[str]:
        """See `script.Panel`."""
        yield HOW
        yield from (one.text for one in self._help())

    def play(self, text: str) -> script.Line:
        """See `script.Panel`; every line is one that can be typed."""
        plain = text.partition("#")[0].rstrip()
        happens = happening(_HAPPENS, plain)
        shown = self._happen(*happens) if happens is not None else self.type(codes_of(plain))
        place = self.machine.place
        return script.Line(
            "".join(map(_written, text.strip())),
            tuple(shown),
            "" if self._waiting is None else "a line waits for the end of the vector",
            str(self.mode),
            self.machine.time_s,
            {"place": None if place is None else list(place), "positions": self.machine.unit},
        )

    def type(self, codes: bytes) -> list[Shown]:
        """Type characters, and end the line."""
        shown: list[Shown] = []
        echo, begin = b"", 0
        for n, code in enumerate(codes + bytes((line_of.RETURN,))):
            self._line, sent = line_of.take(self._line, code)
            if self._line.closed:
                line, self._line = self._line, self._line.next()
                if echo != codes[begin:n]:
                    shown += _say(*line_of.screen(echo))
                shown += self._read(line)
                echo, begin = b"", n + 1
            else:
                echo += sent
        return shown

    def _read(self, line: Line) -> list[Shown]:
        """Do what a line says that was ended, or let it wait."""
        if line.lost is not Lost.NONE:
            again = "control R brings the line back, to be corrected"
            lost = Refused(_LOST[line.lost], line.lost_at, hint=again)
            return _refusal(line.data, lost)
        if self.mode is Mode.RUNNING and line.data:
            if self._waiting is not None:
                why = "a line waits for the end of the vector already"
                return _refusal(line.data, Refused(why, 0))
            self._waiting = line.data
            return []
        return self._main(line.data)

    def _main(self, data: bytes) -> list[Shown]:
        """Do what a line says (MAIN)."""
        data = line_of.normal(data)
        try:
            return self._command(Buffer(data))
        except Refused as why:
            return _refusal(data, why)

    def _command(self, buffer: Buffer) -> list[Shown]:
        carry, buffer = line_of.skip(buffer)
        if not carry:
            return []
        if chr(buffer.here).isdigit():
            return self._enter(buffer)
        begin, word = buffer.pointer, ""
        while buffer.here != line_of.END and buffer.here not in line_of.SEPARATORS:
            code, buffer = line_of.gnumci(buffer)
            word += chr(code)
        command = COMMANDS.get(word)
        if command is None:
            raise Refused("there is no such command", begin, len(word), "? lists the commands")
        if self.mode not in command.modes:
            raise Refused(f"{word} is not done while {WHILE[self.mode]}", begin, len(word))
        read = line_of.gnumhx if command.hexadecimal else line_of.getnum
        numbers = _numbers(buffer, command.numbers, command.least, read)
        deed: Callable[..., list[Shown]] = getattr(self, f"_{command.deed}")
        try:
            return deed(*(number.value for number, _ in numbers))
        except NotDone as why:
            raise Refused(str(why), begin, len(word), why.hint) from why

    def _enter(self, buffer: Buffer) -> list[Shown]:
        """Take a record into the program."""
        if self.mode is not Mode.STANDBY:
            raise Refused(f"no record is taken while {WHILE[self.mode]}", buffer.pointer)
        numbers = _numbers(buffer, dem15.FIELDS, len(dem15.FIELDS), line_of.getnum)
        record = " ".join(str(number.value) for number, _ in numbers)
        try:
            return self._entered(self.machine.enter(record))
        except NotDone as why:
            number, at = numbers[why.field or 0]
            raise Refused(str(why), at, number.digits, why.hint) from why

    def _entered(self, number: int) -> list[Shown]:
        return _say(f"record {number}: {self.machine.describe(number)}")

    # --- commands -------------------------------------------------------------------------------

    def _count_um(self) -> list[Shown]:
        self.machine.count("um")
        return _say("positions count um, two a step")

    def _count_steps(self) -> list[Shown]:
        self.machine.count("steps")
        return _say("positions count steps")

    def _pause(self) -> list[Shown]:
        return self._entered(self.machine.enter(dem15.PAUSE))

    def _end(self) -> list[Shown]:
        return self._entered(self.machine.enter(dem15.END))

    def _take_back(self) -> list[Shown]:
        return _say(f"taken back: {self.machine.take_back()}")

    def _new(self) -> list[Shown]:
        self.machine.records = []
        return _say("the program is empty")

    def _list(self, first: int = 1) -> list[Shown]:
        records = self.machine.records
        if not 1 <= first <= len(records):
            raise NotDone(f"there is no record {first}" if records else "the program is empty")
        rows = list(enumerate(records, 1))[first - 1 : first - 1 + SCREEN]
        more = [] if rows[-1][0] == len(records) else [f"D {rows[-1][0] + 1} goes on"]
        return _say(*(f"{number:5d}  {text}" for number, text in rows), *more)

    def _save(self) -> list[Shown]:
        self.machine.punch()
        return _say(f"{_number(len(self.machine.records), 'record')} on tape")

    def _load_tape(self) -> list[Shown]:
        self.machine.load_tape()
        return _say(f"{_number(len(self.machine.records), 'record')} of the tape")

    def _at(self, x: int, y: int) -> list[Shown]:
        self.machine.set_place(x, y)
        return _say(self._place())

    def _go(self) -> list[Shown]:
        self.machine.begin()
        assert self.machine.route is not None
        what = f"{_number(len(self.machine.records), 'record')}, {self.machine.route.steps} steps"
        return [*_say(what), *self._run_on(one_vector=False)]

    def _vector(self) -> list[Shown]:
        if self.mode is Mode.STANDBY:
            self.machine.begin()
        return self._run_on(one_vector=True)

    def _go_on(self) -> list[Shown]:
        return self._run_on(one_vector=False)

    def _run_on(self, one_vector: bool) -> list[Shown]:
        """Start the timers: t(i), t(p) and OEV are those of the record."""
        self.mode, self._one_vector = Mode.RUNNING, one_vector
        what = "one vector" if one_vector else "runs"
        return _say(f"{self._where_in_run()}: {what}")

    def _halt(self) -> list[Shown]:
        self._one_vector = True
        return []

    def _give_up(self) -> list[Shown]:
        self.machine.give_up()
        self.mode = Mode.STANDBY
        return _say(f"{self._place()}: the run is given up")

    def _where(self) -> list[Shown]:
        return _say(self._place() if self.mode is Mode.STANDBY else self._where_in_run())

    def _ports(self, address: int | None = None) -> list[Shown]:
        """Show what is written to the ports: safe values but while the timers run."""
        t_i, t_p = self.machine.words if self.mode is Mode.RUNNING else (0, 0)
        volts_i, volts_p = t_i * _VOLT_T_I, t_p * _VOLT_T_P
        rows = {
            0x4020: f"V(t(i)) {t_i:02X}H, {volts_i:.2f} V",
            0x4021: f"V(t(p)) {t_p:02X}H, {volts_p:.2f} V",
            0x4022: f"OEV {int(not t_p)}, the generator is {'on' if t_p else 'off'}",
        }
        if address not in (None, *rows):
            raise NotDone("the outputs are " + ", ".join(f"{one:X}" for one in rows))
        return _say(*(f"{one:X} {row}" for one, row in rows.items() if address in (None, one)))

    def _help(self) -> list[Shown]:
        rows = ["x y  new x y  t(i) t(p) speed: a record"] if self.mode is Mode.STANDBY else []
        for word, command in COMMANDS.items():
            if self.mode in command.modes:
                rows.append(f"{word}: {command.name}")
        return _say(*rows)

    def _place(self) -> str:
        """Return what the position counters hold."""
        place = self.machine.place
        if place is None:
            return "no place is taken in yet"
        return f"x {place[0]:5d} y {place[1]:5d} {self.machine.unit}"

    def _where_in_run(self) -> str:
        left = _number(self.machine.steps_left, "step")
        return f"{self._place()}, record {self.machine.record}, {left} to its end"

    # --- what happens around the machine --------------------------------------------------------

    def _happen(self, name: str, numbers: Sequence[int]) -> list[Shown]:
        deed: Callable[..., list[Shown]] = getattr(self, name)
        try:
            return deed(*numbers)
        except NotDone as why:
            return _say(f"nothing happens: {why}")

    def run_on(self) -> list[Shown]:
        """Let the machine run until it stops."""
        return self.run(None)

    def run(self, steps: int | None) -> list[Shown]:
        """Let the machine run so many steps, or until it stops; a line that waits is read."""
        self._need_run()
        machine = self.machine
        assert machine.route is not None
        most = machine.route.steps
        goal = most if steps is None else min(machine.here + steps, most)
        shown: list[Shown] = []
        while self.mode is Mode.RUNNING:
            end = machine.vector_end
            stop = min(goal, end) if self._one_vector or self._waiting is not None else goal
            what = machine.advance(stop)
            shown += self._arrived(what, vector_ends=what != "there" or stop == end)
            if what == "there" and stop == goal:
                break
        if self.mode is Mode.RUNNING:
            shown += _say(f"{self._where_in_run()}: running")
        return shown

    def _arrived(self, what: str, vector_ends: bool) -> list[Shown]:
        """Return what the line that waits says at the end of a vector, and where the run halts.

        The line is read before the machine halts: one that was typed while it ran never skips a
        pause.
        """
        shown: list[Shown] = []
        if vector_ends and self._waiting is not None:
            data, self._waiting = self._waiting, None
            shown = [*_say(data.decode("ascii")), *self._main(data)]
        if what == "end":
            self.machine.give_up()
            self.mode = Mode.STANDBY
            return [*shown, *_say(f"{self._place()}: end of the program")]
        if what == "pause":
            self.mode = Mode.HALTED
            return [*shown, *_say(f"{self._where_in_run()}: pause; C continues")]
        if vector_ends and self._one_vector:
            self.mode = Mode.HALTED
            return [*shown, *_say(f"{self._where_in_run()}: halted; C continues, V for one vector")]
        return shown

    def run_to_record(self, number: int) -> list[Shown]:
        """Let the machine run to the start of a record."""
        self._need_run()
        steps = self.machine.start_of(number) - self.machine.here
        if steps <= 0:
            raise NotDone(f"record {number} lies behind the machine")
        return self.run(steps)

    def stop(self) -> list[Shown]:
        """Press the emergency stop."""
        return self._break_off(Trouble.STOP, "emergency stop")

    def limit(self) -> list[Shown]:
        """Let a limit switch open."""
        return self._break_off(Trouble.LIMIT, "limit switch, the motors have no supply")

    def break_wire(self) -> list[Shown]:
        """Let the wire break."""
        self._need_run()
        return self._break_off(Trouble.BREAK, "the wire is broken")

    def _break_off(self, trouble: Trouble, text: str) -> list[Shown]:
        """Run the routine of an emergency, which is the initialisation."""
        if self.mode is Mode.RUNNING:
            self.machine.fail(trouble)
        if self.mode is not Mode.STANDBY:
            self.mode = Mode.EMERGENCY
        in_run = self.mode is Mode.EMERGENCY
        where = self._where_in_run() if in_run else self._place()
        shown = _say(
            f"EMERGENCY: {text}",
            f"{where}: kept; V(t(i)) = V(t(p)) = 0, generator off, interrupts off"
            + ("; C continues" if in_run else ""),
        )
        return [*shown, *self._drop_waiting()]

    def _drop_waiting(self) -> list[Shown]:
        """Forget a line that was typed before an emergency: it could start the machine again."""
        data, self._waiting = self._waiting, None
        return [] if data is None else _say(f"not read: {data.decode('ascii')}")

    def short(self, length_um: int) -> list[Shown]:
        """Let the wire touch the work; it is free so many um back."""
        self._need_run()
        if not length_um:
            raise NotDone("a wire that is free on the spot does not touch")
        if not self.machine.fail(Trouble.SHORT, length_um):
            return _say(f"{self._where_in_run()}: shorted, went back, is free and here again")
        self.mode = Mode.EMERGENCY
        return [
            *_say(f"{self._where_in_run()}: ALARM, still shorted after the way back; C continues"),
            *self._drop_waiting(),
        ]

    def wait(self, seconds: int) -> list[Shown]:
        """Let time pass."""
        self.machine.time_s += seconds
        return []

    def _need_run(self) -> None:
        if self.mode is not Mode.RUNNING:
            raise NotDone(WHILE[self.mode])


_LOST = {
    Lost.LENGTH: f"a line has {line_of.LONGEST} characters, and the rest is not taken",
    Lost.STRANGE: "a character here is none of the terminal's",
}


def codes_of(text: str) -> bytes:
    r"""Return the characters that a line of a script types.

    >>> codes_of("4<BS>5"), codes_of("5\N{MICRO SIGN}m")
    (b'4\x085', b'5\xb5m')
    """
    parts = re.split("|".join(f"({re.escape(name)})" for name in _KEYS), text)
    codes = b""
    for part in filter(None, parts):
        key = _KEYS.get(part)
        # What has no 7 bits is no character of the terminal: LINE refuses it.
        codes += bytes((key,)) if key is not None else bytes(min(ord(c), 0xFF) for c in part)
    return codes


def _written(character: str) -> str:
    return _WRITTEN.get(character, character)


def _numbers(
    buffer: Buffer,
    names: Sequence[str],
    least: int,
    read: Callable[[Buffer], tuple[Number, Buffer]],
) -> list[tuple[Number, int]]:
    """Return the numbers up to the end of a line, with where they stand.

    Raises:
        Refused: one is missing, is none, or too large, or there is something more.
    """
    numbers: list[tuple[Number, int]] = []
    carry, buffer = line_of.skip(buffer)
    for name in names:
        begin = buffer.pointer
        if not carry and len(numbers) >= least:
            return numbers
        if not carry:
            raise Refused(f"{name} is missing", begin)
        number, buffer = read(buffer)
        ends = buffer.here in (line_of.END, *line_of.SEPARATORS)
        if not number.digits or not ends:
            raise Refused(f"{name} is a number: this is no digit", buffer.pointer)
        if number.overflows:
            raise Refused(f"{name} has more than 16 bits", begin, number.digits)
        numbers.append((number, begin))
        carry, buffer = line_of.skip(buffer)
    if carry:
        raise Refused("nothing more is expected", buffer.pointer)
    return numbers


def _refusal(data: bytes, why: Refused) -> list[Shown]:
    """Return a refused line with a mark below what is wrong."""
    mark = " " * why.at + "^" + "~" * (why.length - 1)
    hint = [] if why.hint is None else [f"hint: {why.hint}"]
    return _say(data.decode("ascii"), mark, f"refused: {why}", *hint)


def _say(*texts: str) -> list[Shown]:
    return [Shown("", text) for text in texts]


def _number(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"
