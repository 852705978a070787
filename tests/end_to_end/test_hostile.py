"""No exit 70: closed and full streams, names of any bytes, links in a circle, folders as files.

What goes wrong outside of the program is one line that names the file, and exit 1 or 2.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner
from test_cli import wedmcam

import parts
from wedmcam.cli.main import cli

SQUARE = parts.dxf_bytes((parts.rectangle(20_000, 10_000),))
COMPILE = ("compile", "part.dxf", "--offset", "0.1")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "part.dxf").write_bytes(SQUARE)
    return tmp_path


def shell(folder, line):
    """Run a line of a shell in which ``wedmcam`` is the program."""
    command = f'wedmcam() {{ {sys.executable} -m wedmcam "$@"; }}; {line}'
    return subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, check=False)


@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("wedmcam compile part.dxf --offset 0.1 --to 3b -o - >&-", 1),
        ("wedmcam compile part.dxf --offset 0.1 -o a.3b --json >&-", 1),
        ("wedmcam compile part.dxf --offset 0.1 -o a.3b 2>&-", 0),
        ("wedmcam compile part.dxf --offset 0.1 -o a.3b <&- >&- 2>&-", 0),
        ("wedmcam compile - --offset 0.1 -o a.3b <&-", 1),
        ("wedmcam compile missing.dxf --offset 0.1 -o a.3b 2>&-", 1),
        ("wedmcam compile part.dxf --offset 0.1 --to 3b -o - >/dev/full", 1),
        ("wedmcam compile part.dxf --offset 0.1 -o a.3b --json >/dev/full", 1),
        ("wedmcam compile part.dxf --offset 0.1 -o a.3b 2>/dev/full", 1),
        ("wedmcam compile part.dxf --offset 0.1 -o /dev/full --to 3b", 1),
        ("wedmcam inspect part.dxf >/dev/full", 1),
        ("wedmcam --help >/dev/full", 1),
    ],
)
def test_field_closed_and_full_streams(folder, line, status):
    done = shell(folder, line)
    assert done.returncode == status, done.stderr
    assert b"internal" not in done.stderr
    assert b"Traceback" not in done.stderr
    assert b"Exception ignored" not in done.stderr


def test_a_stream_that_is_closed_is_never_an_output_file(folder):
    # The first file that is opened would be standard output.
    shell(folder, "wedmcam compile part.dxf --offset 0.1 -o a.3b --certificate c.json --json >&-")
    assert not (folder / "a.3b").read_bytes().startswith(b"{")


def test_field_full_disk_names_the_output(folder):
    done = shell(folder, "ulimit -f 1; wedmcam compile part.dxf --offset 0.1 -o a.3b --plot b.html")
    assert done.returncode == 1
    assert b"b.html: cannot be written: File too large" in done.stderr
    assert not (folder / "a.3b").exists()


def test_field_symlink_loop(folder):
    (folder / "loop1").symlink_to("loop2")
    (folder / "loop2").symlink_to("loop1")
    for line in (
        (*COMPILE, "-o", "loop1", "--to", "3b"),
        (*COMPILE, "-o", "a.3b", "--certificate", "loop1"),
        ("compile", "loop1", "--from", "dxf", "--offset", "0.1", "-o", "a.3b"),
        (*COMPILE, "-o", "a.3b", "--profile", "loop1"),
        ("verify", "loop1", "--against", "part.dxf"),
        ("plot", "part.dxf", "-o", "loop1/x.svg"),
        ("batch", "loop1", "-o", "out", "--offset", "0.1"),
    ):
        done = wedmcam(*line, cwd=folder)
        assert done.returncode in (1, 2), (line, done.stderr)
        assert b"loop" in done.stderr


def test_an_output_whose_name_is_too_long(folder):
    done = wedmcam(*COMPILE, "-o", "x" * 300 + ".3b", cwd=folder)
    assert done.returncode == 2
    assert b"cannot be written: File name too long" in done.stderr


@pytest.mark.parametrize("name", [b"n\xff.dxf", "n\u202e\x1b[31m.dxf".encode(), b"n<&\x07.dxf"])
def test_field_a_name_of_any_bytes(folder, name):
    os.rename(folder / "part.dxf", os.path.join(os.fsencode(folder), name))
    drawing = os.fsdecode(name)
    beside = ("--certificate", "c.json", "--map", "m.json", "--setup-sheet")
    for sheet, plot in (("s.html", "p.svg"), ("s.md", "p.html")):
        done = wedmcam(
            *("compile", drawing, "--offset", "0.1", "-o", drawing[0] + drawing[1:-3] + "3b"),
            *(*beside, sheet, "--plot", plot, "--json"),
            cwd=folder,
        )
        assert done.returncode == 0, done.stderr
        for text in (done.stderr, done.stdout, *((folder / f).read_bytes() for f in (sheet, plot))):
            seen = text.decode("utf-8")
            assert not {"\u202e", "\x1b", "\x07"} & set(seen)
        assert json.loads(done.stdout)["input"] == drawing
        for made in ("c.json", "m.json"):
            assert json.loads((folder / made).read_bytes().decode("utf-8"))["input"] == drawing
    ElementTree.fromstring((folder / "p.svg").read_bytes())
    done = wedmcam("verify", drawing[:-3] + "3b", "--certificate", "c.json", cwd=folder)
    assert done.returncode == 0, done.stderr
    done = wedmcam("batch", drawing, "-o", "out", "--offset", "0.1", "--json", cwd=folder)
    assert json.loads(done.stdout.decode("utf-8"))["input"] == drawing


def test_field_ansi_layer(folder):
    layer = "A\x1b[31m\x1b]0;title\x07\u202eB"
    text = SQUARE.decode("utf-8").replace("\n0\n10\n", "\n0\n10\n")
    text = "".join(
        f"{code}\n{layer if code.strip() == '8' else value}\n"
        for code, value in zip(text.split("\n")[::2], text.split("\n")[1::2], strict=False)
    )
    (folder / "part.dxf").write_bytes(text.encode("utf-8"))
    for line in (
        (*COMPILE, "-o", "a.3b", "--json", "-v", "--plot", "p.html"),
        ("inspect", "part.dxf", "-v"),
        ("inspect", "part.dxf", "--json"),
        ("plot", "part.dxf", "-o", "p.svg", "--contours"),
        (*COMPILE, "-o", "a.3b", "--layer", "X\x1b[31m\u202e"),
    ):
        done = wedmcam(*line, cwd=folder)
        assert done.returncode in (0, 1)
        for seen in (done.stdout, done.stderr):
            assert not {"\u202e", "\x1b", "\x07"} & set(seen.decode("utf-8")), line


def test_field_batch_says_what_it_cannot_read(folder):
    inputs = folder / "in"
    inputs.mkdir()
    (inputs / "good.dxf").write_bytes(SQUARE)
    (inputs / "a.dxf").symlink_to("nowhere")
    os.mkfifo(inputs / "b.dxf")
    (inputs / "loop.dxf").symlink_to("loop.dxf")
    (inputs / "folder.dxf").mkdir()
    done = wedmcam("batch", "in", "-o", "out", "--offset", "0.1", "--json", cwd=folder)
    assert done.returncode == 1
    status = {d["input"]: d["status"] for d in map(json.loads, done.stdout.splitlines())}
    assert status == {"in/a.dxf": 1, "in/b.dxf": 1, "in/loop.dxf": 1, "in/good.dxf": 0}
    assert b"in/a.dxf: cannot be read: a link that leads nowhere" in done.stderr
    assert b"in/b.dxf: cannot be read: no regular file" in done.stderr


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="asks /proc for the workers")
def test_field_workers_end_with_a_batch_that_is_killed(folder):
    (folder / "in").mkdir()
    for k in range(40):
        (folder / "in" / f"p{k}.dxf").write_bytes(SQUARE)
    line = ("batch", "in", "-o", "out", "--offset", "0.1", "--jobs", "2")
    batch = subprocess.Popen(
        [sys.executable, "-m", "wedmcam", *line], cwd=folder, stderr=subprocess.DEVNULL
    )
    workers = []
    until = time.monotonic() + 30
    while len(workers) < 2 and time.monotonic() < until:
        time.sleep(0.05)
        workers = children(batch.pid)
    batch.send_signal(signal.SIGKILL)
    batch.wait()
    until = time.monotonic() + 30
    while any(map(runs, workers)) and time.monotonic() < until:
        time.sleep(0.1)
    assert len(workers) == 2
    assert not any(map(runs, workers))


def children(pid):
    return [
        int(place.name)
        for place in Path("/proc").iterdir()
        if place.name.isdecimal() and stat(place)[1:2] == [str(pid)]
    ]


def stat(place):
    try:
        return (place / "stat").read_text().rpartition(")")[2].split()
    except OSError:
        return []


def runs(pid):
    return stat(Path(f"/proc/{pid}"))[:1] not in ([], ["Z"])


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device here")
@pytest.mark.parametrize("line", ["check /dev/zero", "dump /dev/zero", "verify /dev/full"])
def test_a_device_without_an_end(line, monkeypatch):
    monkeypatch.setattr("wedmcam.files.MOST_BYTES", 10**6)
    done = CliRunner().invoke(cli, line.split())
    assert done.exit_code == 1
    assert "a device without an end" in done.output
