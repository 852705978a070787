"""ARCHITECTURE.md: the arc that it follows through the stages is followed here too."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "ARCHITECTURE.md").read_text("utf-8")


def _commands():
    """Yield each command line with the lines of its output that the page shows."""
    for block in re.findall(r"^```console\n(.*?)^```$", TEXT, re.S | re.M):
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            line, *shown = part.splitlines()
            yield line, shown


def test_the_commands_of_the_page_print_what_it_shows(tmp_path):
    commands = list(_commands())
    assert len(commands) >= 8
    wedmcam = f"{shlex.quote(sys.executable)} -m wedmcam"
    for line, shown in commands:
        there = line.replace("/tmp", str(tmp_path))
        command = re.sub(r"\bwedmcam (?=[a-z]+ )", f"{wedmcam} ", there)
        ran = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True)
        assert ran.returncode == 0, f"{line}: {ran.stderr}"
        output = iter((ran.stdout + ran.stderr).splitlines())
        for expected in shown:
            assert expected in output, f"{line}: not printed, or in another order: {expected}"


def test_every_file_that_the_page_names_is_there():
    places = [ROOT, *(p for room in ("src/wedmcam", "tests") for p in (ROOT / room).rglob("*"))]
    folders = [p for p in (*places, ROOT / "src" / "wedmcam") if p.is_dir()]
    for name in set(re.findall(r"`([\w/]+\.(?:py|toml|lark))`", TEXT)):
        assert any((folder / name).is_file() for folder in folders), name
    for name in set(re.findall(r"`(\w+(?:/\w+)*/)`", TEXT)):
        assert any((folder / name).is_dir() for folder in folders), name
