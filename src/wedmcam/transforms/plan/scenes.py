"""Which contours make one part, and what of it is kept.

Cuts that make one part (an outline and the holes in it) must know each other: they form a *scene*,
are compensated together and judged against one kept material. Cuts that cannot belong to one part
(the punch and the die of one outline) are scenes of their own. Within a scene, what lies in an even
number of outlines is one thing and the rest the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wedmcam.diag import Diagnostic, Place, error, has_errors
from wedmcam.geom import measure
from wedmcam.geom.segments import distances
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Scene, Side
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.meetings import contour_meetings
from wedmcam.transforms.nest import Nesting, nest
from wedmcam.transforms.plan.pieces import Piece
from wedmcam.transforms.plan.shaped import ShapedCut

#: Boxes that are as equal as this are the boxes of one outline, um.
EQUAL_UM = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class PieceScene:
    """Contours that make one part, and how they lie in each other.

    ``keeps``: what is kept of it, PART or DIE; None where no side keeps anything. ``plate``: of
    which piece of material. ``starts``: thread points for any of its contours; None where each
    cut has its own.
    """

    pieces: tuple[Piece, ...]
    nesting: Nesting
    keeps: Side | None
    plate: int = 0
    starts: tuple[ThreadPoint, ...] | None = None

    def as_planned(self, cuts: Sequence[ShapedCut], first: int) -> Scene:
        """Return the scene of a plan in which ``first`` outlines come before."""
        return Scene(
            tuple(p.contour for p in self.pieces),
            self.nesting.depths,
            tuple(p.offset for p in self.pieces),
            tuple(self._side(cuts[p.cut].item.side) for p in self.pieces),
            self.keeps,
            first,
            tuple(p.clearance for p in self.pieces) if self._clears else (),
            self.plate,
            any(cuts[p.cut].of_drawing for p in self.pieces),
        )

    @property
    def _clears(self) -> bool:
        return any(p.clearance for p in self.pieces)

    def _side(self, word: str) -> Side:
        if word in ("inside", "outside"):
            assert self.keeps is not None, "a contour with an inside keeps one of two sides"
            return self.keeps
        return Side(word)


def scenes_of(
    cuts: Sequence[ShapedCut], pieces: Sequence[Piece]
) -> tuple[list[PieceScene], list[Diagnostic]]:
    """Return the contours in groups that can be one part, and the rest each alone.

    A cut whose nesting is known is one part as it is.
    """
    if not pieces:
        return [], []
    known = cuts[0].nesting
    if len(cuts) == 1 and known is not None:
        return _one_scene(pieces, known, cuts[0].item.side)
    free = [p for p in pieces if p.outside is None]
    depths = nest([p.contour for p in free]).depths  # a hole is one on the line, too
    alone = [
        PieceScene((p,), Nesting((p.contour,), (depth,), (-1,)), None)
        for p, depth in zip(free, depths, strict=True)
    ]
    scenes: list[PieceScene] = []
    findings: list[Diagnostic] = []
    for plate in sorted({cut.plate for cut in cuts}):
        sided = [p for p in pieces if p.outside is not None and cuts[p.cut].plate == plate]
        some, problems = _of_plate(cuts, sided)
        scenes += [replace(scene, plate=plate) for scene in some]
        findings += problems
    if any(cut.of_drawing for cut in cuts):
        return _of_drawing([*scenes, *alone], cuts[0].starts), findings
    return [*scenes, *alone], findings


def _of_plate(
    cuts: Sequence[ShapedCut], sided: Sequence[Piece]
) -> tuple[list[PieceScene], list[Diagnostic]]:
    """Return contours of one piece of material in groups that can be one part."""
    if not sided:
        return [], []
    findings: list[Diagnostic] = list(contour_meetings(_once(sided)))
    if has_errors(findings):
        return [], findings
    nesting = _one_part(sided)
    if nesting is not None:
        groups = [(list(sided), nesting)]
    else:
        groups, findings = _groups(sided)
    scenes = []
    for group, nested in groups:
        some, problems = _one_scene(group, nested, cuts[group[0].cut].item.side)
        scenes += some
        findings += problems
    return scenes, findings


def _of_drawing(scenes: Sequence[PieceScene], starts: Sequence[ThreadPoint]) -> list[PieceScene]:
    """Return the scenes of a drawing in their order, each with the thread points it may serve.

    What others enclose is cut before them, or it would be loose. A thread point is for the nearest
    contour of a scene in whose scrap it lies.
    """
    every = [p.contour for scene in scenes for p in scene.pieces]
    owner = [k for k, scene in enumerate(scenes) for _ in scene.pieces]
    depths = nest(every).depths
    deep = [
        min(d for d, k in zip(depths, owner, strict=True) if k == n) for n in range(len(scenes))
    ]
    own: list[list[ThreadPoint]] = [[] for _ in scenes]
    for start in starts:
        far = [_distance(scene, start) for scene in scenes]
        scrap = [k for k, scene in enumerate(scenes) if _in_scrap(scene, start)]
        own[min(scrap or range(len(scenes)), key=lambda k: (far[k], k))].append(start)
    order = sorted(range(len(scenes)), key=lambda k: (scenes[k].plate, -deep[k], k))
    return [replace(scenes[k], starts=tuple(own[k])) for k in order]


def _distance(scene: PieceScene, at: ThreadPoint) -> float:
    """Return how far a point is from the contours of a scene, um."""
    s, _ = measure.segments_of_all([(p.contour.vertices, p.contour.closed) for p in scene.pieces])
    x, y = np.full(len(s), at.x), np.full(len(s), at.y)
    return float(distances(s, x, y).min())


def _in_scrap(scene: PieceScene, at: ThreadPoint) -> bool:
    """Return whether a point lies in what falls away; where nothing is kept, it does anywhere."""
    if scene.keeps is None:
        return True
    x, y = np.array([at.x]), np.array([at.y])
    within = sum(bool(measure.contains(p.contour.vertices, x, y)[0]) for p in scene.pieces)
    return (within % 2 == 0) == (scene.keeps is Side.PART)


def _groups(
    sided: Sequence[Piece],
) -> tuple[list[tuple[list[Piece], Nesting]], list[Diagnostic]]:
    """Return cuts in groups: each joins the first one with which it can be one part."""
    findings: list[Diagnostic] = []
    groups: list[tuple[list[Piece], Nesting]] = []
    for number in dict.fromkeys(p.cut for p in sided):
        own = [p for p in sided if p.cut == number]
        crossing = list(contour_meetings([p.contour for p in own]))
        if has_errors(crossing):
            findings += crossing
            continue
        for k, (group, _) in enumerate(groups):
            nesting = _one_part([*group, *own])
            if nesting is not None:
                groups[k] = ([*group, *own], nesting)
                break
        else:
            groups.append((own, nest([p.contour for p in own])))
    return groups, findings


def _once(pieces: Sequence[Piece]) -> list[Contour]:
    """Return the contours, of equal ones (a punch and its die) the first: others must not cross."""
    contours = [p.contour for p in pieces]
    boxes = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
    return [
        c
        for k, c in enumerate(contours)
        if not k or np.abs(boxes[:k] - boxes[k]).max(axis=1).min() >= EQUAL_UM
    ]


def _one_part(pieces: Sequence[Piece]) -> Nesting | None:
    """Return how contours lie in each other, None where they cannot be one part."""
    contours = [p.contour for p in pieces]
    nesting = nest(contours)
    if _kept(pieces, nesting) is None or has_errors(contour_meetings(contours)):
        return None
    return nesting


def _one_scene(
    pieces: Sequence[Piece], nesting: Nesting, word: str
) -> tuple[list[PieceScene], list[Diagnostic]]:
    """Return contours as one scene, or an error where their sides contradict each other.

    ``word``: the side of the cut of the first one.
    """
    if pieces[0].outside is None:
        return [PieceScene(tuple(pieces), nesting, None)], []
    keeps = _kept(pieces, nesting)
    if keeps is not None:
        return [PieceScene(tuple(pieces), nesting, keeps)], []
    inside = _inside_kept(pieces, nesting)
    one, other = pieces[0].contour, pieces[inside.index(not inside[0])].contour
    first, second = (Place.of_um(c.vertices["x"][0], c.vertices["y"][0]) for c in (one, other))
    return [], [
        error(
            "closed-left-right",
            "the closed contour at {second} keeps what the one at {first} of the same cut takes "
            "away: both are cut {side}",
            other.source_of(0),
            points_mm=(second,),
            hint="'inside' and 'outside' keep one of the two, whatever way the contours run",
            first=first,
            second=second,
            side=word,
        )
    ]


def _kept(pieces: Sequence[Piece], nesting: Nesting) -> Side | None:
    """Return what of nested contours is kept, None where their sides contradict each other."""
    inside = set(_inside_kept(pieces, nesting))
    if len(inside) != 1:
        return None
    return Side.PART if inside.pop() else Side.DIE


def _inside_kept(pieces: Sequence[Piece], nesting: Nesting) -> list[bool]:
    """Return for each contour whether its side says that what outermost ones enclose is kept."""
    return [p.outside == (d % 2 == 0) for p, d in zip(pieces, nesting.depths, strict=True)]
