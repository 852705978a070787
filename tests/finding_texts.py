"""Reads out of sources which findings they make, and what is wrong with their templates.

A finding is a template and values. What joins the text beforehand, forgets the value of a field or
carries a value that no text shows is found here by the syntax alone, for findings that no test
makes too.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import takewhile
from string import Formatter
from typing import TypeAlias

Texts: TypeAlias = Mapping[str, list[str]]
_Function: TypeAlias = ast.FunctionDef

#: Arguments that are texts of a finding.
_TEXTS = ("template", "more", "hint", "hint_template")
#: Functions that read a template, and no values of theirs.
_EXTENDING = ("extended", "with_hint")


@dataclass(frozen=True)
class Maker:
    """A function, method or class that takes a template.

    Attributes:
        name: qualified, behind the path of its module: ``frontends/b4.py:Reader.tell``.
        positional: names of the arguments that may stand without a name; none is a value.
        fields: other arguments that are no values.
        given: values that it adds itself.
        method: it is called on an object.
    """

    name: str
    positional: tuple[str, ...]
    fields: frozenset[str] = frozenset({"hint", "notes", "points_mm", "count", "values"})
    given: frozenset[str] = frozenset()
    method: bool = False


Makers: TypeAlias = dict[str, list[Maker]]

_SHORT = frozenset({"hint", "notes", "points_mm", "count"})
#: Those of ``diag/finding.py``.
DIAG: dict[str, Maker] = {
    **{
        name: Maker(name, ("code", "template", "span"), _SHORT)
        for name in ("error", "warning", "note")
    },
    "Diagnostic": Maker(
        "Diagnostic",
        (
            "severity",
            "code",
            "template",
            "span",
            "notes",
            "hint_template",
            "points_mm",
            "count",
            "times",
            "rest",
            "values",
        ),
    ),
    "extended": Maker("extended", ("more",), frozenset({"hint"}), method=True),
    "with_hint": Maker("with_hint", ("hint",), frozenset(), method=True),
}


def templates_of(node: ast.expr, named: Texts) -> list[str] | None:
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


def literals_in(node: ast.Module | _Function, outer: Texts) -> dict[str, list[str]]:
    """Return the names that stand for literals alone, in a module or a function.

    ``outer``: those that are known around it.
    """
    found: dict[str, list[str] | None] = {}
    for statement in node.body if isinstance(node, ast.Module) else ast.walk(node):
        if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
            known = {**outer, **{name: texts for name, texts in found.items() if texts is not None}}
            for target in getattr(statement, "targets", [getattr(statement, "target", None)]):
                for name in (n.id for n in ast.walk(target) if isinstance(n, ast.Name)):
                    literals = templates_of(statement.value, known)
                    before = found.get(name, [])
                    whole = literals is not None and before is not None
                    found[name] = [*(before or []), *(literals or [])] if whole else None
        elif isinstance(statement, ast.AugAssign | ast.For | ast.NamedExpr):
            for name in (n.id for n in ast.walk(statement.target) if isinstance(n, ast.Name)):
                found[name] = None
    return {name: literals for name, literals in found.items() if literals is not None}


def imported(tree: ast.Module, constants: Mapping[str, Texts]) -> dict[str, list[str]]:
    """Return the literals that a module has from others: ``constants`` by the module's name."""
    return {
        alias.asname or alias.name: constants[node.module][alias.name]
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module in constants
        for alias in node.names
        if alias.name in constants[node.module]
    }


def makers_in(
    path: str, tree: ast.Module, given: Mapping[str, Mapping[str, str]] | None = None
) -> Makers:
    """Return the functions and classes of a module that take a template, by their last name.

    ``given``: name of a maker -> values that it adds, each with the reason.
    """
    makers: Makers = {}

    def inside(node: ast.AST, around: str, in_class: bool) -> None:
        for child in ast.iter_child_nodes(node):
            if not isinstance(child, ast.FunctionDef | ast.ClassDef):
                inside(child, around, in_class)
                continue
            names, more = _arguments(child)
            qualified = f"{path}:{around}{child.name}"
            if "template" in (*names, *more):
                adds = frozenset((given or {}).get(qualified, ()))
                method = in_class and isinstance(child, ast.FunctionDef)
                maker = Maker(qualified, names, given=adds, method=method)
                makers.setdefault(child.name, []).append(maker)
            inside(child, f"{around}{child.name}.", isinstance(child, ast.ClassDef))

    inside(tree, "", False)
    return makers


