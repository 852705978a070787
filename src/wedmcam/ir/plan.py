"""Plan: what the wire will do, in order, before the grid of the machine enters.

One `Cut` per contour: the outline as drawn, the wire path (exact, float um, starting where the lead
meets it), the thread point and the leads, its side and its offset. Contours that make one part are
a `Scene`: they bound one kept material. Frames: drawing coordinates in um.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from wedmcam.ir.choices import Order as Order
from wedmcam.ir.choices import Side as Side
from wedmcam.ir.contour import Contour
from wedmcam.ir.program import Program
from wedmcam.ir.sketch import ThreadPoint

#: Outlines are one whose extremes, of vertices and centres, are the same to so many digits behind
#: the point, um.
SAME_DIGITS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """One contour to cut.

    Attributes:
        outline: the contour as drawn, in cutting direction; None where it was not drawn.
        path: where the centre of the wire goes: exact, in cutting direction; a closed path starts
            at the point where the lead arrives.
        thread: where the wire is threaded, whole um.
        depth: how many contours of its scene enclose this one.
        keeps_left: the kept material lies to the left (True) or right (False) of the path; None
            for ``on``.
        stop_um: distance along the path before its end at which the machine pauses; 0 for none.
        overcut_um: how far a closed path is cut past its start.
        number: which of the plan's ``outlines`` it is of, 1-based. Never told: whatever is printed
            counts cuts as they are cut.
        side: as asked for; ``inside`` and ``outside`` of a part program are what their scene keeps.
        offset_um: distance from the outline to the wire's centre; 0 for ``on``. Below 0 the wire
            runs behind the outline, in what is drawn as kept: the clearance is more than the wire.
        scene: which of the plan's ``scenes`` it is of, from 0.
        stated: the thread point as it was stated; None where wedmcam placed it.
        clearance_um: how far behind its outline the kept material begins.
        cornered: the outline before its corners had their arcs (``--corners paper``), in the
            direction of ``outline``; None where these are not of that kind.
        corner_um: radius of these arcs; 0 for none.
    """

    outline: Contour | None
    path: Contour
    thread: tuple[int, int]
    depth: int = 0
    keeps_left: bool | None = None
    stop_um: float = 0.0
    overcut_um: float = 0.0
    number: int = 1
    side: Side = Side.ON
    offset_um: float = 0.0
    scene: int = 0
    stated: ThreadPoint | None = None
    clearance_um: float = 0.0
    cornered: Contour | None = None
    corner_um: float = 0.0


def outline_numbers(cuts: Sequence[Cut]) -> list[int]:
    """Return for each cut a number that it shares with the cuts of the same outline.

    Rough and finishing passes run beside one outline: a lead may cross the paths of both, in what
    falls away. Cuts whose outline was not drawn are each of their own.
    """
    first: dict[tuple[float, ...], int] = {}
    numbers: list[int] = []
    for k, cut in enumerate(cuts):
        if cut.outline is None:
            numbers.append(k)
            continue
        v = cut.outline.vertices
        ends = [end for name in ("x", "y", "cx", "cy") for end in (v[name].min(), v[name].max())]
        key = (*(round(float(end), SAME_DIGITS) for end in ends), float(len(v)))
        numbers.append(first.setdefault(key, k))
    return numbers


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Contours that make one part, whether they are cut or not; the four tuples run in parallel.

    Attributes:
        outlines: what bounds the kept material; contours without one stand in a scene as well.
        depths: how many others enclose each one.
        offsets: how far from each one the wire's centre runs, um, as of its cut; 0 for ``on``.
        sides: of each one, as of its cut.
        keeps: PART where what lies in an even number of outlines falls away, and that in an odd
            number is kept; DIE for the reverse; None where the wire has no kept side (``on``, and
            open contours).
        first: how many outlines of the plan come before these.
        clearances: how far behind each one the kept material begins, um; empty for nowhere.
        plate: scenes of different plates are cut from different pieces of material.
        beside: the wire of other scenes of its plate keeps out of what is kept here. Where not,
            each scene is cut by itself, whatever the frame that they share: a punch, then its die.
    """

    outlines: tuple[Contour, ...]
    depths: tuple[int, ...]
    offsets: tuple[float, ...]
    sides: tuple[Side, ...]
    keeps: Side | None
    first: int = 0
    clearances: tuple[float, ...] = ()
    plate: int = 0
    beside: bool = False

    @property
    def behind(self) -> tuple[float, ...]:
        """The clearance of each outline."""
        return self.clearances or (0.0,) * len(self.outlines)


