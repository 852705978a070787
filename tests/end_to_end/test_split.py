"""A program over the memory is written as several, each proven, cut where the wire is cut."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from wedmcam import api, machines
from wedmcam.cli.main import cli
from wedmcam.operations import split as loads
from wedmcam.options import Options

PLATE = Path(__file__).parents[2] / "samples/plate.dxf"


def small(format_: str, most: int) -> machines.Machine:
    machine = machines.default(format_)
    key = "blocks" if format_ == "3b" else "memory_bytes"
    return replace(machine, limits=replace(machine.limits, **{key: most}))


@pytest.mark.parametrize(("format_", "most"), [("3b", 30), ("3b", 12), ("compact", 200)])
def test_loads_fit_and_cut_everything_once(format_: str, most: int) -> None:
    machine = small(format_, most)
    options = Options.of(offset_um=100.0)
    whole = api.compile(PLATE, profile=machine, options=options)
    assert any(d.code == "over-memory" for d in whole.findings)
    made = loads.compile_loads(PLATE, profile=machine, options=options, output_name="a.x")
    assert len(made) > 1
    assert whole.plan is not None
    cuts = []
    for load in made:
        assert load.ok
        assert load.data is not None
        assert load.plan is not None
        cuts += [c.number for c in load.plan.cuts]
        alone = len(load.plan.cuts) == 1
        assert alone or not any(d.code == "over-memory" for d in load.findings)
        if format_ == "compact" and not alone:
            assert len(load.data) <= most
    assert cuts == [c.number for c in whole.plan.cuts]
    starts = [load["start_um"] for load in loads.moves(made)]
    assert starts == [list(load.plan.cuts[0].thread) for load in made[1:] if load.plan]


def test_files_are_numbered_and_each_can_be_verified(tmp_path: Path) -> None:
    run = CliRunner().invoke
    text = machines.text("b3-compact").replace("[words]", "blocks = 30\n\n[words]")
    profile = tmp_path / "small.toml"
    profile.write_text(text)
    out, proof = tmp_path / "plate.3b", tmp_path / "proof.json"
    ask = ["compile", str(PLATE), "-o", str(out), "--offset", "0.1", "--profile", str(profile)]
    done = run(cli, [*ask, "--split", "--certificate", str(proof), "--json"])
    assert done.exit_code == 0, done.output
    assert "to the thread point" in done.output
    made = sorted(p.name for p in tmp_path.glob("plate-*.3b"))
    assert made == [f"plate-{k}.3b" for k in range(1, len(made) + 1)]
    assert len(made) > 1
    assert not out.exists()
    certificate = tmp_path / "proof-2.json"
    assert json.loads(certificate.read_text())["options"]["cuts"]
    again = run(cli, ["verify", str(tmp_path / "plate-2.3b"), "--certificate", str(certificate)])
    assert again.exit_code == 0, again.output
    wide = ["compile", str(PLATE), "-o", str(out), "--offset", "0.1", "--split"]
    assert run(cli, wide).exit_code == 0
    assert out.exists()
    assert run(cli, [*wide[:3], "-", *wide[4:], "--to", "3b"]).exit_code == 2


def test_what_from_block_leaves_is_not_split(tmp_path):
    drawing = Path(__file__).parents[2] / "samples" / "plate.dxf"
    line = ["compile", str(drawing), "-o", str(tmp_path / "a.3b"), "--offset", "0.1"]
    done = CliRunner().invoke(cli, [*line, "--split", "--from-block", "9"])
    assert done.exit_code == 2
    assert "--from-block" in done.output
