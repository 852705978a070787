"""Controllers whose programs state the path of the wire: 3B, the ZD-065's formats, ISO.

The operator enters nothing for a plan, paths may start anywhere, and reader and writer are those of
the format.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from wedmcam.diag import Diagnostic, error
from wedmcam.diag.run import WrongUse
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Axis, Program
from wedmcam.machines import Machine, iso_profiles
from wedmcam.targets.entries import Entries

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wedmcam.programs import reblock as carry
    from wedmcam.transforms.lower import Rules


#: Formats with control words of one kind, a shop's own among them; an M word of ISO is none.
KIN_3B = frozenset({"3b", "4b"})


@dataclass(frozen=True, slots=True)
class Stated:
    """What all of them share; a format with nothing special needs no more.

    Attributes:
        machine: the profile.
        square: arcs count on the inscribed square, not on an axis.
        geometric: J by geometry can be asked for (``--count textbook``).
        words: a pattern of the bare control words that the format keeps; empty for none.
        kin: formats whose words it keeps, all of them.
        pairs: a line alone between two pauses would be read as a move.
        end: there is a record for the end of the file beside that for the end of cutting.
        turns: a block may hold more than a turn.
    """

    machine: Machine

    is_text: ClassVar[bool] = True
    coarse: ClassVar[bool] = False
    makes_path: ClassVar[bool] = False
    moves_starts: ClassVar[bool] = False
    takes_gap: ClassVar[bool] = False
    states_counts: ClassVar[bool] = False
    needs_lead: ClassVar[str] = ""
    square: ClassVar[bool] = False
    geometric: ClassVar[bool] = False
    words: ClassVar[str] = ""
    kin: ClassVar[frozenset[str]] = frozenset()
    pairs: ClassVar[bool] = True
    end: ClassVar[bool] = False
    turns: ClassVar[bool] = True

    @property
    def whole_contours(self) -> str:
        """See `Target`."""
        return self.needs_lead

    @property
    def stop_word(self) -> str:
        """See `Target`."""
        return self.machine.words.stop

    @property
    def advice(self) -> tuple[Diagnostic, ...]:
        """Nothing to add: such a program states the very path."""
        return ()

    @property
    def arc_limit_um(self) -> Callable[[NDArray[np.float64]], NDArray[np.float64]] | None:
        """What all else is held to."""
        return None

    @property
    def block_bytes(self) -> tuple[int, int]:
        """A record each."""
        return 1, 1

    @property
    def memory(self) -> int:
        """See `Target`."""
        return self.machine.limits.blocks

    @property
    def refuses_written(self) -> Diagnostic | None:
        """See `Target`."""
        if self.machine.writes:
            return None
        return error(
            "reads-only",
            "profile {profile} reads programs only: it does not state enough to write",
            hint="write with a profile that writes ({writers}), or with one of your own made for "
            "the machine; --profile-in reads its programs",
            profile=self.machine.name,
            writers=list(iso_profiles(lambda m: m.writes)),
        )

    @property
    def refuses_carried(self) -> Diagnostic | None:
        """A path can be stated."""
        return self.refuses_written

    @property
    def own_path(self) -> Machine:
        """Its own: the program states the path."""
        machine = self.machine
        if machine.writes:
            return machine
        closed = replace(machine.iso, coordinates="absolute", unit="mm")
        return replace(machine, writes=True, iso=closed)

    @property
    def square_axis(self) -> Axis:
        """How the inscribed square counts at a tie, seen from the drawing."""
        return Axis.SQUARE_X if self.machine.axes.exchange else Axis.SQUARE

    def rules(self, count: str | None, feed_um: float | None = None) -> Rules:
        """See `Target`."""
        from wedmcam.transforms.lower import Rules

        textbook = (count or self.machine.count) == "textbook"
        if textbook and not self.geometric:
            raise WrongUse(
                "--count textbook is for 3B: the ZD-065 counts on the inscribed square, by stepping"
            )
        limits = self.machine.limits
        return Rules(
            stepping=self.machine.stepping,
            square=self.square,
            square_axis=self.square_axis,
            count_um=limits.count_um,
            line_um=limits.line_um,
            move_um=self.machine.move_um,
            arc_um=limits.arc_um,
            textbook=textbook,
            step_um=self.machine.axes.step_um,
        )

    def lower(
        self, plan: Plan, count: str | None, feed_um: float | None = None
    ) -> tuple[Program | None, list[Diagnostic]]:
        """See `Target`."""
        from wedmcam.transforms.lower import lower

        return lower(plan, self.rules(count, feed_um))

    def place_starts(self, plan: Plan) -> tuple[Plan | None, Sequence[Diagnostic]]:
        """Anywhere will do."""
        return plan, ()

    def entries(self, plan: Plan) -> Entries:
        """Nothing is entered."""
        return Entries()

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """Nothing was."""
        return Entries()

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """See `Target`."""
        return self._encoded(program)

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """See `Target`."""
        return self._decoded(data, file)

    def on_contour(self, plan: Plan, entries: Entries) -> tuple[Plan, list[Diagnostic]]:
        """Leads are stated."""
        return plan, []

    def unstated(self, program: Program) -> list[Diagnostic]:
        """Everything is stated."""
        return []

    def senses(self, data: bytes) -> NDArray[np.int64] | None:
        """A path is no outline."""
        return None

    def keeps(self, word: str) -> bool:
        """Return whether a bare control word of another format is one in this too."""
        return bool(re.fullmatch(self.words, word))

    def carry_rules(self, source: str) -> carry.Rules:
        """See `Target`."""
        from wedmcam.programs.reblock import Rules

        return Rules(
            square=self.square,
            square_axis=self.square_axis,
            stepping=self.machine.stepping,
            count_um=self.machine.limits.count_um,
            line_um=self.machine.limits.line_um,
            keeps=(lambda word: True) if source in self.kin else self.keeps,
            pairs=self.pairs,
            end=self.end,
            turns=self.turns,
        )

    def write_carried(
        self,
        program: Program,
        entries: Entries,
        senses: NDArray[np.int64] | None,
        feed_um: float | None = None,
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """See `Target`."""
        data, findings = self._encoded(program)
        return data, list(findings)

    def _encoded(self, program: Program, **stated: Any) -> tuple[bytes, list[Diagnostic]]:
        from wedmcam.backends import encoder

        written: tuple[bytes, list[Diagnostic]] = encoder(self.machine.format)(
            program, self.machine, **stated
        )
        return written

    def _decoded(self, data: bytes, file: str, **entered: Any) -> tuple[Program, list[Diagnostic]]:
        from wedmcam.frontends import decoder

        read: tuple[Program, list[Diagnostic]] = decoder(self.machine.format)(
            data, self.machine, file, **entered
        )
        return read


class B3(Stated):
    """3B: text, J on an axis, by stepping or by geometry."""

    states_counts = True
    geometric = True
    end = True
    kin = KIN_3B


class Iso(Stated):
    """ISO G-code of the wire's path; what is read may be outlines in G41, G42 all the same."""

    words = r"M\d{1,4}"
    turns = False

    def keeps(self, word: str) -> bool:
        """See `Stated`; none for a profile that names its words.

        M20 threads the wire at one machine and drills at the next: a name is no meaning.
        """
        return super().keeps(word) and not self.machine.iso.words

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """See `Target`."""
        return self._encoded(program, feed_um=feed_um)

    def write_carried(
        self,
        program: Program,
        entries: Entries,
        senses: NDArray[np.int64] | None,
        feed_um: float | None = None,
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """See `Target`."""
        data, findings = self._encoded(program, feed_um=feed_um)
        return data, list(findings)

    @property
    def stop_word(self) -> str:
        """See `Target`."""
        return "M02"

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """The controller's table of offsets; else one offset for all D, stated or of the plan."""
        every = entries.every_um
        if every is None and not entries.d and plan is not None:
            every = _one_offset(plan)
        return self._of_table(Entries(d=entries.d, every_um=every))

    def _of_table(self, entries: Entries) -> Entries:
        """Return entries as this controller's table takes them."""
        how = self.machine.iso
        return replace(entries, letter=how.offset_letter, diameter=how.entry_factor == 2)

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """See `Target`."""
        from wedmcam.targets.g41 import decode

        table = self._of_table(entries).offset_of()
        return decode(data, self.machine, file, table, entries.dialect, assumed=not entries.d)


def _one_offset(plan: Plan) -> float | None:
    """Return the offset of all cuts, um; None where they have several, or one has none."""
    offsets = {cut.offset_um for cut in plan.cuts}
    only = offsets.pop() if len(offsets) == 1 else 0.0
    return only or None


class Memory(Stated):
    """What the ZD-065 holds in its memory: bytes, arcs counted on the inscribed square."""

    is_text = False
    square = True
    pairs = False

    @property
    def stop_word(self) -> str:
        """The format always ends."""
        return ""

    @property
    def memory(self) -> int:
        """See `Target`."""
        return self.machine.limits.memory_bytes


class Compact(Memory):
    """The ZD-065's cutting format."""

    states_counts = True

    @property
    def block_bytes(self) -> tuple[int, int]:
        """See `formats.compact`."""
        from wedmcam.formats import compact

        return compact.LINE_BYTES, compact.ARC_BYTES