@dataclass(frozen=True, slots=True, eq=False)
class Material:
    """What the cuts of a scene that have one offset must leave, and reach.

    Attributes:
        scene: its number.
        outlines: all of the scene: they bound what is kept.
        depths: for each of ``outlines``, how many others enclose it.
        side: PART or DIE: what of them is kept.
        offset_um: distance from an outline to the wire's centre; below 0 the wire runs behind it.
        reached: numbers (from 0, of ``outlines``) of those that the cuts are to reach.
        first: how many outlines of the plan come before these.
        clearance_um: how far behind those that are to be reached the kept material begins.
        clearances: how far behind each of ``outlines`` it does.
    """

    scene: int
    outlines: tuple[Contour, ...]
    depths: tuple[int, ...]
    side: Side
    offset_um: float
    reached: tuple[int, ...]
    first: int
    clearance_um: float = 0.0
    clearances: tuple[float, ...] = ()

    def holds(self, cut: Cut) -> bool:
        """Return whether a cut is one of those."""
        own = (cut.scene, cut.offset_um, cut.clearance_um)
        return own == (self.scene, self.offset_um, self.clearance_um)


@dataclass(frozen=True, slots=True, eq=False)
class Others:
    """What other loads run of a program, where this one has only some blocks of a contour.

    The machine waits in the kerf between two loads, so all of them are one program that is proven
    as one. All in steps of the machine.

    Attributes:
        before: blocks that ran before, as decoded; its origin is where the whole program starts.
        behind: blocks that run afterwards, the end of the program among them.
        start: where this load starts: there the one before it stands.
        rows: of the lowered program, first and last of this load, from 0.
    """

    before: Program
    behind: Program
    start: tuple[int, int]
    rows: tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Cuts in their order, and what they are to leave.

    A report on a plan as a whole is that of its scenes, so a part of it has the same.

    Attributes:
        cuts: in cutting order.
        scenes: every contour, whether cut or not, in groups that are one part each.
        partial: other programs cut what these cuts leave: outlines that no closed path of them
            runs along need not be cut.
        others: what other loads run of the program of these cuts; None where it has all blocks.
    """

    cuts: tuple[Cut, ...]
    scenes: tuple[Scene, ...]
    partial: bool = False
    others: Others | None = None

    @property
    def outlines(self) -> tuple[Contour, ...]:
        """Every contour, whether cut or not."""
        return tuple(c for scene in self.scenes for c in scene.outlines)

    @property
    def depths(self) -> tuple[int, ...]:
        """For each of ``outlines``, how many others of its scene enclose it."""
        return tuple(d for scene in self.scenes for d in scene.depths)

    @property
    def offset_um(self) -> float:
        """The largest distance from an outline to the wire's centre; 0 for ``on``."""
        return max((o for scene in self.scenes for o in scene.offsets), default=0.0)

    @property
    def wire_um(self) -> float:
        """The largest radius of the wire with its gap: an offset and its clearance."""
        own = (
            (o, c)
            for scene in self.scenes
            for o, c in zip(scene.offsets, scene.behind, strict=True)
        )
        return max((o + c for o, c in own), default=0.0)

    @property
    def plates(self) -> tuple[int, ...]:
        """For each cut, from which piece of material it is cut."""
        return tuple(self.scenes[cut.scene].plate for cut in self.cuts)

    @property
    def offsets_text(self) -> str:
        """The offsets of the cuts for people, mm: one, or each that occurs."""
        each = sorted({cut.offset_um for cut in self.cuts})
        return ", ".join(f"{um / 1000:.3f}" for um in each) + " mm"

    @property
    def side(self) -> Side:
        """The side of all contours; of several sides what is kept, PART where that is both."""
        sides = {side for scene in self.scenes for side in scene.sides}
        if len(sides) == 1:
            return sides.pop()
        keeps = {scene.keeps for scene in self.scenes if scene.keeps is not None}
        if keeps:
            return keeps.pop() if len(keeps) == 1 else Side.PART
        if not sides:
            return Side.ON
        return Side.RIGHT if Side.RIGHT in sides else Side.LEFT

    @property
    def materials(self) -> tuple[Material, ...]:
        """What is kept, scene by scene and offset by offset; none where no side keeps anything."""
        return tuple(
            Material(
                number,
                scene.outlines,
                scene.depths,
                scene.keeps,
                offset,
                tuple(k for k, o in enumerate(own) if o == (offset, clearance)),
                scene.first,
                clearance,
                scene.behind,
            )
            for number, scene in enumerate(self.scenes)
            if scene.keeps is not None
            for own in [list(zip(scene.offsets, scene.behind, strict=True))]
            for offset, clearance in sorted(set(own))
        )
