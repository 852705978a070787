"""Program in, bytes out: one writer a format.

A writer is ``encode(program, machine, positions=None) -> (bytes, findings)``. It refuses what its
format cannot say; it never decides what is cut.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

#: Format -> module with ``encode``; named and not imported, so that starting costs nothing.
ENCODERS: dict[str, str] = {
    "3b": "wedmcam.backends.b3",
    "compact": "wedmcam.backends.zd065.compact",
    "rotation": "wedmcam.backends.zd065.rotation",
    "compensation": "wedmcam.backends.zd065.compensation",
    "iso": "wedmcam.backends.iso",
    "4b": "wedmcam.backends.b4",
    "dem15": "wedmcam.backends.dem15",
    "nby15": "wedmcam.backends.nby15",
}


def encoder(format_: str) -> Callable[..., Any]:
    """Return ``encode`` of a format.

    Raises:
        KeyError: no writer has this name.

    It takes programs in the frame of the drawing and writes them in that of the controller.

    >>> import numpy as np
    >>> from wedmcam.ir.program import BLOCK, Program
    >>> from wedmcam.machines import default
    >>> data, found = encoder("compact")(Program(np.zeros(0, BLOCK)), default("compact"))
    >>> data.hex(), found
    ('00', [])
    """
    from wedmcam.backends.axes import in_frame

    encode: Callable[..., Any] = in_frame(import_module(ENCODERS[format_]).encode)
    return encode
