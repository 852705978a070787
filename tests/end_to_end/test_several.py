"""``compile --to 3b,compact``: one source, several programs, one path; all of them or none."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from test_cli_programs import run, status

from wedmcam import api
from wedmcam.formats.names import SUFFIX_OF_FORMAT
from wedmcam.frontends import DECODERS
from wedmcam.ir.program import Kind
from wedmcam.judge.difference import difference
from wedmcam.machines import builtin, default
from wedmcam.operations import convert
from wedmcam.operations.together import compile_several
from wedmcam.options import Options

ROOT = Path(__file__).parents[2]
SAMPLES = sorted((ROOT / "samples").glob("*.dxf"))
#: Formats that hold the path itself, in um. The others make it of a figure, or have larger steps.
FORMATS = [f for f in DECODERS if f not in ("rotation", "compensation", "4b", "nby15", "dem15")]


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda p: p.stem)
def test_every_format_of_a_sample_is_the_same_path(sample):
    options = {"offset": 0.1} | ({"units": "mm"} if sample.stem == "damaged" else {})
    from wedmcam.api import options_in_mm

    machines = [default(f) for f in FORMATS]
    made = compile_several(sample, machines, options=options_in_mm(**options))
    assert made.ok, made.findings
    assert max(made.apart_um) <= 1.0
    # ... and each is what `convert` makes of the first, or steps like it.
    first = made.compilations[0]
    for one in made.compilations[1:]:
        again = convert.convert(first.data, to=one.machine.format, format="3b")
        assert again.ok
        tables = [m.own_stepping for m in (one.machine, again.machine)]
        assert difference(one.program, again.program_out, *tables).equal
    cuts = {int((m.program.blocks["kind"] == Kind.MOVE).sum()) for m in made.compilations}
    assert len(cuts) == 1


@pytest.mark.parametrize("formats", ["3b,nby15", "3b,dem15", "nby15,dem15"])
def test_a_coarse_path_lies_beside_the_others_within_both_deviations(formats):
    """Each is proven against the plan: two paths are apart by what both are off at most."""
    from wedmcam.api import options_in_mm

    machines = [default(f) for f in formats.split(",")]
    sample = ROOT / "samples" / "key-punch.dxf"
    made = compile_several(sample, machines, options=options_in_mm(offset=0.1))
    assert made.ok, made.findings
    most = sum(one.verdict.max_deviation_um for one in made.compilations)
    assert 0.5 < max(made.apart_um) <= most


def test_files_and_their_certificates(tmp_path):
    out, certificate = tmp_path / "plate.3b", tmp_path / "plate.json"
    result = run(
        "compile", ROOT / "samples" / "plate.dxf", "-o", out, "--offset", "0.1",
        "--to", "3b,compact", "--certificate", certificate, "--plot", tmp_path / "plate.svg",
        "--map", tmp_path / "map.json", "--json",
    )  # fmt: skip
    assert status(result) == 0, result.stderr
    assert {p.name for p in tmp_path.iterdir()} == {
        "plate.3b", "plate.zd", "plate.3b.json", "plate.zd.json", "plate.svg", "map.3b.json",
        "map.zd.json",
    }  # fmt: skip
    assert [row["format"] for row in json.loads(result.stdout)] == ["3b", "compact"]
    assert "the same path in 2 formats" in result.stderr
    for suffix in (".3b", ".zd"):
        issued = tmp_path / f"plate{suffix}.json"
        assert status(run("verify", tmp_path / f"plate{suffix}", "--certificate", issued)) == 0


def test_all_or_none(tmp_path):
    """The controller's gap wants tangent joints: the outline of the gear has corners."""
    (tmp_path / "plate.3b").write_bytes(b"as it was")
    result = run(
        "compile", ROOT / "samples" / "gear-24.dxf", "-o", tmp_path / "plate", "--offset", "0.1",
        "--to", "3b,compensation",
    )  # fmt: skip
    assert status(result) == 1
    assert "not-tangent" in result.stderr
    assert (tmp_path / "plate.3b").read_bytes() == b"as it was"
    assert len(list(tmp_path.iterdir())) == 1


def test_a_program_that_differs_is_refused(monkeypatch):
    """Both proofs pass; that the two are one path is asked on its own."""
    from wedmcam.judge.difference import Difference
    from wedmcam.operations import together as several

    monkeypatch.setattr(several, "WITHIN_UM", 0.0)
    made = compile_several(SAMPLES[1], [default("3b"), default("compact")])
    assert isinstance(made.apart_um[0], float)
    assert issubclass(Difference, tuple)
    assert (made.ok, made.status) == (False, 3)
    assert made.differs[0].code == "conversion-differs"


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--to", "3b,gerber"], "no program format is called 'gerber'"),
        (["--to", "3b,compact", "--split"], "--split takes one format"),
        (["--to", "3b,3b"], "names a format twice"),
        (["--to", "3b,compact", "--profile", "zd065-rotation"], "is for rotation, not for"),
    ],
)
def test_wrong_use(more, said, tmp_path):
    result = run("compile", SAMPLES[0], "-o", tmp_path / "a", "--offset", "0.1", *more)
    assert status(result) == 2
    assert said in str(result.exception) + result.stderr


def test_suffixes_tell_formats():
    assert set(SUFFIX_OF_FORMAT) == set(DECODERS)


@pytest.mark.parametrize(
    "name", ["plate", "key-punch", "bracket-inch", "cam", "damaged", "gear-24"]
)
def test_the_controllers_own_path_is_the_same_too(name):
    """Outlines start elsewhere for a controller that offsets them; then all programs do."""
    from wedmcam.api import options_in_mm
    from wedmcam.machines import builtin

    options = {"offset": 0.1} | ({"units": "mm"} if name == "damaged" else {})
    machines = [default("3b"), builtin("iso-g41-mm")]
    made = compile_several(
        ROOT / "samples" / f"{name}.dxf", machines, options=options_in_mm(**options)
    )
    assert made.ok, made.findings
    assert max(made.apart_um) <= 1.0


@pytest.mark.parametrize("profile", ["iso-g41", "iso-g41-mm"])
@pytest.mark.parametrize(
    "name", ["bracket-inch", "cam", "cover", "gear-24", "key-punch", "plate", "stator-36"]
)
def test_an_outline_in_g41_goes_with_the_path_in_3b(name, profile):
    """Starts are placed once; a controller that makes its path is held to the plan."""
    machines = [builtin("b3-compact"), builtin(profile)]
    both = compile_several(
        ROOT / "samples" / f"{name}.dxf", machines, options=Options.of(offset_um=100.0)
    )
    assert both.ok, [d.message for d in both.findings]
    threads = [[c.thread for c in one.plan.cuts] for one in both.compilations]
    assert threads[0] == threads[1]
    for one in both.compilations:  # the certificate of each says whose starts the plan has
        proof = api.verify(
            one.data,
            against=ROOT / "samples" / f"{name}.dxf",
            against_name=one.summary["input"],
            certificate=one.summary,
            options=Options.from_data(one.summary["options"]),
            name="a.3b" if one is both.compilations[0] else "a.nc",
        )
        assert proof.ok, [d.message for d in proof.findings]
    proofs = sum(one.verdict.max_deviation_um for one in both.compilations)
    assert max(both.apart_um) <= max(1.0, proofs)
