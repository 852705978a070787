"""Choices that a plan states: on which side the wire runs, in which order contours are cut.

Apart from the plan, so that whoever states them needs no arrays.
"""

from __future__ import annotations

import enum


class Side(enum.StrEnum):
    """Where the wire runs. PART keeps the material inside outer contours, DIE the reverse."""

    PART = "part"
    DIE = "die"
    LEFT = "left"
    RIGHT = "right"
    ON = "on"


class Order(enum.StrEnum):
    """In which order contours are cut. GIVEN: as drawn, whatever lies in what."""

    GIVEN = "given"
    INNER_FIRST = "inner-first"
    NEAREST = "nearest"
