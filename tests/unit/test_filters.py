"""What is taken and left out by layer, type, line type and colour; and what drawings tell of it."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from drawings import codes, drawing, got
from wedmcam import api
from wedmcam.cli.main import cli
from wedmcam.diag import has_errors
from wedmcam.options import Options, WrongUse


def frame(msp, layer="0", **look):
    attributes = {"layer": layer, **look}
    msp.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True, dxfattribs=attributes)


def ring(msp, layer="0", at=(10, 10), **look):
    msp.add_circle(at, 3, dxfattribs={"layer": layer, **look})


def cut(data, **options):
    sketch, found = got(data, **options)
    return sorted(
        f"{kind} {layer}" for kind, of in sketch.info.entities.items() for layer in of
    ), found


# --- names before wildcards -------------------------------------------------------------------


@pytest.mark.parametrize("name", ["CUT[1]", "A*", "A?", "[AB]", "a*"])
@pytest.mark.parametrize("nested", [False, True])
def test_field_layer_brackets(name, nested):
    def draw(doc, msp):
        to = doc.blocks.new("B") if nested else msp
        frame(to, "NAMED")
        ring(to, "AB")
        ring(to, "CUT1", (30, 10))
        ring(to, "A", (30, 10))
        if nested:
            msp.add_blockref("B", (0, 0))

    data = drawing(draw).replace(b"NAMED", name.encode())  # ezdxf writes no such names
    assert cut(data, layers=(name,))[0] == [f"LWPOLYLINE {name}"]
    assert cut(data, ignore_layers=(name.lower(),))[0] == ["CIRCLE A", "CIRCLE AB", "CIRCLE CUT1"]


def test_a_pattern_is_one_where_no_name_is_it():
    def draw(doc, msp):
        for layer in ("CUT1", "CUT2", "X"):
            ring(msp, layer)

    data = drawing(draw)
    assert cut(data, layers=("cut[12]",))[0] == ["CIRCLE CUT1", "CIRCLE CUT2"]
    assert cut(data, layers=("CUT?",))[0] == ["CIRCLE CUT1", "CIRCLE CUT2"]


@pytest.mark.parametrize(
    ("options", "near"),
    [
        ({"ignore_layers": ("DIMM",)}, "did you mean DIM?"),
        ({"ignore_types": ("CIRCEL",)}, "did you mean CIRCLE?"),
        ({"ignore_linetypes": ("CENTR",)}, "did you mean CENTER?"),
        ({"ignore_colours": ("red",)}, "there is white"),
        ({"layers": ("0", "CUT9")}, "there is"),
        ({"ignore_layers": ("Q*",)}, "there is"),
    ],
)
def test_a_name_that_matches_nothing_is_said(options, near):
    def draw(doc, msp):
        doc.layers.add("DIM")
        frame(msp)
        ring(msp, linetype="CENTER")

    found = cut(drawing(draw), **options)[1]
    (said,) = [d for d in found if d.code == "filter-unmatched"]
    assert near in said.hint
    assert str(said.severity) == "warning"
    # A default of a shop is for every part.
    assert "filter-unmatched" not in codes(cut(drawing(draw), wished=frozenset(), **options)[1])


# --- line types and colours -------------------------------------------------------------------


def test_field_centre_marks_linetype():
    def draw(doc, msp):
        doc.linetypes.add("CENTER", [1.0, 0.5, -0.5])
        frame(msp)
        msp.add_line((30, 10), (50, 10), dxfattribs={"linetype": "CENTER"})

    data = drawing(draw)
    made = api.compile(data, offset=0.1)
    assert not made.ok
    wrong = [d for d in made.findings if d.code == "crossing-contours"]
    assert "linetype CENTER" in str(wrong[0].span) + str(wrong[0].notes[0][1])
    assert "--ignore-linetype CENTER" in wrong[0].hint
    made = api.compile(data, offset=0.1, ignore_linetypes=("center",))
    assert made.ok
    assert made.summary["options"]["ignore_linetypes"] == ("center",)
    assert "look-left-out" in codes(made.findings)
    again = api.verify(made.data, against=data, certificate=made.summary, options=made.options)
    assert again.ok


BLUE, RED = 5, 1


@pytest.mark.parametrize(
    ("entity", "insert", "layer", "seen"),
    [
        ({"color": RED}, {}, {}, "red"),
        ({"color": 256}, {}, {"color": RED}, "red"),
        ({}, {}, {"color": RED}, "red"),
        ({"color": 0}, {"color": RED}, {"color": BLUE}, "red"),
        ({"color": 0}, {}, {"color": RED}, "red"),
        ({"true_color": 0xFF0000}, {"color": BLUE}, {}, "red"),
        ({"true_color": 0x123456}, {}, {"color": RED}, "#123456"),
        ({"color": 12}, {}, {}, "12"),
    ],
)
def test_colours_are_those_that_are_seen(entity, insert, layer, seen):
    def draw(doc, msp):
        doc.layers.add("L", **layer)
        block = doc.blocks.new("B")
        ring(block, "L", **entity)
        msp.add_blockref("B", (0, 0), dxfattribs={"layer": "L", **insert})
        msp.add_circle((30, 10), 3, dxfattribs={"color": 3})

    data = drawing(draw)
    assert cut(data, colours=(seen,))[0] == ["CIRCLE L"]
    assert cut(data, ignore_colours=(seen,))[0] == ["CIRCLE 0"]
    assert cut(data, colours=("green",))[0] == ["CIRCLE 0"]


@pytest.mark.parametrize(
    ("entity", "insert", "layer"),
    [
        ({"linetype": "HIDDEN"}, {}, {}),
        ({}, {}, {"linetype": "HIDDEN"}),
        ({"linetype": "BYLAYER"}, {}, {"linetype": "HIDDEN"}),
        ({"linetype": "ByBlock"}, {"linetype": "HIDDEN"}, {}),
        ({"linetype": "BYBLOCK"}, {}, {"linetype": "HIDDEN"}),
    ],
)
def test_line_types_are_those_that_are_seen(entity, insert, layer):
    def draw(doc, msp):
        doc.linetypes.add("HIDDEN", [1.0, 0.5, -0.5])
        doc.layers.add("L", **layer)
        block = doc.blocks.new("B")
        ring(block, "L", **entity)
        msp.add_blockref("B", (0, 0), dxfattribs={"layer": "L", **insert})
        ring(msp, at=(30, 10))

    data = drawing(draw)
    assert cut(data, linetypes=("hid*",))[0] == ["CIRCLE L"]
    assert cut(data, ignore_linetypes=("HIDDEN",))[0] == ["CIRCLE 0"]
    assert cut(data, linetypes=("continuous",))[0] == ["CIRCLE 0"]


def test_thread_points_stay_where_something_is_taken():
    def draw(doc, msp):
        frame(msp, color=RED)
        msp.add_point((-5, 5), dxfattribs={"layer": "START"})

    for options in ({"colours": ("red",)}, {"types": ("LWPOLYLINE",)}, {"layers": ("0",)}):
        sketch, _ = got(drawing(draw), **options)
        assert len(sketch.thread_points) == 1
        assert len(sketch.segments) == 4


def test_type_takes_only_that_type_also_in_blocks():
    def draw(doc, msp):
        block = doc.blocks.new("B")
        ring(block)
        frame(block)
        msp.add_blockref("B", (0, 0))
        msp.add_text("x")

    names, found = cut(drawing(draw), types=("circle",))
    assert names == ["CIRCLE 0"]
    assert codes(found) == ["type-left-out"]


def test_a_hatch_of_a_colour_left_out_bounds_nothing():
    def draw(doc, msp):
        ring(msp)
        hatch = msp.add_hatch(color=RED)
        hatch.paths.add_polyline_path([(0, 0), (40, 0), (40, 20), (0, 20)])

    data = drawing(draw)
    assert not api.compile(data, offset=0.1).ok
    assert api.compile(data, offset=0.1, ignore_colours=("red",)).ok


def test_what_contradicts_itself_and_is_left_out_by_its_look_is_a_warning():
    from drawings import bare

    data = bare("0 LINE 8 0 10 0 20 0 11 9 21 0", "0 CIRCLE 8 0 62 1 10 5 20 5 40 2 40 3")
    assert has_errors(got(data)[1])
    assert not has_errors(got(data, ignore_colours=("1",))[1])


@pytest.mark.parametrize("text", ["pink", "0", "256", "#12345", "-1", ""])
def test_no_colour_is_wrong_use(text):
    with pytest.raises(WrongUse):
        Options.of(colours=(text,))


def test_options_on_the_command_line_and_in_the_settings(tmp_path):
    def draw(doc, msp):
        frame(msp)
        ring(msp, color=RED)

    (tmp_path / "p.dxf").write_bytes(drawing(draw))
    name = str(tmp_path / "p.dxf")
    for options in (["--ignore-colour", "red"], ["--ignore-color", "1"], ["--type", "LWPOLYLINE"]):
        for command in (["check", "--offset", "0.1"], ["inspect"]):
            result = CliRunner().invoke(
                cli, [command[0], name, *command[1:], *options, "--json"], standalone_mode=False
            )
            assert result.return_value == 0, result.output
            assert '"contours": 1' in result.output or '"closed": 1' in result.output
    (tmp_path / "wedmcam.toml").write_text('ignore-colour = ["red", "blue"]\noffset = 0.1\n')
    result = CliRunner().invoke(cli, ["check", name], standalone_mode=False)
    assert result.return_value == 0
    assert "contours   1 cut" in result.output
    assert "filter-unmatched" not in result.output
