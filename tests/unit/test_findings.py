"""Findings are literal templates with a value for each field: a program can read them."""

from __future__ import annotations

import ast
import string
from collections.abc import Iterator
from pathlib import Path

import pytest

SRC = Path(__file__).parents[2] / "src" / "wedmcam"

#: Rooms and modules whose findings carry values.
DONE = [
    *("judge", "backends", "controllers/zd065.py", "machines", "programs", "ir", "probe"),
    *("operations", "reports"),
]
MAKERS = {"error", "warning", "note", "finding", "extended", "tell"}
#: Where the template stands among the arguments: of `Checks.tell` behind severity, code and mask.
AT = {"extended": 0, "tell": 3}
#: Keywords that are no values, and fields that every finding has.
FIELDS = {"hint", "notes", "points_mm", "count", "span"}


def modules() -> list[Path]:
    paths = [SRC / room for room in DONE]
    return sorted(p for path in paths for p in ([path] if path.suffix else path.rglob("*.py")))


def literals(node: ast.expr, constants: dict[str, str]) -> list[str] | None:
    """The texts that an expression may be; None where it is no literal."""
    if isinstance(node, ast.Constant) and node.value is None:
        return []
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.IfExp):
        parts = [literals(n, constants) for n in (node.body, node.orelse)]
        return None if None in parts else [text for part in parts for text in part or ()]
    if isinstance(node, ast.Name) and node.id in constants:
        return [constants[node.id]]
    return None


def constants_of(tree: ast.Module) -> dict[str, str]:
    """Texts of the capital names of a module; imported ones have no fields."""
    out = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            out.update({a.name: "" for a in node.names if a.name.isupper()})
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            out.update({t.id: node.value.value for t in node.targets if isinstance(t, ast.Name)})
    return {name: text for name, text in out.items() if isinstance(text, str)}


def findings(path: Path) -> Iterator[tuple[ast.Call, str]]:
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Call):
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            if name in MAKERS and not (name in AT and isinstance(node.func, ast.Name)):
                yield node, name


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(SRC)))
def test_templates_are_literal_and_have_their_values(path):
    constants = constants_of(ast.parse(path.read_text("utf-8")))
    for call, name in findings(path):
        where = f"{path.name}:{call.lineno}"
        at = AT.get(name, 1)
        hints = [k.value for k in call.keywords if k.arg == "hint"]
        texts = [literals(node, constants) for node in (*call.args[at : at + 1], *hints)]
        assert None not in texts, f"{where}: a template is no literal"
        fields = {
            field
            for text in texts
            for one in text or ()
            for _, field, _, _ in string.Formatter().parse(one)
            if field is not None
        }
        keywords = {k.arg for k in call.keywords}
        if None in keywords or name in AT:
            continue  # values of a place, of the finding that is extended, or of a function
        missing = fields - keywords - {"count"}
        assert not missing, f"{where}: no value for {sorted(missing)}"
        assert len(fields & (keywords - FIELDS)) == len(fields - {"count"}), where


def test_there_are_some():
    assert sum(1 for path in modules() for _ in findings(path)) > 90
