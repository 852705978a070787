"""How large things may become: functions, commands, what is imported inside functions."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src" / "wedmcam"
TREES = {
    path.relative_to(PACKAGE): ast.parse(path.read_text("utf-8"))
    for path in sorted(PACKAGE.rglob("*.py"))
}
#: Rooms whose kernels take a column an argument.
KERNELS = {"geom", "transforms", "judge"}


def _functions():
    for path, tree in TREES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                yield path, node


def _is_command(function):
    """Whether click gives a function its arguments."""
    calls = [d.func for d in function.decorator_list if isinstance(d, ast.Call)]
    return any(isinstance(f, ast.Attribute) and f.attr == "command" for f in calls)


def _parameters(function):
    a = function.args
    names = [p.arg for p in (*a.posonlyargs, *a.args, *a.kwonlyargs)]
    return [name for name in names if name not in {"self", "cls"}]


def _lines(function):
    return function.end_lineno - function.lineno + 1


def test_the_facade_is_thin():
    assert len((PACKAGE / "api.py").read_text("utf-8").splitlines()) < 250


def test_no_command_is_long():
    """Of each file of a command there is one that click calls, or the work behind it."""
    rooms = {("cli", "commands"), ("cli", "run")}
    commands = [(p, f) for p, f in _functions() if p.parts[:2] in rooms]
    assert sum(_is_command(f) for _, f in commands) >= 13
    assert sum(p.parts[1] == "run" and f.name.startswith("run_") for p, f in commands) >= 13
    assert not [f"{p} {f.name}: {_lines(f)}" for p, f in commands if _lines(f) > 80]


def test_no_function_takes_too_much():
    """Eight parameters at most: what belongs together is a record."""
    assert not [
        f"{path} {f.name}: {len(_parameters(f))}"
        for path, f in _functions()
        if len(_parameters(f)) > 8 and path.parts[0] not in KERNELS and not _is_command(f)
    ]


def test_imports_stand_at_the_top():
    """Under 6 % stand in functions: there they load a heavy library only when it is needed."""
    imports = (ast.Import, ast.ImportFrom)
    every = {n for tree in TREES.values() for n in ast.walk(tree) if isinstance(n, imports)}
    local = {n for _, f in _functions() for n in ast.walk(f) if isinstance(n, imports)}
    assert len(every) > 2000
    assert len(local) < 0.06 * len(every), f"{len(local)} of {len(every)}"
