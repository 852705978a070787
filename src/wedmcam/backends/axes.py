"""From the drawing's frame to the controller's: what a program goes through before its writer.

Everything above works in the frame of the drawing; a program is in that of the controller. The
reader has a way back of its own (``frontends.axes``), so that a round trip proves something.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import error
from wedmcam.ir.program import Axis, Program
from wedmcam.ir.programmed import Programmed
from wedmcam.machines import Axes, Machine

#: What counts on what once x and y are exchanged; indexed by `Axis`.
_EXCHANGED = np.array([Axis.Y, Axis.X, Axis.SQUARE_X, Axis.SQUARE], np.uint8)


def places(xy: NDArray[Any], axes: Axes) -> NDArray[Any]:
    """Return places or ways (x, y), shape (n, 2), as the controller has them.

    >>> places(np.array([[5, 2]]), Axes(exchange=True, mirror_x=True)).tolist()
    [[2, -5]]
    """
    signs = np.array([-1 if axes.mirror_x else 1, -1 if axes.mirror_y else 1])
    mirrored: NDArray[Any] = xy * signs
    return mirrored[:, ::-1] if axes.exchange else mirrored


def to_controller(program: Program, axes: Axes) -> Program:
    """Return a program of the drawing's frame in the controller's: mirrored, then exchanged."""
    if axes.plain:
        return program
    blocks = program.blocks.copy()
    if axes.mirror_x:
        blocks["x"] *= -1
        blocks["turn"] *= -1
    if axes.mirror_y:
        blocks["y"] *= -1
        blocks["turn"] *= -1
    if axes.exchange:
        blocks["x"], blocks["y"] = blocks["y"].copy(), blocks["x"].copy()
        blocks["turn"] *= -1
        moving = blocks["count"] > 0
        blocks["axis"][moving] = _EXCHANGED[blocks["axis"][moving]]
    x, y = places(np.array([program.origin]), axes)[0].tolist()
    return replace(program, blocks=blocks, origin=(x, y))


def outlines_to_controller(
    written: Programmed, ends: NDArray[np.float64], axes: Axes
) -> tuple[Programmed, NDArray[np.float64]]:
    """Return outlines of the drawing's frame, and where their blocks end, in the controller's.

    A mirror turns left and right around, and the sense of arcs.
    """
    motions = written.motions.copy()
    for x, y in (("x0", "y0"), ("x1", "y1"), ("cx", "cy")):
        there = places(np.stack([motions[x], motions[y]], axis=1), axes)
        motions[x], motions[y] = there[:, 0], there[:, 1]
    if axes.exchange ^ axes.mirror_x ^ axes.mirror_y:
        motions["turn"] *= -1
        motions["shift"] *= -1
    program = to_controller(written.program, axes)
    return Programmed(program, written.mark, motions), places(ends, axes)


def in_frame(encode: Any) -> Any:
    """Return a writer of programs in the drawing's frame, from one in the controller's."""

    def encode_in_frame(
        program: Program, machine: Machine, positions: NDArray[np.int64] | None = None, **more: Any
    ) -> Any:
        here, there = program.step_um, machine.axes.step_um
        if here != there:
            return b"", [
                error(
                    "other-step",
                    "the program counts steps of {step_um:g} um, {machine} steps of "
                    "{machine_step_um:g} um: it cannot go the same path",
                    hint="compile the drawing for it, or convert the program to .dxf and compile "
                    "that",
                    step_um=here,
                    machine=machine.name,
                    machine_step_um=there,
                )
            ]
        if positions is not None:
            more["positions"] = places(positions, machine.axes)
        return encode(to_controller(program, machine.axes), machine, **more)

    return encode_in_frame
