"""ARCHITECTURE.md: the arc that it follows through the stages is followed here too."""

import re
from pathlib import Path

from page_commands import run_page

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "ARCHITECTURE.md").read_text("utf-8")


def test_the_commands_of_the_page_print_what_it_shows(tmp_path):
    for name in ("samples", "src"):
        (tmp_path / name).symlink_to(ROOT / name)
    run_page("ARCHITECTURE.md", tmp_path, 8)


def test_every_file_that_the_page_names_is_there():
    places = [ROOT, *(p for room in ("src/wedmcam", "tests") for p in (ROOT / room).rglob("*"))]
    folders = [p for p in (*places, ROOT / "src" / "wedmcam") if p.is_dir()]
    for name in set(re.findall(r"`([\w/]+\.(?:py|toml|lark))`", TEXT)):
        assert any((folder / name).is_file() for folder in folders), name
    for name in set(re.findall(r"`(\w+(?:/\w+)*/)`", TEXT)):
        assert any((folder / name).is_dir() for folder in folders), name
