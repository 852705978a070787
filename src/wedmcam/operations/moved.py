"""Transforms of programs: the data processing of the ZD-065 on whatever can be read as blocks.

A program becomes the program of its images, in the frame in which it starts at (0, 0). The machine
makes it (`controllers.zd065.moved`); that every vertex as stepped is within 1 um of the exact one
is measured by the judge on the bytes that are to be written (`judge.images`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.controllers.zd065.images import Image, images
from wedmcam.controllers.zd065.loop import Most
from wedmcam.controllers.zd065.moved import Link, Moved, moved
from wedmcam.diag import Diagnostic, Place, Span, error, note, warning
from wedmcam.frontends.wed import parse_transforms
from wedmcam.ir.figure import Rotate, Transform, Translate, With
from wedmcam.ir.figure import Sequence as Stages
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.images import Fit, Said, fit
from wedmcam.machines import Machine
from wedmcam.programs.stretches import stretches

T = TypeVar("T", bound=Transform)

#: More blocks than this are a typing error and not a program.
MOST_BLOCKS = 2_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """A program made of images of another one, and what was understood.

    Attributes:
        texts: the transforms as they were typed.
        transforms: as values; lengths are steps of the machine.
        figure: the blocks that were moved, from (0, 0) on: without the end of the program.
        made: the processing's own account.
        program: the images in the order of the path, and the end of the program.
        step_um: how long a step is.
        stepping: of the program that was read, and of this one.
        left_out: how many images lay on one that was there.
        fit: how near to the exact transform the written program is; None before it is written.
    """

    texts: tuple[str, ...]
    transforms: tuple[Transform, ...]
    figure: NDArray[np.void]
    made: Moved
    program: Program
    step_um: float
    stepping: Stepping
    left_out: int
    fit: Fit | None = None

    @property
    def count(self) -> int:
        """How many images there are, the figure itself counted where it stays."""
        return len(self.made.links)

    def moves_um(self) -> list[float]:
        """Return how long each move from image to image is, um."""
        stands = self.made.stands.astype(float)
        way = stands[1:, 0] - stands[:-1, -1]
        length = np.hypot(way[:, 0], way[:, 1]) * self.step_um
        return [float(v) for v in length[self.made.links[1:] == Link.MOVE]]

    def as_data(self) -> dict[str, Any]:
        """Return what was understood as plain data; lengths are mm, the fit um."""
        moves = self.moves_um()
        fitted = self.fit
        return {
            "transforms": list(self.texts),
            "images": self.count,
            "left_out": self.left_out,
            "start_mm": [v * self.step_um / 1000 for v in self.made.start],
            "moves": len(moves),
            "moves_mm": [round(min(moves) / 1000, 6), round(max(moves) / 1000, 6)]
            if moves
            else None,
            "same_blocks": self.made.same,
            "split": len(self.made.split),
            "vertices": int(self.made.stands.shape[0] * self.made.stands.shape[1]),
            "vertex_um": round(fitted.largest_um * self.step_um, 4) if fitted else None,
            "vertex_image": fitted.image if fitted else None,
            "vertex_block": fitted.block if fitted else None,
        }

    def lines(self) -> list[tuple[str, str]]:
        """Return what was understood for people, each line with what it is about."""
        out = [("transform", text) for text in self.texts]
        one = f"{_number(self.count, 'image')} of {_number(len(self.figure), 'block')}"
        x, y = (v * self.step_um / 1000 for v in self.made.start)
        out.append(("images", f"{one}, from ({x:.3f}, {y:.3f}) on"))
        moves = self.moves_um()
        goes_on = self.count - 1 - len(moves)
        if moves:
            low, high = (f"{length / 1000:.3f}" for length in (min(moves), max(moves)))
            long = f"{low} mm" if low == high else f"{low} to {high} mm"
            each = " each" if len(moves) > 1 and low == high else ""
            made = f"{_number(len(moves), 'move')} with the generator off, {long}{each}"
            out.append(("between", made))
        if goes_on:
            out.append(("goes on", f"{goes_on} of them where the one before ends"))
        if self.fit:
            f = self.fit
            where = f"behind block {f.block}" if f.block else "at the start"
            largest = f.largest_um * self.step_um
            place = f" ({where} of image {f.image})" if largest >= 0.005 else ""
            out.append(
                ("vertices", f"as stepped at most {largest:.2f} um from the exact ones{place}")
            )
        return out


def images_of(
    program: Program, machine_in: Machine, texts: Sequence[str], machine: Machine | None = None
) -> tuple[Images | None, list[Diagnostic]]:
    """Return the images of a program, and what was found.

    Args:
        program: as it was read.
        machine_in: the profile that it was read with.
        texts: transforms in the words of the part language, one after the other.
        machine: that the images are for: its limits; None for that of the program.
    """
    parsed, findings = parse_transforms(texts)
    if findings:
        return None, findings
    stepping = machine_in.stepping
    stop = np.flatnonzero(np.isin(program.blocks["kind"], (Kind.STOP, Kind.END)))
    size = int(stop[0]) if len(stop) else len(program.blocks)
    figure = program.blocks[:size]
    findings = _not_moved(program, size, stepping)
    if findings:
        return None, findings
    transforms = tuple(_in_steps(t, program.step_um) for t in parsed)
    total = size
    for t in transforms:
        total *= _copies(t) + 1
    if total > MOST_BLOCKS:
        too_many = error(
            "too-large",
            "the transforms make {blocks} blocks; {most} are taken for a typing error",
            _of(program, 0),
            hint="see to the number of copies",
            blocks=total,
            most=MOST_BLOCKS,
        )
        return None, [too_many]
    places, left_out = images(transforms)
    if left_out:
        findings.append(_left_out(left_out, program))
    to = (machine or machine_in).limits
    most = Most(*(limit or 999_999_999 for limit in (to.arc_um, to.count_um, to.line_um)))
    made = moved(figure, places, stepping, most, "square" if _square(machine) else "ends")
    whole = _program(program, size, made)
    findings += _notes(program, figure, places, made, stepping)
    step = program.step_um
    out = Images(tuple(texts), transforms, figure, made, whole, step, stepping, len(left_out))
    return out, findings


def measured(one: Images, written: Program, stepping: Stepping) -> tuple[Images, list[Diagnostic]]:
    """Return images with how near to the exact transform the written program steps.

    Args:
        one: the images.
        written: decoded from the bytes that are to be written; for an output that is no program
            the images themselves.
        stepping: its interpolator.
    """
    made = one.made
    said = Said(made.blocks, made.start, made.image, made.stands)
    how = fit(one.figure, one.transforms, said, one.stepping, written.blocks, stepping)
    one = replace(one, fit=how)
    if how.ok:
        return one, []
    hint = "convert to .zd or .3b, whose blocks hold the path itself, or transform the drawing"
    where = _of(one.program, 0)
    if how.wrong:
        text = "the images are not those of the program: {wrong}"
        return one, [error("transform-differs", text, where, hint=hint, wrong=how.wrong)]
    off = error(
        "transform-differs",
        "a vertex as stepped is {off_um:.2f} um from the exact one, behind block {block} of image "
        "{image}",
        where,
        hint=hint,
        off_um=how.largest_um * one.step_um,
        block=how.block,
        image=how.image,
    )
    return one, [off]


def _number(n: int, what: str) -> str:
    return f"{n} {what}" if n == 1 else f"{n} {what}s"


def _square(machine: Machine | None) -> bool:
    from wedmcam.targets import target_of

    return machine is not None and bool(getattr(target_of(machine), "square", False))


def _of(program: Program, i: int) -> Span | None:
    return program.spans[i] if 0 <= i < len(program.spans) else None


def _in_steps(t: T, step_um: float) -> T:
    """Return a transform whose lengths are steps."""
    if step_um == 1:
        return t
    if isinstance(t, Translate):
        return replace(t, x=t.x / step_um, y=t.y / step_um)
    if isinstance(t, Rotate):
        return replace(t, about=(t.about[0] / step_um, t.about[1] / step_um))
    if isinstance(t, With):
        return replace(t, transform=_in_steps(t.transform, step_um))
    if isinstance(t, Stages):
        return replace(t, transforms=tuple(_in_steps(part, step_um) for part in t.transforms))
    return t


def _copies(t: Transform) -> int:
    """Return how many images a transform adds to each."""
    if isinstance(t, Stages):
        total = 1
        for part in t.transforms:
            total *= _copies(part) + 1
        return total - 1
    if isinstance(t, With):
        return max(_copies(t.transform), 1)
    return getattr(t, "copies", 0)


def _not_moved(program: Program, size: int, stepping: Stepping) -> list[Diagnostic]:
    """Return why a program has no images: a block without an end, motions behind its end."""
    blocks = program.blocks
    endless = np.flatnonzero(stepping.run(blocks[:size]).steps < 0)
    if len(endless):
        i = int(endless[0])
        text = "block {block} never ends on its own controller: it has no image"
        return [error("endless-block", text, _of(program, i), block=i + 1)]
    late = size + np.flatnonzero(blocks["kind"][size:] <= Kind.MOVE)
    if len(late):
        return [
            error(
                "not-carried",
                "{blocks} blocks behind the end of cutting are no part of the path, and no image "
                "is made of them",
                _of(program, int(late[0])),
                hint="take them out, or move the end of cutting behind them",
                blocks=len(late),
            )
        ]
    if not (blocks["kind"][:size] <= Kind.MOVE).any():
        nowhere = "the program moves nowhere: nothing can be transformed"
        return [error("no-blocks", nowhere, _of(program, 0))]
    return []


def _left_out(images: Sequence[Image], program: Program) -> Diagnostic:
    x, y, u, v = images[0].place
    scale = program.step_um
    first = Place.of_um((x + u) * scale, (y + v) * scale)
    one = len(images) == 1
    return warning(
        "duplicate",
        "1 image lies on what is there already and is left out; it would start at {first}"
        if one
        else "{count} images lie on what is there already and are left out; the first would start "
        "at {first}",
        _of(program, 0),
        hint="copies is the number of copies without the figure itself",
        points_mm=(first,),
        count=len(images),
        first=first,
    )


def _program(program: Program, size: int, made: Moved) -> Program:
    """Return the program of images; what follows from its blocks keeps its place in the file."""
    tail = program.blocks[size:]
    source = np.concatenate([made.blocks["source"], np.arange(size, len(program.blocks))])
    # What leads to an image stands where the first block of the image does.
    known = source.copy()
    for i in np.flatnonzero(source < 0)[::-1].tolist():
        known[i] = known[i + 1]
    words = dict(program.words)
    named = np.flatnonzero(np.isin(source, np.array(list(words), np.int64)))
    blocks = np.concatenate([made.blocks, tail])
    blocks["source"] = -1
    return replace(
        program,
        blocks=blocks,
        origin=made.start,
        sources=(),
        spans=[program.spans[i] for i in known.tolist()] if len(program.spans) else (),
        words=tuple((int(i), words[int(source[i])]) for i in named),
    )


def senses_of(one: Images, senses: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return, for each block of the images, whether its arc grows where the outline is offset.

    Args:
        one: the images.
        senses: of the blocks of the program that was read.
    """
    source = one.made.blocks["source"]
    own = np.where(source >= 0, senses[source], 0)
    size = len(one.figure)
    return np.concatenate([own, senses[size:]])


