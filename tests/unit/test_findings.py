"""Findings carry a template and its values: no text is put together before it is printed."""

from __future__ import annotations

import ast
import importlib
import string
from collections.abc import Iterator
from pathlib import Path

import pytest

import wedmcam

SOURCE = Path(wedmcam.__file__).parent
#: Rooms below the source whose findings are written so.
DONE = ["formats/listing.py", "frontends/b3", "frontends/b4.py", "frontends/iso", "frontends/zd065"]

#: Functions and records that take a template or a hint.
MAKERS = {"error", "warning", "note", "Diagnostic", "extended", "listed", "Question", "_of_words"}
MAKERS |= {"tell", "tell_words", "tell_lines", "tell_unknown", "refuse", "_refusal", "_Fault"}
#: Keywords that are no values of the templates.
FIELDS = {"hint", "hint_template", "template", "notes", "points_mm", "count", "values"}
FIELDS |= {"assumed", "by_profile", "span"}
#: Values that a maker gives itself.
GIVEN = {"count", "block", "words", "text", "assumed"}


def files() -> list[Path]:
    paths = [SOURCE / room for room in DONE]
    return [f for p in paths for f in (sorted(p.rglob("*.py")) if p.is_dir() else [p])]


def calls(tree: ast.AST) -> Iterator[tuple[ast.Call, ast.FunctionDef | None]]:
    """Yield the calls of makers, and the functions that they stand in."""
    within: dict[ast.AST, ast.FunctionDef] = {}
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            within |= dict.fromkeys(ast.walk(function), function)
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            if name in MAKERS:
                yield node, within.get(node)


def texts(call: ast.Call, names: object, function: ast.FunctionDef | None) -> Iterator[str | None]:
    """Yield the literals of a call that may be a template; None for one that is put together."""
    stack = [*call.args, *(k.value for k in call.keywords if k.arg in FIELDS - {"assumed"})]
    while stack:
        node = stack.pop()
        match node:
            case ast.Constant(value=str(text)):
                yield text
            case ast.IfExp():
                stack += [node.body, node.orelse]
            case ast.Name(id=name) if name.lstrip("_").isupper():
                if isinstance(text := getattr(names, name), str):
                    yield text
            case ast.Name(id=name) if function is not None:
                stack += [
                    a.value
                    for a in ast.walk(function)
                    if isinstance(a, ast.Assign | ast.AugAssign)
                    and any(getattr(t, "id", "") == name for t in getattr(a, "targets", [a]))
                    and isinstance(a.value, ast.Constant | ast.IfExp | ast.JoinedStr | ast.Name)
                ]
            case ast.JoinedStr():
                yield None
            case ast.BinOp(left=ast.Constant(value=str()) | ast.JoinedStr()):
                yield None
            case ast.BinOp(right=ast.Constant(value=str()) | ast.JoinedStr()):
                yield None
            case ast.Call(func=ast.Attribute(attr="format")):
                yield None


def keys(node: ast.AST) -> set[str]:
    """Return the keys of the dictionaries that are written in a piece of code."""
    dicts = [d for d in ast.walk(node) if isinstance(d, ast.Dict)]
    return {k.value for d in dicts for k in d.keys if isinstance(k, ast.Constant)}


def given_by(name: str, functions: list[ast.FunctionDef]) -> set[str]:
    """Return the values that functions of a name give."""
    return {key for f in functions if f.name == name for key in keys(f)}


def values(call: ast.Call, functions: list[ast.FunctionDef]) -> tuple[set[str], bool]:
    """Return the names of the values of a call, and whether there may be others."""
    given = {k.arg for k in call.keywords if k.arg is not None} - FIELDS
    more = any(k.arg is None for k in call.keywords)
    for node in [*call.args, *(k.value for k in call.keywords if k.arg == "values")]:
        name = getattr(node, "id", "")
        if isinstance(node, ast.Lambda | ast.Dict):
            given |= keys(node)
        given |= given_by(name, functions)
        more |= name in ("values", "template")  # those of the caller
    return given, more


@pytest.mark.parametrize("path", files(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_templates_are_literals_with_a_value_for_each_field(path):
    tree = ast.parse(path.read_text())
    parts = path.relative_to(SOURCE).with_suffix("").parts
    module = importlib.import_module(".".join(("wedmcam", *parts)).removesuffix(".__init__"))
    functions = [f for f in ast.walk(tree) if isinstance(f, ast.FunctionDef)]
    for call, function in calls(tree):
        where = f"{path.name}:{call.lineno}"
        literals = list(texts(call, module, function))
        assert None not in literals, f"{where}: a text is put together before it is printed"
        parsed = [field for text in literals for field in string.Formatter().parse(text)]
        fields = {name for _, name, _, _ in parsed if name is not None}
        given, more = values(call, functions)
        missing = fields - given - GIVEN - given_by(getattr(call.func, "id", ""), functions)
        assert more or not missing, f"{where}: no value for {missing}"
        if not more:
            assert given <= fields, f"{where}: {given - fields} is in no template"


@pytest.mark.parametrize(
    "text",
    ['f"{a} mm"', '"{} mm".format(a)', '"%s mm" % a', '"a" + b', '"a" if c else f"{b}"'],
)
def test_a_text_that_is_put_together_is_seen(text):
    ((call, _),) = calls(ast.parse(f'error("gap", {text}, span)'))
    assert None in list(texts(call, None, None))


def test_a_value_that_no_field_prints_is_seen():
    ((call, _),) = calls(ast.parse('error("gap", "{gap_mm} mm", span, gap=1)'))
    assert values(call, []) == ({"gap"}, False)
