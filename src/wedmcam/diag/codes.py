"""Every code a finding can have: what it checks, why it matters on the machine, what to do.

One table, so that ``wedmcam explain CODE`` and the documentation say the same. A code is a slug
that never changes its meaning.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Code:
    """What one code means.

    Attributes:
        what: what was found, in one line.
        why: what it would do on the machine.
        cure: what the user can do.
    """

    what: str
    why: str
    cure: str


CODES: dict[str, Code] = {
    # --- reading a drawing -----------------------------------------------------------------
    # --- contours --------------------------------------------------------------------------
    # --- wire path: compensation, leads, order ---------------------------------------------
    # --- lowering --------------------------------------------------------------------------
    # --- formats and profiles --------------------------------------------------------------
    # --- the judge -------------------------------------------------------------------------
    # --- files and the command line --------------------------------------------------------
}
