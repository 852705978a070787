"""A program over the memory is written as several, each proven, cut where the wire is cut."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from wedmcam import api, machines
from wedmcam.cli.main import cli
from wedmcam.diag.run import WrongUse
from wedmcam.ir.program import Kind
from wedmcam.operations import split as loads
from wedmcam.options import Options

PLATE = Path(__file__).parents[2] / "samples/plate.dxf"
STATOR = PLATE.parent / "stator-36.dxf"  # one of its two contours is longer than 4,096 bytes
KEY = PLATE.parent / "key-punch.dxf"  # one contour of about 60 blocks


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
    cuts = {}
    for load in made:
        assert load.ok
        assert load.data is not None
        assert load.plan is not None
        cuts |= dict.fromkeys(c.number for c in load.plan.cuts)
        assert not any(d.code == "over-memory" for d in load.findings)
        if format_ == "compact":
            assert len(load.data) <= most
    assert list(cuts) == [c.number for c in whole.plan.cuts]
    cutting = [int((load.program.blocks["kind"] < 2).sum()) for load in made]
    assert sum(cutting) == int((whole.program.blocks["kind"] < 2).sum())
    for load, move in zip(made[1:], loads.moves(made), strict=True):
        if move["kerf"]:
            assert move["move_um"] == [0, 0]
        else:
            assert move["start_um"] == list(load.plan.cuts[0].thread)


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


# --- in the kerf ---------------------------------------------------------------------------------


def in_kerf(machine, drawing=KEY, **more):
    options = Options.of(offset_um=100.0, **more)
    whole = api.compile(drawing, profile=machine, options=options)
    made = loads.compile_loads(drawing, profile=machine, options=options, output_name="a.x")
    assert all(load.ok for load in made), [str(d) for load in made for d in load.findings]
    assert not any(d.code == "over-memory" for load in made for d in load.findings)
    return whole, made


def test_loads_in_the_kerf_are_the_bytes_of_the_one_program():
    whole, made = in_kerf(machines.default("compact"), STATOR)
    told = next(d for d in whole.findings if d.code == "over-memory")
    assert len(made) == told.values["loads"] == 2
    assert b"".join(load.data[:-1] for load in made) + b"\0" == whole.data
    assert all(len(load.data) <= 4096 for load in made)
    (move,) = loads.moves(made)
    assert move["kerf"]
    assert move["move_um"] == [0, 0]
    (together,) = loads.proven_together(made)
    assert together.loads == (1, 2)
    assert not together.findings
    notes = [d for load in made for d in load.findings if d.code == "kerf-load"]
    assert [len(d.points_mm) for d in notes] == [1, 1]
    assert notes[0].values["end"] == notes[1].values["start"]
    assert notes[0].values["last"] + 1 == notes[1].values["first"]
    assert together.verdict.closure_um == 0
    assert together.verdict.steps == whole.verdict.steps
    assert together.verdict.max_deviation_um == whole.verdict.max_deviation_um
    for figure in ("blocks", "steps", "moves"):
        assert sum(load.summary[figure] for load in made) == whole.summary[figure]
    assert sum(load.summary["path_mm"] for load in made) == pytest.approx(
        whole.summary["path_mm"], abs=0.002
    )


@pytest.mark.parametrize("more", [{}, {"stop_um": 2000, "overcut_um": 700}, {"count": "textbook"}])
@pytest.mark.parametrize("most", [14, 33])
def test_loads_of_records(most, more):
    machine = small("3b", most)
    whole, made = in_kerf(machine, **more)
    own, *parts = (p.program.blocks[p.program.blocks["kind"] < Kind.STOP] for p in (whole, *made))
    assert np.concatenate(parts).tobytes() == own.tobytes()
    assert len(made) > 1
    assert all(load.data.count(b"\n") <= most for load in made)
    for load in made:
        again = api.verify(load.data, against=KEY, certificate=load.summary, name="a.3b")
        assert again.ok, again.findings
        assert not [d for d in again.findings if d.code == "certificate-differs"]


@pytest.mark.parametrize("profile", ["iso-mm", "iso-um", "zd065"])
def test_loads_of_other_formats(profile):
    machine = machines.builtin(profile)
    key = "memory_bytes" if machine.limits.memory_bytes else "blocks"
    most = {"memory_bytes": 500, "blocks": 40}[key]
    machine = replace(machine, limits=replace(machine.limits, **{key: most}))
    _, made = in_kerf(machine)
    assert len(made) == 2
    for load in made:
        again = api.verify(load.data, against=KEY, certificate=load.summary, name="a")
        assert again.ok, again.findings
    assert loads.proven_together(made)[0].verdict.closure_um == 0


def test_a_load_is_proven_without_its_certificate():
    _, (first, second) = in_kerf(small("compact", 400))
    for load in (first, second):
        a, b = load.options.portion.blocks
        proof = api.verify(load.data, against=KEY, name="a.zd", offset=0.1, blocks=(a, b))
        assert proof.ok, proof.findings
        assert proof.summary["origin_um"] == load.summary["origin_um"]
    wrong = api.verify(second.data, against=KEY, name="a.zd", offset=0.1, blocks=(a - 1, b))
    assert not wrong.ok


def test_a_load_that_was_changed_is_refused():
    _, made = in_kerf(small("compact", 400))
    first, second = made
    for load, other in ((first, second), (second, first)):
        certificate = load.summary
        data = load.data
        assert not api.verify(other.data, against=KEY, certificate=certificate, name="a.zd").ok
        lengths = []
        at = 0
        program = load.program
        while at < len(data) - 1:
            step = 12 if data[at] & 0xF0 in (0x10, 0x20) else 7
            step = 1 if data[at] in (0x30, 0x31) else step
            lengths.append((at, step))
            at += step
        for at, step in (lengths[0], lengths[len(lengths) // 2], lengths[-1]):
            assert step > 1
            without = data[:at] + data[at + step :]
            assert not api.verify(without, against=KEY, certificate=certificate, name="a.zd").ok
            # Five steps more or less in the last number of a block.
            last = at + step - 1
            digit = bytes([(data[last] & 0xF0) | (data[last] + 5) % 10])
            changed = data[:last] + digit + data[last + 1 :]
            assert changed != data
            assert not api.verify(changed, against=KEY, certificate=certificate, name="a.zd").ok
        assert program.blocks["kind"][-1] == 4


@pytest.mark.parametrize(
    ("blocks", "said"),
    [((1, 9999), "there is no --blocks"), ((1, 507), "no load can end"), ((5, 2), "such as 1-480")],
)
def test_blocks_that_are_no_load(blocks, said):
    with pytest.raises(WrongUse, match=said):
        api.compile(STATOR, to="compact", offset=0.1, blocks=blocks)


def test_blocks_go_with_a_path_of_their_own():
    with pytest.raises(WrongUse, match="from-block"):
        api.compile(STATOR, to="compact", offset=0.1, blocks=(1, 9), from_block=3)
    with pytest.raises(WrongUse, match="kerf"):
        api.compile(STATOR, profile="iso-g41", offset=0.1, blocks=(1, 9))


def test_too_large_a_program_is_no_error_where_it_is_split():
    machine = machines.default("compact")
    options = Options.of(offset_um=100.0, strict=True)
    made = loads.compile_loads(STATOR, profile=machine, options=options, output_name="a.zd")
    assert [load.ok for load in made] == [True, True]
    assert not api.compile(STATOR, profile=machine, options=options).ok


@pytest.mark.parametrize("profile", ["iso-g41", "b4-compact", "zd065-rotation"])
def test_what_cannot_be_cut_in_the_kerf_stays_whole(profile):
    """An outline is taken up on a lead, or scaled or turned as a whole."""
    machine = machines.builtin(profile)
    key, most = ("memory_bytes", 300) if machine.limits.memory_bytes else ("blocks", 30)
    machine = replace(machine, limits=replace(machine.limits, **{key: most}))
    options = Options.of(offset_um=100.0, corner_um=300.0)
    made = loads.compile_loads(KEY, profile=machine, options=options, output_name="a.nc")
    assert all(load.ok for load in made)
    large = [load for load in made if any(d.code == "over-memory" for d in load.findings)]
    assert len(large) == 1
    assert len(large[0].plan.cuts) == 1


def test_small_contours_share_loads_with_a_long_one():
    _, made = in_kerf(small("3b", 300), STATOR)
    records = sum(load.data.count(b"\n") for load in made)
    assert len(made) == -(-records // 300)
    assert len(made[-1].plan.cuts) == 2


def test_the_command_says_where_the_machine_waits(tmp_path):
    out = tmp_path / "stator.zd"
    line = ["compile", str(STATOR), "-o", str(out), "--offset", "0.1", "--split", "--json"]
    done = CliRunner().invoke(cli, [*line, "--certificate", str(tmp_path / "c.json")])
    assert "in kerf    the machine waits at (-24.647, -10.248) mm, generator off" in done.stderr
    assert "together   loads 1 to 2 run one after the other" in done.stderr
    assert sorted(p.name for p in tmp_path.glob("*.zd")) == ["stator-1.zd", "stator-2.zd"]
    told = json.loads("[" + done.stdout.replace("}\n{", "},{") + "]")
    assert [t["kerf"] for t in told[1:]] == [True]
    assert told[0]["together"]["closure_um"] == 0
    again = CliRunner().invoke(
        cli,
        ["verify", str(tmp_path / "stator-2.zd"), "--certificate", str(tmp_path / "c-2.json")],
        standalone_mode=False,
    )
    assert again.return_value == 0, again.output