def _notes(
    program: Program,
    figure: NDArray[np.void],
    places: Sequence[Image],
    made: Moved,
    stepping: Stepping,
) -> list[Diagnostic]:
    """Return what is to be known of images that were made."""
    findings = []
    if made.split:
        image, block = made.split[0]
        findings.append(
            note(
                "image-split",
                "the arc of block {block} is several blocks in image {image}: no whole centre "
                "brings it to its end, or it is over a limit"
                if len(made.split) == 1
                else "{count} arcs of images are several blocks: no whole centre brings them to "
                "their end, or they are over a limit; the first is block {block} in image {image}",
                _of(program, block),
                count=len(made.split),
                block=block + 1,
                image=image + 1,
            )
        )
    same = len(made.blocks) == len(figure) and all(
        (made.blocks[name] == figure[name]).all()
        for name in ("kind", "turn", "axis", "x", "y", "count")
    )
    if same and len(places) == 1:
        x, y = (v * program.step_um / 1000 for v in made.start)
        findings.append(
            warning(
                "transform-idle",
                "the transform moves the program as a whole: its data are what they were, and it "
                "starts at ({x_mm:.3f}, {y_mm:.3f}) mm from where it did",
                _of(program, 0),
                hint="thread the wire there; 'copies N' makes copies",
                x_mm=x,
                y_mm=y,
            )
        )
    if any(i.back for i in places):
        findings += _pauses_reversed(program, figure, stepping)
    return findings


def _pauses_reversed(
    program: Program, figure: NDArray[np.void], stepping: Stepping
) -> list[Diagnostic]:
    """Return a warning of pauses in closed contours: in reverse they come near the start."""
    run = stepping.run(figure)
    ends = np.cumsum(np.column_stack([run.dx, run.dy]), axis=0)
    starts = ends - np.column_stack([run.dx, run.dy])
    late = [
        (before, int((one.path > before).sum()))
        for one in stretches(figure, starts, ends)
        if one.closed
        for before in one.pauses
    ]
    if not late:
        return []
    before, left = late[0]
    return [
        warning(
            "pause-reversed",
            "block {block}: a pause before a contour closes (blocks to its end: {left}) comes "
            "behind its start in the reversed image, with the piece still held"
            if len(late) == 1
            else "{count} pauses before a contour closes come behind its start in the reversed "
            "image, with the piece still held; the first is block {block} (blocks to the end of "
            "its contour: {left})",
            _of(program, before + 1),
            hint="hold the pieces of the image without a stop, or compile the drawing with "
            "--transform",
            count=len(late),
            block=before + 2,
            left=left,
        )
    ]
