"""Import directions: the table of ARCHITECTURE.md, enforced."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from wedmcam.machines import Machine

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "wedmcam"
SHELL = {"__init__", "__main__", "cli"}


def _table() -> dict[str, tuple[set[str], set[str]]]:
    """Layer -> (ours it may import, third parties), from the table in ARCHITECTURE.md."""
    table = {}
    for line in (ROOT / "ARCHITECTURE.md").read_text("utf-8").splitlines():
        cells = [c.strip() for c in line.strip().strip("|").split("|")]
        if len(cells) == 3 and re.fullmatch(r"(`\w+`(, )?)+", cells[0]):
            ours, others = (set(re.findall(r"`(\w+)`", c)) for c in cells[1:])
            for layer in re.findall(r"`(\w+)`", cells[0]):
                table[layer] = (ours, others)
    return table


TABLE = _table()


def _imports():
    for path in sorted(PACKAGE.rglob("*.py")):
        here = path.relative_to(PACKAGE).with_suffix("").parts
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                assert not node.level, f"{path}: relative import"
                names = [node.module]
                if node.module == "wedmcam":
                    names = [f"wedmcam.{a.name}" for a in node.names if a.name != "__version__"]
            elif isinstance(node, ast.Import):
                names = [a.name for a in node.names]
            else:
                continue
            for name in names:
                yield here, name


EDGES = sorted({(h[0], n.split(".")[1]) for h, n in _imports() if n.startswith("wedmcam.")})
STANDARD = sys.stdlib_module_names | {"wedmcam", "__future__"}
THIRD = sorted({(h[0], n.split(".")[0]) for h, n in _imports() if n.split(".")[0] not in STANDARD})


def test_the_table_names_every_layer():
    layers = {
        p.stem for p in PACKAGE.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists()
    }
    assert layers - SHELL == set(TABLE)


@pytest.mark.parametrize(("layer", "target"), EDGES)
def test_import_direction(layer, target):
    assert layer in SHELL or target == layer or target in TABLE[layer][0]


@pytest.mark.parametrize(("layer", "library"), THIRD)
def test_third_party(layer, library):
    allowed = TABLE[layer][1] if layer in TABLE else {"numpy", "click", "resvg_py", "rich"}
    assert library in allowed


def test_the_judge_shares_no_geometry():
    ours = TABLE["judge"][0]
    assert not ours & {"geom", "transforms", "backends", "arithmetic", "options"}


def test_the_core_is_pure():
    """Only the shell opens files, prints, exits or looks at the environment."""
    allowed = {"cli", "__main__", "files"}
    for path in sorted(PACKAGE.rglob("*.py")):
        layer = path.relative_to(PACKAGE).with_suffix("").parts[0]
        if layer in allowed:
            continue
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in {"open", "print", "input", "exit"}, path
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                assert (node.value.id, node.attr) not in {("os", "environ"), ("sys", "exit")}, path


#: Rooms that may ask of which kind a machine is.
KINDS_ROOMS = {"machines", "targets", "formats"}


def _trees():
    for path in sorted(PACKAGE.rglob("*.py")):
        yield path.relative_to(PACKAGE), ast.walk(ast.parse(path.read_text("utf-8")))


def test_only_targets_ask_what_kind_a_machine_is():
    """`identify` may compare the format that it found; others take a target and ask it."""
    assert not {"gapped", "offsets", "binary"} & set(dir(Machine))
    for path, nodes in _trees():
        if path.parts[0] in KINDS_ROOMS:
            continue
        for node in nodes:
            if isinstance(node, ast.Compare):
                for side in (node.left, *node.comparators):
                    if isinstance(side, ast.Attribute) and side.attr == "format":
                        found = isinstance(side.value, ast.Name) and side.value.id == "seen"
                        assert found or path.name == "identify.py", f"{path}:{node.lineno}"


def test_line_tables_are_made_where_controllers_are():
    for path, nodes in _trees():
        if path.parts[0] in {"controllers", "machines"}:
            continue
        for node in nodes:
            if isinstance(node, ast.Call):
                name = node.func.id if isinstance(node.func, ast.Name) else ""
                assert name != "LineTable", f"{path}:{node.lineno}"


def _wedmcam_imports(module, seen):
    """Add to ``seen`` what a module imports of ours, and what that imports, at any level."""
    if module in seen:
        return
    base = ROOT / "src" / Path(*module.split("."))
    path = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
    if not path.exists():
        return
    seen.add(module)
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for name in (node.module, *(f"{node.module}.{a.name}" for a in node.names)):
                _wedmcam_imports(name, seen)


def test_what_a_controller_makes_of_g41_shares_nothing_with_what_makes_programs():
    """The judge holds G41 programs to that path: the model is the target's alone."""
    forbidden = {"geom", "transforms", "backends", "arithmetic"}
    seen: set[str] = set()
    _wedmcam_imports("wedmcam.controllers.offsetting", seen)
    assert "wedmcam.controllers.offsetting.path" in seen
    assert not {name for name in seen if name.split(".")[1] in forbidden - {"geom"}}, seen
    for path in [
        PACKAGE / "targets" / "g41" / "read.py",
        *(PACKAGE / "controllers" / "offsetting").glob("*.py"),
    ]:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("wedmcam."):
                assert node.module.split(".")[1] not in forbidden, path


def test_reading_g41_loads_nothing_that_makes_programs():
    text = "G91\\nG41 D1 G01 X500\\nG01 Y500\\nG40\\nM02\\n"
    code = (
        "import sys\n"
        "from wedmcam.machines import builtin\n"
        "from wedmcam.targets.g41.read import decode\n"
        f"program, findings = decode(b'{text}', builtin('iso-um'), 'x.nc', lambda number: 100.0)\n"
        "assert len(program.blocks) == 3 and not findings, findings\n"
        "makers = ('wedmcam.transforms', 'wedmcam.backends')\n"
        "print([name for name in sys.modules if name.startswith(makers)])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
