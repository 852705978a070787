"""The rotation format (旋转格式) of the ZD-065: polar blocks, to be turned by the controller.

One block after the other, instruction codes and controls as in the cutting format::

    arc   instruction 1 . exponent 1 . start angle 4 . R 4 . exponent 1 . subtended angle 4   15
    line  instruction 1 . exponent 1 . heading 4 . length 3                                    9

Widths are the paper's [S]. Angles are degrees, 0.dddddddd x 10^ee: an 8-digit significand with an
exponent byte of its own, plain BCD, both positive [D]; below 0.1 degree the exponent is 0 and the
significand starts with zeros [R].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.formats import compact

ARC_BYTES, LINE_BYTES = 15, 9


def _lengths() -> bytes:
    table = bytearray(compact.LENGTH)
    for code, size in enumerate(compact.LENGTH):
        if size == compact.ARC_BYTES:
            table[code] = ARC_BYTES
        elif size == compact.LINE_BYTES:
            table[code] = LINE_BYTES
    return bytes(table)


#: Bytes of the block that an instruction opens; 0 where no block has it (END included).
LENGTH = _lengths()


def angle_fields(
    degrees: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return exponent and 8-digit significand of angles, 0 <= degrees < 1000.

    >>> [v.tolist() for v in angle_fields(np.array([30.0, 0.05, 123.456789, 0.0]))]
    [[2, 0, 3, 0], [30000000, 5000000, 12345679, 0]]
    """
    exponent = np.select([degrees >= 100, degrees >= 10, degrees >= 1], [3, 2, 1], 0)
    significand = np.floor(degrees * 10.0 ** (8 - exponent) + 0.5).astype(np.int64)
    over = significand >= 10**8
    return exponent + over, np.where(over, significand // 10, significand)


def angle_value(exponent: NDArray[np.int64], significand: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return degrees: the float64 nearest to the decimal number; exponents above 20 are 20.

    >>> angle_value(np.array([2]), np.array([30000000])).tolist()
    [30.0]
    """
    power = 8 - np.minimum(exponent, 20)
    up = 10.0 ** np.maximum(-power, 0)
    return np.asarray(significand * up / 10.0 ** np.maximum(power, 0))
