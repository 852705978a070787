"""What a controller makes of outlines that it offsets itself (G41, G42 D, G40).

The model [R], after what handbooks of such controllers have in common:

* The lead-in, a straight line at least as long as the offset, ends beside the start of the outline,
  on the normal of the first block. The lead-out starts on the normal of the last block.
* Lines shift along their normal, arcs keep their centre. At outer corners an arc about the corner
  joins them, at inner corners they are cut where neighbours cross.
* The controller looks one block ahead (``lookahead``). A block that the offset leaves nothing of,
  or a wire that comes too near to a block farther on, it cannot see or refuses; so it is refused
  here. An outline may run on over its own start, and round again.
* A stated centre that is not as far from the end as from the start moves to where it is.

The path is put on the grid and stepped as ``lower`` does it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Span, error
from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import Floats, Ints
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.plan import Cut, Plan
from wedmcam.ir.program import BLOCK, Kind, Program, Role
from wedmcam.ir.programmed import Programmed
from wedmcam.transforms.lookahead import Lost, beside
from wedmcam.transforms.lower import Rules, lower

Blocks = NDArray[np.void]


@dataclass(slots=True)
class _Made:
    """Blocks of one run: of which motion each is."""

    blocks: Blocks
    of: Ints


def applied(read: Programmed, rules: Rules) -> tuple[Program | None, list[Diagnostic]]:
    """Return the program that the controller makes of outlines and offsets.

    Args:
        read: as the reader of the format gives it.
        rules: limits of a block, and the line table.

    Returns:
        Every run as the stepped path beside its outline; spans stay those of the file. None and
        errors where the model does not hold.
    """
    program, motions = read.program, read.motions
    if not len(motions):
        return program, []
    found: list[Diagnostic] = []
    spans = [program.spans[k] for k in _block_of(read).tolist()]
    made: list[_Made] = []
    for run in range(int(motions["run"].max()) + 1):
        rows = np.flatnonzero(motions["run"] == run)
        one, more = _run(motions[rows], [spans[k] for k in rows.tolist()], rules)
        found += more
        if one is None:
            continue
        made.append(_Made(one.blocks, rows[one.of]))
    if found:
        return None, found
    return _woven(read, made), []


def _block_of(read: Programmed) -> Ints:
    """Return the block of each motion."""
    where = np.flatnonzero(read.mark >= 0)
    block = np.zeros(len(read.motions), np.int64)
    block[read.mark[where]] = where
    return block


def _woven(read: Programmed, made: list[_Made]) -> Program:
    """Return the program with every motion of a run replaced by its blocks."""
    program = read.program
    blocks = np.concatenate([m.blocks for m in made])
    of = np.concatenate([m.of for m in made])
    plain = np.flatnonzero(read.mark < 0)
    place = np.concatenate([plain, _block_of(read)[of]])
    order = np.argsort(place, kind="stable")
    every = np.concatenate([program.blocks[plain], blocks])[order]
    place = place[order]
    # A lead-out that is a move (wire cut) stays one.
    kinds = program.blocks["kind"][place]
    every["kind"][(kinds == Kind.MOVE) & (every["kind"] == Kind.LINE)] = Kind.MOVE
    every["source"], every["cut"], every["role"] = -1, 0, 0
    texts = dict(program.words)
    words = tuple((k, texts[int(i)]) for k, i in enumerate(place) if int(i) in texts)
    spans = [program.spans[int(i)] for i in place]
    return Program(every, program.origin, program.sources, spans, words)


def _run(motions: Blocks, spans: list[Span], rules: Rules) -> tuple[_Made | None, list[Diagnostic]]:
    """Return the blocks of one run; ``of`` counts its motions from 0 on."""
    on = np.flatnonzero(motions["role"] == Role.CONTOUR)
    lead = motions[0]
    shift = float(lead["shift"])
    length = float(np.hypot(lead["x1"] - lead["x0"], lead["y1"] - lead["y0"]))
    if length < abs(shift) - 1e-6:
        return None, [
            error(
                "compensation-lead",
                f"the lead-in is {length / 1000:.3f} mm long, shorter than the offset "
                f"D{int(lead['d'])} of {abs(shift) / 1000:.3f} mm",
                spans[0],
                hint="start farther from the outline",
            )
        ]
    outline = outline_of(motions[on], tuple(spans[k] for k in on.tolist()))
    shifts = motions["shift"][on][outline.vertices["source"][:-1]]
    path, lost = beside(outline, shifts, shift)
    if path is None:
        assert lost is not None
        s = seg.of_rows(outline.starts, outline.ends)
        return None, [_lost_error(outline, s, lost, float(shifts[lost.row]))]
    x, y = to_grid([lead["x0"], lead["y0"]]).tolist()
    cut = Cut(None, path, (x, y), keeps_left=shift < 0)
    lowered, found = lower(Plan((cut,), ()), rules)
    if lowered is None:
        return None, [replace(d, span=spans[0]) for d in found]
    # The way out of a closed path is not that of the file: it follows.
    kind, role = lowered.blocks["kind"], lowered.blocks["role"]
    blocks = lowered.blocks[(kind <= Kind.MOVE) & (role != Role.LEAD_OUT)].copy()
    of = np.where(blocks["role"] == Role.LEAD_IN, 0, on[blocks["source"]])
    if motions["role"][-1] == Role.LEAD_OUT:
        end = path.vertices[0 if path.closed else -1]
        ax, ay = to_grid([end["x"], end["y"]]).tolist()
        bx, by = to_grid([motions["x1"][-1], motions["y1"][-1]]).tolist()
        out = _line(bx - ax, by - ay, rules)
        blocks = np.concatenate([blocks, out])
        of = np.concatenate([of, np.full(len(out), len(motions) - 1)])
    return _Made(blocks, of), []


def _line(dx: int, dy: int, rules: Rules) -> Blocks:
    """Return a line in as many blocks as the limits need; none where it has no length."""
    most = min(rules.line_um, rules.count_um)
    pieces = -(-max(abs(dx), abs(dy)) // most)
    k = np.arange(pieces + 1)
    x, y = dx * k // max(pieces, 1), dy * k // max(pieces, 1)
    out = np.zeros(pieces, BLOCK)
    out["kind"], out["x"], out["y"] = Kind.LINE, np.diff(x), np.diff(y)
    out["axis"], out["count"] = rules.stepping.line_count(out["x"], out["y"])
    return out


def outline_of(motions: Blocks, spans: tuple[Span, ...]) -> Contour:
    """Return the outline of a run as an open contour: a vertex a motion, ``source`` its number.

    A full circle among other motions is two vertices: start and end of a path may not be one.
    """
    n = len(motions)
    rows = np.zeros(n, VERTEX)
    rows["x"], rows["y"], rows["turn"] = motions["x0"], motions["y0"], motions["turn"]
    rows["cx"], rows["cy"] = centred(motions)
    rows["source"] = np.arange(n)
    whole = (motions["x0"] == motions["x1"]) & (motions["y0"] == motions["y1"])
    if n > 1 and whole.any():
        half = rows[whole]
        half["x"], half["y"] = 2 * half["cx"] - half["x"], 2 * half["cy"] - half["y"]
        rows = np.insert(rows, np.flatnonzero(whole) + 1, half)
    last = np.zeros(1, VERTEX)
    last["x"], last["y"], last["source"] = motions["x1"][-1], motions["y1"][-1], -1
    return Contour(np.concatenate([rows, last]), False, spans)


def centred(motions: Blocks) -> tuple[Floats, Floats]:
    """Return centres as far from the end of each arc as from its start, nearest to those stated."""
    dx, dy = motions["x1"] - motions["x0"], motions["y1"] - motions["y0"]
    mx, my = 0.5 * (motions["x0"] + motions["x1"]), 0.5 * (motions["y0"] + motions["y1"])
    chord = dx * dx + dy * dy
    along = ((motions["cx"] - mx) * dx + (motions["cy"] - my) * dy) / np.where(chord > 0, chord, 1)
    arc = (motions["turn"] != 0) & (chord > 0)
    return (
        np.where(arc, motions["cx"] - along * dx, motions["cx"]),
        np.where(arc, motions["cy"] - along * dy, motions["cy"]),
    )


def _lost_error(outline: Contour, s: seg.Segments, lost: Lost, shift: float) -> Diagnostic:
    """Return why the controller cannot follow an outline, for people."""
    x, y = lost.at
    offset = f"{abs(shift) / 1000:.3f} mm"
    other = f" of {_called(outline.source_of(lost.other))}" if lost.other >= 0 else ""
    hint = (
        "a smaller offset or larger inside radii (--corner), or a profile that does not leave the "
        "offset to the controller"
    )
    if lost.kind == "radius":
        radius = f"{s.radius[lost.row] / 1000:.3f} mm"
        what = f"its inside radius of {radius} is smaller than the offset {offset}"
    elif lost.kind == "back":
        what = f"it runs back on the block{other}, where the wire would be on its other side"
        hint = (
            "G40 and a lead-out before a pass the other way, which takes the other of G41 and G42"
        )
    elif lost.kind == "near":
        what = (
            f"with an offset of {offset} the wire comes {lost.gap_um / 1000:.3f} mm near to the "
            f"block{other}"
        )
        if lost.row == len(s) - 1:
            hint = "end the outline before or behind an inner corner, by more than the offset"
    else:
        what = f"with an offset of {offset} nothing is left of it, or it meets another block"
    return error(
        "compensation-lost",
        f"the controller cannot offset this block at ({x / 1000:.3f}, {y / 1000:.3f}) mm from "
        f"the start of the program: {what}",
        outline.source_of(lost.row),
        hint=hint,
    )


def _called(span: Span | None) -> str:
    line = getattr(span, "line", None)
    return "another line" if line is None else f"line {line}"
