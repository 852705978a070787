"""A finding is a template and values: nothing in the sources forms its text beforehand."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path
from string import Formatter

import pytest

from wedmcam.diag import ByteSpan, Severity
from wedmcam.formats.listing import ERRORS, in_order, listed

SRC = Path(__file__).parents[2] / "src" / "wedmcam"


#: Rooms whose findings are looked at.
ROOMS = sorted(p.stem for p in SRC.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists())

#: Values that no text shows: a program that reads findings wants them. (code of the finding, name)
UNSHOWN: set[tuple[str, str]] = set()

#: Functions that make findings, and the arguments that are no values of theirs.
MAKERS = {
    "error": ("code", "template", "span"),
    "warning": ("code", "template", "span"),
    "note": ("code", "template", "span"),
    "Diagnostic": ("severity", "code", "template", "span"),
    "extended": ("more",),
}
_FIELDS = {"hint", "hint_template", "notes", "points_mm", "count", "times", "rest", "values"}


def templates_of(node: ast.expr, named: Mapping[str, list[str]]) -> list[str] | None:
    """Return the literals that an expression may be; None where it is formed.

    Args:
        node: the expression.
        named: names -> literals that they may stand for.
    """
    if isinstance(node, ast.Constant) and node.value is None:
        return []
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.Name):
        return named.get(node.id)
    if isinstance(node, ast.IfExp):
        parts = [templates_of(part, named) for part in (node.body, node.orelse)]
        return None if None in parts else [text for part in parts for text in part or []]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        left, right = templates_of(node.left, named), templates_of(node.right, named)
        if left is None or right is None:
            return None
        return [a + b for a in left for b in right]
    return None


def fields_of(template: str) -> set[str]:
    """Return the names in a template, those of nested formats included.

    >>> sorted(fields_of("{a_mm:.{digits}f} {{x}} {point[0]}"))
    ['a_mm', 'digits', 'point']
    """
    names: set[str] = set()
    for _, name, spec, _ in Formatter().parse(template):
        if name is not None:
            names.add(name.split("[")[0].split(".")[0])
            names |= fields_of(spec or "")
    return names


def literals_in(node: ast.Module | ast.FunctionDef) -> dict[str, list[str]]:
    """Return the names that stand for literals alone, in a module or a function."""
    found: dict[str, list[str] | None] = {}
    for statement in node.body if isinstance(node, ast.Module) else ast.walk(node):
        if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
            for target in getattr(statement, "targets", [getattr(statement, "target", None)]):
                for name in (n.id for n in ast.walk(target) if isinstance(n, ast.Name)):
                    literals = templates_of(statement.value, {})
                    before = found.get(name, [])
                    whole = literals is not None and before is not None
                    found[name] = [*(before or []), *(literals or [])] if whole else None
        elif isinstance(statement, ast.AugAssign | ast.For | ast.NamedExpr):
            for name in (n.id for n in ast.walk(statement.target) if isinstance(n, ast.Name)):
                found[name] = None
    return {name: literals for name, literals in found.items() if literals is not None}


Makers = dict[str, list[tuple[str, ...]]]


def makers_in(*trees: ast.Module) -> Makers:
    """Return the functions that take a template: name -> positional arguments of each."""
    makers: Makers = {}
    for tree in trees:
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef):
                names = tuple(a.arg for a in function.args.args if a.arg != "self")
                if "template" in (*names, *(a.arg for a in function.args.kwonlyargs)):
                    makers.setdefault(function.name, []).append(names)
    return makers


def _calls(tree: ast.Module) -> Iterator[tuple[ast.FunctionDef | None, ast.Call]]:
    """Yield each call with the innermost function around it."""

    def inside(
        node: ast.AST, function: ast.FunctionDef | None
    ) -> Iterator[tuple[ast.FunctionDef | None, ast.Call]]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Call):
                yield function, child
            yield from inside(child, child if isinstance(child, ast.FunctionDef) else function)

    yield from inside(tree, None)


def _keys(node: ast.expr | None) -> set[str] | None:
    """Return the names in values that are written down; None where they cannot be seen."""
    if node is None or (isinstance(node, ast.Constant) and node.value is None):
        return set()
    if isinstance(node, ast.Lambda):
        return _keys(node.body)
    if isinstance(node, ast.Dict) and all(isinstance(k, ast.Constant) for k in node.keys):
        return {str(k.value) for k in node.keys if isinstance(k, ast.Constant)}
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "dict":
        if node.args or any(k.arg is None for k in node.keywords):
            return None
        return {str(k.arg) for k in node.keywords}
    return None


def faults_of(path: str, tree: ast.Module, others: Makers) -> list[str]:
    """Return what is wrong with the findings that a module makes.

    Args:
        path, tree: the module.
        others: makers of findings in all modules; a name that the module defines itself is its own.
    """
    makers = {**others, **makers_in(tree), **{name: [names] for name, names in MAKERS.items()}}
    constants, faults = literals_in(tree), []
    for function, call in _calls(tree):
        name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
        name = call.func.id if isinstance(call.func, ast.Name) else name
        if name == "replace" and any(k.arg in ("template", "hint_template") for k in call.keywords):
            faults.append(f"{path}:{call.lineno}: replace() of a template")
        own = {a.arg for a in (*function.args.args, *function.args.kwonlyargs)} if function else {}
        if name not in makers:
            continue
        known = constants | (literals_in(function) if function else {})
        tries = [_faults(name, names, call, set(own), known) for names in makers[name]]
        faults += [f"{path}:{call.lineno}: {fault}" for fault in min(tries, key=len, default=[])]
    return faults


def _faults(
    name: str,
    positional: tuple[str, ...],
    call: ast.Call,
    own: set[str],
    named_texts: Mapping[str, list[str]],
) -> list[str]:
    """Return the faults of one call; ``own`` are the parameters of the function around it."""
    named = dict(zip(positional, call.args, strict=False))
    named |= {k.arg: k.value for k in call.keywords if k.arg}
    if not {"template", "more"} & set(named):  # `error()` of another library
        return []
    faults: list[str] = []
    texts: list[str] = []
    whole = True
    for key in ("template", "more", "hint", "hint_template"):
        if (node := named.get(key)) is not None:
            literals = templates_of(node, named_texts)
            if literals is None and not _passed_on(node, own):
                faults.append(f"the {key} of {name}() is no literal")
            whole &= literals is not None
            texts += literals or []
    more = _keys(named.get("values"))
    if not whole or more is None or any(k.arg is None for k in call.keywords):
        return faults
    values = more | {k for k in named if k not in (*positional, *_FIELDS, "template", "more")}
    fields = {field for text in texts for field in fields_of(text)}
    if name != "extended" and (missing := fields - values - {"count"}):
        faults.append(f"fields without a value: {sorted(missing)}")
    code = named.get("code")
    text = str(code.value) if isinstance(code, ast.Constant) else ""
    if unused := {value for value in values - fields if (text, value) not in UNSHOWN}:
        faults.append(f"values in no text: {sorted(unused)}")
    return faults


def _passed_on(node: ast.expr, own: set[str]) -> bool:
    """Return whether an expression is a template of the caller's, maybe with a literal beside."""
    if isinstance(node, ast.Name):
        return node.id in own & {"template", "hint"}
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str)
    return (
        isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Add)
        and _passed_on(node.left, own)
        and _passed_on(node.right, own)
    )


