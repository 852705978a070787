"""The parser, made from ``grammars/wed.lark``: a piece of text in, its tree with places out.

lark is imported here, when the first ``.wed`` is read. What it expected becomes a sentence; a word
that is nearly one of those names it.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from wedmcam.diag import Diagnostic, error
from wedmcam.diag.lists import Listing
from wedmcam.frontends.wed.chunks import COMMANDS, STATEMENTS, Source

ENTRIES = ("program", "statement", "heading", "command", "transform", "expression")
#: Parentheses, signs and powers of one piece: so that nesting stays shallow.
MOST_NESTED = 100
#: Tokens of one piece, about.
MOST_LONG = 100_000
_VALUE = {"NAME", "NUMBER", "LPAR", "ADD"}
_SAID = {"NAME": "a name", "NUMBER": "a number", "TEXT": 'a text in "..."'}
#: What may always go on after a value: not worth saying among what was expected.
_GOES_ON = {"MUL", "ADD", "CIRCUMFLEX", "DOT", "LPAR", "VBAR"}


@dataclass(frozen=True, slots=True)
class Node:
    """A rule of the grammar and what it is made of.

    Attributes:
        kind: name of the rule, or of the terminal.
        start: first character in the text.
        end: behind the last one.
        items: nodes.
        text: of a terminal.
    """

    kind: str
    start: int
    end: int
    items: tuple[Node, ...] = ()
    text: str = ""


def grammar_text() -> str:
    """Return the grammar: installed beside the package, else as it lies in the repository."""
    package = files("wedmcam")
    installed = package.joinpath("grammars", "wed.lark")
    if installed.is_file():
        return installed.read_text("utf-8")
    return (Path(str(package)).parents[1] / "grammars" / "wed.lark").read_text("utf-8")


def _whole(terminal: Any) -> None:
    """Make a word end where it ends: 'too' is not 'to' and something more."""
    from lark.lexer import PatternRE

    pattern = terminal.pattern
    if re.fullmatch(r"(\(\?:)?[a-z]+(\|[a-z]+)*\)?", pattern.value):
        terminal.pattern = PatternRE(rf"(?:{pattern.value})\b", pattern.flags)
        terminal.priority = 1


@cache
def _parser() -> Any:
    from lark import Lark

    return Lark(
        grammar_text(),
        parser="lalr",
        start=list(ENTRIES),
        maybe_placeholders=False,
        # Every token is kept so that a node knows its own place: that is done in half the time of
        # `propagate_positions`, and no second tree has to be made.
        keep_all_tokens=True,
        propagate_positions=False,
        tree_class=_node,
        edit_terminals=_whole,
    )


@cache
def _named() -> frozenset[str]:
    """Return the terminals that the grammar gives a name: words and brackets say nothing more."""
    return frozenset(re.findall(r"^([A-Z]+):", grammar_text(), re.MULTILINE))


class _Inlined(NamedTuple):
    """A rule without a name of its own (``_figure``): lark puts its children where it stands."""

    children: list[Any]


def _node(rule: str, children: list[Any]) -> Node | _Inlined:
    """Return a rule as a node; children are nodes and all tokens."""
    if rule[0] == "_":
        return _Inlined(children)
    if not children:
        return Node(rule, 0, 0)
    named, items = _named(), []
    for child in children:
        if type(child) is Node:
            items.append(child)
        elif child.type in named:
            items.append(Node(child.type, child.start_pos, child.end_pos, (), child.value))
    first, last = children[0], children[-1]
    start = first.start if type(first) is Node else first.start_pos
    end = last.end if type(last) is Node else last.end_pos
    return Node(rule, start, end, tuple(items))


def parse(source: Source, entry: str, start: int, end: int) -> tuple[Node | None, list[Diagnostic]]:
    """Return the tree of characters ``start`` up to ``end``, or what is wrong with them."""
    from lark import TextSlice
    from lark.exceptions import UnexpectedInput

    text = source.text[start:end]
    if problem := _too_deep(source, text, start):
        return None, [problem]
    try:
        tree = _parser().parse(TextSlice(source.text, start, end), start=entry)
    except UnexpectedInput as why:
        return None, [_expected(source, text, start, why, entry)]
    return Node(tree.kind, start, end, tree.items), []


def _too_deep(source: Source, text: str, start: int) -> Diagnostic | None:
    """Return an error for what would nest too deep to be worked with."""
    depth = 0
    for count, m in enumerate(re.finditer(r"[(^]|with\b|[-+](?=\s*[-+])|\)", text)):
        depth += -1 if m[0] == ")" else 1
        if depth > MOST_NESTED or count > MOST_LONG:
            span = source.span(start + m.start(), start + m.end())
            return error("wed-syntax", "this is nested too deep to be read", span)
    return None


def _expected(source: Source, text: str, start: int, why: Any, entry: str) -> Diagnostic:
    token = getattr(why, "token", None)
    names = set(getattr(why, "accepts", None) or getattr(why, "expected", None) or ())
    names |= set(getattr(why, "allowed", None) or ())
    names -= {"$END"}
    at = why.pos_in_stream  # in the whole text; None at its end
    at = None if at is None else at - start
    if token is None and at is not None and at < len(text):
        word = text[at]
        length = 1
    elif token is None or token.type == "$END":
        at, word, length = len(text), "", 1
    else:
        word, length = str(token), len(token)
    if at >= len(text) and text:
        at, length = len(text) - 1, 1
    known = _words(names)
    if entry == "command":
        known = known - set(STATEMENTS) | set(COMMANDS)
    elif entry == "statement":
        known |= set(STATEMENTS)
    unit = word in ("mm", "um", "inch", "in", "deg")
    comma = word == "," and re.match(r"\d,\d", text[at - 1 : at + 2])
    named = word[:1].isalpha() and not unit
    near = difflib.get_close_matches(word.lower(), known, 1, 0.5) if named else []
    finding = error(
        "wed-syntax",
        "'{word}' has no meaning here" if word else "something is missing at the end of this",
        source.span(start + at, start + at + length),
        hint="numbers stand alone: the unit is that of the program, angles are degrees"
        if unit
        else "numbers have a decimal point: 9.5"
        if comma
        else "did you mean '{nearest}'?"
        if near
        else None,
        word=word if len(word) <= 40 else word[:37] + "...",
        nearest=near[0] if near else None,
    )
    if expected := expectation(names, entry):
        return finding.extended("; expected is {expected}", expected=expected)
    return finding


def _words(names: Iterable[str]) -> set[str]:
    words: set[str] = set()
    for t in _parser().terminals:
        if t.name in names:
            pattern = re.sub(r"\(\?:|\)|\\b", "", t.pattern.value)
            words.update(w for w in pattern.split("|") if w.isalpha())
    return words


def expectation(names: set[str], entry: str = "") -> Listing:
    """Return what would have been right, in words."""
    names = set(names)
    out = []
    if names >= {"NUMBER", "LPAR"}:
        names -= _VALUE
        out.append("a number, a point or a name")
    elif len(names) > len(names & _GOES_ON):
        names -= _GOES_ON
    words = _words(names)
    if entry != "program" and not words >= set(STATEMENTS):
        words -= {w for w in STATEMENTS if entry == "command"}
    elif entry != "program":
        words -= set(STATEMENTS) | set(COMMANDS)
    out += [_SAID[n] for n in sorted(names) if n in _SAID]
    out += [f"'{w}'" for w in sorted(words)]
    for t in _parser().terminals:
        if t.name in names and t.name not in _SAID and not re.search(r"[a-z]", t.pattern.value):
            out.append(f"'{t.pattern.value.replace(chr(92), '')}'")
    out = [o for o in out if o != "'}'"] if entry == "statement" else out
    return Listing(out, end=" or ")
