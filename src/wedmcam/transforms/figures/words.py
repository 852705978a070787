"""The transform words of the part language, for ``--transform``: text in, `Transform` out.

``rotate 10 copies 35 about (0, 0)``: lengths are mm, angles degrees, numbers may be expressions
and are kept exact where they are (360/7 is a seventh of a turn). All errors of a text are reported,
each with its column; a misspelt word names the nearest one.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from wedmcam.diag import Diagnostic, TextSpan, error
from wedmcam.ir.figure import (
    MOST_COPIES,
    MOST_TURNS,
    Mirror,
    Reverse,
    Rotate,
    Sequence,
    Symmetry,
    Transform,
    Translate,
    With,
)

WORDS = ("translate", "rotate", "symmetry", "mirror", "reverse", "with")
#: Larger lengths are typing errors, mm: 100 m.
MOST_MM = 100_000
#: Parentheses, signs and powers of one text: so that nesting stays shallow.
MOST_NESTED = 60
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<word>[A-Za-z_]\w*)"
    r"|(?P<mark>[-+*/^(),|]))"
)
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sqrt": math.sqrt,
    "sin": lambda a: math.sin(math.radians(a)),
    "cos": lambda a: math.cos(math.radians(a)),
    "tan": lambda a: math.tan(math.radians(a)),
    "abs": abs,
}


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str
    text: str
    column: int  # from 1


class _Wrong(Exception):  # noqa: N818 - a way out of one stage of a pipeline
    """The rest of this stage cannot be read."""


def parse_transform(
    text: str, name: str = "--transform"
) -> tuple[Transform | None, list[Diagnostic]]:
    """Return the transform that a text describes.

    Args:
        text: one transform, or several with ``|`` between them, first one first.
        name: of the text, for the places of findings.

    Returns:
        The transform, or None when there is an error.

    >>> parse_transform("rotate 10 copies 35 about (0, 0)")[0]
    Rotate(degrees=Fraction(10, 1), copies=35, about=(0.0, 0.0))
    >>> parse_transform("mirorr 45")[1][0].hint
    "did you mean 'mirror'?"
    """
    parser = _Parser(text, name)
    result = None if text.strip() and not parser.tokens else parser.pipeline()
    return (None if parser.found else result), parser.found


class _Parser:
    def __init__(self, text: str, name: str) -> None:
        self.name = name
        self.found: list[Diagnostic] = []
        self.tokens: list[_Token] = []
        at = 0
        while at < len(text.rstrip()):
            m = _TOKEN.match(text, at)
            if m is None:
                at += len(text[at:]) - len(text[at:].lstrip())
                self.tell("transform-syntax", f"'{text[at]}' has no meaning here", at + 1)
                at += 1
                continue
            kind = str(m.lastgroup)
            self.tokens.append(_Token(kind, m[kind], m.start(kind) + 1))
            at = m.end()
        self.end = _Token("end", "", max(len(text.rstrip()), 0) + 1)
        self.at = 0
        inner = [t for t in self.tokens if t.text in ("(", "-", "+", "^") or t.text == "with"]
        if len(inner) > MOST_NESTED:
            column = inner[MOST_NESTED].column
            self.tell("transform-syntax", "this is too long to be read", column)
            self.tokens = []

    # --- tokens ---

    @property
    def now(self) -> _Token:
        return self.tokens[self.at] if self.at < len(self.tokens) else self.end

    def take(self) -> _Token:
        token = self.now
        self.at += 1
        return token

    def tell(
        self, code: str, message: str, column: int, length: int = 1, hint: str | None = None
    ) -> None:
        span = TextSpan(self.name, 1, column, max(length, 1))
        self.found.append(error(code, message, span, hint=hint))

    def expected(self, what: str) -> _Wrong:
        token = self.now
        seen = f"'{token.text}'" if token.text else "the end"
        hint = None
        if token.kind == "word" and token.text.lower() in ("mm", "um", "inch", "in", "deg"):
            hint = "numbers stand alone: lengths are mm, angles degrees"
        self.tell("transform-syntax", f"{what} was expected, not {seen}", token.column,
                  len(token.text), hint)  # fmt: skip
        return _Wrong()

    def mark(self, text: str) -> None:
        if self.now.text != text:
            raise self.expected(f"'{text}'")
        self.at += 1

    # --- transforms ---

    def pipeline(self) -> Transform | None:
        stages: list[Transform] = []
        while True:
            try:
                stages.append(self.stage())
                if self.now.kind != "end" and self.now.text != "|":
                    raise self.expected("'|' or the end")
            except _Wrong:
                while self.now.kind != "end" and self.now.text != "|":
                    self.at += 1
            if self.now.kind == "end":
                break
            self.at += 1
        if not stages:
            return None
        return stages[0] if len(stages) == 1 else Sequence(tuple(stages))

    def stage(self) -> Transform:
        token = self.now
        if token.kind != "word":
            raise self.expected(f"a transform ({', '.join(WORDS)})")
        word = token.text.lower()
        if word not in WORDS:
            near = difflib.get_close_matches(word, WORDS, 1, 0.5)
            hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(WORDS)}"
            self.tell(
                "transform-syntax",
                f"no transform is called '{token.text}'",
                token.column,
                len(token.text),
                hint,
            )
            raise _Wrong
        self.at += 1
        made: Transform = getattr(self, f"_{word}")()
        return made

    def _reverse(self) -> Transform:
        return Reverse()

    def _with(self) -> Transform:
        return With(self.stage())

    def _symmetry(self) -> Transform:
        token = self.now
        if token.text.lower() not in ("x", "y"):
            raise self.expected("the axis x or y")
        self.at += 1
        return Symmetry("x" if token.text.lower() == "x" else "y")

    def _mirror(self) -> Transform:
        token = self.now
        value = self.number()
        if value not in (45, 135):
            self.tell(
                "transform-value",
                f"a mirror stands at 45 or 135 degrees, not at {_said(value)}",
                token.column,
                self._length(token),
                hint="any other line: symmetry x or y, and rotate",
            )
            raise _Wrong
        return Mirror(45 if value == 45 else 135)

    def _translate(self) -> Transform:
        x, y = self.point()
        options = self.options(("copies",), MOST_COPIES)
        return Translate(x, y, options[0])

    def _rotate(self) -> Transform:
        token = self.now
        degrees = self.number()
        if abs(degrees) > 1_000_000:
            self.tell(
                "transform-value",
                f"an angle of {_said(degrees)} degrees is a typing error",
                token.column,
                self._length(token),
            )
        copies, about = self.options(("copies", "about"), MOST_TURNS)
        return Rotate(degrees, copies, about or (0.0, 0.0))

    def options(self, known: tuple[str, ...], most: int) -> tuple[int, tuple[float, float] | None]:
        """Read ``copies N`` and ``about (x, y)`` in any order, each at most once."""
        copies: int | None = None
        about: tuple[float, float] | None = None
        while self.now.kind == "word":
            token = self.now
            word = token.text.lower()
            if word not in known:
                near = difflib.get_close_matches(word, known, 1, 0.5)
                hint = f"did you mean '{near[0]}'?" if near else f"known are {', '.join(known)}"
                if word in ("mm", "um", "inch", "in", "deg"):
                    hint = "numbers stand alone: lengths are mm, angles degrees"
                self.tell(
                    "transform-syntax",
                    f"'{token.text}' has no meaning here",
                    token.column,
                    len(token.text),
                    hint,
                )
                raise _Wrong
            if (copies if word == "copies" else about) is not None:
                self.tell(
                    "transform-syntax", f"'{word}' stands twice", token.column, len(token.text)
                )
            self.at += 1
            if word == "about":
                about = self.point()
            else:
                copies = self.count(most)
        return copies or 0, about

    def count(self, most: int) -> int:
        token = self.now
        value = self.number()
        if value.denominator != 1 or not 1 <= value <= most:
            self.tell(
                "transform-value",
                f"copies are a whole number from 1 to {most}, not {_said(value)}",
                token.column,
                self._length(token),
                hint="the figure itself is not counted: 36 slots are 35 copies",
            )
            return 1
        return int(value)

    def point(self) -> tuple[float, float]:
        """Read ``(x, y)`` in mm; um."""
        if self.now.text != "(":
            raise self.expected("a point (x, y)")
        self.at += 1
        both = []
        for closing in (",", ")"):
            token = self.now
            value = self.number()
            if abs(value) > MOST_MM:
                self.tell(
                    "transform-value",
                    f"{_said(value)} mm is more than 100 m",
                    token.column,
                    self._length(token),
                )
            both.append(float(value * 1000))
            self.mark(closing)
        return both[0], both[1]

    def _length(self, first: _Token) -> int:
        last = self.tokens[self.at - 1]
        return last.column + len(last.text) - first.column

    # --- numbers ---

    def number(self) -> Fraction:
        """Read an expression: sums of products of powers."""
        value = self.product()
        while self.now.text in ("+", "-"):
            sign = 1 if self.take().text == "+" else -1
            value += sign * self.product()
        return value

    def product(self) -> Fraction:
        value = self.signed()
        while self.now.text in ("*", "/"):
            token = self.take()
            factor = self.signed()
            if token.text == "*":
                value *= factor
            elif factor:
                value /= factor
            else:
                self.tell("transform-value", "division by zero", token.column)
                raise _Wrong
        return value

    def signed(self) -> Fraction:
        if self.now.text in ("-", "+"):
            return -self.signed() if self.take().text == "-" else self.signed()
        return self.power()

    def power(self) -> Fraction:
        base = self.atom()
        if self.now.text != "^":
            return base
        token = self.take()
        exponent = self.signed()
        try:
            if exponent.denominator == 1 and abs(exponent) <= 64:
                return base ** int(exponent)
            return self.fraction(float(base) ** float(exponent), token)
        except (ArithmeticError, TypeError, ValueError):
            self.tell("transform-value", "this power is no number", token.column)
            raise _Wrong from None

    def atom(self) -> Fraction:
        token = self.now
        if token.kind == "number":
            self.at += 1
            # No float may hold it: the exponent alone must not cost memory.
            return self.fraction(float(token.text), token, Fraction)
        if token.text == "(":
            self.at += 1
            value = self.number()
            self.mark(")")
            return value
        word = token.text.lower()
        if word == "pi":
            self.at += 1
            return Fraction(math.pi)
        if word in _FUNCTIONS:
            self.at += 1
            self.mark("(")
            value = self.number()
            self.mark(")")
            try:
                return self.fraction(_FUNCTIONS[word](float(value)), token)
            except (ArithmeticError, ValueError):
                self.tell(
                    "transform-value",
                    f"{word} of {_said(value)} is no number",
                    token.column,
                    len(word),
                )
                raise _Wrong from None
        raise self.expected("a number")

    def fraction(
        self, value: float, token: _Token, exact: Callable[[str], Fraction] | None = None
    ) -> Fraction:
        if isinstance(value, complex) or not math.isfinite(value) or 0 < abs(value) < 1e-30:
            self.tell("transform-value", "this is no number to work with", token.column,
                      len(token.text))  # fmt: skip
            raise _Wrong
        return exact(token.text) if exact is not None else Fraction(value)


def _said(value: Fraction) -> str:
    if abs(value) >= 10**15:
        return "a number beyond 10^15"
    return str(value.numerator) if value.denominator == 1 else f"{float(value):.6g}"
