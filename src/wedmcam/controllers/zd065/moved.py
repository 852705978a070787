"""Translation, symmetry, mirror, rotation of data in memory: cutting data of images of a figure.

The figure is what a program steps: its vertices are where its blocks end, its arcs those of the
stated radius. An image that is not reversed and lies square has the same numbers with other signs,
so it is exact; all else goes through the closed loop (`loop`), with vertices computed from the
figure in 8-digit decimals. Where an image does not begin where the one before ends, the machine
pauses and moves there with the generator off.
"""

from __future__ import annotations

import enum
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.stepping import Stepping
from wedmcam.controllers.zd065.data import Floats, Ints
from wedmcam.controllers.zd065.images import Image, turned
from wedmcam.controllers.zd065.loop import EXACT, Most, follow, to_whole
from wedmcam.ir.program import BLOCK, Axis, Kind

Blocks = NDArray[np.void]
Bools = NDArray[np.bool_]

#: The path goes on where the machine stands so near to the start of the next image, um.
MEETS_UM = 1.0
#: Ends so near to each other are one vertex that was rounded twice (2 * sqrt(1/2)), um.
ONE_VERTEX_UM = 1.4143


class Link(enum.IntEnum):
    """How an image follows the one before."""

    FIRST = 0
    GOES_ON = 1
    LINE = 2  # a line of a um or two: one vertex, rounded twice
    MOVE = 3  # with the generator off


@dataclass(frozen=True, slots=True, eq=False)
class Moved:
    """Cutting data of images.

    Attributes:
        blocks: dtype `BLOCK`; ``source`` is the block of the figure that each comes of, -1 for what
            leads from image to image.
        start: where the data start, whole um, from where the figure does.
        image: for each block the number of its image; that it leads to, for a link.
        stands: where the machine stands at the start of an image and behind each block of it, in
            the order in which it is run, int64, shape (images, blocks of the figure + 1, 2).
        links: a `Link` for each image.
        split: (image, block of the figure) of arcs that became several blocks.
        same: how many blocks have the numbers of the figure.
    """

    blocks: Blocks
    start: tuple[int, int]
    image: Ints
    stands: Ints
    links: Ints
    split: list[tuple[int, int]]
    same: int


@dataclass(frozen=True, slots=True, eq=False)
class _Figure:
    """A figure as motions of at most a turn: arcs of more turns are several rows.

    Attributes:
        blocks: as given.
        row: of which block each motion is.
        kind, turn, radius, sweep, angle: angle is the polar angle of the start, degrees.
        places: where motions start and the last one ends, shape (n + 1, 2), from ``middle``.
        middle: whole um.
        first: the motion with which each block begins; and their number.
    """

    blocks: Blocks
    row: Ints
    kind: NDArray[np.uint8]
    turn: Ints
    radius: Floats
    sweep: Floats
    angle: Floats
    places: Ints
    middle: tuple[int, int]
    first: Ints


