"""Write the rotation format of the ZD-065: one figure of polar blocks.

The controller computes each vertex from the figure and goes to the um next to it
(`controllers.zd065.rotation`). So what is aimed at are vertices, not blocks: those of the path
where a figure is to be turned, else those that the program that is written really steps on.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks
from wedmcam.backends.zd065.compact import encode as encode_compact
from wedmcam.backends.zd065.figure import Complex, state
from wedmcam.backends.zd065.memory import Memory
from wedmcam.controllers import Motion
from wedmcam.controllers.zd065.data import POLAR, WAY, decimals, whole
from wedmcam.diag import Diagnostic, Severity, has_errors
from wedmcam.formats import rotation
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: A path that comes back to a place is stated to come back to it within this, um: the controller
#: then steps onto the same um.
COMES_BACK_UM = 0.3


def encode(
    program: Program, machine: Machine, positions: NDArray[np.int64] | None = None
) -> tuple[bytes, list[Diagnostic]]:
    """Return the rotation data of a program, to be entered with no copies, and what was found.

    Args:
        program: blocks as for the cutting format.
        machine: a rotation profile.
        positions: not needed; writers are called alike.

    Returns:
        The bytes, empty when there is an error.
    """
    _, findings = encode_compact(program, machine)
    findings = [d for d in findings if d.code != "over-memory"]
    if has_errors(findings):
        return b"", findings
    motion = machine.own_stepping.run(program.blocks)
    figure, drifts = _figure_of(program.blocks, motion)
    checks = Checks(program)
    checks.tell(
        Severity.WARNING,
        "figure-drift",
        drifts > COMES_BACK_UM,
        "block {block} comes back to a place where the path was before, and whole lengths and "
        "angles of 8 digits lead {drift_um:.2f} um beside it",
        lambda i: {"drift_um": float(drifts[i])},
        hint="--to compact holds the path as it is",
    )
    findings += checks.findings
    memory = memory_of(figure)
    return memory.data.tobytes(), [*findings, *memory.too_large(machine)]


def memory_of(figure: NDArray[np.void]) -> Memory:
    """Return the data of a figure (dtype `POLAR`), its end byte included."""
    angle, size = decimals(figure["start"]), decimals(figure["size"])
    x, y = whole(size * angle.cos(degrees=True)), whole(size * angle.sin(degrees=True))
    memory = Memory(figure["kind"], figure["turn"], x, y, rotation.LENGTH)
    arc, straight = memory.arc, memory.straight
    exponent, significand = rotation.angle_fields(figure["start"])
    memory.put(arc | straight, 1, 1, exponent)
    memory.put(arc | straight, 2, 4, significand)
    memory.put(arc, 6, 4, figure["size"])
    memory.put(straight, 6, 3, figure["size"])
    exponent, significand = rotation.angle_fields(figure["sweep"])
    memory.put(arc, 10, 1, exponent)
    memory.put(arc, 11, 4, significand)
    return memory


def _figure_of(blocks: NDArray[np.void], motion: Motion) -> tuple[NDArray[np.void], Floats]:
    """Return polar blocks (dtype `POLAR`) of cutting blocks, and how far each misses its place.

    The path is taken in parts between places that it comes back to (a thread point, the start of
    a contour): a part that comes back has to close.
    """
    drifts = np.zeros(len(blocks))
    moving = np.flatnonzero(motion.steps > 0)
    path, ends = _path_of(blocks, motion, moving)
    places, place = np.unique(ends, return_inverse=True)
    visited = np.concatenate([[True], ends[1:] != ends[:-1]])
    visits = np.bincount(place[visited], minlength=len(places))
    nodes = np.flatnonzero(visited & (visits[place] > 1))
    borders = sorted({0, *nodes.tolist(), len(path)})
    stated = {int(place[0]): 0j}
    at = 0j
    rows, numbers = [], []
    for first, last in pairwise(borders):
        origin, node = complex(ends[first]), int(place[last])
        goal = stated.get(node, complex(ends[last])) - origin
        part = path[first:last].copy()
        part["x"] -= origin.real
        part["y"] -= origin.imag
        part["x"][-1], part["y"][-1] = goal.real, goal.imag
        made = state(part, begin=at - origin)
        at = origin + (complex(made.ends[-1]) if len(made.ends) else at - origin)
        if node in stated:
            drifts[moving[last - 1]] = abs(at - stated[node])
        stated.setdefault(node, at)
        rows.append(made.figure)
        numbers.append(moving[first + made.of])
    controls = np.flatnonzero(blocks["kind"] > Kind.MOVE)
    still = np.zeros(len(controls), dtype=POLAR)
    still["kind"] = blocks["kind"][controls]
    order = np.argsort(np.concatenate([*numbers, controls]), kind="stable")
    return np.concatenate([*rows, still])[order], drifts


def _path_of(
    blocks: NDArray[np.void], motion: Motion, moving: Ints
) -> tuple[NDArray[np.void], Complex]:
    """Return the path that blocks step (dtype `WAY`), and its vertices, the start first."""
    b = blocks[moving]
    vertices = np.zeros(len(moving) + 1, dtype=np.complex128)
    vertices[1:] = np.cumsum(motion.dx[moving] + 1j * motion.dy[moving])
    arc, turn = b["kind"] == Kind.ARC, b["turn"].astype(np.float64)
    begin = b["x"] + 1j * b["y"]
    end = begin + np.diff(vertices)
    path = np.zeros(len(b), dtype=WAY)
    path["kind"], path["turn"] = b["kind"], np.where(arc, b["turn"], 0)
    path["x"], path["y"] = vertices[1:].real, vertices[1:].imag
    path["radius"] = np.where(arc, abs(begin), 0.0)
    start = np.degrees(np.angle(begin)) % 360.0
    exact = np.mod((np.degrees(np.angle(end)) - start) * turn, 360.0)
    # A turn and some steps is no speck: J tells which of the two.
    about = _sweep(start, np.abs(begin), turn, b["count"].astype(np.float64))
    sweep = exact + 360.0 * np.rint((about - exact) / 360.0)
    sweep = np.where(np.diff(vertices) == 0, 360.0, np.maximum(sweep, 0.0))
    path["sweep"], path["start"] = np.where(arc, sweep, 0.0), np.where(arc, start, 0.0)
    return path, vertices


def _sweep(start: Floats, radius: Floats, turn: Floats, count: Floats) -> Floats:
    """Return the angle, degrees, over which an arc counts J on the inscribed square."""
    root = np.sqrt(2.0)
    n = np.floor(start / 90.0 + 0.5)
    c = root * n + np.sin(np.radians(start - 90.0 * n)) + turn * count / np.maximum(radius, 1)
    m = np.floor(c / root + 0.5)
    end = 90.0 * m + np.degrees(np.arcsin(np.clip(c - root * m, -1.0, 1.0)))
    return np.asarray(np.abs(end - start))