def _arguments(node: _Function | ast.ClassDef) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of positional arguments, or of fields of a class; and those of others."""
    if isinstance(node, ast.ClassDef):
        targets = [s.target for s in node.body if isinstance(s, ast.AnnAssign)]
        return tuple(t.id for t in targets if isinstance(t, ast.Name)), ()
    names = tuple(a.arg for a in node.args.args if a.arg != "self")
    return names, tuple(a.arg for a in node.args.kwonlyargs)


def shared(makers: Iterable[Makers]) -> Makers:
    """Return the makers of all modules that others may call: names without a leading _."""
    public: Makers = {}
    for of_module in makers:
        for name, here in of_module.items():
            if not name.startswith("_"):
                public.setdefault(name, []).extend(here)
    return public


def _calls(tree: ast.Module) -> Iterator[tuple[tuple[_Function, ...], ast.Call]]:
    """Yield each call with the functions around it, the innermost last."""

    def inside(
        node: ast.AST, around: tuple[_Function, ...]
    ) -> Iterator[tuple[tuple[_Function, ...], ast.Call]]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Call):
                yield around, child
            more = (child,) if isinstance(child, ast.FunctionDef) else ()
            yield from inside(child, (*around, *more))

    yield from inside(tree, ())


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


@dataclass
class _Made:
    """A call that makes a finding or extends one.

    Attributes:
        maker: what is called.
        line: where.
        texts: its templates, as far as they are literals.
        whole: all are.
        values: names of its values; None where they cannot be seen.
        code: of the finding, where it is a literal.
        faults: of the call alone.
    """

    maker: Maker
    line: int
    texts: list[str]
    whole: bool
    values: set[str] | None
    code: str
    faults: list[str]

    @property
    def fields(self) -> set[str]:
        """The names in its templates."""
        return {field for text in self.texts for field in fields_of(text)}

    def misfits(
        self, more_fields: set[str], more_values: set[str] | None, unshown: set[tuple[str, str]]
    ) -> list[str]:
        """Return the fields without a value and the values in no text.

        Args:
            more_fields: in texts that come behind.
            more_values: of the finding that is extended; None where they cannot be seen.
            unshown: (code, name) of values that no text need show.
        """
        if not self.whole or self.values is None:
            return []
        faults = []
        values = self.values
        if more_values is not None and (
            missing := self.fields - values - more_values - self.maker.given - {"count"}
        ):
            faults.append(f"fields without a value: {sorted(missing)}")
        shown = self.fields | more_fields
        if unused := {v for v in values - shown if (self.code, v) not in unshown}:
            faults.append(f"values in no text: {sorted(unused)}")
        return faults


def _made(maker: Maker, call: ast.Call, own: set[str], known: Texts) -> _Made | None:
    """Return a call as `_Made`; None where it is none. ``own``: parameters around it."""
    named = dict(zip(maker.positional, call.args, strict=False))
    named |= {k.arg: k.value for k in call.keywords if k.arg}
    if not {"template", "more", "hint"} & set(named):  # `error()` of another library
        return None
    made = _Made(maker, call.lineno, [], True, None, "", [])
    last = maker.name.rpartition(":")[2].rpartition(".")[2]
    for key in _TEXTS:
        if (node := named.get(key)) is not None:
            literals = templates_of(node, known)
            if literals is None and not _passed_on(node, own, call):
                made.faults.append(f"the {key} of {last}() is no literal")
            made.whole &= literals is not None
            made.texts += literals or []
    more = _keys(named.get("values") if "values" in maker.fields else None)
    if more is not None and all(k.arg is not None for k in call.keywords):
        made.values = more | (set(named) - set(maker.positional) - maker.fields - {"template"})
    code = named.get("code")
    made.code = str(code.value) if isinstance(code, ast.Constant) else ""
    return made


def _passed_on(node: ast.expr, own: set[str], call: ast.Call) -> bool:
    """Return whether an expression is a template that was handed over.

    One of the caller's, maybe with a literal beside; or one of an object, with its values.
    """
    if isinstance(node, ast.Name):
        return node.id in own & {"template", "hint"}
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str)
    if isinstance(node, ast.Attribute):
        owner = ast.dump(node.value)
        return node.attr in ("template", "hint", "hint_template") and any(
            isinstance(n, ast.Attribute) and n.attr == "values" and ast.dump(n.value) == owner
            for n in ast.walk(call)
        )
    return (
        isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Add)
        and _passed_on(node.left, own, call)
        and _passed_on(node.right, own, call)
    )


def _short_ways(node: ast.expr) -> bool:
    """Return whether an expression is `error`, `warning` or `note`, or one of them."""
    if isinstance(node, ast.IfExp):
        return _short_ways(node.body) and _short_ways(node.orelse)
    return isinstance(node, ast.Name) and node.id in ("error", "warning", "note")


def _common(names: list[str], others: list[str]) -> int:
    """Return how many names two lists open with alike."""
    pairs = zip(names, others, strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


class Module:
    """A module whose findings are looked at.

    Attributes:
        faults: what is wrong with them.
        calls: how many calls make or extend findings.
    """

    def __init__(
        self,
        path: str,
        tree: ast.Module,
        others: Makers,
        constants: Mapping[str, Texts] | None = None,
        unshown: set[tuple[str, str]] | None = None,
        given: Mapping[str, Mapping[str, str]] | None = None,
    ) -> None:
        """Read a module.

        Args:
            path, tree: the module.
            others: makers of all modules; a name that the module defines itself is its own.
            constants: name of a module -> its constants that are literals.
            unshown: see `_Made.misfits`.
            given: see `makers_in`.
        """
        self._rooms = path.split("/")
        self.makers = {**others, **makers_in(path, tree, given)}
        self.makers |= {name: [maker] for name, maker in DIAG.items()}
        known = imported(tree, constants or {})
        self.constants = known | literals_in(tree, known)
        self._assigned: dict[_Function | None, dict[str, list[ast.expr]]] = {}
        self._literals: dict[_Function, dict[str, list[str]]] = {}
        self._made: dict[ast.Call, _Made] = {}
        self._faults: list[tuple[int, str]] = []
        for around, call in (calls := list(_calls(tree))):
            self._look(around, call)
        self._look_at_tables(tree)
        self._look_at_misfits(calls, unshown or set())
        self.calls = len(self._made)
        self.faults = [f"{path}:{line}: {fault}" for line, fault in sorted(self._faults)]

    def _look(self, around: tuple[_Function, ...], call: ast.Call) -> None:
        name = call.func.attr if isinstance(call.func, ast.Attribute) else ""
        name = call.func.id if isinstance(call.func, ast.Name) else name
        if name == "replace" and any(k.arg in ("template", "hint_template") for k in call.keywords):
            self._faults.append((call.lineno, "replace() of a template"))
        known = dict(self.constants)
        for function in around:
            if function not in self._literals:
                self._literals[function] = literals_in(function, known)
            known |= self._literals[function]
        own = {name for function in around[-1:] for part in _arguments(function) for name in part}
        tries = [_made(m, call, own, known) for m in self._called(name, around, call)]
        made = [one for one in tries if one is not None]
        if made:
            best = min(made, key=lambda one: len([*one.faults, *one.misfits(set(), set(), set())]))
            self._made[call] = best
            self._faults += [(call.lineno, fault) for fault in best.faults]

    def _called(self, name: str, around: tuple[_Function, ...], call: ast.Call) -> list[Maker]:
        """Return the makers that a call may be of: methods of objects, else functions."""
        method = isinstance(call.func, ast.Attribute) and not (
            isinstance(call.func.value, ast.Name)
            and call.func.value.id[:1].islower()
            and not any(m.method for m in self.makers.get(name, []))
        )
        makers = [m for m in self.makers.get(name, []) if m.method == method]
        within = ".".join(function.name for function in around)
        local = [m for m in makers if m.name.endswith(f":{within}.{name}")]
        if local:
            return local
        values = self._values(around[-1] if around else None).get(name, [])
        if not makers and isinstance(call.func, ast.Name) and any(map(_short_ways, values)):
            return [DIAG["error"]]
        # Of methods of one name, those of the nearest room: classes are not seen here.
        near = [_common(m.name.split("/"), self._rooms) for m in makers]
        return [m for m, shared in zip(makers, near, strict=True) if shared == max(near)]

    def _values(self, function: _Function | None) -> dict[str, list[ast.expr]]:
        """Return what is assigned to the names of a function; a constant for what is not seen."""
        if function not in self._assigned:
            assigned: dict[str, list[ast.expr]] = {}
            for node in ast.walk(function) if function else ():
                if isinstance(node, ast.Assign):
                    for target in node.targets:
                        if isinstance(target, ast.Name):
                            assigned.setdefault(target.id, []).append(node.value)
                elif isinstance(node, ast.For | ast.comprehension):
                    for name in (n.id for n in ast.walk(node.target) if isinstance(n, ast.Name)):
                        assigned.setdefault(name, []).append(ast.Constant(None))
                elif isinstance(node, ast.arg):
                    assigned.setdefault(node.arg, []).append(ast.Constant(None))
            self._assigned[function] = assigned
        return self._assigned[function]

    def _look_at_tables(self, tree: ast.Module) -> None:
        """Look at templates that stand in tuples behind `error`, `warning` or `note`."""
        for node in ast.walk(tree):
            if isinstance(node, ast.Tuple) and node.elts and _short_ways(node.elts[0]):
                formed = [
                    n
                    for element in node.elts[1:]
                    for n in ast.walk(element)
                    if isinstance(n, ast.JoinedStr)
                    or (isinstance(n, ast.Attribute) and n.attr == "format")
                    or (isinstance(n, ast.BinOp) and templates_of(n, self.constants) is None)
                ]
                self._faults += [(n.lineno, "a template of a table is no literal") for n in formed]

    def _look_at_misfits(
        self,
        calls: list[tuple[tuple[_Function, ...], ast.Call]],
        unshown: set[tuple[str, str]],
    ) -> None:
        """Look for fields without a value, and values in no text; what extends counts too."""
        chains: dict[ast.Call, list[ast.Call]] = {}
        roots: dict[ast.Call, set[ast.Call] | None] = {}
        for around, call in calls:
            if call in self._made and self._made[call].maker.name in _EXTENDING:
                assert isinstance(call.func, ast.Attribute)
                values = self._values(around[-1] if around else None)
                roots[call] = self._roots(call.func.value, values, frozenset())
                for root in roots[call] or ():
                    chains.setdefault(root, []).append(call)
        for call, made in self._made.items():
            starts = roots.get(call, {call})
            linked = {c for s in starts or () for c in (s, *chains.get(s, []))} - {call}
            fields = {field for c in linked for field in self._made[c].fields}
            parts = [self._made[c] for c in linked]
            given: set[str] | None = {v for p in parts for v in (p.values or set()) | p.maker.given}
            if starts is None or any(p.values is None for p in parts):
                given = None
            if made.maker.name not in _EXTENDING:
                given = set()
            if all(p.whole for p in parts):
                faults = made.misfits(fields, given, unshown)
                self._faults += [(call.lineno, fault) for fault in faults]

    def _roots(
        self, node: ast.expr, values: Mapping[str, list[ast.expr]], seen: frozenset[str]
    ) -> set[ast.Call] | None:
        """Return the calls that make the finding that an expression is; None where not seen."""
        if isinstance(node, ast.Name):
            if node.id in seen:
                return set()
            parts = [self._roots(v, values, seen | {node.id}) for v in values.get(node.id, [])]
        elif isinstance(node, ast.IfExp):
            parts = [self._roots(part, values, seen) for part in (node.body, node.orelse)]
        elif not isinstance(node, ast.Call):
            return None
        elif node in self._made and self._made[node].maker.name not in _EXTENDING:
            return {node}
        elif isinstance(node.func, ast.Attribute) and node.func.attr in _EXTENDING:
            return self._roots(node.func.value, values, seen)
        else:
            return None
        if not parts or None in parts:
            return None
        return {root for part in parts for root in part or ()}
