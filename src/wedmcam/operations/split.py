"""Loads: a program that does not fit the controller's memory, as several that do (``--split``).

Loads are cut at thread points, where the wire is cut anyway, and each is compiled and proven as a
program of its own, of those contours (``--cuts``). The table is moved in between as the program
would have moved it. One contour that is longer than the memory is cut in the kerf, at the end of a
block (``--blocks``): there the machine waits with the generator off, and the next load starts where
it stands. Such loads have the very blocks of the one program; each is proven between the others,
and what was decoded of all of them once more as one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.compiler.pipeline import judge_program
from wedmcam.compiler.results import Compilation
from wedmcam.diag import Diagnostic
from wedmcam.diag.run import Run
from wedmcam.files import Source, bytes_of
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.judge.verdict import Verdict
from wedmcam.machines import Machine
from wedmcam.operations.compile import compile_plan, planned_for
from wedmcam.options import Options
from wedmcam.programs.loads import joined
from wedmcam.programs.places import block_ends, match_blocks
from wedmcam.targets import target_of
from wedmcam.transforms.plan.options import Portion


@dataclass(frozen=True, slots=True, eq=False)
class Together:
    """Loads that were cut in the kerf, proven as the one program that they are.

    Attributes:
        loads: numbers of the first and the last of them, 1-based.
        verdict: of all of them, one after the other, decoded from their bytes.
        findings: of the judge.
    """

    loads: tuple[int, int]
    verdict: Verdict
    findings: tuple[Diagnostic, ...]


def compile_loads(
    source: Source,
    *,
    profile: Machine,
    name: str | None = None,
    output_name: str = "",
    options: Options,
    named: bool = True,
) -> tuple[Compilation, ...]:
    """Compile a drawing into programs that fit the memory one by one.

    Args:
        source: a path, or the bytes of a drawing.
        profile: the machine; its limits say how much fits.
        name: of the source.
        output_name: NAME.3b makes NAME-1.3b, NAME-2.3b, ... in findings and certificates.
        options: as for `api.compile`.
        named: as for `api.compile_plan`.

    Returns:
        The loads in their order; the whole program where it fits, or where it failed. A contour
        that does not fit, and cannot be cut in the kerf, is a load with the warning
        ``over-memory``.
    """
    data, name = bytes_of(source, name)
    run = Run(options.judging.strict)
    refused = planned_for(data, name, options, [profile], run)
    loads: list[Compilation] = []

    def load_of(portion: Portion, output: str, strict: bool) -> Compilation:
        trial, by_name = run.forked(), named or bool(loads)  # one note for all loads
        trial.strict = strict
        of_load = replace(options, portion=portion)
        return compile_plan(data, name, profile, of_load, trial, output, refused, named=by_name)

    strict = options.judging.strict
    # That the program is too large is no error: that is what loads are for.
    whole = load_of(options.portion, output_name, False)
    if not whole.ok or not _too_large(whole) or whole.plan is None:
        return (load_of(options.portion, output_name, True) if strict and whole.ok else whole,)
    if options.portion.blocks is not None:
        return (load_of(options.portion, output_name, True) if strict else whole,)
    first = options.portion.cuts[0] if options.portion.cuts else 1
    groups = _groups(whole)
    while groups:
        low, high = groups.pop(0)
        portion, load = options.portion, whole
        if high - low + 1 < len(whole.plan.cuts):
            portion = Portion(cuts=(first + low, first + high))
            load = load_of(portion, numbered(output_name, len(loads) + 1), False)
        pieces = in_the_kerf(load) if load.ok and _too_large(load) else []
        if load.ok and _too_large(load) and high > low and not pieces:
            groups[:0] = [(low, high - 1), (high, high)]  # the sizes are estimates
            continue
        for blocks in pieces:
            output = numbered(output_name, len(loads) + 1)
            loads.append(load_of(replace(portion, blocks=blocks), output, strict))
        if not pieces:
            alone = output_name if load is whole else numbered(output_name, len(loads) + 1)
            loads.append(load_of(portion, alone, True) if strict else load)
    return tuple(loads)


def in_the_kerf(load: Compilation) -> list[tuple[int, int]]:
    """Return the blocks of each load of a program that does not fit the memory, 1-based.

    Loads end between two blocks of a contour that is longer than the memory, and have as many as
    fit. Empty where the format has no program that begins in the kerf, or where that is not enough.
    """
    target = target_of(load.machine)
    if target.whole_contours or load.program is None or load.lowered is None:
        return []
    sizes, end = block_sizes(load.program, load.machine)
    like = match_blocks(load.lowered, load.program, load.machine)
    b = load.lowered.blocks[like]
    cutting = (load.program.blocks["kind"] < Kind.MOVE) & (like >= 0)
    long = np.bincount(b["cut"][cutting], sizes[cutting]) + end > target.memory
    path = cutting & (b["role"] == Role.CONTOUR) & long[b["cut"]]
    may_end = np.flatnonzero(path[:-1] & path[1:] & (np.diff(b["cut"]) == 0)) + 1  # from 1
    filled = np.concatenate([[0], np.cumsum(sizes)])
    pieces, done, n = [], 0, len(sizes)
    while filled[n] - filled[done] + end > target.memory:
        fits = may_end[(may_end > done) & (filled[may_end] - filled[done] + end <= target.memory)]
        if not len(fits):
            return []
        pieces.append((done + 1, int(fits[-1])))
        done = int(fits[-1])
    return [*pieces, (done + 1, n)]


def block_sizes(program: Program, machine: Machine) -> tuple[NDArray[np.int64], int]:
    """Return how much of the memory each block of a decoded program takes, and its end.

    The blocks that end it count with the end.
    """
    line, arc = target_of(machine).block_bytes
    kinds = program.blocks["kind"]
    ends = (kinds == Kind.STOP) | (kinds == Kind.END)
    sizes = np.where(kinds == Kind.ARC, arc, np.where(kinds < Kind.PAUSE, line, 1))
    return np.where(ends, 0, sizes).astype(np.int64), max(int(ends.sum()), 1)


def proven_together(loads: Sequence[Compilation]) -> list[Together]:
    """Return the proof of all loads that were cut in the kerf, run one after the other as decoded.

    Each must be ``ok``. A finding that is an error says that together they do not cut the plan.
    """
    groups = groupby(enumerate(loads, 1), lambda pair: pair[1].options.portion.cuts)
    out = []
    for _, pairs in groups:
        numbers, parts = zip(*pairs, strict=True)
        if parts[0].options.portion.blocks is None:
            continue
        programs = [p.program for p in parts if p.program is not None]
        whole = replace(joined(programs), origin=programs[0].origin)
        plan = replace(parts[0].plan, others=None)
        target = target_of(parts[0].machine)
        verdict, findings = judge_program(whole, plan, target, parts[0].options)
        out.append(Together((numbers[0], numbers[-1]), verdict, tuple(findings)))
    return out


def numbered(name: str, number: int) -> str:
    """Return the file name of a load.

    >>> numbered("out/plate.3b", 2)
    'out/plate-2.3b'
    """
    folder, slash, file = name.rpartition("/")
    stem, dot, ending = file.rpartition(".")
    return f"{folder}{slash}{stem}-{number}{dot}{ending}" if stem else f"{name}-{number}"


def _too_large(compilation: Compilation) -> bool:
    return any(d.code == "over-memory" for d in compilation.findings)


def _groups(whole: Compilation) -> list[tuple[int, int]]:
    """Return the cuts of programs that are loaded one by one, first and last, 0-based.

    By the sizes of their blocks. A program that has a contour longer than the memory is more than
    one load; what is free in its first and its last load takes the contours before and behind it.
    """
    assert whole.plan is not None
    assert whole.lowered is not None
    b = whole.lowered.blocks
    target = target_of(whole.machine)
    line, arc = target.block_bytes
    most = target.memory
    size = np.where(b["kind"] == Kind.ARC, arc, line)
    # Between two contours: a pause, the move and a pause; a pause where it stops.
    each = np.bincount(b["cut"], size, len(whole.plan.cuts) + 1)[1:] + line + 3
    out: list[tuple[int, int]] = []
    room = 0.0
    for k, more in enumerate(each.tolist()):
        long = more > most and not target.whole_contours
        if out and (more <= room or (long and room > line + arc)):
            out[-1] = (out[-1][0], k)
        else:
            out.append((k, k))
            room = most
        room = room - more if more <= room else -1.0 if not long else _left(room, more, most, arc)
    return out


def _left(room: float, more: float, most: float, arc: float) -> float:
    """Return what is free in the last load of a contour that is longer than the memory.

    Args:
        room: free in the first.
        more: what the contour takes.
        most: what a load takes.
        arc: the largest block: so much of each load may stay free.
    """
    return (most - arc) - (more - (room - arc)) % (most - arc)


def moves(loads: Sequence[Compilation]) -> list[dict[str, Any]]:
    """Return, for each load after the first, where it starts and how far the table moves to it.

    ``kerf``: the load before it ends there, within the contour: the wire stays threaded.
    """
    out = []
    for before, load in pairwise(loads):
        assert before.program is not None
        assert load.program is not None
        _, ends = block_ends(before.program, before.machine)
        here, there = ends[-1], np.array(load.program.origin_um)
        blocks = load.options.portion.blocks
        out.append(
            {
                "start_um": there.tolist(),
                "move_um": (there - here).tolist(),
                "kerf": blocks is not None and blocks[0] > 1,
            }
        )
    return out
