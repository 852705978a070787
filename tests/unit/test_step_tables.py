"""docs/zd065.md, section Interpolation: its tables and pictures are what the controller does.

The page is compared with what `benchmarks/step_tables.py` makes; the tables with rules that are
written here once more, from the equations of line and circle alone.
"""

import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import made_parts
import step_figures as figures
import step_tables as tables

BLOCKS = [tables.LINE, tables.ARC, tables.BESIDE, tables.RETURN]


def test_the_page_is_up_to_date():
    page = tables.PAGE.read_text("utf-8")
    assert made_parts.filled(page, tables.PARTS) == page, "docs/zd065.md is old: run `make docs`"
    assert sorted(made_parts.parts_of(page)) == sorted(tables.PARTS)


@pytest.mark.parametrize("name", figures.PICTURES)
def test_pictures_are_up_to_date_and_shown(name):
    text = (figures.FIGURES / name).read_text("utf-8")
    assert text == figures.PICTURES[name](), f"{name} is old: run `make docs`"
    ET.fromstring(text)
    assert f"](figures/{name})" in tables.PAGE.read_text("utf-8")


@pytest.mark.parametrize("block", BLOCKS)
def test_step_tables_obey_the_equations(block):
    """F at every place is that of the equation; its sign decides; J is what is still to count."""
    place, f, left = block.start, 0, block.count
    for row in block.rows():
        assert row.before == f == block.f_at(place)
        x, y = place
        if block.turn:
            # In is towards the centre, out is away from it; never more than 1 um off the circle.
            nearer = sum(v * v for v in row.place) < x * x + y * y
            assert nearer == (f >= 0)
            radii = [(p[0] ** 2 + p[1] ** 2) ** 0.5 for p in (row.place, block.start)]
            assert abs(radii[0] - radii[1]) <= 1
            across_y = abs(x) >= abs(y)
            # The turn about the centre has the sense of the block.
            assert (x * row.place[1] - y * row.place[0]) * block.turn >= 0
        else:
            assert (row.axis == 0) == (f >= 0)
            across_y = block.y >= block.x
        assert abs(row.place[0] - x) + abs(row.place[1] - y) == 1
        left -= (row.axis == 1) == across_y
        assert row.left == left
        place, f = row.place, row.after
    assert left == 0


def test_the_published_steps_of_a_line():
    assert "".join("XY"[r.axis] for r in tables.LINE.rows()) == "XYXYXXYXYX"
    assert tables.LINE.places()[-1] == (6, 4)


def test_arcs_of_the_page_change_quadrants():
    assert {r.name for r in tables.ARC.rows()} == {"NR1", "NR2"}
    assert {r.name for r in tables.BESIDE.rows()} == {"NR4", "NR1"}
    assert tables.ARC.places()[-1] == (-4, 0)


@pytest.mark.parametrize("block", BLOCKS)
def test_undone_is_every_state_of_the_table(block):
    undone = tables.undo(block, block.places()[-1])
    states = [(r.place, r.after, r.left) for r in block.rows()]
    assert [u[:3] for u in undone] == [*states[::-1], (block.start, 0, block.count)]


def test_steps_that_count_are_those_along_the_sides():
    """Of R = 10,000 um a half side is 7071 steps, in every octant."""
    for (_, axis), counted in zip(tables.OCTANTS, tables.octant_counts(10_000), strict=True):
        assert counted["xy".index(axis)] == 7071


def test_either_step_at_45_degrees_counts_too_many():
    for radius in (5, 17, 400):
        on_y, on_x, either = tables.full_circle(radius)
        assert on_y == on_x <= either <= on_y + 4


def test_pixels_and_numbers_of_a_picture_are_those_of_the_table():
    svg = figures.line_figure()
    numbers = re.findall(r"<text [^>]*>(\d+)</text>", svg)
    assert [int(n) for n in numbers] == list(range(11))
    assert svg.count("<rect") == 1 + 11 + sum(r.counted for r in tables.LINE.rows())


def test_neighbours_are_repaired_and_opposites_refused():
    lines = tables.angle_table().splitlines()[2:]
    assert len(lines) == 12
    assert all(line.count("refused") == 1 and line.count("**") == 4 for line in lines)
    cutting = tables.repair_table().splitlines()[2:]
    assert [line.count("**") // 2 for line in cutting] == [2, 2, 0] * 3