def moved(
    figure: Blocks,
    images: Sequence[Image],
    stepping: Stepping,
    most: Most | None = None,
    axes: str = "square",
) -> Moved:
    """Return the cutting data of images of a figure.

    Args:
        figure: dtype `BLOCK`, all of them end on ``stepping``.
        images: as `images.images` makes them: each ``place`` is that of the start of the figure.
        stepping: the interpolator that the figure was written for, and that runs the result.
        most: what a block holds; None for the ZD-065.
        axes: as for `loop.follow`.

    >>> from wedmcam.controllers.pointwise import MIRROR
    >>> from wedmcam.controllers.zd065.images import images
    >>> from wedmcam.ir.figure import Symmetry
    >>> arc = np.zeros(1, BLOCK)
    >>> for name, value in (("kind", 1), ("turn", 1), ("axis", 2), ("x", 500), ("count", 707)):
    ...     arc[name] = value
    >>> m = moved(arc, images([Symmetry("y")])[0], MIRROR)
    >>> [m.blocks[name].tolist() for name in ("turn", "x", "count")], m.stands[0].tolist()
    ([[-1], [-500], [707]], [[0, 0], [500, 500]])
    """
    base = _motions(figure, stepping)
    n = len(base.row)
    paths, keeps, starts = [], [], []
    for image in images:
        path, start = _path(base, image)
        paths.append(path)
        starts.append(start)
        keeps.append(_same_numbers(base, image, path, start, stepping))
    path, number, links = _linked(paths, starts)
    # Rows of the path that are motions of an image, (image, motion); the rest leads between.
    within = np.flatnonzero(path["source"] >= 0).reshape(len(images), n)
    kept = np.zeros(len(path), np.bool_)
    same: list[Blocks] = [np.zeros(0, BLOCK)]
    same_rows = [np.zeros(0, np.int64)]
    stands_at = np.vstack([to_whole(np.array([starts[0]])), to_whole(_ends(path))])
    for k, (rows, (mask, mapped)) in enumerate(zip(within, keeps, strict=True)):
        if not mask.any():
            continue
        at = to_whole(np.array([starts[k]]))[0]
        if (stands_at[rows[0]] != at).any():  # a um off, behind the image before
            mask = mask & (base.row != base.row[_leading(path[rows])])
        kept[rows] = mask
        whole = mask & (base.first[base.row] == np.arange(n))
        same.append(mapped[base.row[whole]])
        same_rows.append(rows[whole])
    straight = path.copy()
    straight["kind"][kept & (path["kind"] == Kind.ARC)] = Kind.LINE
    followed = follow(straight, stepping, starts[0], axes=axes, most=most)
    made = followed.blocks[~kept[followed.blocks["source"]]]
    blocks = np.concatenate([made, *same])
    rows = np.concatenate([made["source"].astype(np.int64), *same_rows])
    order = np.argsort(rows, kind="stable")
    blocks, rows = blocks[order], rows[order]
    run = stepping.run(blocks)
    origin = stands_at[0]
    ends = origin + np.cumsum(np.column_stack([run.dx, run.dy]), axis=0)
    ends = np.vstack([origin, ends])
    last = np.searchsorted(rows, np.arange(len(path)), side="right")
    behind = ends[last]
    # Behind each motion of an image that is a block's last one; at its start what comes before it.
    shown = np.empty((len(images), len(figure) + 1, 2), np.int64)
    closing = np.append(base.first[1:], n) - 1
    for k, (image, own) in enumerate(zip(images, within, strict=True)):
        first = own[0] if n else 0
        shown[k, 0] = behind[first - 1] if first else origin
        tails = n - 1 - base.first[::-1] if image.back else closing
        shown[k, 1:] = behind[own[tails]]
    split = [(int(number[r]), int(path["source"][r])) for r in followed.split if not kept[r]]
    blocks["source"] = path["source"][rows]
    return Moved(
        blocks,
        (int(origin[0]), int(origin[1])),
        number[rows],
        shown,
        links,
        [s for s in split if s[1] >= 0],
        int(sum(len(s) for s in same)),
    )


