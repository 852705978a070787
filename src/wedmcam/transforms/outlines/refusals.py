"""Contours that a controller cannot offset: what is said of each alike."""

from __future__ import annotations

from wedmcam.diag import Diagnostic, Place, error
from wedmcam.ir.plan import Cut


def refusal(cut: Cut, code: str, hint: str) -> Diagnostic:
    """Return an error about a cut, which says what is wrong where it is ``extended``."""
    thread = Place.of_um(*cut.thread)
    return error(
        code,
        "the contour that is threaded at {thread}: ",
        cut.path.source_of(0),
        points_mm=(thread,),
        hint=hint,
        thread=thread,
    )
