"""What expressions and transforms mean: trees in, numbers, points, figures and transforms out.

A value that could not be had is None: it was reported where it failed, and whatever builds on it
stays silent, so that one mistake is reported once.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from wedmcam.diag import Diagnostic, TextSpan, error
from wedmcam.diag.lists import all_of
from wedmcam.frontends.wed.chunks import Source
from wedmcam.frontends.wed.grammar import Node
from wedmcam.frontends.wed.numbers import Number, Numbers, Point, Wrong
from wedmcam.ir.figure import (
    MOST_COPIES,
    MOST_TURNS,
    Mirror,
    Reverse,
    Rotate,
    Symmetry,
    Transform,
    Translate,
    With,
)
from wedmcam.ir.part import Shape

Value = Number | Point | Shape
FACTORS = {"mm": 1000, "um": 1, "inch": 25400}
#: Larger coordinates are typing errors, um: 100 m.
MOST_UM = 1e8
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "abs", "min", "max")
#: Names that are there from the start.
KNOWN = ("pi", "polar", *FUNCTIONS)


class Stop(Exception):  # noqa: N818 - a way out of one statement
    """This value cannot be had; what is wrong has been reported."""


def kind_of(value: Value) -> str:
    """Return what a value is, for messages."""
    return {Number: "a number", Point: "a point", Shape: "a figure"}[type(value)]


@dataclass(slots=True)
class Scope:
    """Names with their values, the arithmetic, and findings.

    Attributes:
        source: the text.
        numbers: the arithmetic.
        units: of the program.
        names: values; None for one that could not be had.
        places: where each name was given.
        later: names that are given further on, and the line.
        findings: so far.
    """

    source: Source
    numbers: Numbers
    units: str = "mm"
    names: dict[str, Value | None] = field(default_factory=dict)
    places: dict[str, TextSpan] = field(default_factory=dict)
    later: dict[str, int] = field(default_factory=dict)
    findings: list[Diagnostic] = field(default_factory=list)

    @property
    def factor(self) -> int:
        """Um in a unit of the program."""
        return FACTORS[self.units]

    def span(self, node: Node) -> TextSpan:
        """Return the place of a node."""
        return self.source.span(node.start, node.end)

    def tell(
        self, code: str, template: str, span: TextSpan, hint: str | None = None, **values: Any
    ) -> None:
        """Report an error; ``values`` of its template and its hint."""
        self.findings.append(error(code, template, span, hint=hint, **values))

    def tell_wrong(self, code: str, why: Exception, span: TextSpan) -> None:
        """Report why a number or a block cannot be."""
        if isinstance(why, Wrong):
            self.findings.append(why.finding(code, span))
        elif str(why):
            self.tell(code, "{reason}", span, reason=str(why))
        else:
            self.tell(code, "this block cannot be", span)

    def tell_unknown(
        self, template: str, span: TextSpan, known: Iterable[str], *, name: str
    ) -> None:
        """Report a name that nothing has, with the nearest of those that are known."""
        nearest = near(name, known)
        self.tell(
            "unknown-name",
            template,
            span,
            "did you mean '{nearest}'?" if nearest else None,
            name=name,
            nearest=nearest,
        )

    # --- values ---

    def value(self, node: Node) -> Value:
        """Return what an expression means.

        Raises:
            Stop: it means nothing, and that was reported.
        """
        method: Callable[[Node], Value] = getattr(self, f"_{node.kind.lower()}")
        return method(node)

    def number(self, node: Node) -> Number:
        """Return an expression that must be a number."""
        value = self.value(node)
        if not isinstance(value, Number):
            self.tell(
                "wed-kind",
                "a number is needed here, not {kind}",
                self.span(node),
                kind=kind_of(value),
            )
            raise Stop
        return value

    def point(self, node: Node) -> Point:
        """Return an expression that must be a point."""
        value = self.value(node)
        if not isinstance(value, Point):
            self.tell(
                "wed-kind",
                "a point is needed here, not {kind}",
                self.span(node),
                "points are (x, y)",
                kind=kind_of(value),
            )
            raise Stop
        for n in (value.x, value.y):
            self._bounded(n, node)
        return value

    def _bounded(self, n: Number, node: Node) -> None:
        if abs(float(n)) * self.factor > MOST_UM:
            self.tell(
                "wed-value",
                "{length:.10g} {units} is more than 100 m",
                self.span(node),
                length=float(n),
                units=self.units,
            )
            raise Stop

    def length(self, node: Node) -> Number:
        """Return an expression that must be a length: a number of a sensible size."""
        n = self.number(node)
        self._bounded(n, node)
        return n

    def um(self, node: Node, what: str, least: float = 0.0) -> float:
        """Return a length in um; negative ones are refused."""
        n = self.length(node)
        um = self.numbers.um(n, self.factor)
        if um < least:
            self.tell(
                "wed-value",
                "{clause} is not negative, but {length:.10g} is",
                self.span(node),
                clause=what,
                length=float(n),
            )
            raise Stop
        return um

    def _work(self, node: Node, work: Callable[[], Number]) -> Number:
        try:
            return work()
        except Wrong as why:
            self.tell_wrong("wed-value", why, self.span(node))
            raise Stop from None

    def _number(self, node: Node) -> Value:
        return self._work(node, lambda: self.numbers.literal(node.text))

    def _group(self, node: Node) -> Value:
        return self.value(node.items[0])

    def _expression(self, node: Node) -> Value:
        return self.value(node.items[0])

    def _point(self, node: Node) -> Value:
        return Point(self.number(node.items[0]), self.number(node.items[1]))

    def _name(self, node: Node) -> Value:
        name = node.text
        if name in self.names:
            value = self.names[name]
            if value is None:
                raise Stop
            return value
        if name == "pi":
            return Number(self.numbers.make(math.pi))
        if name in self.later or name in KNOWN:
            self.tell(
                "unknown-name",
                "nothing is called '{name}'",
                self.span(node),
                "it is given in line {line}: names come before their use"
                if name in self.later
                else "{name}(...) is a function",
                name=name,
                line=self.later.get(name),
            )
        else:
            known = [*self.names, *KNOWN]
            self.tell_unknown("nothing is called '{name}'", self.span(node), known, name=name)
        raise Stop

    def _member(self, node: Node) -> Value:
        value = self.value(node.items[0])
        axis = node.items[1].text
        if not isinstance(value, Point):
            self.tell(
                "wed-kind",
                "{kind} has no .{axis}",
                self.span(node),
                kind=kind_of(value),
                axis=axis,
            )
            raise Stop
        if axis not in ("x", "y"):
            self.tell("wed-kind", "a point has .x and .y, no .{axis}", self.span(node), axis=axis)
            raise Stop
        return value.x if axis == "x" else value.y

    def _sign(self, node: Node) -> Value:
        value = self.value(node.items[1])
        if node.items[0].text == "+":
            return value
        if isinstance(value, Shape):
            return self._mismatch("-", value, None, node)
        n = self.numbers
        if isinstance(value, Point):
            return Point(n.negate(value.x), n.negate(value.y))
        return n.negate(value)

    def _mismatch(self, sign: str, a: Value, b: Value | None, node: Node) -> Value:
        self.tell(
            "wed-kind",
            "'{sign}' does not go with {kinds}",
            self.span(node),
            sign=sign,
            kinds=all_of(kind_of(value) for value in (a, b) if value is not None),
        )
        raise Stop

    def _sum(self, node: Node) -> Value:
        value = self.value(node.items[0])
        for k in range(1, len(node.items), 2):
            sign, other = node.items[k].text, self.value(node.items[k + 1])
            work = self.numbers.add if sign == "+" else self.numbers.subtract
            value = self._added(sign, work, value, other, node)
        return value

    def _added(
        self, sign: str, work: Callable[..., Number], a: Value, b: Value, node: Node
    ) -> Value:
        if isinstance(a, Number) and isinstance(b, Number):
            return self._work(node, lambda: work(a, b))
        if isinstance(a, Point) and isinstance(b, Point):
            x = self._work(node, lambda: work(a.x, b.x))
            return Point(x, self._work(node, lambda: work(a.y, b.y)))
        return self._mismatch(sign, a, b, node)

    def _product(self, node: Node) -> Value:
        value = self.value(node.items[0])
        for k in range(1, len(node.items), 2):
            sign, other = node.items[k].text, self.value(node.items[k + 1])
            value = self._multiplied(sign, value, other, node)
        return value

    def _multiplied(self, sign: str, a: Value, b: Value, node: Node) -> Value:
        work = self.numbers.multiply if sign == "*" else self.numbers.divide
        if isinstance(b, Point) and isinstance(a, Number) and sign == "*":
            a, b = b, a
        if isinstance(b, Number):
            if isinstance(a, Number):
                return self._work(node, lambda: work(a, b))
            if isinstance(a, Point):
                x = self._work(node, lambda: work(a.x, b))
                return Point(x, self._work(node, lambda: work(a.y, b)))
        return self._mismatch(sign, a, b, node)

    def _power(self, node: Node) -> Value:
        a, b = self.value(node.items[0]), self.value(node.items[1])
        if isinstance(a, Number) and isinstance(b, Number):
            return self._work(node, lambda: self.numbers.power(a, b))
        return self._mismatch("^", a, b, node)

    def _call(self, node: Node) -> Value:
        name, given = node.items[0].text, node.items[1:]
        if name not in (*FUNCTIONS, "polar"):
            place, known = self.span(node.items[0]), (*FUNCTIONS, "polar")
            self.tell_unknown("no function is called '{name}'", place, known, name=name)
            raise Stop
        takes = {"atan2": (2, 2), "polar": (2, 3), "min": (1, 99), "max": (1, 99)}.get(name, (1, 1))
        if not takes[0] <= len(given) <= takes[1]:
            form = {"atan2": "(y, x)", "polar": "(r, angle) or (r, angle, about)"}.get(
                name, "(...)"
            )
            self.tell(
                "wed-kind",
                "{function} takes {least} values, not {given}"
                if takes[0] == takes[1]
                else "{function} takes {least} to {most} values, not {given}",
                self.span(node),
                "{function}{form}",
                function=name,
                least=takes[0],
                most=takes[1],
                given=len(given),
                form=form,
            )
            raise Stop
        if name == "polar":
            about = self.point(given[2]) if len(given) == 3 else None
            return self.polar(self.number(given[0]), self.number(given[1]), about, node)
        values = [self.number(g) for g in given]
        n = self.numbers
        if name in ("min", "max"):
            pick = min if name == "min" else max
            return pick(values, key=lambda v: v.fraction)
        if name == "abs":
            return n.absolute(values[0])
        work = getattr(n, name)
        return self._work(node, lambda: work(*values))

    def polar(self, r: Number, angle: Number, about: Point | None, node: Node) -> Point:
        """Return the point at a distance and in a direction from another one."""
        n = self.numbers
        x = self._work(node, lambda: n.multiply(r, n.cos(angle)))
        y = self._work(node, lambda: n.multiply(r, n.sin(angle)))
        if about is None:
            return Point(x, y)
        return Point(
            self._work(node, lambda: n.add(about.x, x)), self._work(node, lambda: n.add(about.y, y))
        )

    # --- transforms ---

    def transform(self, node: Node) -> Transform:
        """Return a transform; lengths become um, angles stay exact.

        Raises:
            Stop: it is none, and that was reported.
        """
        transform: Transform = getattr(self, f"_{node.kind}")(node)
        return transform

    def _reverse(self, node: Node) -> Transform:
        return Reverse()

    def _with(self, node: Node) -> Transform:
        return With(self.transform(node.items[0]))

    def _symmetry(self, node: Node) -> Transform:
        axis = node.items[0].text.lower()
        if axis not in ("x", "y"):
            self.tell(
                "wed-value",
                "symmetry is about the x or the y axis, not '{axis}'",
                self.span(node.items[0]),
                axis=node.items[0].text,
            )
            raise Stop
        return Symmetry("x" if axis == "x" else "y")

    def _mirror(self, node: Node) -> Transform:
        value = self.number(node.items[0])
        if value.fraction not in (45, 135):
            self.tell(
                "wed-value",
                "a mirror stands at 45 or 135 degrees, not at {angle_deg:.10g}",
                self.span(node.items[0]),
                "any other line: symmetry x or y, and rotate",
                angle_deg=float(value),
            )
            raise Stop
        return Mirror(45 if value.fraction == 45 else 135)

    def _translate(self, node: Node) -> Transform:
        p = self.point(node.items[0])
        copies, _ = self._options(node.items[1:], MOST_COPIES)
        um = self.numbers.um
        return Translate(um(p.x, self.factor), um(p.y, self.factor), copies)

    def _rotate(self, node: Node) -> Transform:
        angle = self.number(node.items[0])
        if abs(float(angle)) > 1_000_000:
            self.tell(
                "wed-value",
                "an angle of {angle_deg:.10g} degrees is a typing error",
                self.span(node.items[0]),
                angle_deg=float(angle),
            )
            raise Stop
        copies, about = self._options(node.items[1:], MOST_TURNS)
        return Rotate(angle.fraction, copies, about)

    def _options(self, nodes: Iterable[Node], most: int) -> tuple[int, tuple[float, float]]:
        copies, about, seen = 0, (0.0, 0.0), set()
        for node in nodes:
            if node.kind in seen:
                self.tell(
                    "wed-syntax", "'{clause}' stands twice", self.span(node), clause=node.kind
                )
                raise Stop
            seen.add(node.kind)
            if node.kind == "about":
                p = self.point(node.items[0])
                about = (
                    self.numbers.um(p.x, self.factor),
                    self.numbers.um(p.y, self.factor),
                )
                continue
            n = self.number(node.items[0]).fraction
            if n.denominator != 1 or not 1 <= n <= most:
                self.tell(
                    "wed-value",
                    "copies are a whole number from 1 to {most}, not {copies}",
                    self.span(node.items[0]),
                    "the figure itself is not counted: 36 slots are 35 copies",
                    most=most,
                    copies=_text_of(n),
                )
                raise Stop
            copies = int(n)
        return copies, about


def _text_of(n: Fraction) -> str:
    return str(n.numerator) if n.denominator == 1 else f"{float(n):.6g}"


def near(name: str, known: Iterable[str]) -> str | None:
    """Return the nearest name, or None.

    >>> near("blde", ["blade", "w"])
    'blade'
    """
    return next(iter(difflib.get_close_matches(name, list(known), 1, 0.5)), None)
