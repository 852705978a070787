"""batch: one bad file never stops the others, and bytes do not depend on --jobs (B-01 to B-04)."""

import json
from pathlib import Path

import pytest
from test_cli import wedmcam

import parts


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "in" / "sub dir" / "deeper").mkdir(parents=True)
    for k, place in enumerate(("a.dxf", "b.DXF", "sub dir/ü 中.dxf", "sub dir/deeper/c.dxf")):
        drawing = parts.dxf_bytes((parts.rectangle(5_000 + 1_000 * k, 4_000),))
        (tmp_path / "in" / place).write_bytes(drawing)
    (tmp_path / "in" / "sub dir" / "bad.dxf").write_bytes(b"no drawing")
    (tmp_path / "in" / "notes.txt").write_text("not for us")
    return tmp_path


def tree(place):
    return {str(p.relative_to(place)): p.read_bytes() for p in place.rglob("*") if p.is_file()}


def test_a_folder_is_mirrored_and_one_bad_file_stops_nothing(folder):
    done = wedmcam("batch", "in", "-o", "out", "--offset", "0.1", cwd=folder)
    assert done.returncode == 1
    assert sorted(tree(folder / "out")) == [
        "a.3b",
        "b.3b",
        "sub dir/deeper/c.3b",
        "sub dir/ü 中.3b",
    ]
    text = done.stderr.decode()
    assert "batch: 4 ok, 1 failed" in text
    assert "error[not-dxf]" in text
    assert "\r" not in text


def test_bytes_and_order_do_not_depend_on_jobs(folder):
    results = []
    for jobs in (1, 2, 3):
        out = f"out{jobs}"
        done = wedmcam(
            *("batch", "in", "-o", out, "--offset", "0.1", "--jobs", jobs, "--json"), cwd=folder
        )
        records = [json.loads(line) for line in done.stdout.splitlines()]
        assert [r["ok"] for r in records].count(False) == 1
        for r in records:
            r["output"] = (r["output"] or "").replace(out, "")
        results.append((tree(folder / out), records))
    assert results[0] == results[1] == results[2]


def test_patterns_and_files(folder):
    done = wedmcam("batch", "in/*.dxf", "in/b.DXF", "-o", "out", "--offset", "0.1", cwd=folder)
    assert done.returncode == 0
    assert sorted(tree(folder / "out")) == ["a.3b", "b.3b"]
    done = wedmcam("batch", "in/**/*.dxf", "-o", "all", "--offset", "0.1", cwd=folder)
    assert done.returncode == 1
    assert "sub dir/deeper/c.3b" in tree(folder / "all")


def test_wrong_use(folder):
    for line, said in (
        (("batch", "nothing*.dxf", "-o", "out"), "no drawing"),
        (("batch", "missing", "-o", "out"), "no drawing"),
        (("batch", "in", "-o", "in/a.dxf"), "is a file"),
        (("batch", "in/a.dxf", "in/sub dir/../a.dxf", "-o", "out"), "both become"),
    ):
        done = wedmcam(*line, "--offset", "0.1", cwd=folder)
        assert done.returncode == 2, done.stderr
        assert said in done.stderr.decode()
    assert not (folder / "out").exists()


def test_units_fill_in_only_where_a_drawing_says_none(folder):
    square = (parts.rectangle(20_000, 10_000),)
    (folder / "u").mkdir()
    (folder / "u" / "none.dxf").write_bytes(parts.dxf_bytes(square, units=0))
    (folder / "u" / "mm.dxf").write_bytes(parts.dxf_bytes(square))
    line = ("batch", "u", "-o", "o", "--offset", "0.1", "--units", "um", "--json")
    records = [json.loads(r) for r in wedmcam(*line, cwd=folder).stdout.splitlines()]
    assert {r["input"]: r["units"] for r in records} == {"u/mm.dxf": "mm", "u/none.dxf": "um"}
    forced = [
        json.loads(r) for r in wedmcam(*line, "--force-units", cwd=folder).stdout.splitlines()
    ]
    assert {r["units"] for r in forced} == {"um"}


def test_quiet_shows_the_warnings_of_what_is_written(folder):
    drawing = Path(__file__).parents[1] / "bad" / "scale-zero.dxf"
    (folder / "in" / "scale.dxf").write_bytes(drawing.read_bytes())
    done = wedmcam("batch", "in/scale.dxf", "-o", "out", "--offset", "0.1", "-q", cwd=folder)
    assert done.returncode == 0
    assert "scale.dxf:#2F layer 0: warning[scale-zero]" in done.stderr.decode()
    rounded = drawing.with_name("rounded-turn.dxf")
    (folder / "in" / "turn.dxf").write_bytes(rounded.read_bytes())
    done = wedmcam("batch", "in/turn.dxf", "-o", "out", "--offset", "0.1", "-q", cwd=folder)
    assert "turn.dxf:" not in done.stderr.decode()
