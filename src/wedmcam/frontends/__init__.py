"""Files in, values out: drawings become sketches, programs become `ir.program.Program`.

A program reader is ``decode(data, machine, file) -> (Program, findings)`` and takes any bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

#: Format -> module with ``decode``; named and not imported, so that starting costs nothing.
DECODERS: dict[str, str] = {
    "3b": "wedmcam.frontends.b3.reader",
    "compact": "wedmcam.frontends.zd065.compact",
    "rotation": "wedmcam.frontends.zd065.rotation",
    "compensation": "wedmcam.frontends.zd065.compensation",
    "iso": "wedmcam.frontends.iso",
    "4b": "wedmcam.frontends.b4",
    "dem15": "wedmcam.frontends.dem15",
    "nby15": "wedmcam.frontends.nby15",
}


def decoder(format_: str) -> Callable[..., Any]:
    """Return ``decode`` of a format.

    Raises:
        KeyError: no reader has this name.

    It reads programs in the frame of the controller and returns them in that of the drawing.

    >>> from wedmcam.machines import default
    >>> program, findings = decoder("compact")(bytes.fromhex("01 017000 005000 00"),
    ...                                        default("compact"), "a.zd")
    >>> program.blocks["x"].tolist(), findings
    ([17000, 0], [])
    """
    from wedmcam.frontends.axes import in_frame

    decode: Callable[..., Any] = in_frame(import_module(DECODERS[format_]).decode)
    return decode


def senses(data: bytes, machine: Any) -> Any:
    """Return how the arcs of an outline (4B, compensation) go with a gap, a number a block.

    +1: the radius grows where the outline is offset outwards, -1: it shrinks, 0: the file does not
    say, or the block is no arc.
    """
    return import_module(DECODERS[machine.format]).senses(data, machine)


def describe_blocks(data: bytes, machine: Any) -> dict[str, str]:
    """Return what blocks state beyond those of a cutting format, by `programs.rows.Row.where`.

    Of the ZD-065's other formats and of 4B; empty for the rest. `dump` shows the cutting blocks
    that the controller makes of them (without copies, gap 0).
    """
    of_format = getattr(import_module(DECODERS[machine.format]), "describe_blocks", None)
    more: dict[str, str] = {} if of_format is None else of_format(data, machine)
    return more