def _sources() -> dict[Path, ast.Module]:
    return {path: ast.parse(path.read_text()) for path in sorted(SRC.rglob("*.py"))}


@pytest.mark.parametrize("room", ROOMS)
def test_texts_are_literals_and_each_field_has_its_value(room: str) -> None:
    trees = _sources()
    makers = makers_in(*trees.values())
    mine = [p for p in trees if p.relative_to(SRC).with_suffix("").parts[0] == room]
    assert mine, f"no such room: {room}"
    faults = [f for p in mine for f in faults_of(str(p.relative_to(SRC)), trees[p], makers)]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ('error("gap", f"{a} mm")', "the template of error() is no literal"),
        ('error("gap", "{} mm".format(a))', "the template of error() is no literal"),
        ('error("gap", "%s mm" % a)', "the template of error() is no literal"),
        ('error("gap", "x" + a)', "the template of error() is no literal"),
        ('warning("gap", "x", hint=f"{a}")', "the hint of warning() is no literal"),
        ('Diagnostic(s, "gap", "x", None, hint_template=a)', "the hint_template of Diagnostic()"),
        ('d.extended(f"; {a}")', "the more of extended() is no literal"),
        ('note("gap", "{gap_mm:.3f} mm")', "fields without a value: ['gap_mm']"),
        ('note("gap", "a gap", gap_mm=1)', "values in no text: ['gap_mm']"),
        ('tell("gap", "{a}", lambda i: {"b": i})', "fields without a value: ['a']"),
        ('tell("gap", f"{a}")', "the template of tell() is no literal"),
        (
            'def f(a):\n    text = "a"\n    text += a\n    error("gap", text)',
            "of error() is no literal",
        ),
        ('replace(d, template="x")', "replace() of a template"),
    ],
)
def test_each_fault_is_seen(source: str, fault: str) -> None:
    makers = {"tell": [("code", "template", "values", "hint")]}
    assert fault in "\n".join(faults_of("x.py", ast.parse(source), makers))


@pytest.mark.parametrize(
    "source",
    [
        'error("gap", "{gap_mm:.3f} mm in {count} places", span, gap_mm=1, count=2)',
        'error("gap", "is open" if a else "is {what}", hint="cut {what}", what=1)',
        'TEXT = "a {b}"\nnote("gap", TEXT, b=1)',
        'tell("gap", "{a}", lambda i: {"a": i}, "not {a}")',
        'def f(a):\n    text = "a"\n    if a:\n        text = "b"\n    error("gap", text)',
        'def tell(code, template, values=None, hint=None):\n    error(code, "b: " + template)',
    ],
)
def test_what_is_right_passes(source: str) -> None:
    makers = {"tell": [("code", "template", "values", "hint")]}
    assert faults_of("x.py", ast.parse(source), makers) == []


@pytest.mark.parametrize(("severity", "one_by_one"), [(Severity.ERROR, ERRORS), (Severity.NOTE, 1)])
def test_a_list_ends_with_a_count_of_the_rest(severity: Severity, one_by_one: int) -> None:
    places = list(range(0, 100, 2))
    found = list(
        listed(
            severity,
            "zero-count",
            places,
            lambda i: ByteSpan("a", i, i + 1),
            "byte {byte} of {count}",
            lambda i: {"byte": i},
            "leave byte {byte} out",
        )
    )
    assert [i for i, _ in found] == places[:one_by_one]
    last = found[-1][1]
    assert last.count == len(places) - one_by_one + 1
    assert last.message == f"byte {places[one_by_one - 1]} of {last.count}"
    assert last.hint == f"leave byte {places[one_by_one - 1]} out"
    assert in_order(found[::-1]) == [d for _, d in found]


def test_a_list_without_values_has_none() -> None:
    [(_, only)] = listed(Severity.ERROR, "zero-count", [3], lambda i: None, "J is 0")
    assert (only.message, only.values, only.hint) == ("J is 0", {}, None)
