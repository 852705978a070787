"""docs/machines.md: its tables and its picture are measured, and its commands are run."""

import sys
import xml.etree.ElementTree as ET

from page_commands import ROOT, run_page

sys.path.insert(0, str(ROOT / "benchmarks"))

import machine_tables as tables
import made_parts


def test_every_table_of_the_page_is_made_and_every_one_that_is_made_stands_there():
    """Whether they are up to date is what test_pages asks for."""
    page = tables.PAGE.read_text("utf-8")
    assert sorted(made_parts.parts_of(page)) == sorted(tables.PARTS)
    ET.fromstring(tables.FIGURE.read_text("utf-8"))


def test_a_controller_that_leads_beside_its_circle_shows():
    """Each lies as far off as its rules say: a step and no more, a sagitta, vectors on 2 um."""
    lows = {name: tables.radial(name)[1].min() for name in tables.FORMATS}
    assert -1.01 < lows["zd065"] < -0.5
    sagitta = 3.81e-5 * tables.RADIUS_MM * 1000
    assert -sagitta - 1.5 < lows["nby15"] < -sagitta
    assert -4 < lows["eindhoven"] < -1.5


def test_the_commands_of_the_page_print_what_it_shows(tmp_path):
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    run_page("docs/machines.md", tmp_path, 8)
