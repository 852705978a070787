"""Manners: bars and colours on a terminal only; Ctrl-C and closed pipes leave nothing behind."""

import os
import signal
import subprocess
import sys
import time

import pytest
from test_cli import wedmcam

import parts

pty = pytest.importorskip("pty")

#: Start the program with no patience, and with much: a bar is shown at once, or never.
AT_ONCE, NEVER = (
    f"from wedmcam.cli import progress; progress.PATIENCE = {seconds}; "
    "from wedmcam.__main__ import main; main()"
    for seconds in (0.0, 1e6)
)


@pytest.fixture
def folder(tmp_path):
    for k in range(6):
        (tmp_path / f"p{k}.dxf").write_bytes(parts.dxf_bytes((parts.rectangle(5_000 + k, 4_000),)))
    return tmp_path


def on_a_terminal(folder, *line, env=None, start=("-c", AT_ONCE)):
    """Run with standard error on a terminal; return the exit status and what was seen there."""
    ours, theirs = pty.openpty()
    clean = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "TERM")}
    done = subprocess.Popen(
        [sys.executable, *start, *line],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=theirs,
        env={**clean, "TERM": "xterm", "COLUMNS": "100", **(env or {})},
    )
    os.close(theirs)
    seen = b""
    while True:
        try:
            more = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not more:
            break
        seen += more
    os.close(ours)
    done.stdout.read()
    done.stdout.close()
    return done.wait(), seen.decode()


def test_a_batch_shows_a_bar_on_a_terminal_and_takes_it_away(folder):
    status, seen = on_a_terminal(
        folder, "batch", ".", "-o", "out", "--offset", "0.1", "--jobs", "1"
    )
    assert status == 0
    assert "6/6" in seen or "5/6" in seen
    assert "\x1b[2K" in seen  # the line is cleared
    assert seen.rstrip().endswith("batch: 6 ok, 0 failed")


def test_a_compile_shows_that_it_works(folder):
    status, seen = on_a_terminal(folder, "compile", "p0.dxf", "-o", "x.3b", "--offset", "0.1")
    assert status == 0
    assert "compiling p0.dxf" in seen
    assert seen.rstrip().splitlines()[-1].startswith("verified")


def test_quick_work_shows_no_bar(folder):
    line = ("compile", "p0.dxf", "-o", "x.3b", "--offset", "0.1")
    _, seen = on_a_terminal(folder, *line, start=("-c", NEVER))
    assert "compiling" not in seen


def test_colours_on_a_terminal_unless_they_are_not_wanted(folder):
    line = ("check", "p0.dxf")
    _, seen = on_a_terminal(folder, *line, start=("-c", NEVER))
    assert "\x1b[33;1mwarning[no-offset]\x1b[0m" in seen
    for env in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        _, seen = on_a_terminal(folder, *line, env=env, start=("-c", NEVER))
        assert "\x1b" not in seen
        assert "warning[no-offset]" in seen


def test_no_colour_in_a_bar_either(folder):
    line = ("batch", ".", "-o", "out", "--offset", "0.1", "--jobs", "1")
    _, seen = on_a_terminal(folder, *line, env={"NO_COLOR": "1"})
    assert "\x1b[3" not in seen.replace("\x1b[?", "")


def test_nothing_of_a_bar_into_a_pipe(folder):
    line = ("batch", ".", "-o", "out", "--offset", "0.1")
    done = subprocess.run(
        [sys.executable, "-c", AT_ONCE, *line], cwd=folder, capture_output=True, check=False
    )
    assert done.returncode == 0
    assert b"\x1b" not in done.stderr
    assert b"\r" not in done.stderr


def test_the_bar_is_not_fetched_before_it_is_needed(folder):
    code = (
        "import sys; from wedmcam.__main__ import main\n"
        "try: main()\n"
        "finally: sys.stdout.write(str('rich' in sys.modules))"
    )
    for line in (("--help",), ("check", "p0.dxf", "--offset", "0.1"), ("explain", "gouge")):
        done = subprocess.run(
            [sys.executable, "-c", code, *line], cwd=folder, capture_output=True, check=False
        )
        assert done.stdout.endswith(b"False"), done


def leftovers(folder):
    return [p for p in folder.rglob("*") if p.name.startswith(".")]


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    "line",
    [
        "batch . -o out --offset 0.1 --jobs 2",
        "batch . -o out --offset 0.1 --jobs 1",
        "compile - -o x.3b --offset 0.1",
    ],
)
def test_an_interrupted_run_leaves_no_traceback_and_no_partial_file(folder, line, stop):
    for k in range(300):
        (folder / f"q{k:03d}.dxf").write_bytes((folder / "p0.dxf").read_bytes())
    run = subprocess.Popen(
        [sys.executable, "-m", "wedmcam", *line.split()],
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        # In the background of a shell the tests themselves ignore Ctrl-C, and would hand that on.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    if line.startswith("batch"):  # until it has begun
        until = time.monotonic() + 60
        while not list(folder.glob("out/*.3b")) and time.monotonic() < until:
            time.sleep(0.01)
    else:  # more than a pipe holds: it has begun to read
        run.stdin.write(b" " * 500_000)
        run.stdin.flush()
    # Ctrl-C goes to all processes of the terminal, a kill to one.
    if stop == signal.SIGINT:
        os.killpg(run.pid, stop)
    else:
        os.kill(run.pid, stop)
    said = run.communicate(timeout=60)[1]
    assert run.returncode == (130 if stop == signal.SIGINT else 128 + stop), said
    assert b"Traceback" not in said, said
    assert not leftovers(folder)
    for program in folder.glob("out/*.3b"):
        assert program.read_bytes().endswith(b"DD\n")


@pytest.mark.parametrize("closed", ["stdout", "stderr", "both"])
def test_closed_pipes(folder, closed):
    wedmcam("compile", "p0.dxf", "-o", "x.3b", "--offset", "0.1", cwd=folder)
    for line in (
        ("dump", "x.3b"),
        ("explain", "--list"),
        ("batch", ".", "-o", "out", "--json"),
        ("compile", "p0.dxf", "-o", "-", "--to", "3b"),
        ("inspect", "p0.dxf"),
    ):
        ends = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        gone, open_end = os.pipe()
        os.close(gone)
        for name in ends:
            if closed in (name, "both"):
                ends[name] = open_end
        run = subprocess.Popen([sys.executable, "-m", "wedmcam", *line], cwd=folder, **ends)
        os.close(open_end)
        said = run.communicate(timeout=60)[1] or b""
        assert b"Traceback" not in said, (line, said)
        assert b"internal error" not in said, (line, said)
        assert b"Exception ignored" not in said, (line, said)
        assert not leftovers(folder)
