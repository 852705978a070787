"""The gap-compensation format (间隙补偿格式) of the ZD-065.

One block after the other, instruction codes, lines and controls as in the cutting format::

    arc   instruction 1 . compensation type 1 . R 4 . x 4 . y 4 . J 3      17 bytes

The paper prints 'R' four times; R, x, y, J is the one reading that fits the widths 4, 4, 4, 3 [D].
Type 0x01: the radius grows when the path is offset outwards (convex); 0x02: it shrinks (concave)
[R]. Lines alone are the same bytes as in the cutting format.
"""

from __future__ import annotations

from wedmcam.formats import compact

ARC_BYTES = 17
GROWS, SHRINKS = 0x01, 0x02  # [R]
MOST_GAP_UM = 7_999  # [S]


def _lengths() -> bytes:
    table = bytearray(compact.LENGTH)
    for code, size in enumerate(compact.LENGTH):
        if size == compact.ARC_BYTES:
            table[code] = ARC_BYTES
    return bytes(table)


#: Bytes of the block that an instruction opens; 0 where no block has it (END included).
LENGTH = _lengths()
