"""The path beside an outline, as a controller makes it that looks one block ahead.

Every block is shifted by itself, and joined to the next one:

* Ends that meet but for rounding meet in the middle (a tangent joint).
* At an outer corner an arc about the programmed corner runs from the one end to the other.
* At an inner corner both end where they cross.

The controller knows nothing else. It refuses a block that its two joints leave nothing of, and an
inside radius below the offset; a radius that equals the offset is a point, and may be nothing.

The error of a place is that of a handful of float64 operations, below 1e-6 um for coordinates of a
metre; but ends that nearly meet are moved by up to half of `MEET_UM`, and those that are nearly
tangent sideways by up to `SIDEWAYS_UM`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, hypot, pi

from wedmcam.controllers.offsetting.segment import Point, Segment, crossings

#: A path that ends this near to its start, where the outline is closed, closes: the rounding of a
#: joint that is tangent but for the last digit; um.
CLOSED_UM = 0.5
#: An inside radius this near to the offset becomes a point of the path; um.
POINT_RADIUS_UM = 1.0
#: A shifted arc of less than this radius is none; um.
NO_RADIUS_UM = 1e-3
#: Shifted ends this near to each other are one place; um.
ONE_PLACE_UM = 2e-3
#: Nearer than `TANGENT_GAP_UM` they meet in the middle where that lies less than `SIDEWAYS_UM`
#: beside both blocks: a tangent joint whose blocks are rounded; um.
TANGENT_GAP_UM = 0.5
SIDEWAYS_UM = 0.002
#: Blocks that turn by more than this are not tangent, radians.
TANGENT_TURN = 1.5
#: A block is not moved by more than this share of its length: it could turn round.
MOVED_SHARE = 0.25
#: With less than this between their ends, there is nothing to go round; um.
NO_GAP_UM = 1e-4
#: Shifted ends this near to each other meet in the middle where they do not cross: blocks are
#: rounded, and a joint that was tangent is so no more; um.
MEET_UM = 1.0
#: The sine below which a block that runs against the one before runs straight back.
STRAIGHT_BACK = 1e-12


@dataclass(frozen=True, slots=True)
class Element:
    """A piece of the path.

    Attributes:
        segment: where it runs, um.
        block: number of the block of the outline that it was shifted from; of an arc about a
            corner, the one before it.
        corner: whether it is an arc about a corner.
    """

    segment: Segment
    block: int
    corner: bool = False


@dataclass(frozen=True, slots=True)
class Lost:
    """Why a controller cannot follow an outline.

    Attributes:
        kind: "radius" (an inside radius below the offset), "nothing" (nothing is left of the
            block), "back" (it runs back on another), "near" (the wire comes too near to another).
        block: of the outline.
        at: where, um.
        other: the block before it that it runs back on or comes too near to; -1 for none.
        gap_um: how near the wire comes to that one, um.
    """

    kind: str
    block: int
    at: Point
    other: int = -1
    gap_um: float = 0.0


def path_beside(
    outline: Sequence[Segment], shifts: Sequence[float], before: float
) -> tuple[list[Element], bool] | Lost:
    """Return the path of the wire beside an outline and whether it closes, or what is lost.

    Args:
        outline: blocks in their order, each from where the one before ends, um.
        shifts: for each block how far the wire runs to the left of it (negative: right), um. One
            side, and not 0. A straight block of another shift than the one before leads from the
            one to the other: it begins where the one before meets it with the old shift, and ends
            where it meets the next with its own.
        before: the shift with which the first block begins, um.

    Returns:
        The path from the normal of the first block to the normal of the last, and whether it ends
        at its start.
    """
    begins_with = [before, *shifts[:-1]]
    changes = [k for k, shift in enumerate(shifts) if shift != begins_with[k]]
    closed = not changes and closes(outline, shifts[0])
    # Stretches of one shift each: a block that leads from one shift to another is the last of one
    # stretch, where it still has the old shift, and the first of the next.
    path: list[Element] = []
    for first, last, shift in zip(
        [0, *changes],
        [*changes, len(outline) - 1],
        [*(begins_with[k] for k in changes), shifts[-1]],
        strict=True,
    ):
        stretch = _stretch(outline[first : last + 1], shift, first, closed)
        if isinstance(stretch, Lost):
            return stretch
        path = _lead_over(path, stretch)
    for element in path:
        if element.block in changes and not element.corner:
            block, s = outline[element.block], element.segment
            ux, uy = block.start_heading()
            if (s.x1 - s.x0) * ux + (s.y1 - s.y0) * uy <= 0:
                return _nothing(block, element.block)
    return path, closed


def closes(outline: Sequence[Segment], shift: float) -> bool:
    """Return whether an outline ends at its start, and its path does but for rounding."""
    if outline[-1].end != outline[0].start:
        return False
    return abs(_turn(outline[-1].end_heading(), outline[0].start_heading()) * shift) <= CLOSED_UM


def _lead_over(path: list[Element], stretch: list[Element]) -> list[Element]:
    """Return a path that goes on with another shift.

    The last block of the one is the first of the other: straight, from where it begins in the one
    to where it ends in the other.
    """
    if not path:
        return stretch
    here, there = path[-1], stretch[0]
    segment = Segment(*here.segment.start, *there.segment.end)
    return [*path[:-1], Element(segment, there.block), *stretch[1:]]


def _stretch(
    blocks: Sequence[Segment], shift: float, first: int, closed: bool
) -> list[Element] | Lost:
    """Return the path beside blocks of one shift, or what is lost.

    Args:
        blocks: of the outline, um.
        shift: how far the wire runs to the left, um.
        first: number of the first of them.
        closed: the last is joined to the first.
    """
    may_vanish = set()
    for k, block in enumerate(blocks):
        if block.turn * shift > 0:
            if abs(block.radius - abs(shift)) <= POINT_RADIUS_UM:
                may_vanish.add(first + k)
            elif block.radius < abs(shift):
                return Lost("radius", first + k, block.point(0.5 * block.length))
    path = _shifted(blocks, shift, first, closed)
    while True:
        joints = [_joint(path, k, closed) for k in range(len(path))]
        begins = [0.0] * len(path)
        for k, joint in enumerate(joints):
            if joint.begin is not None:
                begins[(k + 1) % len(path)] = joint.begin
        empty = [joint.stop - begin <= 0 for joint, begin in zip(joints, begins, strict=True)]
        gone = [
            element.block in may_vanish
            and ((empty[k] and not element.corner) or joints[k].place is None)
            for k, element in enumerate(path)
        ]
        if not any(gone) or all(gone):
            break
        path = [element for k, element in enumerate(path) if not gone[k]]
    for k, joint in enumerate(joints):
        if empty[k] or joint.place is None:
            # Of two blocks that do not meet, the shorter one is lost.
            one = path[k].block
            other = path[(k + 1) % len(path)].block if not empty[k] else one
            lost = other if blocks[other - first].length < blocks[one - first].length else one
            return _nothing(blocks[lost - first], lost)
    done = []
    for k, (element, joint) in enumerate(zip(path, joints, strict=True)):
        start = joints[k - 1].place if k or closed else element.segment.start
        assert start is not None
        assert joint.place is not None
        part = element.segment.between(start, joint.place, joint.stop - begins[k])
        done.append(Element(part, element.block, element.corner))
    return done


def _shifted(blocks: Sequence[Segment], shift: float, first: int, closed: bool) -> list[Element]:
    """Return the blocks shifted, tangent ones joined, with an arc about each outer corner."""
    shifted = [block.shifted(shift) for block in blocks]
    starts = [s.start for s in shifted]
    ends = [s.end for s in shifted]
    whole = [not s.turn or s.radius > NO_RADIUS_UM for s in shifted]
    arcs: dict[int, Segment] = {}
    for k in range(len(blocks) if closed else len(blocks) - 1):
        n = (k + 1) % len(blocks)
        heading, next_heading = blocks[k].end_heading(), blocks[n].start_heading()
        turn = _turn(heading, next_heading)
        if whole[k] and whole[n]:
            middle = _middle(shifted[k], shifted[n], turn)
            if middle is not None:
                ends[k] = starts[n] = middle
                continue
        if _is_outer(heading, next_heading, shift) and _gap(ends[k], starts[n]) > NO_GAP_UM:
            cx, cy = blocks[k].end
            way = -1 if shift > 0 else 1
            arcs[k] = Segment(*ends[k], *starts[n], cx, cy, way, abs(shift), abs(turn))
    path = []
    for k, s in enumerate(shifted):
        if whole[k]:
            path.append(Element(_moved(s, starts[k], ends[k]), first + k))
        if k in arcs:
            path.append(Element(arcs[k], first + k, corner=True))
    # What has come to stand beside each other because an arc between was a point.
    for k in range(len(path) if closed else len(path) - 1):
        n = (k + 1) % len(path)
        a, b = path[k].segment, path[n].segment
        if a.end != b.start:
            middle = _middle(a, b, _turn(a.end_heading(), b.start_heading()))
            if middle is not None:
                path[k] = Element(_moved(a, a.start, middle), path[k].block, path[k].corner)
                b = path[n].segment
                path[n] = Element(_moved(b, middle, b.end), path[n].block, path[n].corner)
    return path


@dataclass(frozen=True, slots=True)
class _Joint:
    """How an element meets the next one.

    Attributes:
        stop: at which arc length the element ends, um.
        begin: at which one the next begins; None for its start.
        place: where; None where they do not meet.
    """

    stop: float
    begin: float | None
    place: Point | None


def _joint(path: Sequence[Element], k: int, closed: bool) -> _Joint:
    a = path[k].segment
    if k == len(path) - 1 and not closed:
        return _Joint(a.length, None, a.end)
    b = path[(k + 1) % len(path)].segment
    if a.end == b.start:
        return _Joint(a.length, None, a.end)
    crossed = crossings(a, b)
    if crossed:
        # Of two crossings that nearest to the corner, along both.
        place, on_a, on_b = min(crossed, key=lambda c: a.length - c[1] + c[2])
        return _Joint(on_a, on_b, place)
    near = _gap(a.end, b.start) <= MEET_UM
    return _Joint(a.length, None, _halfway(a.end, b.start) if near else None)


def _is_outer(heading: Point, next_heading: Point, shift: float) -> bool:
    """Return whether a corner turns away from the wire, or straight back, so that it goes round."""
    along = heading[0] * next_heading[0] + heading[1] * next_heading[1]
    across = heading[0] * next_heading[1] - heading[1] * next_heading[0]
    return across * shift < 0 or (along < 0 and abs(across) < STRAIGHT_BACK)


def _middle(a: Segment, b: Segment, turn: float) -> Point | None:
    """Return where two shifted blocks meet whose ends are one place, or that are tangent.

    None for other joints.
    """
    gap = _gap(a.end, b.start)
    if gap > MOVED_SHARE * min(a.length, b.length):
        return None
    middle = _halfway(a.end, b.start)
    if gap < ONE_PLACE_UM:
        return middle
    beside = gap < TANGENT_GAP_UM and max(a.off(*middle), b.off(*middle)) < SIDEWAYS_UM
    return middle if beside and abs(turn) < TANGENT_TURN else None


def _moved(s: Segment, start: Point, end: Point) -> Segment:
    """Return a segment whose ends moved a little; an arc goes on to cover about what it did."""
    if not s.turn:
        return Segment(*start, *end)
    angle = atan2(end[1] - s.cy, end[0] - s.cx) - atan2(start[1] - s.cy, start[0] - s.cx)
    more = (angle * s.turn - s.sweep + pi) % (2 * pi) - pi
    sweep = min(max(s.sweep + more, 0.0), 2 * pi)
    return Segment(*start, *end, s.cx, s.cy, s.turn, s.radius, sweep)


def _turn(heading: Point, next_heading: Point) -> float:
    """Return by how much a corner turns to the left, radians."""
    across = heading[0] * next_heading[1] - heading[1] * next_heading[0]
    return atan2(across, heading[0] * next_heading[0] + heading[1] * next_heading[1])


def _gap(a: Point, b: Point) -> float:
    return hypot(b[0] - a[0], b[1] - a[1])


def _halfway(a: Point, b: Point) -> Point:
    return 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])


def _nothing(block: Segment, number: int) -> Lost:
    return Lost("nothing", number, block.point(0.5 * block.length))
