"""The tape of the NBY-15 in words: one block a line, addresses and whole numbers [R].

The source says a program on 8-channel tape of an inch, in incremental coordinates on the wire's
centre line; it does not give the block, so this one is ours:

    G01 X Y        a line, um, signed; a word that is 0 may be left out
    G00 X Y        the same with the wire out: from thread point to thread point
    G02 A B R      an arc clockwise, from degree A over B degrees, radius R um
    G03 A B R      the same counter-clockwise
    M00            the machine waits        M02   the end

N numbers the blocks from 1 on, one by one: a block that is missing is found.
"""

from __future__ import annotations

import re

#: One block, blanks left out.
BLOCK = re.compile(
    r"(?:N(?P<n>\d{1,6}))?"
    r"(?:(?P<line>G0?[01])(?=[XY])(?:X(?P<x>[+-]?\d{1,6}))?(?:Y(?P<y>[+-]?\d{1,6}))?"
    r"|(?P<arc>G0?[23])A(?P<a>\d{1,3})B(?P<b>\d{1,3})R(?P<r>\d{1,6})"
    r"|(?P<m>M0?[02]))"
)
#: Largest number of a block.
MOST_NUMBER = 999_999
#: Largest |X|, |Y| and R that six digits hold.
MOST_UM = 999_999
