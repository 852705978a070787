"""Write the rotation format of the ZD-065: one figure of polar blocks.

The controller computes each vertex from the figure and goes to the um next to it
(`controllers.zd065.rotation`). So what is aimed at are vertices, not blocks: those of the path
where a figure is to be turned, else those that the program that is written really steps on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.axes import places
from wedmcam.backends.checks import Checks
from wedmcam.backends.zd065.compact import encode as encode_compact
from wedmcam.backends.zd065.landing import Complex, Exact, Landing, aimed, land
from wedmcam.backends.zd065.memory import Memory
from wedmcam.controllers import Motion
from wedmcam.controllers.zd065.data import POLAR, WAY, decimals, whole
from wedmcam.controllers.zd065.rotation import rotate_closed
from wedmcam.diag import Diagnostic, Severity, has_errors
from wedmcam.formats import rotation
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def encode(
    program: Program,
    machine: Machine,
    positions: NDArray[np.int64] | None = None,
    *,
    exact: Exact | None = None,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the rotation data of a program, to be entered with no copies, and what was found.

    Args:
        program: blocks as for the cutting format.
        machine: a rotation profile.
        positions: not needed; writers are called alike.
        exact: what was lowered, in the frame of the drawing; its vertices are aimed at instead of
            those that the program steps on.

    Returns:
        The bytes, empty when there is an error.
    """
    _, findings = encode_compact(program, machine)
    findings = [d for d in findings if d.code != "over-memory"]
    if has_errors(findings):
        return b"", findings
    motion = machine.own_stepping.run(program.blocks)
    aim = None if exact is None else _for_controller(exact, program, machine)
    figure, misses = _figure_of(program.blocks, motion, machine, aim)
    checks = Checks(program)
    checks.tell(
        Severity.WARNING,
        "figure-drift",
        misses > 0,
        "block {block}: whole lengths and angles of 8 digits lead the machine {drift_um:.2f} um "
        "beside the end of it",
        lambda i: {"drift_um": float(misses[i])},
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


def _figure_of(
    blocks: NDArray[np.void], motion: Motion, machine: Machine, exact: Exact | None
) -> tuple[NDArray[np.void], Floats]:
    """Return polar blocks (dtype `POLAR`) of cutting blocks, and how far each misses its place."""
    moving = np.flatnonzero(motion.steps > 0)
    path, vertices = _path_of(blocks, motion, moving)
    b = blocks[moving]
    centres = vertices[:-1] - (b["x"] + 1j * b["y"])
    landing, aim = land(aimed(path, vertices, centres, exact), machine.own_stepping)
    misses = np.zeros(len(blocks))
    misses[moving] = _misses(landing, aim.places[1:])
    controls = np.flatnonzero(blocks["kind"] > Kind.MOVE)
    still = np.zeros(len(controls), dtype=POLAR)
    still["kind"] = blocks["kind"][controls]
    order = np.argsort(np.concatenate([moving[landing.of], controls]), kind="stable")
    return np.concatenate([landing.figure, still])[order], misses


def _for_controller(exact: Exact, program: Program, machine: Machine) -> Exact:
    """Return segments of the drawing as the controller has them, from the start of the program."""
    axes, origin = machine.axes, complex(*program.origin)

    def there(at: Complex) -> Complex:
        xy = places(np.column_stack([at.real, at.imag]), axes)
        return np.asarray(xy[:, 0] + 1j * xy[:, 1] - origin)

    sense = -1 if (axes.exchange + axes.mirror_x + axes.mirror_y) % 2 else 1
    return Exact(
        there(exact.starts), there(exact.ends), there(exact.centres), exact.radius,
        exact.turn * sense,
    )  # fmt: skip


def _misses(landing: Landing, places: Complex) -> Floats:
    """Return how far from its place the machine steps each row of a path, um."""
    made = rotate_closed(landing.figure)
    behind = np.searchsorted(landing.of, np.arange(len(places)), "right")
    last = np.searchsorted(made.blocks["source"], behind)
    stands = np.concatenate([[0j], made.ends[:, 0] + 1j * made.ends[:, 1]])[last]
    return np.asarray(abs(stands - places))


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
