"""Nesting that is rather an accident of the drawing than a part: frames, and contours 3 deep.

A drawing frame around everything would be cut as the outer contour and the parts in it as holes; a
wire that cuts an island in a hole makes a second part, which falls out. Both are said before
anything is planned, with the layers that would leave them out. An ordinary plate is a rectangle
round everything, too: what makes a frame of it is what lies in it (contours that have holes of
their own, a title block), not its shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from shlex import quote

import numpy as np

from wedmcam.diag import Diagnostic, EntityRef, Place, warning
from wedmcam.geom import measure
from wedmcam.geom.segments import Floats
from wedmcam.ir.contour import Contour
from wedmcam.ir.understanding import Role, counted
from wedmcam.transforms.nest import Nesting

#: A contour that fills so much of its box is a rectangle, chamfers and rounded corners included.
RECTANGLE = 0.98
#: A title block lies this near to two sides of the frame, a share of the frame's size...
CORNER = 0.1
#: ...and has so many texts in it; anywhere else so many.
TEXTS_IN_CORNER, TEXTS = 1, 3
#: So many layers are named.
NAMED_LAYERS = 4
#: So many frames are listed.
FRAMES = 10
#: So many places are marked.
MARKED = 12
#: Roles of contours in each other are named down to this depth.
DEEP = 4
LAYERS = (
    "draw what is not to be cut on a layer of its own and leave it out with --ignore-layer, or "
    "take the layers of the part with --layer"
)


def doubtful(nesting: Nesting, texts: Floats) -> tuple[Diagnostic, ...]:
    """Return a warning for each frame, and one for contours that lie 3 deep in no frame.

    Args:
        nesting: of all contours of a drawing.
        texts: where the drawing writes something, um, shape (texts, 2).
    """
    contours, parents = nesting.contours, nesting.parents
    if max(nesting.depths, default=0) == 0:
        return ()
    boxes = measure.extents_of_all([(c.vertices, c.closed) for c in contours])
    children: dict[int, list[int]] = {}
    for k, parent in enumerate(parents):
        if contours[k].closed:
            children.setdefault(parent, []).append(k)
    findings: list[Diagnostic] = []
    frames = set()
    for k in children.get(-1, ()):
        inner = children.get(k, [])
        if not inner or not _rectangle(contours[k], boxes[k]):
            continue
        parts = [j for j in inner if j in children and not _bored(j, children[j], contours, boxes)]
        titles = (
            [] if parts else [j for j in inner if _title(contours[j], boxes[j], boxes[k], texts)]
        )
        if parts or titles:
            frames.add(k)
            findings.append(_frame(nesting, k, boxes, parts, titles))
    if len(findings) > FRAMES:
        more = len(findings) - FRAMES
        findings[FRAMES:] = [
            warning("drawing-frame", "{count} further rectangles like these", count=more)
        ]
    deep = [
        k
        for k, depth in enumerate(nesting.depths)
        if depth > 1 and contours[k].closed and _outermost(k, parents) not in frames
    ]
    if deep:
        findings.append(_deep(nesting, deep, boxes))
    return tuple(findings)


def _outermost(k: int, parents: Sequence[int]) -> int:
    while parents[k] >= 0:
        k = parents[k]
    return k


def _rectangle(contour: Contour, box: Floats) -> bool:
    x0, y0, x1, y1 = box.tolist()
    return bool(abs(measure.area(contour.vertices)) > RECTANGLE * (x1 - x0) * (y1 - y0))


def _bored(k: int, inner: Sequence[int], contours: Sequence[Contour], boxes: Floats) -> bool:
    """Return whether a contour and what lies in it are a bore: circles about one centre."""
    sizes = boxes[:, 2:] - boxes[:, :2]
    for j in (k, *inner):
        disc = np.pi / 4 * sizes[j].prod()
        if abs(abs(measure.area(contours[j].vertices)) - disc) > (1 - RECTANGLE) * disc:
            return False
        if (
            np.abs(boxes[j, :2] + boxes[j, 2:] - boxes[k, :2] - boxes[k, 2:]).max()
            > 0.02 * sizes[k].max()
        ):
            return False
    return True


def _title(contour: Contour, box: Floats, frame: Floats, texts: Floats) -> bool:
    """Return whether a contour in a frame is a title block: a rectangle that is written in."""
    if not _rectangle(contour, box):
        return False
    x, y = texts.T
    within = int(((x > box[0]) & (x < box[2]) & (y > box[1]) & (y < box[3])).sum())
    away = np.minimum(np.abs(box - frame)[:2], np.abs(box - frame)[2:])
    corner = bool((away < CORNER * (frame[2:] - frame[:2])).all())
    return within >= (TEXTS_IN_CORNER if corner else TEXTS)


def _layers(contours: Sequence[Contour]) -> list[str]:
    spans = (c.source_of(row) for c in contours for row in range(len(c)))
    return sorted({span.layer for span in spans if isinstance(span, EntityRef)})


def _by_layers(nesting: Nesting, those: Sequence[int]) -> tuple[str, str]:
    """Return the options that leave contours out and that take the others, by their layers.

    Empty where the layers hold something else, too.
    """
    drop = set(those)
    own = _layers([nesting.contours[k] for k in those])
    rest = _layers([c for k, c in enumerate(nesting.contours) if k not in drop])
    if own and rest and not set(own) & set(rest):
        leave = " ".join(f"--ignore-layer {quote(name)}" for name in own[:NAMED_LAYERS])
        take = " ".join(f"--layer {quote(name)}" for name in rest[:NAMED_LAYERS])
        return leave, take
    return "", ""


def _size_mm(box: Floats) -> tuple[float, float]:
    return float(box[2] - box[0]) / 1000, float(box[3] - box[1]) / 1000


def _frame(
    nesting: Nesting, k: int, boxes: Floats, parts: Sequence[int], titles: Sequence[int]
) -> Diagnostic:
    inside = sum(parent == k for parent in nesting.parents)
    width, height = _size_mm(boxes[k])
    leave, take = _by_layers(nesting, [k, *titles])
    frame = warning(
        "drawing-frame",
        "the rectangle of {width_mm:.3f} x {height_mm:.3f} mm at {place} lies round 1 contour"
        if inside == 1
        else "the rectangle of {width_mm:.3f} x {height_mm:.3f} mm at {place} lies round "
        "{contours} contours",
        nesting.contours[k].source_of(0),
        hint="{leave_out} leaves out what is not to be cut; or {take}" if leave else LAYERS,
        points_mm=_marks(nesting, [k, *titles]),
        width_mm=width,
        height_mm=height,
        place=Place.of_um(*boxes[k][:2]),
        contours=inside,
        leave_out=leave,
        take=take,
    )
    if parts:
        frame = frame.extended(
            ", which has others inside"
            if inside == 1
            else "; one of them has others inside"
            if len(parts) == 1
            else "; {parts} of them have others inside",
            parts=len(parts),
        )
    else:
        frame = frame.extended(
            "; the one at {title} is a title block, written in",
            title=Place.of_um(*boxes[titles[0]][:2]),
        )
    return frame.extended(
        ": if it is the frame of the drawing, it is cut as outer contour and the parts in it as "
        "holes"
    )


def _deep(nesting: Nesting, deep: Sequence[int], boxes: Floats) -> Diagnostic:
    worst = max(deep, key=lambda k: (nesting.depths[k], -k))
    depth = nesting.depths[worst]
    width, height = _size_mm(boxes[worst])
    leave, take = _by_layers(nesting, deep)
    finding = warning(
        "deep-nesting",
        "the contour of {width_mm:.3f} x {height_mm:.3f} mm at {place} lies {deep} deep "
        "({roles}, ...)"
        if depth > DEEP
        else "the contour of {width_mm:.3f} x {height_mm:.3f} mm at {place} lies {deep} deep "
        "({roles})",
        nesting.contours[worst].source_of(0),
        hint="{leave_out} leaves out what is not to be cut; or {take}" if leave else LAYERS,
        points_mm=_marks(nesting, deep),
        count=len(deep),
        width_mm=width,
        height_mm=height,
        place=Place.of_um(*boxes[worst][:2]),
        deep=depth + 1,
        roles=[str(Role.of(True, d)) for d in range(min(depth, DEEP) + 1)],
        leave_out=leave,
        take=take,
    )
    if len(deep) > 1:
        roles = counted(Role.of(True, nesting.depths[k]) for k in deep)
        finding = finding.extended("; {all_roles} lie so", all_roles=roles)
    return finding.extended(": every island is a part of its own, which comes loose")


def _marks(nesting: Nesting, those: Sequence[int]) -> tuple[tuple[float, float], ...]:
    """Return a place on each, mm."""
    rows = (nesting.contours[k].vertices[0] for k in those[:MARKED])
    return tuple((float(v["x"]) / 1000, float(v["y"]) / 1000) for v in rows)
