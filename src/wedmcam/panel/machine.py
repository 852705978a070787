"""What stands behind the panel: memory, data processing, and the machine that cuts.

Each deed takes the numbers that were keyed in and returns what the digits show, or raises `Denied`:
then nothing was done. Data processing is that of ``wedmcam convert``, proven as there; cutting is
`simulate`, some steps at a time: a run of N steps is one that is stopped by a power cut N steps on,
and goes on from that state.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from wedmcam.diag import has_errors
from wedmcam.machines import reading
from wedmcam.operations import memory
from wedmcam.operations.convert import convert
from wedmcam.operations.memory import Image, Recognition
from wedmcam.panel.script import Shown
from wedmcam.simulate.conditions import Conditions, setup_of
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Mode, steps_back, way_back
from wedmcam.simulate.record import Event, Record, table_of
from wedmcam.simulate.route import Route, lay
from wedmcam.simulate.run import initial, run
from wedmcam.simulate.scenario import Fault, Trouble, scenario_of
from wedmcam.simulate.state import State, check_state, read_state, state_bytes
from wedmcam.simulate.zd065 import ZD065
from wedmcam.targets import target_of
from wedmcam.targets.entries import Entries

#: Errors by their numbers on the digits [R].
ERRORS = {
    1: "this key is locked here",
    2: "no such function",
    3: "the digits cannot be",
    4: "the backlash is not entered",
    5: "the data are not recognised",
    6: "the data are in another format",
    7: "the data cannot be processed",
    8: "there is no such block",
    9: "the address is outside of the memory",
}


class Denied(Exception):  # noqa: N818 - the machine denies it; it is no error of ours
    """Nothing was done; ``number`` stands on the digits."""

    def __init__(self, number: int, why: str = "") -> None:
        super().__init__(why or ERRORS[number])
        self.number = number


@dataclass(slots=True)
class Machine:
    """A ZD-065.

    Attributes:
        image: its memory for data.
        recognised: what was recognised in it; None where it was changed since.
        conditions: backlash and approach as entered.
        route: of the program that is run.
        setup: under which it is run.
        state: where it stands in it; None where nothing is run.
        tape: the state that was saved when the power failed.
        time_s: virtual time since the panel was switched on.
    """

    image: Image = field(default_factory=lambda: Image(bytes(4096)))
    recognised: Recognition | None = None
    conditions: Conditions = field(default_factory=Conditions)
    route: Route | None = None
    setup: Setup | None = None
    state: State | None = None
    tape: bytes | None = None
    time_s: float = 0.0

    # --- memory ---------------------------------------------------------------------------------

    def poke(self, address: int, byte: int) -> None:
        """Put a byte into the memory."""
        data = bytearray(self.image.data)
        data[self._index(address)] = byte
        self.image = replace(self.image, data=bytes(data))
        self.recognised = None

    def _index(self, address: int) -> int:
        if not self.image.base <= address <= self.image.last:
            raise Denied(9, f"the memory has {self.image.base:04X} to {self.image.last:04X}")
        return address - self.image.base

    def recognise(self) -> list[Shown]:
        """Say what the memory holds; random data are cleared (数据类型的智能识别) [S]."""
        seen, findings = memory.recognise(self.image)
        if seen.format == "random":
            self.image = replace(self.image, data=bytes(len(self.image.data)))
            self.recognised = None
            return [Shown("----00", "random data: all of the memory is cleared")]
        if seen.format == "cleared":
            return [Shown("000000", "the memory is cleared")]
        if has_errors(findings) or seen.last is None:
            first = next((d.message for d in findings), seen.reason)
            raise Denied(7, first)
        self.recognised = seen
        kind = {"compact": "C", "rotation": "A", "compensation": "B"}[seen.format]
        name = {
            "compact": "cutting format",
            "rotation": "rotation format",
            "compensation": "gap compensation format",
        }[seen.format]
        sure = "" if seen.certain else " (lines alone: so would do gap compensation)"
        return [
            Shown(f"{kind}{seen.blocks:5d}", f"{name}, {seen.blocks} blocks{sure}"),
            Shown(f"  {seen.last:04X}", "the last address"),
        ]

    def find(self, number: int) -> list[Shown]:
        """Say where block N is."""
        block, _ = memory.find_block(self.image, number)
        if block is None:
            raise Denied(8, f"there is no block {number}")
        text = f"block {number}: {block.instruction}, {block.data.hex(' ').upper()}"
        return [Shown(f"  {block.address:04X}", text)]

    def move(self, first: int, last: int, to: int) -> list[Shown]:
        """Move a range, and clear where it was (数据搬移)."""
        for address in (first, last, to):
            self._index(address)
        if last < first or to + last - first > self.image.last:
            raise Denied(9, "the range ends before it begins, or reaches beyond the memory")
        moved, _ = memory.move(self.image, first, last, to)
        self.image, self.recognised = moved.image, None
        return [Shown(f"  {to:04X}", f"{last - first + 1} bytes moved; where they were is 0")]

    def show(self, first: int, last: int, ms: int) -> list[Shown]:
        """Show a range three bytes at a time, each for so long."""
        for address in (first, last):
            self._index(address)
        if last < first:
            raise Denied(9, "the range ends before it begins")
        out = []
        for address, group in memory.show(self.image, first, last):
            out.append(Shown(group.hex().upper().ljust(6), f"{address:04X}"))
            self.time_s += ms / 1000
        return out

    # --- data processing ------------------------------------------------------------------------

    def needs(self, format_: str) -> Recognition:
        """Return what was recognised.

        Raises:
            Denied: nothing was, or another format.
        """
        seen = self.recognised
        if seen is None:
            raise Denied(5)
        if seen.format != format_:
            raise Denied(6, f"the data are in the format {seen.format}")
        return seen

    def transform(self, text: str) -> list[Shown]:
        """Translate, reflect or turn the cutting data in the memory."""
        return self._processed("compact", Entries(), (text,))

    def rotate(self, copies: int, angle: float) -> list[Shown]:
        """Make cutting data of the figure in rotation format."""
        return self._processed("rotation", Entries(copies=copies, angle=angle))

    def compensate(self, gap_um: int, outwards: bool, corner_um: int) -> list[Shown]:
        """Make cutting data of the outline in gap compensation format."""
        if corner_um and corner_um < gap_um:
            raise Denied(3, f"r is {corner_um} um, less than the gap")
        corner = float(corner_um) if corner_um else None
        entries = Entries(gap_um=float(gap_um), outwards=outwards, corner_um=corner)
        return self._processed("compensation", entries)

    def _processed(
        self, format_: str, entries: Entries, transforms: tuple[str, ...] = ()
    ) -> list[Shown]:
        seen = self.needs(format_)
        assert seen.first is not None
        data = self.image.data[seen.first - self.image.base :]
        made = convert(
            data, to="compact", format=format_, name="memory", entered=entries,
            transforms=transforms,
        )  # fmt: skip
        if made.data is None or not made.ok:
            first = next((d.message for d in made.findings if has_errors([d])), "")
            raise Denied(7, first)
        most = len(self.image.data)
        if len(made.data) > most:
            raise Denied(7, f"{len(made.data)} bytes of data; the memory holds {most}")
        self.image = replace(self.image, data=made.data.ljust(most, b"\0"))
        return self.recognise()

    # --- the machine ----------------------------------------------------------------------------

    def enter_backlash(self, x: int, y: int) -> list[Shown]:
        """Take the backlash of both axes."""
        self.conditions = replace(self.conditions, backlash=(x, y))
        return [Shown("      ", f"backlash x {x} um, y {y} um")]

    def enter_approach(self, x: int, y: int) -> list[Shown]:
        """Take the directions of the last approach, 0 for plus and 1 for minus."""
        signs = (1 - 2 * x, 1 - 2 * y)
        self.conditions = replace(self.conditions, approach=signs)
        return [Shown("      ", "last approach x {} y {}".format(*("-+"[s > 0] for s in signs)))]

    def begin(self, dry_ms: int | None = None) -> list[Shown]:
        """Begin to cut, or to draw dry."""
        seen = self.needs("compact")
        if dry_ms is None and self.conditions.backlash is None:
            raise Denied(4)
        assert seen.first is not None
        target = target_of(reading("compact"))
        data = self.image.data[seen.first - self.image.base :]
        program, _ = target.read(data, "memory", Entries())
        route = lay(program, target.machine.stepping)
        if not route.steps:
            raise Denied(7, "the program makes no step")
        self.route = route
        backlash = self.conditions.backlash or (0, 0)
        self.setup = setup_of(replace(self.conditions, dry_ms=dry_ms), backlash)
        self.state = initial(ZD065, route, self.setup)
        what = "cut" if dry_ms is None else f"draw dry, {dry_ms} ms a step"
        return [self.shown(f"{what}: {len(route.program.blocks)} blocks, {route.steps} steps")]

    def run(self, steps: int | None = None) -> tuple[list[Shown], str]:
        """Run so many steps, to the next halt, or to the end; return what stopped it.

        Returns:
            What is shown, and "steps", "halt" or "end".
        """
        assert self.route is not None
        assert self.state is not None
        here = self.state.stand.place
        goal = self.route.steps if steps is None else min(here + steps, self.route.steps)
        halts = [halt for halt in self.route.halts if here < halt.step <= goal]
        goal = halts[0].step if halts else goal
        last = goal == self.route.steps and not halts
        faults = [] if last else [Fault(Trouble.POWER, goal)]
        record = self._go(faults)
        hidden = {"power-cut", "resume"}
        out = [self._event(event) for event in record.events if event.kind not in hidden]
        if record.finished:
            self.state = None
            return out, "end"
        if not halts:
            out.append(self.shown("running"))
        return out, "halt" if halts else "steps"

    def short(self, length: int) -> tuple[list[Shown], bool]:
        """Let the wire touch; return what is shown, and whether the machine stopped."""
        self.may_fail()
        assert self.state is not None
        step = self.state.stand.place
        faults = [Fault(Trouble.SHORT, step, length=length), Fault(Trouble.POWER, step)]
        record = self._go(faults)
        shown = [self._event(e) for e in record.events if e.kind in ("short", "clear", "alarm")]
        stopped = self.state.stand.mode is Mode.ALARM
        return shown if stopped else [*shown, self.shown("cut on")], stopped

    def may_fail(self) -> None:
        """Refuse faults where the generator is off.

        Raises:
            Denied: the machine draws dry, or moves.
        """
        assert self.route is not None
        assert self.setup is not None
        assert self.state is not None
        step = self.state.stand.place
        if self.setup.dry_ms is not None or (step and self.route.moves[step - 1]):
            raise Denied(1, "the generator is off: wires neither short nor break")

    def come_back(self, block: int | None) -> list[Shown]:
        """Return after a wire break: to the thread point, or to the start of a block."""
        assert self.route is not None
        assert self.state is not None
        step = self.state.stand.place
        if block is not None and not 1 <= block <= self.route.reading(step).block:
            raise Denied(8, f"block {block} was not reached")
        fault = Fault(Trouble.BREAK, step, block=block)
        back = steps_back(self.route, way_back(self.route, ZD065.answers, fault, self.state.stand))
        self._go([replace(fault, cut_after=back)])
        return [self.shown(f"returned, {back} steps; ready to cut on")]

    def save(self) -> None:
        """Save the state, as the power fails: to tape [S]."""
        assert self.state is not None
        self.tape, self.state = state_bytes(self.state), None

    def load(self) -> list[Shown]:
        """Take the state of the tape."""
        assert self.tape is not None
        assert self.route is not None
        state, findings = read_state(self.tape, "tape")
        wrong = (
            findings if state is None else check_state(state, ZD065.name, self.route, "", "tape")
        )
        assert state is not None, wrong
        self.state, self.tape = state, None
        return [self.shown("the state is read from the tape; ready to cut on")]

    def _go(self, faults: list[Fault]) -> Record:
        assert self.route is not None
        assert self.setup is not None
        assert self.state is not None
        before = self.state.time_s
        record, wrong = run(
            ZD065, self.route, scenario_of(faults), self.setup, self.state, stop_at_power=True
        )
        if record is None:
            raise Denied(1, wrong[0].message)
        self.state = record.state
        self.time_s += record.state.time_s - before
        return record

    # --- the display ----------------------------------------------------------------------------

    def shown(self, text: str) -> Shown:
        """Return J of the block that is run, as the digits show it, and where that is."""
        assert self.route is not None
        assert self.state is not None
        assert self.setup is not None
        held = self.route.reading(self.state.stand.place)
        x, y = table_of(self.state.axes, self.setup)
        where = f"block {held.block}, J {held.j}, table ({x / 1000:.3f}, {y / 1000:.3f}) mm"
        return Shown(f"{held.j:6d}", f"{where}: {text}")

    def _event(self, event: Event) -> Shown:
        x, y = (um / 1000 for um in event.table_um)
        where = f"block {event.block}, J {event.j}, table ({x:.3f}, {y:.3f}) mm"
        return Shown(f"{event.j:6d}", f"{where}: {_EVENTS[event.kind]}")


_EVENTS = {
    "pause": "pause",
    "thread-point": "thread point: the machine stops",
    "short": "short circuit, no feed signal",
    "clear": "the feed signal is back",
    "alarm": "ALARM: still shorted after the way back",
    "clear-alarm": "cut on",
    "back": "cut on",
    "end": "end of the program",
}
