"""A program made of images of another one, against the exact transform.

The transforms are written here once more, as complex numbers in float64, and share no line with the
processing that made the program. Every vertex of every image, in order, must be a place at which a
block of the decoded program ends, within 1 um of the exact one; and what leads there must be cut or
not, and bend about the right centre, as in the figure.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.ir.figure import (
    Mirror,
    Reverse,
    Rotate,
    Sequence,
    Symmetry,
    Transform,
    Translate,
    With,
)
from wedmcam.ir.program import Kind

Blocks = NDArray[np.void]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

#: How far a vertex as stepped may be from the exact one, um (steps, where these are longer).
WITHIN_UM = 1.0
#: Images in the same turn nearer than this are one, um.
SAME_UM = 1.0
#: How far an arc may stray from the exact circle: that of its vertices, its own centre, and a step.
STRAY_UM = 3.0
#: How far what an arc turns, told by its steps, may differ, in whole turns: the ends are the same,
#: so a wrong one is a whole turn off. Of an arc of some um a um of radius is a large part.
TURN_SHARE = 0.5


class _Exact(NamedTuple):
    """z becomes a z + b, or a conj(z) + b where ``over``; run backwards where ``back``."""

    a: complex
    b: complex
    over: bool
    back: bool

    def of(self, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return self.a * (np.conj(z) if self.over else z) + self.b


@dataclass(frozen=True, slots=True)
class Fit:
    """How well a program states images of another one.

    Attributes:
        largest_um: largest distance of a vertex as stepped from the exact one.
        image: in which image that is, from 1 on.
        block: behind which block of the figure, from 1 on; 0 for the start of the image.
        at: where the machine stands there, from where the program starts.
        wrong: what is not as in the figure, in words; empty if all is.
    """

    largest_um: float
    image: int
    block: int
    at: tuple[int, int]
    wrong: str = ""

    @property
    def ok(self) -> bool:
        """Whether the program states the images."""
        return not self.wrong and self.largest_um <= WITHIN_UM


@dataclass(frozen=True, slots=True, eq=False)
class Said:
    """What a data processing says that it made; nothing of it is believed.

    Attributes:
        blocks: from ``start`` on; ``source`` is the block of the figure that each is of, -1 for
            what leads from image to image.
        start: whole um, in the frame of the figure.
        image: for each block the number of its image, from 0 on.
        stands: where the machine stands at the start of each image and behind each of its blocks,
            in the order in which they are run, shape (images, blocks of the figure + 1, 2).
    """

    blocks: Blocks
    start: tuple[int, int]
    image: Ints
    stands: Ints


def fit(
    figure: Blocks,
    transforms: Iterable[Transform],
    said: Said,
    stepping: Stepping,
    written: Blocks,
    written_stepping: Stepping,
) -> Fit:
    """Return how well a program states the images of a figure.

    Args:
        figure: its blocks, from (0, 0) on.
        transforms: lengths um.
        said: what was made of it.
        stepping: of the figure and of what was made.
        written: blocks decoded from the bytes that are to be written; they start at the same place.
        written_stepping: their interpolator.
    """
    images = _images(transforms)
    run = stepping.run(figure)
    z = np.concatenate([[0], np.cumsum(run.dx + 1j * run.dy)])
    if said.stands.shape != (len(images), len(z), 2):
        return Fit(math.inf, 0, 0, (0, 0), f"{len(said.stands)} images instead of {len(images)}")
    exact = np.array([i.of(z)[::-1] if i.back else i.of(z) for i in images])
    off = np.abs(said.stands[..., 0] + 1j * said.stands[..., 1] - exact)
    made = stepping.run(said.blocks)
    ends = np.vstack([[0, 0], np.cumsum(np.column_stack([made.dx, made.dy]), axis=0)])
    ends += np.array(said.start)
    wrong = _claimed(images, said, len(figure), ends)
    wrong = wrong or _bends(figure, images, said, ends, stepping)
    run = written_stepping.run(written)
    there = np.vstack([[0, 0], np.cumsum(np.column_stack([run.dx, run.dy]), axis=0)])
    there += np.array(said.start)
    stands = said.stands
    if not wrong:
        passed = _passed(stands, stands[..., 0] + 1j * stands[..., 1], there, 0.0)
        # A controller that makes the path of an outline may end a um beside.
        found = passed if passed is not None else _passed(stands, exact, there, WITHIN_UM)
        if found is None:
            wrong = "blocks of what is written do not end within 1 um of all vertices, in order"
        else:
            stands = there[found]
            off = np.abs(stands[..., 0] + 1j * stands[..., 1] - exact)
    k, j = (int(n) for n in np.unravel_index(int(np.argmax(off)), off.shape))
    block = len(figure) + 1 - j if j and images[k].back else j
    here = (int(stands[k, j, 0]), int(stands[k, j, 1]))
    return Fit(float(off[k, j]), k + 1, block, here, wrong)


def _images(transforms: Iterable[Transform]) -> list[_Exact]:
    out = [_Exact(1 + 0j, 0j, False, False)]
    for t in transforms:
        out = _after(out, t)
    return out


def _after(images: list[_Exact], t: Transform) -> list[_Exact]:
    if isinstance(t, Sequence):
        for part in t.transforms:
            images = _after(images, part)
        return images
    if isinstance(t, Reverse):
        return [i._replace(back=not i.back) for i in images[::-1]]
    if isinstance(t, With):
        inner = t.transform
        if isinstance(inner, With) or (isinstance(inner, Translate | Rotate) and inner.copies):
            return _after(images, inner)
        image = _after(images, t.transform)
        if image[0].over != images[0].over:
            image = _after(image, Reverse())
        return _apart(images, image)
    if isinstance(t, Symmetry | Mirror):
        a = {"x": 1, "y": -1}[t.axis] if isinstance(t, Symmetry) else 1j if t.degrees == 45 else -1j
        return [
            _Exact(a * i.a.conjugate(), a * i.b.conjugate(), not i.over, i.back) for i in images
        ]
    made = [
        _shifted(i, t, k) if isinstance(t, Translate) else _turned(i, t, k)
        for k in range(1, max(t.copies, 1) + 1)
        for i in images
    ]
    return _apart(images, made) if t.copies else made


def _shifted(i: _Exact, t: Translate, k: int) -> _Exact:
    return i._replace(b=i.b + k * complex(t.x, t.y))


def _turned(i: _Exact, t: Rotate, k: int) -> _Exact:
    a = _unit(k * Fraction(t.degrees))
    about = complex(*t.about)
    return i._replace(a=a * i.a, b=about + a * (i.b - about))


def _unit(degrees: Fraction) -> complex:
    """Return the number of length 1 at an angle; whole quarters are exact."""
    quarter, rest = divmod(degrees % 360, 90)
    return complex(1j ** int(quarter)) * cmath.exp(1j * math.radians(rest))


def _apart(images: list[_Exact], more: list[_Exact]) -> list[_Exact]:
    """Return images and more of them, without those that lie on one that is there."""
    out: list[_Exact] = []
    seen: dict[tuple[bool, int, int], list[_Exact]] = {}
    for k, image in enumerate([*images, *more]):
        x, y = round(image.b.real / 10), round(image.b.imag / 10)
        like = [
            one
            for i in (x - 1, x, x + 1)
            for j in (y - 1, y, y + 1)
            for one in seen.get((image.over, i, j), ())
            if abs(one.a - image.a) < 1e-12 and abs(one.b - image.b) <= SAME_UM
        ]
        if k < len(images) or not like:
            out.append(image)
            seen.setdefault((image.over, x, y), []).append(image)
    return out


def _passed(
    stands: Ints, wanted: NDArray[np.complex128], ends: Ints, within_um: float
) -> Ints | None:
    """Return the first place of a program, in its order, that is near to each wanted one.

    Args:
        stands: gives the shape of the result: images, vertices.
        wanted: places, a number each.
        ends: where the program starts, and where its blocks end, shape (n, 2).
        within_um: how near.

    Returns:
        Rows of ``ends``; None where they do not come by all that is wanted.
    """
    x, y = ends[:, 0].tolist(), ends[:, 1].tolist()
    rows, at, total = [], 0, len(x)
    for z in wanted.ravel().tolist():
        while at < total and math.hypot(x[at] - z.real, y[at] - z.imag) > within_um:
            at += 1
        if at == total:
            return None
        rows.append(at)
    return np.array(rows, np.int64).reshape(stands.shape[:2])


def _claimed(images: list[_Exact], said: Said, figure: int, ends: Ints) -> str:
    """Say which block does not lead from and to the places that it is said to lead to.

    Args:
        images: as computed here.
        said: what the data processing says of its blocks.
        figure: how many blocks the figure has.
        ends: where the machine stands before each block and behind the last, shape (n + 1, 2).
    """
    rows = np.flatnonzero(said.blocks["source"] >= 0)
    number, source = said.image[rows], said.blocks["source"][rows].astype(np.int64)
    back = np.array([i.back for i in images])[number]
    nth = np.where(back, figure - 1 - source, source)
    key = number * figure + nth
    first = np.append(True, np.diff(key) != 0)[: len(key)]
    last = np.append(np.diff(key) != 0, True)[-len(key) :] if len(key) else first
    wrong = np.append(0, np.diff(key))[: len(key)] < 0
    wrong |= first & (ends[rows] != said.stands[number, nth]).any(axis=1)
    wrong |= last & (ends[rows + 1] != said.stands[number, nth + 1]).any(axis=1)
    if wrong.any():
        i = int(np.flatnonzero(wrong)[0])
        return f"block {int(source[i]) + 1} in image {int(number[i]) + 1} is not in its place"
    empty = np.ones(len(images) * figure, np.bool_)
    empty[key] = False
    gone = (said.stands[:, 1:] != said.stands[:, :-1]).any(axis=2).reshape(-1) & empty
    if gone.any():
        k, j = divmod(int(np.flatnonzero(gone)[0]), figure)
        return f"image {k + 1} lacks its block number {j + 1}"
    return ""


def _bends(figure: Blocks, images: list[_Exact], said: Said, ends: Ints, stepping: Stepping) -> str:
    """Say which block is not run as that of the figure: cut or moved, its sense, its circle."""
    run, made = stepping.run(figure), stepping.run(said.blocks)
    rows = np.flatnonzero(said.blocks["source"] >= 0)
    blocks, number = said.blocks[rows], said.image[rows]
    source = blocks["source"].astype(np.int64)
    stated = figure[source]
    bent = stated["kind"] == Kind.ARC
    arc = blocks["kind"] == Kind.ARC
    bad = (stated["kind"] != blocks["kind"]) & ~(bent & (blocks["kind"] == Kind.LINE))
    flips = np.array([-1 if i.over != i.back else 1 for i in images])[number]
    bad |= arc & (blocks["turn"] != stated["turn"] * flips)
    z = np.concatenate([[0], np.cumsum(run.dx + 1j * run.dy)])
    c = (z[:-1] - (figure["x"] + 1j * figure["y"]))[source]
    a, b, over = (np.array([getattr(i, n) for i in images])[number] for n in ("a", "b", "over"))
    c = a * np.where(over, np.conj(c), c) + b
    radius = np.hypot(stated["x"].astype(float), stated["y"].astype(float))
    begin = ends[rows, 0] + 1j * ends[rows, 1]
    for share in (0.25, 0.5, 0.75):
        n = (np.maximum(made.steps[rows], 0) * share).astype(np.int64)
        x, y = stepping.position(blocks, n)
        bad |= bent & (np.abs(np.abs(begin + x + 1j * y - c) - radius) > STRAY_UM)
    if bad.any():
        i = int(np.flatnonzero(bad)[0])
        return f"block {int(source[i]) + 1} in image {int(number[i]) + 1} is not run as stated"
    # A whole turn and none have the same ends.
    size = len(images) * len(figure)
    steps = np.bincount(number * len(figure) + source, made.steps[rows], size)
    steps = np.where(figure["kind"] == Kind.ARC, steps.reshape(-1, len(figure)), 0)
    once = np.hypot(figure["x"].astype(float), figure["y"].astype(float))
    most = np.maximum(TURN_SHARE * stepping.turn_steps(once), 4.0)
    short = np.abs(steps - np.where(figure["kind"] == Kind.ARC, run.steps, 0)) > most
    if short.any():
        k, i = (int(n[0]) for n in np.nonzero(short))
        return f"block {i + 1} in image {k + 1} does not turn as far as in the figure"
    return ""
