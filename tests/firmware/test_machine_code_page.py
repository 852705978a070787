"""Size and speed of the machine code, and what docs/zd065.md says of them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from blocks import line
from machine import ROM, ROOT
from speed import display_cycles, rows

from wedmcam.formats.compact import LINE

PAGE = " ".join((ROOT / "docs" / "zd065.md").read_text("utf-8").split("## Machine code")[1].split())
EPROMS = 8192


def test_it_fits_two_eproms(image):
    assert len(image.rom) == EPROMS
    assert not any(image.rom[image.size - 6 : EPROMS - 6])  # nothing but filler behind its end
    assert image.size <= EPROMS
    assert f"It takes {image.size:,} of the {EPROMS:,} bytes" in PAGE


def test_cycles_are_those_of_the_page(image):
    for row in rows(image):
        assert " ".join(row.split()) in PAGE, row
    assert f"takes {display_cycles(image)} cycles every 2 ms" in PAGE


def test_addresses_are_those_of_the_page(image):
    names = image.names
    assert f"${names['data']:04X}..${names['data_end'] - 1:04X}" in PAGE
    assert f"${ROM:04X}..$FFFF" in PAGE
    for name in ("generator", "digits"):
        assert f"${names[name]:04X}.." in PAGE
    codes = ("no_instruction", "bad_digit", "no_step", "too_small", "too_large", "no_end")
    assert [names[code] for code in (*codes, "no_play")] == list(range(1, 8))


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        ("line_u_v", "line_u_aside"),
        ("line_v_v", "line_v_aside"),
        ("before_v", "before_high"),
        ("after_v", "after_v_carry"),
    ],
)
def test_no_loop_lies_in_two_pages(image, begin, end):
    assert image.names[begin] >> 8 == image.names[end] >> 8


def test_make_assembles_the_same_image(image, tmp_path):
    makefile = (ROOT / "Makefile").read_text("utf-8")
    arguments = re.search(r"^\t\$\(BIN\)/ophis (.*)$", makefile, re.M).group(1)
    command = [
        Path(sys.executable).parent / "ophis",
        *arguments.replace("build", str(tmp_path)).split(),
    ]
    subprocess.run(command, cwd=ROOT, check=True)
    assert (tmp_path / "zd065.bin").read_bytes() == image.rom


def test_a_program_can_be_run_from_the_command_line(tmp_path):
    path = tmp_path / "a.zd"
    path.write_bytes(line(LINE, 3, 120, 50) + b"\0")
    command = [sys.executable, str(ROOT / "tests" / "firmware" / "machine.py"), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "170, to (-0.120, -0.050) mm" in done.stdout
    path.write_bytes(line(LINE, 3, 120, 50) + b"\x99")
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1
    assert "error     1 in block 2" in done.stdout
