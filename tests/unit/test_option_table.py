"""The table of options: each field has a row, and each row reaches whoever can ask for it."""

import ast
import json
from dataclasses import fields
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

import wedmcam
from wedmcam.cli.main import cli
from wedmcam.cli.options import options_of
from wedmcam.cli.settings.keys import COMMANDS, known_options
from wedmcam.diag.run import WrongUse
from wedmcam.ir.choices import Order, Side
from wedmcam.option_table import ROWS, Kind, field_rows
from wedmcam.options import GROUPS, Options, options_in_mm

PACKAGE = Path(wedmcam.__file__).parent
#: Names in certificates: whoever renames one cannot prove what was issued before.
ISSUED = """
    units fill_in_units layers ignore_layers types ignore_types linetypes ignore_linetypes colours
    ignore_colours join_um tolerance_um thin_wall_um transforms offset_um side layer_sides
    layer_offsets clearance_um clearance_on corner_um paper sharp trim starts_um lead_um stop_um
    overcut_um order reverse count strict source defines arithmetic cuts blocks from_block backwards
    d feed_um units_in whole_in coordinates_in centres_in semicolon_in subprograms_in
""".split()
#: A value of each field: of the field, in mm, and as it is typed.
SAMPLES = {
    "units": ("inch", "inch", ["--units", "inch"]),
    "fill_in_units": (True, True, None),
    "join_um": (20.0, 0.02, ["--join", "0.02"]),
    "tolerance_um": (2.0, 0.002, ["--tolerance", "2um"]),
    "thin_wall_um": (0.0, 0, ["--thin-wall", "0"]),
    "offset_um": (100.0, 0.1, ["--offset", "0.1"]),
    "side": (Side.ON, "on", ["--side", "on"]),
    "layer_sides": ((("A", Side.ON),), {"A": "on"}, ["--layer-side", "A=on"]),
    "layer_offsets": ((("A", 120.0),), {"A": 0.12}, ["--layer-offset", "A=0.12"]),
    "clearance_um": (0.0, 0, ["--clearance", "0"]),
    "clearance_on": ("punch", "punch", ["--clearance-on", "punch"]),
    "corner_um": (200.0, 0.2, ["--corner", "0.2"]),
    "paper": (True, True, ["--corners", "paper"]),
    "sharp": (True, True, ["--convex", "sharp"]),
    "trim": (True, True, ["--on-interference", "trim"]),
    "starts_um": (((1000.0, -2e3),), [(1, -2)], ["--start", "1,-2"]),
    "lead_um": (500.0, 0.5, ["--lead", "0.5"]),
    "stop_um": (2000.0, 2.0, ["--stop", "2"]),
    "overcut_um": (700.0, 0.7, ["--overcut", "0.7"]),
    "order": (Order.NEAREST, "nearest", ["--order", "nearest"]),
    "reverse": (True, True, ["--reverse"]),
    "count": ("textbook", "textbook", ["--count", "textbook"]),
    "strict": (True, True, ["--strict"]),
    "source": ("wed", "wed", ["--from", "wed"]),
    "transforms": (("rotate 10",), ["rotate 10"], ["--transform", "rotate 10"]),
    "defines": (("a=1",), ["a=1"], ["-D", "a=1"]),
    "arithmetic": ("float64", "float64", ["--arithmetic", "float64"]),
    "cuts": ((2, 5), (2, 5), ["--cuts", "2-5"]),
    "blocks": ((1, 480), (1, 480), ["--blocks", "1-480"]),
    "from_block": (7, 7, ["--from-block", "7"]),
    "backwards": (False, False, ["--no-backwards"]),  # alone it has no sense
    "d": (((1, 100.0),), [(1, 100.0)], ["--d", "1=0.1"]),
    "feed_um": (2500.0, 2.5, ["--feed", "2.5"]),
    "units_in": ("inch", "inch", ["--units-in", "inch"]),
    "whole_in": ("10um", "10um", ["--whole-in", "10um"]),
    "coordinates_in": ("absolute", "absolute", ["--coordinates-in", "absolute"]),
    "centres_in": ("to-start", "to-start", ["--centres-in", "to-start"]),
    "semicolon_in": ("comment", "comment", ["--semicolon-in", "comment"]),
    "subprograms_in": ("O-number", "O-number", ["--subprograms-in", "o-number"]),
    "colours": (("red",), ["red"], ["--color", "red"]),
    "ignore_colours": (("#ff0000",), ["#ff0000"], ["--ignore-colour", "#ff0000"]),
    **{
        f"{prefix}{name}s".replace("-", "_"): (("X",), ["X"], [f"--{prefix}{name}", "X"])
        for name in ("layer", "type", "linetype")
        for prefix in ("", "ignore-")
    },
}


def command_of(name):
    command = cli.get_command(click.Context(cli), name)
    assert command is not None
    return command


def typed(*words):
    """Return the options of what is typed for the one command that takes them all."""
    command = command_of("verify")
    with command.make_context("verify", ["x.3b", *words]) as context:
        return options_of(dict(context.params))


