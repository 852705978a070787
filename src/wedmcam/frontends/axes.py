"""From the controller's frame back to the drawing's: what a program goes through after its reader.

A program is in the frame of its controller; everything that looks at it works in that of the
drawing. The writer has a way of its own (``backends.axes``), so that a round trip proves something.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.machines import Axes, Machine


def matrix(axes: Axes) -> NDArray[np.int64]:
    """Return M with (x, y) of the drawing = M (x, y) of the controller.

    >>> (matrix(Axes(exchange=True, mirror_x=True)) @ [2, -5]).tolist()
    [5, 2]
    """
    out = np.diag([-1 if axes.mirror_x else 1, -1 if axes.mirror_y else 1])
    return out[:, ::-1] if axes.exchange else out


def to_drawing(program: Program, axes: Axes) -> Program:
    """Return a program of the controller's frame in that of the drawing, with its step."""
    if axes.step_um != 1:
        program = replace(program, step_um=axes.step_um)
    m = matrix(axes)
    if (m == np.eye(2)).all():
        return program
    blocks = program.blocks.copy()
    blocks["x"], blocks["y"] = m @ np.stack([program.blocks["x"], program.blocks["y"]])
    if m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0] < 0:
        blocks["turn"] = -program.blocks["turn"]
    if m[0, 0] == 0:
        cutting = program.blocks["kind"] <= Kind.MOVE
        for controller, drawing in (
            (Axis.X, Axis.Y),
            (Axis.Y, Axis.X),
            (Axis.SQUARE, Axis.SQUARE_X),
            (Axis.SQUARE_X, Axis.SQUARE),
        ):
            blocks["axis"][cutting & (program.blocks["axis"] == controller)] = drawing
    x, y = (m @ program.origin).tolist()
    return replace(program, blocks=blocks, origin=(x, y))


def in_frame(decode: Any) -> Any:
    """Return a reader of programs into the drawing's frame, from one into the controller's."""

    def decode_in_frame(data: bytes, machine: Machine, file: str, **more: Any) -> Any:
        program, findings = decode(data, machine, file, **more)
        return to_drawing(program, machine.axes), findings

    return decode_in_frame
