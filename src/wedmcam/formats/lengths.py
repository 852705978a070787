"""Lengths for people: a number in a program is so many steps of a machine."""

from __future__ import annotations

from collections.abc import Callable


def mm_of(step_um: float = 1.0) -> Callable[[float], str]:
    """Return a function that tells lengths in steps of ``step_um``.

    >>> mm_of()(1500), mm_of(5.0)(1500)
    ('1.500 mm', '7.500 mm')
    """
    in_mm = to_mm(step_um)
    return lambda steps: f"{in_mm(steps):.3f} mm"


def to_mm(step_um: float = 1.0) -> Callable[[float], float]:
    """Return a function that gives lengths in steps of ``step_um`` in mm.

    >>> to_mm()(1500), to_mm(5.0)(1500)
    (1.5, 7.5)
    """
    per_mm = 1000.0 / step_um
    return lambda steps: float(steps) / per_mm
