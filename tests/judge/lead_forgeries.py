"""Forged leads: programs of which the contours are right and a lead is not, and what is proven.

A lead is replaced by other lines, in the way in and in the way out of every cut. Behind it the
program goes on as it was (`carried`: all that follows is displaced), or the move before or behind
makes up for it (`mended`: all that follows is in its place). What must be refused:

- of a program with a certificate (strict order), every one of them;
- of any other, those that enter kept material, meet another cut, or end where they may not, and
  those that displace a contour by more than the limit.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from judge_cases import line, move

from wedmcam import api
from wedmcam.compiler import pipeline, proof
from wedmcam.diag import Severity
from wedmcam.diag.run import Refused, Run
from wedmcam.ir.plan import Side
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.in_steps import in_steps
from wedmcam.judge.match import pair_with_cuts
from wedmcam.judge.walk import walk
from wedmcam.targets import target_of

#: By how much forged leads are off, um. Aside of the plan's by up to 2 um a lead may well be right;
#: where it ends is known to the step, but for open paths and controllers that recompute arc ends.
OFF = (1, 3, 20, 500)


@dataclass(frozen=True, eq=False)
class Forged:
    """A program with a forged lead; ``refused`` is that no proof may pass it."""

    name: str
    program: Program
    refused: bool


@dataclass(frozen=True, eq=False)
class Lead:
    """A way in or out: rows of the program, where it begins and ends, and what it is of."""

    cut: int
    into: bool
    rows: np.ndarray
    first: int
    start: np.ndarray
    end: np.ndarray


def leads(made: Any) -> list[Lead]:
    """Return the leads of a compiled program."""
    program, stepping = made.program, made.machine.stepping
    plan = in_steps(made.plan, program.step_um)
    way = walk(program, stepping)
    out = []
    for piece, k in pair_with_cuts(way, plan):
        assert k >= 0
        index, none = piece.index, np.zeros(0, np.int64)
        contour = index[piece.first], index[piece.last - 1]
        rows = index[: piece.first] if piece.first else none
        out.append(Lead(k, True, rows, int(index[0]), way.start[index[0]], way.start[contour[0]]))
        if plan.cuts[k].path.closed:
            rows = index[piece.out :]
            first = int(rows[0]) if len(rows) else int(contour[1]) + 1
            out.append(Lead(k, False, rows, first, way.end[contour[1]], way.end[index[-1]]))
    return out


def forged(made: Any) -> Iterator[Forged]:
    """Yield programs with one forged lead, or one forged end of an open path, each."""
    every = leads(made)
    last = [lead for lead in every if lead.cut == len(made.plan.cuts) - 1]
    if not made.plan.cuts[-1].path.closed and last[0].into:
        yield from _beyond(made)
    for lead in every:
        whole = (lead.end - lead.start).astype(float)
        if not lead.into and len(lead.rows) != 1:
            whole = None  # back over an overcut: only what has no direction of its own
        for name, points, wrong in _ways(lead, whole, every, made):
            for how in ("carried", "mended"):
                program, shift = _with(made, lead, points, how == "mended")
                if program is None:
                    continue
                refused = wrong or (how == "carried" and shift > 8)
                yield Forged(
                    f"cut {lead.cut + 1} {'in' if lead.into else 'out'}: {name}, {how}",
                    program,
                    refused,
                )


def _beyond(made: Any) -> Iterator[Forged]:
    """Yield programs that end elsewhere than where an open path ends."""
    program, stepping = made.program, made.machine.stepping
    cutting = np.flatnonzero(program.blocks["kind"] <= Kind.ARC)
    row = int(cutting[-1]) + 1
    for off in OFF[1:]:
        for x, y in ((off, 0), (-off, 0), (0, off), (0, -off)):
            for back in (False, True) if off > 3 else (False,):
                rows = [
                    line(x, y, stepping.table),
                    *([line(-x, -y, stepping.table)] if back else []),
                ]
                blocks = np.concatenate([program.blocks[:row], *rows, program.blocks[row:]])
                made_ = replace(program, blocks=blocks, spans=(), words=())
                yield Forged(f"end {x}, {y}{' and back' if back else ''}", made_, not back)
    blocks = np.delete(program.blocks, row - 1)
    yield Forged("end: last block dropped", replace(program, blocks=blocks, spans=()), True)


def _ways(
    lead: Lead, whole: np.ndarray | None, every: list[Lead], made: Any
) -> Iterator[tuple[str, list[np.ndarray], bool]]:
    """Yield names, the places that a forged lead runs through, and whether it may never pass."""
    a, b = lead.start.astype(float), lead.end.astype(float)
    exact = counted(made) != "textbook"
    ends = not lead.into  # a way out has to end where the wire was threaded
    sided = made.plan.side in (Side.PART, Side.DIE) and made.plan.offset_um > 0
    if whole is not None and np.hypot(*whole) > 10:
        length = float(np.hypot(*whole))
        u = whole / length
        n = np.array([-u[1], u[0]])
        for off in OFF:
            if off == 1 and (not exact or not made.plan.cuts[lead.cut].path.closed):
                continue
            if off < length - 2:
                yield f"short by {off}", [a, b - off * u] if ends else [a + off * u, b], ends
            yield f"long by {off}", [a, b + off * u] if ends else [a - off * u, b], ends
            if off > 1:
                yield f"turned by {off}", [a, b + off * n] if ends else [a + off * n, b], ends
                yield f"aside by {off}", [a, a + off * n, b + off * n, b], False
                yield f"bent by {off}", [a, (a + b) / 2 + off * n, b], False
        for angle in (90, 180, 270):
            c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
            other = np.array([c * whole[0] - s * whole[1], s * whole[0] + c * whole[1]])
            # Half a turn leads to the other side of the path: into what is kept.
            deep = sided and angle == 180 and length > 50
            yield f"turned by {angle}", [a, a + other] if ends else [b - other, b], ends or deep
        yield "doubled", [a, b, a, b], False
        yield "there, back", [a, b, a] if ends else [b, a, b], ends
    yield "dropped", [b, b] if lead.into else [a, a], ends and bool((a != b).any())
    for other in every:
        if other.cut == lead.cut or other.into != lead.into:
            continue
        # To the other cut, across its path and back.
        on = (other.end if other.into else other.start).astype(float)
        near = a if ends else b
        beyond = near + (on - near) * 1.05 + 1
        if np.hypot(*(on - near)) > 100:
            points = [a, beyond, a, b] if ends else [a, b, beyond, b]
            yield f"across cut {other.cut + 1}", points, True
        if (other.end - other.start != lead.end - lead.start).any() and whole is not None:
            moved = (other.end - other.start).astype(float)
            name = f"that of cut {other.cut + 1}"
            yield name, [a, a + moved] if ends else [b - moved, b], ends
        break


def _with(
    made: Any, lead: Lead, points: list[np.ndarray], mended: bool
) -> tuple[Program | None, float]:
    """Return the program with another lead, and by how much what follows is displaced."""
    program, stepping = made.program, made.machine.stepping
    whole = [np.round(p).astype(np.int64) for p in points]
    legs = [q - p for p, q in itertools.pairwise(whole) if (q != p).any()]
    rows = [line(int(x), int(y), stepping.table) for x, y in legs]
    b = program.blocks
    before, after = b[: lead.first], b[lead.first + len(lead.rows) :]
    # How much farther the forged lead leads than the right one did.
    more = sum(legs, np.zeros(2, np.int64)) - (lead.end - lead.start)
    origin = np.array(program.origin)
    if not more.any():
        if mended:
            return None, 0.0  # nothing to mend
    elif mended:
        moves = np.flatnonzero((before if lead.into else after)["kind"] == Kind.MOVE)
        if lead.into and not len(moves):
            origin = origin - more
        elif len(moves):
            some = (before if lead.into else after).copy()
            k = int(moves[-1] if lead.into else moves[0])
            m = walk(replace(program, blocks=some[k : k + 1], spans=(), words=()), stepping)
            x, y = (int(v) for v in m.end[0] - m.start[0] - more)
            if x == 0 == y:
                return None, 0.0
            some[k : k + 1] = move(x, y, stepping.table)
            before, after = (some, after) if lead.into else (before, some)
        else:
            return None, 0.0  # the last way out: nothing follows
    blocks = np.concatenate([before, *rows, after])
    if len(blocks) == len(b) and (blocks == b).all():
        return None, 0.0
    last = not lead.into and not (after["kind"] <= Kind.ARC).any()
    made_ = replace(program, blocks=blocks, origin=tuple(origin.tolist()), spans=(), words=())
    return made_, 0.0 if last else float(np.hypot(*more))


def passes(made: Any, program: Program, ours: bool) -> bool:
    """Return whether ``verify --against`` passes a program, with a certificate or without."""
    run = Run()
    try:
        how = proof.Placing(None, proof.given_points(made.drawn, made.options), False, ours)
        proof.place_program(program, made.plan, target_of(made.machine), made.options, how, run)
    except Refused:
        return False
    return all(d.severity < Severity.ERROR for d in run.findings)


def counted(made: Any) -> str:
    """Return the counting in force."""
    return made.options.judging.count or made.machine.count


def strict(made: Any, program: Program) -> bool:
    """Return whether the judge of ``compile`` passes a program, which knows where it starts."""
    return pipeline.judge_program(program, made.plan, target_of(made.machine), made.options)[0].ok


#: Small parts: name -> what is compiled (None: a plate with two holes), and how.
CASES: dict[str, tuple[str | None, dict[str, Any]]] = {
    "3b": (None, {}),
    "3b, die": (None, {"side": "die"}),
    "3b, on the line": (None, {"side": "on", "offset": None}),
    "3b, stop and overcut": (None, {"stop": 0.3, "overcut": 0.1}),
    "3b, thread points": (None, {"starts": [(-0.2, 0.3), (0.4, 0.5)]}),
    "3b, textbook": (None, {"count": "textbook"}),
    "compact": (None, {"to": "compact"}),
    "iso": (None, {"to": "iso"}),
    "iso, G41": (None, {"profile": "iso-g41-mm"}),
    "4b": (None, {"to": "4b", "corner": 0.2}),
    "compensation": (None, {"to": "compensation", "corner": 0.2}),
    "cuts 2 to 3": (None, {"cuts": (2, 3)}),
    "from a block": (None, {"from_block": 17}),
    "from a block, backwards": (None, {"from_block": 17, "backwards": True}),
    "wed, enter": (
        "contour a { from (0, 0) line to (3, 0) line to (3, 2) line to (0, 2) close }\n"
        "cut a outside offset 0.05 enter (1, 0) start (0.8, -0.4)",
        {"name": "a.wed", "offset": None},
    ),
    "wed, open": (
        "contour a { from (0, 0) line to (2, 0) arc ccw to (3, 1) center (2, 1) line to (3, 2) }\n"
        "cut a left offset 0.05",
        {"name": "a.wed", "offset": None},
    ),
    "wed, one circle": (
        "contour a { circle center (1, 1) radius 0.6 }\ncut a inside offset 0.05",
        {"name": "a.wed", "offset": None},
    ),
}


def plate() -> bytes:
    """Return a plate of 1.8 x 1 mm with two holes of different size."""
    from drawings import drawing

    def draw(_: Any, m: Any) -> None:
        m.add_lwpolyline([(0, 0), (1.8, 0), (1.8, 1), (0, 1)], close=True)
        m.add_circle((0.4, 0.5), 0.25)
        m.add_circle((1.2, 0.5), 0.3)

    return drawing(draw)


def compiled(name: str) -> Any:
    """Compile one of `CASES`."""
    text, options = CASES[name]
    source = plate() if text is None else text.encode()
    made = api.compile(source, **{"offset": 0.05, "lead": 0.15, **options})
    assert made.ok, [d.message for d in made.findings]
    return made
