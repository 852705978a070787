"""The command line: exit status, what is said, what is written and what is left alone."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import parts
from fork_server import wedmcam

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.fixture
def folder(tmp_path):
    square = parts.rectangle(20_000, 10_000)
    hole = parts.circle(10_000, 5_000, 2_000)
    (tmp_path / "part.dxf").write_bytes(parts.dxf_bytes((square, hole)))
    (tmp_path / "inch.dxf").write_bytes(parts.dxf_bytes((square,), units=1))
    (tmp_path / "none.dxf").write_bytes(parts.dxf_bytes((square,), units=0))
    (tmp_path / "rubbish.dxf").write_bytes(b"\x89PNG\r\n\x1a\n this is no drawing")
    (tmp_path / "empty.dxf").write_bytes(b"")
    gap = parts.contour_of_bulges(
        __import__("numpy").array([[0.0, 0], [20_000, 0], [20_000, 10_000], [0, 300]]),
        __import__("numpy").zeros(4),
        closed=False,
    )
    (tmp_path / "gap.dxf").write_bytes(parts.dxf_bytes((gap,)))
    (tmp_path / "old.3b").write_bytes(b"an old program\n")
    return tmp_path


TABLE = [
    ("compile part.dxf -o x.3b --offset 0.1", 0, "verified"),
    ("compile part.dxf -o x.zd --offset 100um", 0, "verified"),
    ("compile part.dxf -o x.3b --offset 0.004in --side die", 0, "verified"),
    ("compile part.dxf -o x.3b --wire 0.18 --gap 0.01", 0, "offset 0.100 mm"),
    ("compile part.dxf -o x.3b", 0, "warning[no-offset]"),
    ("compile part.dxf -o x.3b --side on", 0, "verified"),
    ("compile part.dxf -o x.3b --strict", 1, "error[no-offset]"),
    ("compile part.dxf -o x.3b --offset 0.1 --profile b3-columns", 0, "verified"),
    ("compile part.dxf -o x.txt --offset 0.1 --to 3b", 0, "verified"),
    ("compile part.dxf -o x.3b --offset 0.1 --stop 1 --overcut 0.5", 0, "verified"),
    ("compile part.dxf -o x.3b --offset 0.1 --corner 0.3 --convex sharp", 0, "verified"),
    ("compile part.dxf -o x.3b --offset 0.1 --start -3,5 --start 10,5", 0, "verified"),
    ("compile part.dxf -o x.3b --offset 0.1 --reverse --order nearest", 0, "verified"),
    ("compile part.dxf -o x.3b --offset 0.1 --count textbook", 0, "verified"),
    ("check part.dxf --offset 0.1", 0, "(not written)"),
    ("compile part.dxf -o x.3b --offset 3", 1, "error[interference]"),
    ("compile part.dxf -o x.3b --offset 0.1 --start 3,3", 1, "error[thread-point-unused]"),
    ("compile part.dxf -o x.3b --offset 0.1 --side left", 1, "error[closed-left-right]"),
    ("compile none.dxf -o x.3b --offset 0.1", 1, "--units"),
    ("compile none.dxf -o x.3b --offset 0.1 --units mm", 0, "verified"),
    ("compile gap.dxf -o x.3b --offset 0.1", 1, "error[open-contour]"),
    ("compile rubbish.dxf -o x.3b --offset 0.1", 1, "error[not-dxf]"),
    ("compile empty.dxf -o x.3b --offset 0.1", 1, "error["),
    ("compile part.dxf -o x.3b --offset 0.1 --stop 500", 1, "error[stop-too-long]"),
    ("compile missing.dxf -o x.3b --offset 0.1", 1, "cannot be read"),
    ("compile part.dxf -o nowhere/x.3b --offset 0.1", 2, "there is no folder"),
    ("compile part.dxf -o part.dxf --to 3b --offset 0.1", 2, "overwrite"),
    ("compile part.dxf -o x.pdf --offset 0.1", 2, "--to"),
    ("compile part.dxf --offset 0.1", 2, "-o"),
    ("compile part.dxf -o x.3b --offset abc", 2, "no length"),
    ("compile part.dxf -o x.3b --offset -0.1", 2, "takes 0 to 100 m"),
    ("compile part.dxf -o x.3b --offset 0.1 --wire 0.2 --gap 0.01", 2, "not both"),
    ("compile part.dxf -o x.3b --wire 0.2", 2, "go together"),
    ("compile part.dxf -o x.3b --side part", 2, "needs an offset"),
    ("compile part.dxf -o x.3b --offset 0.1 --corner 0.05", 2, "below the offset"),
    ("compile part.dxf -o x.3b --offset 0.1 --profile b3-colums", 2, "b3-columns"),
    ("compile part.dxf -o x.3b --offset 0.1 --start 3", 2, "X,Y"),
    ("compile part.dxf -o x.3b --ofset 0.1", 2, "--offset"),
    ("explain open-contour", 0, ""),
    ("explain open-contur", 2, "open-contour"),
    ("profile list", 0, ""),
    ("profile show zd065", 0, ""),
    ("identify part.dxf", 0, ""),
    ("identify empty.dxf", 1, ""),
    ("verify part.dxf", 2, "is a drawing"),
    ("dump part.dxf", 2, "is a drawing"),
    ("diff part.dxf old.3b", 2, "is a drawing"),
    ("explain part.dxf --block 1", 2, "is a drawing"),
    ("compile part.dxf -o x.3b --offset 0.1 -v", 0, "  1        1-3 "),
    ("compile part.dxf -o x.zd --offset 0.1 --count textbook", 2, "is for 3B"),
    ("compile part.dxf -o x.3b --offset 0.1 --profile gone.toml", 2, "gone.toml: cannot be read"),
    ("compile part.dxf -o x.3b --units cm", 2, "error: invalid value for '--units'"),
    ("compile", 2, "error: missing argument 'INPUT'"),
    ("compil part.dxf", 2, "Did you mean 'compile'"),
    ("batch part.dxf -o out --to compact --count textbook", 2, "part.dxf: error: --count"),
    ("dump old.3b", 1, "error["),
]


@pytest.mark.parametrize(("line", "status", "said"), TABLE)
def test_table(folder, line, status, said):
    done = wedmcam(*line.split(), cwd=folder)
    text = done.stderr.decode()
    assert done.returncode == status, text
    assert said in text
    assert "Traceback" not in text
    made = [p for p in folder.iterdir() if p.stem == "x"]
    assert bool(made) == (status == 0 and line.startswith("compile"))
    assert not [p for p in folder.iterdir() if p.name.startswith(".")]


def test_a_failed_compile_leaves_the_old_program(folder):
    done = wedmcam("compile", "gap.dxf", "-o", "old.3b", "--offset", "0.1", cwd=folder)
    assert done.returncode == 1
    assert (folder / "old.3b").read_bytes() == b"an old program\n"
    assert b"as it was" in done.stderr


def test_certificate_and_verify(folder):
    line = "compile part.dxf -o a.3b --offset 0.1 --certificate a.json --plot a.svg --json"
    done = wedmcam(*line.split(), cwd=folder)
    assert done.returncode == 0, done.stderr.decode()
    issued = json.loads((folder / "a.json").read_text("utf-8"))
    told = json.loads(done.stdout)
    assert told.pop("arithmetic_difference_um") < 0.01
    assert told == issued
    assert issued["ok"] is True
    assert issued["contours"] == 2
    assert issued["closure_um"] == 0
    assert issued["max_deviation_um"] <= 2
    assert (folder / "a.svg").read_text("utf-8").startswith("<")
    for line in (
        "verify a.3b --certificate a.json",
        "verify a.3b --against part.dxf --offset 0.1",
        "verify a.3b --against part.dxf --offset 0.1 --origin 10,5",
    ):
        done = wedmcam(*line.split(), cwd=folder)
        assert done.returncode == 0, done.stderr.decode()
    wrong = wedmcam(*["verify", "a.3b", "--against", "part.dxf", "--offset", "0.2"], cwd=folder)
    assert wrong.returncode == 3
    forged = (folder / "a.3b").read_bytes().replace(b"L1", b"L3", 1)
    (folder / "a.3b").write_bytes(forged)
    done = wedmcam(*["verify", "a.3b", "--certificate", "a.json"], cwd=folder)
    assert done.returncode == 3, done.stderr.decode()
    assert b"certificate-differs" in done.stderr
    # The judge names the block.
    assert b"block" in done.stderr


def test_a_certificate_proves_nothing_without_its_drawing(folder):
    line = "compile part.dxf -o a.3b --offset 0.1 --certificate a.json"
    wedmcam(*line.split(), cwd=folder)
    (folder / "deep").mkdir()
    for name in ("a.3b", "a.json"):
        (folder / "deep" / name).write_bytes((folder / name).read_bytes())
    done = wedmcam(*"verify a.3b --certificate a.json".split(), cwd=folder / "deep")
    assert done.returncode == 0, done.stderr.decode()  # found in the folder above
    (folder / "part.dxf").unlink()
    done = wedmcam(*"verify a.3b --certificate a.json".split(), cwd=folder)
    assert done.returncode == 1
    assert b"nothing" in done.stderr


def test_changed_figures_of_a_certificate_are_seen(folder):
    line = "compile part.dxf -o a.3b --offset 0.1 --certificate a.json"
    wedmcam(*line.split(), cwd=folder)
    issued = json.loads((folder / "a.json").read_text("utf-8"))
    issued["max_deviation_um"] = 0.001
    (folder / "a.json").write_text(json.dumps(issued), "utf-8")
    done = wedmcam(*"verify a.3b --certificate a.json".split(), cwd=folder)
    assert done.returncode == 3
    assert b"max_deviation_um" in done.stderr


def test_a_program_without_a_stop_is_told(folder):
    wedmcam(*"compile part.dxf -o a.3b --offset 0.1".split(), cwd=folder)
    text = (folder / "a.3b").read_bytes()
    (folder / "a.3b").write_bytes(text.replace(b"DD\n", b""))
    done = wedmcam(*"verify a.3b --against part.dxf --offset 0.1".split(), cwd=folder)
    assert b"no-end" in done.stderr


def test_devices_are_written_to_and_never_replaced(folder):
    """A null device must still be one afterwards (here: a pipe of our own in its place)."""
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    reader = subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE)
    line = "compile part.dxf -o pipe --to 3b --offset 0.1"
    done = wedmcam(*line.split(), cwd=folder)
    out, _ = reader.communicate(timeout=20)
    assert done.returncode == 0, done.stderr.decode()
    assert out.startswith(b"B")
    assert pipe.is_fifo()


def test_standard_input_and_output(folder):
    drawing = (folder / "part.dxf").read_bytes()
    line = "compile - -o - --to 3b --offset 0.1"
    done = wedmcam(*line.split(), cwd=folder, stdin=drawing)
    assert done.returncode == 0
    wedmcam(*["compile", "part.dxf", "-o", "x.3b", "--offset", "0.1"], cwd=folder)
    assert done.stdout == (folder / "x.3b").read_bytes()


def test_same_bytes_in_any_locale_folder_and_time_zone(folder, tmp_path_factory):
    other = tmp_path_factory.mktemp("other place")
    (other / "part.dxf").write_bytes((folder / "part.dxf").read_bytes())
    line = ["compile", "part.dxf", "-o", "x.3b", "--offset", "0.1", "--profile", "b3-numbered"]
    wedmcam(*line, cwd=folder, env={"TZ": "UTC", "PYTHONHASHSEED": "1"})
    strange = {"TZ": "Asia/Tokyo", "LC_ALL": "de_DE.UTF-8", "PYTHONHASHSEED": "2"}
    wedmcam(*line, cwd=other, env=strange)
    assert (folder / "x.3b").read_bytes() == (other / "x.3b").read_bytes()


def test_nothing_in_colour_into_a_pipe(folder):
    done = wedmcam(*["compile", "part.dxf", "-o", "x.3b"], cwd=folder)
    assert b"\x1b" not in done.stderr
    assert b"\r" not in done.stderr


def test_a_closed_pipe_leaves_no_traceback(folder):
    wedmcam(*["compile", "part.dxf", "-o", "x.3b", "--offset", "0.1"], cwd=folder)
    shell = f"{sys.executable} -m wedmcam dump x.3b | head -1"
    done = subprocess.run(shell, shell=True, cwd=folder, capture_output=True, check=False)
    assert b"Traceback" not in done.stderr


def test_inspect_tells_the_largest_offset(folder):
    done = wedmcam("inspect", "part.dxf", "--json", cwd=folder)
    facts = json.loads(done.stdout)
    assert facts["largest_offset"]["offset_mm"] == pytest.approx(2.0, abs=1e-3)
    assert facts["largest_offset"]["limited_by"] == "vanished"
    assert (facts["outer"], facts["holes"]) == (1, 1)


@pytest.mark.parametrize("sample", sorted(p.name for p in SAMPLES.glob("*.dxf")))
def test_samples_compile_from_the_command_line(sample, tmp_path):
    out = tmp_path / "out.3b"
    options = ["--offset", "0.1"] + (["--units", "mm"] if sample == "damaged.dxf" else [])
    done = wedmcam("compile", SAMPLES / sample, "-o", out, *options)
    assert done.returncode == 0, done.stderr.decode()
    done = wedmcam("verify", out, "--against", SAMPLES / sample, *options)
    assert done.returncode == 0, done.stderr.decode()


def test_json_says_by_how_much_the_arithmetics_differ(tmp_path):
    source, out = SAMPLES / "cover.dxf", tmp_path / "a.3b"
    done = wedmcam("compile", source, "-o", out, "--offset", "0.1", "--json")
    assert done.returncode == 0
    told = json.loads(done.stdout)
    assert told["arithmetic"] == "decimal8"
    assert 0 < told["arithmetic_difference_um"] < 0.01
    done = wedmcam("compile", source, "-o", out, "--offset", "0.1", "--arithmetic", "float64")
    assert b"wire paths up to 0.00" in done.stderr
    done = wedmcam("compile", source, "-o", out, "--arithmetic", "float32")
    assert done.returncode == 2


def test_the_map_is_written_with_the_program_or_not_at_all(folder):
    import hashlib

    done = wedmcam(*"compile part.dxf -o x.3b --offset 0.1 --map x.json".split(), cwd=folder)
    assert done.returncode == 0, done.stderr.decode()
    told = json.loads((folder / "x.json").read_text("utf-8"))
    assert told["sha256"]["output"] == hashlib.sha256((folder / "x.3b").read_bytes()).hexdigest()
    assert told["blocks"][0]["source"]["file"] == "part.dxf"
    done = wedmcam(*"compile gap.dxf -o y.3b --offset 0.1 --map y.json".split(), cwd=folder)
    assert done.returncode == 1
    assert not (folder / "y.json").exists()
    done = wedmcam(*"compile part.dxf -o y.3b --offset 0.1 --map y.3b".split(), cwd=folder)
    assert done.returncode == 2
    assert not (folder / "y.3b").exists()


def test_nothing_left_to_cut_is_said(folder):
    line = "check part.dxf --offset 6 --side die --on-interference trim"
    done = wedmcam(*line.split(), cwd=folder)
    assert done.returncode == 1
    assert "error[nothing-to-cut]" in done.stderr.decode()


def test_profiles_are_shown_and_checked(folder):
    shown = wedmcam("profile", "show", "b3-columns", cwd=folder)
    (folder / "mine.toml").write_bytes(shown.stdout.replace(b'stop = "DD"', b'stop = "HALT"'))
    done = wedmcam("profile", "check", "mine.toml", "--json", cwd=folder)
    assert done.returncode == 0
    assert json.loads(done.stdout) == {
        "file": "mine.toml",
        "ok": True,
        "name": "mine",
        "diagnostics": [],
    }
    told = json.loads(wedmcam("profile", "show", "mine.toml", "--json", cwd=folder).stdout)
    assert told["words"]["stop"] == "HALT"
    assert told["limits"]["travel_um"] is None
    (folder / "bad.toml").write_text("[limts]\n[limits]\ncount_um = 0\n")
    done = wedmcam("profile", "check", "bad.toml", cwd=folder)
    assert done.returncode == 2
    text = done.stderr.decode()
    assert text.count("error[profile-") == 7
    assert "bad.toml:3:1: error[profile-value]" in text
    assert "    3 | count_um = 0\n      | ^~~~~~~~\n" in text
    assert wedmcam("profile", "check", "zd056").returncode == 2
    rows = json.loads(wedmcam("profile", "list", "--json").stdout)
    assert [r["name"] for r in rows if r["default"] and r["format"] == "compact"] == ["zd065"]


def test_codes_are_listed():
    lines = wedmcam("explain", "--list").stdout.decode().splitlines()
    assert any(line.startswith("open-contour ") for line in lines)
    assert lines == sorted(lines)
    assert wedmcam("explain").returncode == 2


def test_what_is_typed_wins_over_the_certificate_one_by_one(folder):
    line = "compile part.dxf -o a.3b --offset 0.1 --corner 0.3 --certificate a.json -q"
    assert wedmcam(*line.split(), cwd=folder).returncode == 0
    line = "verify a.3b --certificate a.json --json"
    for more, status in (
        ([], 0),
        (["--order", "nearest"], 0),
        (["--corner", "0.2"], 3),
        (["--offset", "0.12"], 3),
        (["--wire", "0.18", "--gap", "0.01"], 0),
        (["--side", "on"], 3),
    ):
        done = wedmcam(*line.split(), *more, cwd=folder)
        assert done.returncode == status, (more, done.stderr.decode())


def test_a_page_to_click_in(folder):
    line = "compile part.dxf -o a.3b --offset 0.1 --plot a.html"
    assert wedmcam(*line.split(), cwd=folder).returncode == 0
    page = (folder / "a.html").read_text("utf-8")
    assert page.startswith("<!DOCTYPE html>")
    blocks = len((folder / "a.3b").read_text().splitlines())
    assert page.count("<tr><td>") == blocks
    assert "<title>block 1: line" in page
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")
    from xml.etree import ElementTree

    body = page[page.index("<svg") : page.index("</svg>") + 6]
    ids = [e.get("id") for e in ElementTree.fromstring(body).iter()]
    assert "drawing" in ids  # what the script looks for
    wedmcam("plot", "gap.dxf", "-o", "b.html", "--offset", "0.1", cwd=folder)
    assert "open-contour" in (folder / "b.html").read_text("utf-8")


def test_no_output_overwrites_a_profile_or_the_settings(folder):
    shown = wedmcam("profile", "show", "b3-columns", cwd=folder).stdout
    (folder / "mine.toml").write_bytes(shown)
    (folder / "wedmcam.toml").write_text("offset = 0.1\n")
    for name in ("mine.toml", "wedmcam.toml"):
        line = f"compile part.dxf -o x.3b --profile mine.toml --certificate {name}"
        done = wedmcam(*line.split(), cwd=folder)
        assert done.returncode == 2
        assert "would overwrite" in done.stderr.decode()
    assert (folder / "mine.toml").read_bytes() == shown


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("plot part.dxf -o x.svg --contours --offset 0.1", ["--offset"]),
        ("plot made.3b -o x.svg --offset 0.1 --join 0.02", ["--join", "--offset"]),
        ("verify made.3b --reverse --layer X", ["--layer", "--reverse"]),
        ("verify made.3b --against part.dxf --offset 0.1 --reverse", []),
        ("plot part.dxf -o x.svg --offset 0.1 --reverse", []),
    ],
)
def test_options_of_a_drawing_that_are_not_used_are_said(folder, line, words):
    wedmcam("compile", "part.dxf", "-o", "made.3b", "--offset", "0.1", cwd=folder)
    said = wedmcam(*line.split(), cwd=folder).stderr.decode()
    found = [row.split()[1] for row in said.splitlines() if "has no effect" in row]
    assert found == words, said
