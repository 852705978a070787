"""What stands behind the terminal of Eindhoven's microcomputer: a program, a place, a machine.

Each deed returns, or raises `NotDone`: then nothing was done. What a record may hold is what the
reader of a ``.d15`` takes (`frontends.dem15`); the machine is `simulate`, some steps at a time: a
run up to a place is one that a power cut stops there, and it goes on from that state.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

from wedmcam.diag import Diagnostic, TextSpan, has_errors
from wedmcam.formats import dem15
from wedmcam.frontends.dem15 import describe_blocks, records_in
from wedmcam.ir.program import Program
from wedmcam.machines import Machine as Profile
from wedmcam.machines import builtin
from wedmcam.simulate.conditions import Conditions, setup_of
from wedmcam.simulate.eindhoven import EINDHOVEN
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Mode
from wedmcam.simulate.record import Record, table_of
from wedmcam.simulate.route import Route
from wedmcam.simulate.run import initial, run
from wedmcam.simulate.scenario import Fault, Trouble, scenario_of
from wedmcam.simulate.state import State
from wedmcam.targets import target_of
from wedmcam.targets.entries import Entries

#: What positions count -> the profile of the machine that counts so.
PROFILES = {"um": "dem15", "steps": "dem15-steps"}
#: What a file of the memory is called in findings.
NAME = "program"


@cache
def _profile(unit: str) -> Profile:
    return builtin(PROFILES[unit])


class NotDone(Exception):  # noqa: N818 - the machine does not do it; it is no error of ours
    """Nothing was done.

    Attributes:
        hint: what to do; None where nothing is to be said.
        field: which number of a record is why, 0 to 6; None where it is none of them.
    """

    def __init__(self, why: str, hint: str | None = None, field: int | None = None) -> None:
        super().__init__(why)
        self.hint = hint
        self.field = field


@dataclass(slots=True)
class Machine:
    """The microcomputer at its DEM-15.

    Attributes:
        unit: what positions count, a key of `formats.dem15.UNITS`.
        records: the program: records, pauses and ends, one text each.
        place: what the position counters hold; None where no place was taken in yet.
        tape: the program that was punched last.
        route: of the program that is run; None where none is.
        setup: under which it is run.
        state: where it stands in it.
        origin: the place of its first record.
        paused: how many pauses of it are behind the machine.
        time_s: virtual time since the machine was switched on.
    """

    unit: str = "um"
    records: list[str] = field(default_factory=list)
    place: tuple[int, int] | None = None
    tape: bytes | None = None
    route: Route | None = None
    setup: Setup | None = None
    state: State | None = None
    origin: tuple[int, int] = (0, 0)
    paused: int = 0
    time_s: float = 0.0

    # --- the program ----------------------------------------------------------------------------

    @property
    def profile(self) -> Profile:
        """The machine that counts so."""
        return _profile(self.unit)

    @property
    def data(self) -> bytes:
        """The program as a file."""
        return self._file(self.records)

    def _file(self, records: list[str]) -> bytes:
        return "".join(f"{line}\n" for line in (dem15.UNITS[self.unit][0], *records)).encode()

    def read(self, data: bytes, name: str) -> tuple[Program, list[Diagnostic]]:
        """Return the program of a file, with the findings."""
        program, findings = target_of(self.profile).read(data, name, Entries())
        return program, list(findings)

    def load(self, data: bytes, name: str) -> list[Diagnostic]:
        """Take the program of a file; an error says that it is none, and nothing is changed."""
        unit, records = records_in(data, name)
        before = self.unit
        self.unit = unit or before
        findings = self.read(data, name)[1]
        if has_errors(findings):
            self.unit = before
        else:
            self.records = records
        return findings

    def enter(self, record: str) -> int:
        """Take a record, a pause or an end into the program; return its number.

        Raises:
            NotDone: it could not be run as it is meant, or does not follow on the one before.
        """
        # All that a record is held against is the one before it, and an end.
        before = next((text for text in reversed(self.records) if text[0].isdigit()), None)
        last = self.records[-1:] if self.records[-1:] != [before] else []
        known = [*([] if before is None else [before]), *last]
        end = [] if record == dem15.END else [dem15.END]
        findings = self.read(self._file([*known, record, *end]), NAME)[1]
        if has_errors(findings):
            raise self._not_taken(record, findings[0])
        self.records.append(record)
        return len(self.records)

    def _not_taken(self, record: str, finding: Diagnostic) -> NotDone:
        """Return why a record is not taken, with its number that is the reason."""
        span = finding.span
        at = span.column - 1 if isinstance(span, TextSpan) else 0
        field = record[:at].count(" ") if record[0].isdigit() else None
        return NotDone(finding.message, finding.hint, field)

    def describe(self, number: int) -> str:
        """Return what a record says of way, speed and generator, for people."""
        record = self.records[number - 1]
        if not record[0].isdigit():
            return {dem15.PAUSE: "pause", dem15.END: "end"}[record]
        x, y, new_x, new_y = map(int, record.split()[:4])
        mm = dem15.STEP_UM / 1000 / dem15.UNITS[self.unit][1]
        (told,) = describe_blocks(self._file([record]), self.profile).values()
        return f"{(new_x - x) * mm:.3f}, {(new_y - y) * mm:.3f} mm, {told}"

    def take_back(self) -> str:
        """Take the last record out of the program; return it.

        Raises:
            NotDone: there is none.
        """
        if not self.records:
            raise NotDone("the program is empty")
        return self.records.pop()

    def count(self, unit: str) -> None:
        """Take what positions count.

        Raises:
            NotDone: there is a program, or a place, that counts something else.
        """
        if unit != self.unit and (self.records or self.place is not None):
            raise NotDone(f"positions count {self.unit} already")
        self.unit = unit

    def set_place(self, x: int, y: int) -> None:
        """Take in where the wire stands.

        Raises:
            NotDone: steps never arrive there.
        """
        per_step = dem15.UNITS[self.unit][1]
        if x % per_step or y % per_step:
            raise NotDone(f"({x}, {y}) is odd: steps of {dem15.STEP_UM} um never arrive there")
        self.place = (x, y)

    def complete(self) -> Program:
        """Return the program.

        Raises:
            NotDone: it could not be run.
        """
        program, findings = self.read(self.data, NAME)
        if has_errors(findings):
            raise NotDone(findings[0].message, findings[0].hint)
        return program

    def punch(self) -> None:
        """Punch the program on tape.

        Raises:
            NotDone: it has no end.
        """
        self.complete()
        self.tape = self.data

    def load_tape(self) -> None:
        """Take the program of the tape in.

        Raises:
            NotDone: there is no tape, or its positions count something else.
        """
        if self.tape is None:
            raise NotDone("there is no tape in the reader")
        unit, records = records_in(self.tape, "tape")
        if unit is not None and unit != self.unit and self.place is not None:
            raise NotDone(f"positions of the tape count {unit}, those of the machine {self.unit}")
        self.unit, self.records = unit or self.unit, records

    # --- the run --------------------------------------------------------------------------------

    def begin(self) -> None:
        """Begin the program.

        Raises:
            NotDone: there is none, or the wire stands elsewhere.
        """
        program = self.complete()
        route = EINDHOVEN.lay(program, self.profile.stepping)
        if not route.steps:
            raise NotDone("the program makes no step")
        first = next(text for text in self.records if text[0].isdigit())
        x, y = map(int, first.split()[:2])
        if self.place not in (None, (x, y)):
            assert self.place is not None
            raise NotDone(
                "the wire stands at ({}, {}), and the program begins at ({}, {})".format(
                    *self.place, x, y
                ),
                "A X Y states where the wire stands",
            )
        self.place = self.origin = (x, y)
        self.route, self.paused = route, 0
        self.setup = setup_of(Conditions(), (0, 0), route.step_um)
        self.state = initial(EINDHOVEN, route, self.setup)

    def give_up(self) -> None:
        """Run the program no more; the place is kept."""
        self.route = self.setup = self.state = None

    @property
    def here(self) -> int:
        """How many steps of the program are behind the machine."""
        assert self.state is not None
        return self.state.stand.place

    @property
    def vector_end(self) -> int:
        """After how many steps of the program the vector ends that is run next."""
        assert self.route is not None
        later = self.route.first[self.route.first > self.here]
        return int(later[0]) if len(later) else self.route.steps

    @property
    def record(self) -> int:
        """Number of the record that is run, from 1."""
        assert self.route is not None
        return self.route.reading(self.here).block

    @property
    def steps_left(self) -> int:
        """Steps to the end of the record that is run."""
        assert self.route is not None
        return self.route.reading(self.here).j

    def start_of(self, number: int) -> int:
        """Return after how many steps of the program a record begins.

        Raises:
            NotDone: there is none of this number.
        """
        assert self.route is not None
        if not 1 <= number <= len(self.route.program.blocks):
            raise NotDone(f"there is no record {number}")
        return self.route.start_of(number)

    def advance(self, goal: int) -> str:
        """Run on to a place, or to a pause before it; return "there", "pause" or "end"."""
        assert self.route is not None
        pauses = [halt.step for halt in self.route.halts[self.paused : self.paused + 1]]
        pause = bool(pauses) and pauses[0] <= goal
        goal = pauses[0] if pause else goal
        last = goal == self.route.steps and not pause
        self._go([] if last else [Fault(Trouble.POWER, goal)])
        self.paused += pause
        if last:
            return "end"
        return "pause" if pause else "there"

    def fail(self, trouble: Trouble, length_um: int = 0) -> bool:
        """Let something go wrong; return whether the machine stopped with an alarm.

        Raises:
            NotDone: it cannot happen here.
        """
        assert self.route is not None
        here = self.here
        self._go([Fault(trouble, here, length=length_um), Fault(Trouble.POWER, here)])
        # Of pauses before which it went back it comes to again.
        self.paused = min(self.paused, sum(halt.step <= self.here for halt in self.route.halts))
        assert self.state is not None
        return self.state.stand.mode is Mode.ALARM

    def _go(self, faults: list[Fault]) -> Record:
        assert self.route is not None
        assert self.setup is not None
        assert self.state is not None
        before = self.state.time_s
        record, wrong = run(
            EINDHOVEN, self.route, scenario_of(faults), self.setup, self.state, stop_at_power=True
        )
        if record is None:
            raise NotDone(wrong[0].message.removeprefix(f"{faults[0]}: "))
        self.state = record.state
        self.time_s += record.state.time_s - before
        x, y = table_of(self.state.axes, self.setup)
        per_step = dem15.UNITS[self.unit][1]
        self.place = self.origin[0] + x * per_step, self.origin[1] + y * per_step
        return record

    @property
    def words(self) -> tuple[int, int]:
        """t(i) and t(p) of the record that is run."""
        t_i, t_p = map(int, self.records[self.record - 1].split()[4:6])
        return t_i, t_p
