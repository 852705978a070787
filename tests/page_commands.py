"""Commands that a page of the docs shows, and the lines that they are to print."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import fork_server

ROOT = Path(__file__).parents[1]


def commands_of(page):
    """Yield each command line of a page with the lines of its output that the page shows."""
    text = (ROOT / page).read_text("utf-8")
    for block in re.findall(r"^```console\n(.*?)^```$", text, re.S | re.M):
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            line, *shown = part.splitlines()
            yield line, [text for text in shown if text != "..."]


def run_page(page, folder, least, status=None):
    """Run the commands of a page in a folder, one after the other, and look for what it shows.

    ``status``: command line -> its exit status where that is not 0.
    """
    commands = list(commands_of(page))
    assert len(commands) >= least
    for line, shown in commands:
        ran = run_line(line.replace("/tmp", str(folder)), folder)
        assert ran.returncode == (status or {}).get(line, 0), f"{line}: {ran.stderr}"
        output = iter((ran.stdout + ran.stderr).splitlines())
        for expected in shown:
            assert expected in output, f"{line}: not printed, or in another order: {expected}"


def run_line(line, folder):
    """Run a line as a shell does; one that is a command of wedmcam alone without a shell."""
    if line.startswith("wedmcam ") and not re.search(r"[|&;<>()$`*?\[~#\n]", line):
        ran = fork_server.wedmcam(*shlex.split(line)[1:], cwd=folder)
        ran.stdout, ran.stderr = ran.stdout.decode(), ran.stderr.decode()
        return ran
    wedmcam = f"{shlex.quote(sys.executable)} -m wedmcam"
    command = re.sub(r"\bwedmcam (?=[a-z0-9]+ )", f"{wedmcam} ", line)
    return subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True)