def _motions(blocks: Blocks, stepping: Stepping) -> _Figure:
    """Return the motions of a figure."""
    run = stepping.run(blocks)
    assert (run.steps >= 0).all()
    arc = blocks["kind"] == Kind.ARC
    x, y = blocks["x"].astype(float), blocks["y"].astype(float)
    radius = np.where(arc, np.hypot(x, y), 0.0)
    angle = np.degrees(np.arctan2(y, x))
    end = np.degrees(np.arctan2(y + run.dy, x + run.dx))
    sweep = np.where(arc, (end - angle) * blocks["turn"] % 360.0, 0.0)
    # By an end the path comes once a turn: what goes beyond are whole turns.
    a, b, turn = blocks["x"], blocks["y"], np.where(arc, blocks["turn"], 1)
    once = stepping.arc_end(a, b, turn, a + run.dx, b + run.dy).steps
    lap = stepping.arc_end(a, b, turn, a, b).steps
    turns = np.where(arc & (once > 0) & (lap > 0), (run.steps - once) // np.maximum(lap, 1), 0)
    home = arc & (run.dx == 0) & (run.dy == 0) & (run.steps > 0)
    sweep[home] = 360.0
    row = np.repeat(np.arange(len(blocks)), 1 + turns)
    first = np.searchsorted(row, np.arange(len(blocks)))
    tail = np.append(first[1:], len(row)) - 1
    each = np.full(len(row), 360.0)
    each[tail] = sweep
    last = np.zeros(len(row), np.bool_)
    last[tail] = True
    kind = blocks["kind"][row].copy()
    kind[(kind == Kind.ARC) & (each <= 0)] = Kind.LINE  # a step along the radius
    way = np.where(last[:, None], np.column_stack([run.dx, run.dy])[row], 0)
    places = np.vstack([[0, 0], np.cumsum(way, axis=0)]).astype(np.int64)
    low, high = places.min(axis=0), places.max(axis=0)
    middle = (low + high) // 2
    return _Figure(
        blocks,
        row,
        kind,
        np.where(kind == Kind.ARC, blocks["turn"][row], 0).astype(np.int64),
        radius[row],
        each,
        angle[row],
        places - middle,
        (int(middle[0]), int(middle[1])),
        first,
    )


def _path(base: _Figure, image: Image) -> tuple[Blocks, tuple[float, float]]:
    """Return the exact path of an image, and where it starts; ``source`` is a block."""
    x, y = base.middle
    here = turned(np.array([x]), np.array([-y if image.over else y]), image.degrees)
    px, py, u, v = image.place
    place = (
        int(here.x[0]) + px,
        int(here.y[0]) + py,
        float(here.rest_x[0]) + u,
        float(here.rest_y[0]) + v,
    )
    exact = replace(image, place=place).of(base.places[:, 0], base.places[:, 1]).exact
    out = np.zeros(len(base.row), EXACT)
    step = -1 if image.back else 1
    flip = -1.0 if image.over else 1.0
    angle = base.angle + (base.turn * base.sweep if image.back else 0.0)
    out["kind"] = base.kind[::step]
    out["turn"] = (base.turn * int(flip) * step)[::step]
    out["radius"], out["sweep"] = base.radius[::step], base.sweep[::step]
    out["start"] = (flip * angle + float(image.degrees))[::step]
    out["source"] = base.row[::step]
    ends = exact[:-1][::-1] if image.back else exact[1:]
    out["x"], out["y"] = ends[:, 0], ends[:, 1]
    first = exact[-1 if image.back else 0]
    return out, (float(first[0]), float(first[1]))


def _ends(path: Blocks) -> Floats:
    return np.column_stack([path["x"], path["y"]])


def _same_numbers(
    base: _Figure, image: Image, path: Blocks, start: tuple[float, float], stepping: Stepping
) -> tuple[Bools, Blocks]:
    """Return for which motions the figure's own numbers, with other signs, are the image's blocks.

    They are tried by stepping: the rules use magnitudes, but where x and y change places an arc may
    stop elsewhere at a tie, and some controllers step lines of two quadrants otherwise.
    """
    none = np.zeros(len(base.row), np.bool_)
    if image.back or not image.is_even:
        return none, base.blocks
    blocks = base.blocks.copy()
    x, y = blocks["x"].copy(), blocks["y"].copy()
    y = -y if image.over else y
    quarter = int(image.degrees // 90)
    blocks["x"], blocks["y"] = ((x, y), (-y, x), (-x, -y), (y, -x))[quarter]
    if image.over:
        blocks["turn"] = -blocks["turn"]
    if quarter % 2:
        moves = blocks["kind"] <= Kind.MOVE
        other = np.array([Axis.Y, Axis.X, Axis.SQUARE, Axis.SQUARE_X], np.uint8)
        blocks["axis"] = np.where(moves, other[blocks["axis"]], blocks["axis"])
    run = stepping.run(blocks)
    stands = to_whole(np.vstack([start, _ends(path)]))
    ends = np.append(base.first[1:], len(base.row))
    way = stands[ends] - stands[base.first]
    right = (run.steps >= 0) & (way == np.column_stack([run.dx, run.dy])).all(axis=1)
    return right[base.row], blocks


def _linked(
    paths: Sequence[Blocks], starts: Sequence[tuple[float, float]]
) -> tuple[Blocks, Ints, Ints]:
    """Return the paths of images in a row, the number of the image of each row, and the links."""
    out: list[Blocks] = []
    number: list[Ints] = []
    links = np.zeros(len(paths), np.int64)
    for k, (path, start) in enumerate(zip(paths, starts, strict=True)):
        if k and len(path):
            link, rows = _link(paths[k - 1], path, start)
            links[k] = link
            if link == Link.GOES_ON:  # controls are where the machine stands
                path["x"][: _leading(path)] = out[-1]["x"][-1]
                path["y"][: _leading(path)] = out[-1]["y"][-1]
            out.append(rows)
            number.append(np.full(len(rows), k, np.int64))
        out.append(path)
        number.append(np.full(len(path), k, np.int64))
    return np.concatenate(out), np.concatenate(number), links


def _leading(path: Blocks) -> int:
    """Return how many controls come before the first motion; the last row where none does."""
    motions = np.flatnonzero(path["kind"] <= Kind.MOVE)
    return int(motions[0]) if len(motions) else len(path) - 1


def _link(before: Blocks, path: Blocks, start: tuple[float, float]) -> tuple[Link, Blocks]:
    """Return how an image follows the one before, and the rows that lead to it."""
    end = _ends(before[-1:])[0]
    stands = to_whole(end)
    there = np.array(start)
    if np.hypot(*(stands - there)) <= MEETS_UM:
        return Link.GOES_ON, path[:0]
    row = np.zeros(1, EXACT)
    row["x"], row["y"], row["source"] = start[0], start[1], -1
    if np.hypot(*(end - there)) <= ONE_VERTEX_UM:
        row["kind"] = Kind.LINE
        return Link.LINE, row
    row["kind"] = Kind.MOVE
    pauses = row.copy()
    pauses["kind"] = Kind.PAUSE
    ahead, behind = pauses.copy(), pauses
    ahead["x"], ahead["y"] = end
    quiet = (Kind.PAUSE, Kind.THREAD, Kind.MOVE)
    parts = [row]
    if before["kind"][-1] not in quiet:
        parts.insert(0, ahead)
    if path["kind"][0] not in quiet:
        parts.append(behind)
    return Link.MOVE, np.concatenate(parts)
