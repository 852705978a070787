"""One class a kind of controller: the only room that asks which kind a machine is of.

A target knows what lowering may emit, where paths have to start, what the operator enters, how
bytes are written and read, and what to say when a proof fails. Everything else takes a target and
asks it. A new kind of controller is a class here and a line in `KINDS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from wedmcam.targets.entries import Entries

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wedmcam.diag import Diagnostic
    from wedmcam.ir.plan import Plan
    from wedmcam.ir.program import Program
    from wedmcam.machines import Machine
    from wedmcam.programs import reblock as carry
    from wedmcam.transforms.lower import Rules


class Target(Protocol):
    """One controller: a machine, and what follows from the kind that it is of."""

    @property
    def machine(self) -> Machine:
        """Its profile."""
        ...

    @property
    def is_text(self) -> bool:
        """Whether its programs are text, and not bytes."""
        ...

    @property
    def coarse(self) -> bool:
        """Its path is its own: polygons of degrees, vectors for a speed, held to the plan alone."""
        ...

    @property
    def makes_path(self) -> bool:
        """Whether the controller makes the path itself, of an outline that a program states."""
        ...

    @property
    def moves_starts(self) -> bool:
        """Whether `place_starts` may move them: programs of the same plan then start there too."""
        ...

    @property
    def takes_gap(self) -> bool:
        """Whether a program is an outline for which the operator enters one gap and its side."""
        ...

    @property
    def refuses_written(self) -> Diagnostic | None:
        """Why no program is written for it at all; None where one is."""
        ...

    @property
    def refuses_carried(self) -> Diagnostic | None:
        """Why no program of another format can become one of this; None where it can."""
        ...

    @property
    def states_counts(self) -> bool:
        """Whether its blocks state X, Y, J and G as they are run."""
        ...

    @property
    def needs_lead(self) -> str:
        """Why a path cannot start in the kerf; empty where it can."""
        ...

    @property
    def whole_contours(self) -> str:
        """Why no program begins or ends within a contour; empty where one can."""
        ...

    @property
    def stop_word(self) -> str:
        """The word that ends a program; empty where the format always ends one."""
        ...

    @property
    def advice(self) -> tuple[Diagnostic, ...]:
        """What to say when the proof of a program fails."""
        ...

    @property
    def arc_limit_um(self) -> Callable[[NDArray[np.float64]], NDArray[np.float64]] | None:
        """See `judge.followed.Terms`; None where arcs are held to what all else is."""
        ...

    @property
    def block_bytes(self) -> tuple[int, int]:
        """How much of `memory` a line takes, and an arc: bytes, or records."""
        ...

    @property
    def memory(self) -> int:
        """How much fits the controller, in bytes or records; 0 for no limit."""
        ...

    @property
    def own_path(self) -> Machine:
        """A machine whose programs state the path that this controller makes."""
        ...

    def rules(self, count: str | None, feed_um: float | None = None) -> Rules:
        """Return what lowering may emit.

        Args:
            count: "exact" or "textbook"; None for what the profile says.
            feed_um: cutting speed, um a minute, where the path depends on it; None for the
                profile's.

        Raises:
            WrongUse: the controller does not count so.
        """
        ...

    def lower(
        self, plan: Plan, count: str | None, feed_um: float | None = None
    ) -> tuple[Program | None, list[Diagnostic]]:
        """Return the program of a plan, in blocks of this controller; arguments as of `rules`.

        Raises:
            WrongUse: the controller does not count so.
        """
        ...

    def place_starts(self, plan: Plan) -> tuple[Plan | None, Sequence[Diagnostic]]:
        """Return the plan with every path starting where this controller can start it."""
        ...

    def entries(self, plan: Plan) -> Entries:
        """Return what the operator enters for a plan.

        Raises:
            WrongUse: the controller has no way to enter it.
        """
        ...

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """Return what was entered for a program that is read.

        Args:
            entries: as the user states them: ``d``, ``every_um`` (None where no offset is
                stated) and ``outwards``.
            plan: that the program is compared with, where there is one.
        """
        ...

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """Return the bytes of a program of a plan.

        Args:
            program: the plan in blocks.
            plan: the plan.
            entries: what the operator enters.
            feed_um: cutting speed, um a minute, for a profile that writes F.
            sharp: the corners of the plan were prolonged, and not rounded.

        Raises:
            WrongUse: for what such a controller has no words.
        """
        ...

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """Return the cutting program that a file means to the controller, with these entries."""
        ...

    def on_contour(self, plan: Plan, entries: Entries) -> tuple[Plan, list[Diagnostic]]:
        """Return the plan as far as a program with these entries follows it, and what is left out.

        The leads of a format that does not hold them are not run where they are not entered.
        """
        ...

    def unstated(self, program: Program) -> list[Diagnostic]:
        """Return a note that a program was read without what the operator enters, if it matters."""
        ...

    def senses(self, data: bytes) -> NDArray[np.int64] | None:
        """Return how the arcs of an outline go with a gap, a number a block; None of a path."""
        ...

    def carry_rules(self, source: str) -> carry.Rules:
        """Return what its format asks of the blocks of a program that comes from another one.

        ``source``: the format of that program. The words of one are no words of every other.
        """
        ...

    def write_carried(
        self,
        program: Program,
        entries: Entries,
        senses: NDArray[np.int64] | None,
        feed_um: float | None = None,
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """Return the bytes of a program that comes from another format; None where it cannot be.

        Args:
            program: in blocks by `carry_rules`.
            entries: as the operator enters them.
            senses: of an outline that stays one, `senses` of what it was made from, by the source
                of each block.
            feed_um: cutting speed, um a minute, for a profile that writes F.
        """
        ...


#: Format -> "module:class" of its target (or a function of the machine); named and not imported.
KINDS: dict[str, str] = {
    "3b": "wedmcam.targets.stated:B3",
    "compact": "wedmcam.targets.stated:Compact",
    "iso": "wedmcam.targets.g41:iso_target",
    "rotation": "wedmcam.targets.rotation:Rotation",
    "compensation": "wedmcam.targets.compensation:Compensation",
    "4b": "wedmcam.targets.scaled:B4",
    "dem15": "wedmcam.targets.vectors:Dem15",
    "nby15": "wedmcam.targets.nby15:Nby15",
}


def target_of(machine: Machine) -> Target:
    """Return the target of a machine.

    >>> from wedmcam.machines import builtin
    >>> type(target_of(builtin("iso-um"))).__name__, type(target_of(builtin("iso-g41"))).__name__
    ('Iso', 'Offsetting')
    """
    module, _, name = KINDS[machine.format].partition(":")
    target: Target = getattr(import_module(module), name)(machine)
    return target


__all__ = ["KINDS", "Entries", "Target", "target_of"]
