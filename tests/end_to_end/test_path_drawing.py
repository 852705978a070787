"""The path of a program as a DXF: read again it is the same path, and makes the same program."""

from pathlib import Path

import ezdxf
import numpy as np
import pytest
from click.testing import CliRunner

from wedmcam import api
from wedmcam.cli.main import cli
from wedmcam.ir.plan import Order
from wedmcam.options import Options

ROOT = Path(__file__).parents[2]
#: Counted otherwise; and threaded in the centre of a ring, where every start is as near.
OTHER = {"gear-24.textbook.3b", "stator-36.3b", "stator-36.wed.3b", "stator-90.wed.3b"}
GOLDEN = sorted({p.name for p in (ROOT / "tests/golden").glob("*.3b")} - OTHER)
GOLDEN += ["plate.zd", "key-punch.zd"]


def drawing_of(name: str) -> tuple[bytes, bytes]:
    data = (ROOT / "tests/golden" / name).read_bytes()
    program, machine, _ = api.read_program(data, name=name)
    assert program is not None
    return data, api.path_drawing(program, machine)


@pytest.mark.parametrize("name", GOLDEN)
def test_a_drawn_path_makes_the_same_program(name: str) -> None:
    data, drawing = drawing_of(name)
    # Contours are drawn in the order in which they are cut; a part program's need not be ours.
    options = Options.of(layers=("CUT", "START"), join_um=1.5, order=Order.GIVEN)
    again = api.compile(drawing, name="path.dxf", options=options)
    assert again.ok, [str(d) for d in again.findings]
    assert again.data is not None
    # The stairs of two arcs through the same microns lie to either side of the true arc.
    told, _ = api.diff(data, again.data, names=(name, "again.3b"), within_mm=0.002)
    assert told is not None
    assert told.equal, told


@pytest.mark.parametrize("name", ["plate.3b", "stator-36.3b", "cam.zd"])
def test_neighbours_meet_to_a_nanometre(name: str) -> None:
    _, drawing = drawing_of(name)
    import io

    read = ezdxf.read(io.StringIO(drawing.decode("cp1252")))
    assert read.header["$INSUNITS"] == 4
    ends = []
    for e in read.modelspace().query("LINE ARC"):
        places = (e.dxf.start, e.dxf.end) if e.dxftype() == "LINE" else (e.start_point, e.end_point)
        ends += [(1000 * p.x, 1000 * p.y) for p in places]
    ends = np.array(ends)
    assert np.abs(ends - np.round(ends)).max() < 1e-3


def test_the_same_bytes_without_a_date() -> None:
    one, two = drawing_of("plate.3b")[1], drawing_of("plate.3b")[1]
    assert one == two
    assert b"2026" not in one


def test_leads_overcut_stops_and_moves_have_their_layers(tmp_path: Path) -> None:
    made = api.compile(
        ROOT / "samples/plate.dxf", options=Options.of(offset_um=100, stop_um=2000, overcut_um=700)
    )
    assert made.ok
    assert made.program is not None
    drawing = api.path_drawing(made.program, made.machine)
    import io

    found = ezdxf.read(io.StringIO(drawing.decode("cp1252"))).modelspace()
    count = {layer: len(found.query(f'*[layer=="{layer}"]')) for layer in ("START", "STOP", "MOVE")}
    assert count == {"START": 10, "STOP": 10, "MOVE": 9}
    assert len(found.query('*[layer=="LEAD"]')) == 20
    assert len(found.query('*[layer=="OVERCUT"]')) >= 20


def test_compile_and_plot_write_dxf(tmp_path: Path) -> None:
    run = CliRunner().invoke
    sample = str(ROOT / "samples/plate.dxf")
    path, program, other = (str(tmp_path / n) for n in ("path.dxf", "p.3b", "plot.dxf"))
    assert run(cli, ["compile", sample, "-o", path, "--offset", "0.1"]).exit_code == 0
    assert run(cli, ["compile", sample, "-o", program, "--offset", "0.1"]).exit_code == 0
    assert run(cli, ["plot", program, "-o", other]).exit_code == 0
    asked = ["compile", path, "-o", str(tmp_path / "q.3b"), "--side", "on"]
    asked += ["--layer", "CUT", "--layer", "START"]
    done = run(cli, asked)
    assert done.exit_code == 0, done.output
    assert run(cli, ["diff", program, str(tmp_path / "q.3b"), "--within", "2um"]).exit_code == 0
    assert run(cli, ["plot", sample, "--contours", "-o", other]).exit_code == 2


def test_pauses_between_contours_are_drawn(tmp_path: Path) -> None:
    """Of two pauses before a move one threads the wire; the other is the program's own."""
    program = tmp_path / "q.3b"
    program.write_text("B1000B0B1000GXL1\nD\nD\nB0B1000B1000GYL2\nD\nB5B0B5GXL1\nDD\n")
    made = CliRunner().invoke(cli, ["convert", str(program), "-o", str(tmp_path / "q.dxf")])
    assert made.exit_code == 0, made.output
    points = ezdxf.readfile(tmp_path / "q.dxf").modelspace().query("POINT[layer=='STOP']")
    assert [tuple(p.dxf.location)[:2] for p in points] == [(1.0, 0.0)]
