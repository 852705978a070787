"""Lengths on the command line: ``0.1mm``, ``100um``, ``0.004in``; a bare number is mm."""

from __future__ import annotations

import math
import re
from typing import Any

import click

from wedmcam.option_table import ROWS
from wedmcam.ranges import MOST_UM, Range

UM = {"": 1000.0, "mm": 1000.0, "um": 1.0, "µm": 1.0, "in": 25400.0, "inch": 25400.0, '"': 25400.0}
PATTERN = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([a-zµ\"]*)\s*$")


def length_um(text: str) -> float:
    """Return a length in um.

    >>> [length_um(t) for t in ("0.1", "0.1mm", "100um", "0.004in")]
    [100.0, 100.0, 100.0, 101.6]

    Raises:
        ValueError: not a length.
    """
    match = PATTERN.match(text)
    if not match or match[2] not in UM:
        raise ValueError(f"'{text}' is no length: write 0.1, 0.1mm, 100um or 0.004in")
    value = round(float(match[1]) * UM[match[2]], 6)
    if not abs(value) <= MOST_UM:
        raise ValueError(f"'{text}' is longer than 100 m")
    return value


class Length(click.ParamType):  # type: ignore[type-arg]
    """A length of a range, as um."""

    name = "length"

    def __init__(self, takes: Range) -> None:
        self.takes = takes

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        """Return um; a wrong one is wrong use."""
        if isinstance(value, float):
            return value
        try:
            um = length_um(value)
        except ValueError as why:
            self.fail(str(why), param, ctx)
        if not self.takes.holds(um):
            self.fail(f"takes {self.takes}, not '{value}'", param, ctx)
        return um


def length(name: str) -> Length:
    """Return the type of an option by its parameter's name: its range stands in `option_table`."""
    return Length(ROWS[name].takes)


class Cuts(click.ParamType):  # type: ignore[type-arg]
    """2-5 as (2, 5), and 4 as (4, 4): contours or blocks of a program."""

    name = "a-b"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, int]:
        """Return the first and the last; a wrong one is wrong use."""
        if isinstance(value, tuple):
            return value
        match = re.fullmatch(r"\s*([0-9]{1,9})(?:\s*-\s*([0-9]{1,9}))?\s*", value)
        first, last = (int(match[1]), int(match[2] or match[1])) if match else (0, 0)
        if not 1 <= first <= last:
            self.fail(f"'{value}' is no range such as 2-5", param, ctx)
        return first, last


class Unit(click.ParamType):  # type: ignore[type-arg]
    """A unit or a length with one, as it was typed."""

    name = "unit"

    def convert(self, value: Any, param: Any, ctx: Any) -> str:
        """Return the text; a wrong one is wrong use."""
        from wedmcam.frontends.answers import nm_of

        try:
            nm_of(value)
        except ValueError as why:
            self.fail(str(why), param, ctx)
        return str(value)


class Degrees(click.ParamType):  # type: ignore[type-arg]
    """An angle of a full turn at most, degrees."""

    name = "degrees"

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        """Return degrees; a wrong one is wrong use."""
        try:
            degrees = float(value)
        except ValueError:
            degrees = math.nan
        if not abs(degrees) <= 360:
            self.fail(f"takes -360 to 360 degrees, not '{value}'", param, ctx)
        return degrees


class Point(click.ParamType):  # type: ignore[type-arg]
    """X,Y in mm (units allowed), as um."""

    name = "x,y"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[float, float]:
        """Return (x, y) in um; a wrong one is wrong use."""
        if isinstance(value, tuple):
            return value
        parts = str(value).split(",")
        if len(parts) != 2:
            self.fail(f"'{value}' is no point: write X,Y in mm, for instance 4,10", param, ctx)
        try:
            return length_um(parts[0]), length_um(parts[1])
        except ValueError as why:
            self.fail(str(why), param, ctx)


class Offset(click.ParamType):  # type: ignore[type-arg]
    """N=LENGTH: the offset that a controller's table has for D number N, um."""

    name = "n=length"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, float]:
        """Return (N, um); a wrong one is wrong use."""
        if isinstance(value, tuple):
            return value
        number, _, length = str(value).partition("=")
        number = number.strip().lstrip("Dd")
        if not (number.isdecimal() and number.isascii() and len(number) <= 6 and length):
            self.fail(f"'{value}' is no offset of a D number: write 1=0.1mm", param, ctx)
        try:
            return int(number), length_um(length)
        except ValueError as why:
            self.fail(str(why), param, ctx)


class OfLayer(click.ParamType):  # type: ignore[type-arg]
    """NAME=VALUE: what holds for the contours of a layer."""

    def __init__(self, of: click.ParamType, what: str, example: str) -> None:  # type: ignore[type-arg]
        self.name = f"name={what}"
        self.of = of
        self.example = example

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[str, Any]:
        """Return (name, value); a wrong one is wrong use."""
        if isinstance(value, tuple):
            return value
        name, sign, text = str(value).rpartition("=")
        if not sign or not name.strip():
            self.fail(f"'{value}' names no layer: write {self.example}", param, ctx)
        return name.strip(), self.of.convert(text.strip(), param, ctx)


CUTS = Cuts()
DEGREES = Degrees()
OFFSET = Offset()
POINT = Point()
UNIT = Unit()
