"""Part of a program: some contours of it, and what a broken wire left, forwards and backwards."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from wedmcam import api
from wedmcam.cli.main import cli
from wedmcam.ir.program import Kind, Role
from wedmcam.options import WrongUse

ROOT = Path(__file__).parents[2]
PLATE, KEY = ROOT / "samples/plate.dxf", ROOT / "samples/key-punch.dxf"


def track(made: api.Compilation) -> np.ndarray:
    """Return where the blocks of the contour proper end, um."""
    assert made.ok, [str(d) for d in made.findings]
    assert made.lowered is not None
    _, ends = api.positions(made.lowered, made.machine)
    blocks = made.lowered.blocks
    return ends[(blocks["role"] == Role.CONTOUR) & (blocks["kind"] < Kind.MOVE)]


def test_some_contours_are_a_program_of_their_own() -> None:
    whole = api.compile(PLATE, offset=0.1)
    part = api.compile(PLATE, offset=0.1, cuts=(3, 5))
    assert part.ok
    assert part.plan is not None
    assert whole.plan is not None
    assert [c.number for c in part.plan.cuts] == [c.number for c in whole.plan.cuts[2:5]]
    assert part.data is not None
    assert api.verify(part.data, against=PLATE, format="3b", offset=0.1, cuts=(3, 5)).ok
    assert not api.verify(part.data, against=PLATE, format="3b", offset=0.1).ok
    with pytest.raises(WrongUse, match="10 contours"):
        api.compile(PLATE, offset=0.1, cuts=(3, 11))


@pytest.mark.parametrize("to", ["3b", "compact"])
@pytest.mark.parametrize("block", [2, 3, 7, 12])
def test_on_from_a_block_the_rest_is_cut_and_no_more(to: str, block: int) -> None:
    whole = api.compile(KEY, offset=0.1, to=to)
    assert whole.program is not None
    starts, _ = api.positions(whole.program, whole.machine)
    made = api.compile(KEY, offset=0.1, to=to, from_block=block)
    assert made.ok, [str(d) for d in made.findings]
    assert made.program is not None
    if block > 2:
        assert made.program.origin == tuple(starts[block - 1])
        assert made.verdict is not None
        assert whole.verdict is not None
        assert made.verdict.path_mm < whole.verdict.path_mm
    # It ends where the contour closed: in the point where the lead arrived.
    _, there = api.positions(made.program, made.machine)
    assert np.abs(track(made)[-1] - track(whole)[-1]).max() <= 1
    assert len(there) <= len(starts) + 1


def test_compensation_is_not_taken_up_in_the_kerf() -> None:
    """Blocks were counted in a path without its offset: of a .wed, whose cuts state it."""
    washer = ROOT / "samples/washer.wed"
    whole = api.compile(washer, profile="iso-g41")
    assert [int(k) for k in whole.program.blocks["kind"]] == [0, 1, 0, 3, 2, 3, 0, 1, 0, 4]
    for block, contours in ((1, 2), (5, 1), (7, 1)):
        rest = api.compile(washer, profile="iso-g41", from_block=block)
        assert rest.ok
        assert len(rest.plan.cuts) == contours
    for block, which in ((2, "contour 1: .* --cuts 1-2 "), (8, "contour 2: .* --cuts 2-2 ")):
        with pytest.raises(WrongUse, match=which):
            api.compile(washer, profile="iso-g41", from_block=block)
    with pytest.raises(WrongUse, match="no block 11"):
        api.compile(washer, profile="iso-g41", from_block=11)


@pytest.mark.parametrize("block", [4, 9, 12])
def test_backwards_ends_where_the_block_starts(block: int) -> None:
    whole = api.compile(KEY, offset=0.1)
    assert whole.program is not None
    starts, _ = api.positions(whole.program, whole.machine)
    made = api.compile(KEY, offset=0.1, from_block=block, backwards=True)
    assert made.program is not None
    assert made.program.origin == whole.program.origin
    assert np.abs(track(made)[-1] - starts[block - 1]).max() <= 2
    on = api.compile(KEY, offset=0.1, from_block=block)
    assert on.plan is not None
    assert made.plan is not None
    assert made.plan.cuts[0].keeps_left is not on.plan.cuts[0].keeps_left


def test_the_judge_refuses_a_rest_that_is_short() -> None:
    made = api.compile(KEY, offset=0.1, from_block=5)
    later = api.compile(KEY, offset=0.1, from_block=8)
    assert later.data is not None
    assert made.ok
    assert not api.verify(later.data, against=KEY, format="3b", offset=0.1, from_block=5).ok


def test_later_contours_follow_a_rest() -> None:
    whole = api.compile(PLATE, offset=0.1)
    assert whole.lowered is not None
    rows = np.flatnonzero(whole.lowered.blocks["cut"] == 4)
    cut_blocks = rows[whole.lowered.blocks["role"][rows] == Role.CONTOUR]
    made = api.compile(PLATE, offset=0.1, from_block=int(cut_blocks[-1]) + 1)
    assert made.ok, [str(d) for d in made.findings]
    assert made.plan is not None
    assert len(made.plan.cuts) == 7
    move = np.flatnonzero(whole.lowered.blocks["kind"] == Kind.MOVE)[4]
    after = api.compile(PLATE, offset=0.1, from_block=int(move) + 1)
    assert after.ok
    assert after.plan is not None
    assert len(after.plan.cuts) == 5


def test_what_cannot_be_left_is_wrong_use(tmp_path: Path) -> None:
    run = CliRunner().invoke
    ask = ["compile", str(KEY), "-o", str(tmp_path / "k.3b"), "--offset", "0.1"]
    for more, said in (
        (["--from-block", "999"], "there is no block 999"),
        (["--backwards"], "--from-block"),
        (["--cuts", "x"], "no range"),
        (["--cuts", "2"], "1 contours"),
        (["--from-block", "1", "--backwards"], "begins a contour"),
    ):
        done = run(cli, ask + more)
        assert done.exit_code == 2 or isinstance(done.exception, WrongUse), (more, done.output)
        assert said in done.output + str(done.exception)
    done = run(cli, [*ask, "--from-block", "6", "--backwards"])
    assert done.exit_code == 0, done.output
    certificate = str(tmp_path / "c.json")
    done = run(cli, [*ask, "--from-block", "6", "--certificate", certificate])
    assert done.exit_code == 0, done.output
    done = run(cli, ["verify", str(tmp_path / "k.3b"), "--certificate", certificate])
    assert done.exit_code == 0, done.output
