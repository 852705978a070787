"""A drawing that is refused is drawn with its places marked, wherever something of it was read."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from drawings import bare, drawing
from wedmcam import api
from wedmcam.cli.main import cli
from wedmcam.options import WrongUse


def crossing(doc, msp):
    msp.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True)
    msp.add_circle((40, 10), 3)


def branching(doc, msp):
    crossing(doc, msp)
    msp.add_line((0, 0), (10, 10))


def opened(doc, msp):
    msp.add_lwpolyline([(0, 0), (40, 0), (40, 20)])


def narrow(doc, msp):
    msp.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True)
    msp.add_circle((20, 10), 0.05)


def filled(doc, msp):
    msp.add_circle((10, 10), 3)
    msp.add_hatch().paths.add_polyline_path([(0, 0), (40, 0), (40, 20), (0, 20)])


def tilted(doc, msp):
    crossing(doc, msp)
    msp.add_circle((5, 0), 2, dxfattribs={"extrusion": (0.3, 0, 0.95)})


REFUSED = {f.__name__: f for f in (crossing, branching, opened, narrow, filled, tilted)}


def run(*arguments: str):
    return CliRunner().invoke(cli, list(arguments), standalone_mode=False)


@pytest.mark.parametrize("draw", REFUSED.values(), ids=REFUSED)
@pytest.mark.parametrize("ending", ["svg", "png", "html"])
@pytest.mark.parametrize(
    "command",
    [
        "plot {0} -o {1}",
        "check {0} --plot {1}",
        "compile {0} -o {2} --plot {1}",
        "compile {0} -o {2} --to 3b,iso --plot {1}",
        "compile {0} -o {2} --split --plot {1}",
    ],
)
def test_field_plot_crossing(draw, ending, command, tmp_path):
    if ending != "svg" and draw is not crossing:
        return
    source, picture = tmp_path / "p.dxf", tmp_path / f"x.{ending}"
    source.write_bytes(drawing(draw))
    words = command.format(source, picture, tmp_path / "p.3b").split()
    result = run(*words, "--offset", "0.1")
    assert result.return_value == 1, result.output
    data = picture.read_bytes()
    assert "shows what was read, with the places marked" in result.output
    assert not (tmp_path / "p.3b").exists()
    if ending == "svg":
        assert b'id="read"' in data
        assert draw is tilted or data.count(b"<circle") >= 2  # a ring, and one in the legend
        assert (b'id="not-read"' in data) == (draw is filled)


@pytest.mark.parametrize("draw", [crossing, branching, filled, tilted])
def test_contours_alone_are_drawn_likewise(draw, tmp_path):
    source, picture = tmp_path / "p.dxf", tmp_path / "x.svg"
    source.write_bytes(drawing(draw))
    result = run("plot", str(source), "-o", str(picture), "--contours")
    assert result.return_value == 1, result.output
    assert b'id="read"' in picture.read_bytes()


def test_places_have_the_numbers_of_the_list():
    made = api.compile(drawing(crossing), offset=0.1)
    svg = api.plot(made, "p.dxf")
    (found,) = [d for d in made.findings if d.points_mm]
    assert "crossing-contours (40, 7)" in svg
    assert svg.count(f"error: {found.message}") == len(found.points_mm)


def test_places_lie_where_a_transform_puts_them():
    made = api.compile(drawing(branching), offset=0.1, transforms=("move (100, 0)",))
    assert not made.ok
    assert "refused" in api.plot(made)


def test_a_finding_without_a_place_has_that_of_its_entity():
    data = drawing(lambda d, m: [crossing(d, m), m.add_lwpolyline([(0, 0, 1e6), (9, 0, 0)], "xyb")])
    made = api.compile(data, offset=0.1)
    assert "bad-bulge" in [d.code for d in made.findings]
    assert 'id="read"' in api.plot(made)


def test_without_units_a_drawing_is_drawn_in_its_units():
    made = api.compile(bare("0 LINE 8 0 10 0 20 0 11 80 21 40", header=""), offset=0.1)
    svg = api.plot(made)
    assert "1 unit shown as 1 mm" in svg
    assert ">80.000</text>" in svg


def test_where_nothing_was_read_that_is_said(tmp_path):
    for name, data in (("no.dxf", b"hello\n"), ("empty.dxf", drawing(lambda d, m: None))):
        (tmp_path / name).write_bytes(data)
        for words in (["plot", "-o"], ["check", "--plot"]):
            picture = tmp_path / "x.svg"
            result = run(words[0], str(tmp_path / name), words[1], str(picture))
            assert result.return_value == 1
            assert "no picture was written: " in result.output
            assert not picture.exists()
        made = api.compile(data)
        with pytest.raises(WrongUse):
            api.plot(made)


def test_strict_refusals_are_drawn_too(tmp_path):
    (tmp_path / "p.dxf").write_bytes(drawing(lambda d, m: m.add_circle((0, 0), 5)))
    result = run("plot", str(tmp_path / "p.dxf"), "-o", str(tmp_path / "x.svg"), "--strict")
    assert result.return_value == 1
    assert (tmp_path / "x.svg").exists()


def test_a_program_that_is_refused_is_drawn_as_it_was_read(tmp_path):
    program = tmp_path / "g.nc"
    program.write_text("G90 G21\nG42 D1 G01 X1. Y0.\nX10.\nY10.\nX0.\nG40 Y0.\nM02\n")
    picture = tmp_path / "g.svg"
    arguments = ["plot", str(program), "-o", str(picture), "--d", "1=2mm"]
    result = run(*arguments)
    assert result.return_value == 1
    assert "error[compensation-lead]" in result.output
    assert "shows what was read, with the places marked" in result.output
    assert "Wire path of 5 cutting blocks" in picture.read_text()