def test_every_field_of_every_group_has_a_row_and_every_row_a_field():
    at = {(name, f.name) for name, group in GROUPS.items() for f in fields(group)}
    own = {("", f.name) for f in fields(Options)} - {("", name) for name in GROUPS}
    assert {(row.group, row.name) for row in field_rows()} == at | own - {("", "wishes")}
    assert {type(getattr(Options(), name)) for name in GROUPS} == set(GROUPS.values())


def test_names_in_certificates_are_those_that_were_issued():
    assert sorted(row.name for row in field_rows()) == sorted(ISSUED)


@pytest.mark.parametrize("name", ROWS)
def test_a_row_reaches_the_command_line_or_says_why_not(name):
    row = ROWS[name]
    offered = [
        option
        for command in COMMANDS
        for option in command_of(command).params
        if isinstance(option, click.Option) and row.option and row.option in option.opts
    ]
    assert bool(offered) == (row.panel is not None) == (not row.unoffered)
    assert {option.name for option in offered} <= {row.param}
    if row.option.startswith("--"):
        assert row.option.removeprefix("--") in known_options(cli)
    if row.fills:
        assert ROWS[row.fills].group is not None


@pytest.mark.parametrize("name", [row.name for row in field_rows()])
def test_a_field_is_the_same_however_it_is_stated(name):
    value, mm, words = SAMPLES[name]
    options = Options.of(**{name: value})
    row = ROWS[name]
    assert options.value(row) == value
    assert options_in_mm(**{row.keyword: mm}) == options
    assert Options.from_data(json.loads(json.dumps(options.as_data()))) == options
    assert set(options.as_data()) == ({name} if value != row.usual else set())
    if words is not None:
        assert typed(*words) == options


def test_what_nobody_states_is_the_same_everywhere():
    assert typed() == Options.of() == options_in_mm() == Options() == Options.from_data({})
    assert Options().as_data() == {}
    assert all(Options().value(row) == row.usual for row in field_rows())


def test_options_are_replaced_by_their_fields():
    options = Options.of(offset_um=100.0, wishes=frozenset({"offset_um"}))
    other = options.with_values(lead_um=500.0, strict=True, arithmetic="float64")
    assert (other.leading.lead_um, other.judging.strict) == (500.0, True)
    assert (other.arithmetic, other.cutting, other.wished) == (
        "float64",
        options.cutting,
        {"offset_um"},
    )


def test_only_the_shell_and_the_compiler_take_options_whole():
    """A stage takes its groups; whoever makes options anew is of `operations` or `compiler`."""
    whole = {"compiler", "operations", "batch", "cli", "options.py"}
    for path in sorted(PACKAGE.rglob("*.py")):
        room = path.relative_to(PACKAGE).parts[0]
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.arg) and node.annotation is not None:
                taken = {n.id for n in ast.walk(node.annotation) if isinstance(n, ast.Name)}
                assert "Options" not in taken or room in whole, f"{path}:{node.lineno}"
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args:
                replaced = node.func.id == "replace" and ast.unparse(node.args[0]) == "options"
                assert not replaced or room in {"compiler", "operations"}, f"{path}:{node.lineno}"


def test_inspect_takes_what_says_how_a_source_is_read(tmp_path):
    (tmp_path / "part.txt").write_text(
        'part "p"\nlet r = 5\ncontour c { circle center (0, 0) radius r }\n'
        "cut c inside offset 0.1\n"
    )
    words = ["inspect", str(tmp_path / "part.txt"), "--from", "wed", "-D", "r=3", "--json"]
    done = CliRunner().invoke(cli, words)
    assert not done.stderr
    assert json.loads(done.stdout)["size_mm"] == [6.0, 6.0]


def test_inspect_takes_a_side_without_an_offset():
    """The largest one is what it looks for; a path on that side needs one."""
    drawing = str(PACKAGE.parents[1] / "samples/plate.dxf")
    for words in (["--side", "die"], ["--side", "die", "--layer-side", "CUT=die"]):
        done = CliRunner().invoke(cli, ["inspect", drawing, "--json", *words])
        assert json.loads(done.stdout)["largest_offset"]["side"] == "die"
    for mm in ({"side": "on"}, {"layer_sides": {"CUT": "on"}}):
        assert wedmcam.inspect(drawing, **mm).status == 0
    with pytest.raises(WrongUse, match="--side die needs an offset"):
        Options.of(side=Side.DIE)
    with pytest.raises(WrongUse, match="--layer-side A=die needs an offset"):
        options_in_mm(layer_sides={"A": "die"})


def test_what_is_usual_can_be_asked_for():
    for row in ROWS.values():
        if row.kind is Kind.LENGTH:
            assert row.usual is None or row.takes.holds(row.usual), row.name
        elif row.kind is Kind.WORD and row.words:
            assert row.usual in (None, *row.words), row.name


def test_messages_name_options_that_exist():
    assert [ROWS[name].typed for name in ("sharp", "trim", "fill_in_units")] == [
        "--convex",
        "--on-interference",
        "fill_in_units",
    ]
    with pytest.raises(WrongUse, match="--convex takes true or false"):
        Options.of(sharp=1)
