"""Loads: a program that does not fit the controller's memory, as several that do (``--split``).

Loads are cut at thread points only, where the wire is cut anyway, and each is compiled and proven
as a program of its own, of those contours (``--cuts``). The table is moved in between as the
program would have moved it.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from wedmcam.compiler.results import Compilation
from wedmcam.diag.run import Run
from wedmcam.files import Source, bytes_of
from wedmcam.ir.program import Kind
from wedmcam.machines import Machine
from wedmcam.operations.compile import compile_plan, planned_for
from wedmcam.options import Options
from wedmcam.programs.places import block_ends
from wedmcam.targets import target_of
from wedmcam.transforms.plan.options import Portion


def compile_loads(
    source: Source,
    *,
    profile: Machine,
    name: str | None = None,
    output_name: str = "",
    options: Options,
    named: bool = True,
) -> tuple[Compilation, ...]:
    """Compile a drawing into as few programs as fit the memory one by one.

    Args:
        source: a path, or the bytes of a drawing.
        profile: the machine; its limits say how much fits.
        name: of the source.
        output_name: NAME.3b makes NAME-1.3b, NAME-2.3b, ... in findings and certificates.
        options: as for `api.compile`.
        named: as for `api.compile_plan`.

    Returns:
        The loads in their order; the whole program where it fits, or where it failed. A contour
        that does not fit alone is a load with the warning ``over-memory``.
    """
    data, name = bytes_of(source, name)
    run = Run(options.judging.strict)
    refused = planned_for(data, name, options, [profile], run)
    loads: list[Compilation] = []

    def load_of(portioned: Options, output: str) -> Compilation:
        trial, by_name = run.forked(), named or bool(loads)  # one note for all loads
        return compile_plan(data, name, profile, portioned, trial, output, refused, named=by_name)

    whole = load_of(options, output_name)
    if not whole.ok or not _too_large(whole) or whole.plan is None or len(whole.plan.cuts) < 2:
        return (whole,)
    first = options.portion.cuts[0] if options.portion.cuts else 1
    groups = _groups(whole)
    while groups:
        low, high = groups.pop(0)
        of_load = replace(options, portion=Portion(cuts=(first + low, first + high)))
        load = load_of(of_load, numbered(output_name, len(loads) + 1))
        if load.ok and _too_large(load) and high > low:
            groups[:0] = [(low, high - 1), (high, high)]  # the sizes are estimates
            continue
        loads.append(load)
    return tuple(loads)


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
    """Return the cuts of each load, first and last, 0-based, by the sizes of their blocks."""
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
    filled = 0.0
    for k, more in enumerate(each.tolist()):
        if out and filled + more <= most:
            out[-1] = (out[-1][0], k)
            filled += more
        else:
            out.append((k, k))
            filled = more
    return out


def moves(loads: tuple[Compilation, ...]) -> list[dict[str, Any]]:
    """Return, for each load after the first, where it starts and how far the table moves to it."""
    out = []
    for before, load in pairwise(loads):
        assert before.program is not None
        assert load.program is not None
        _, ends = block_ends(before.program, before.machine)
        here, there = ends[-1], np.array(load.program.origin_um)
        out.append({"start_um": there.tolist(), "move_um": (there - here).tolist()})
    return out
