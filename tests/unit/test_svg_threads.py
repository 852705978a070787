"""The picture says which thread point is which, where the program starts, and what is kept."""

from __future__ import annotations

import re

import numpy as np
import pytest

import wedmcam
from drawings import drawing
from wedmcam.reports.picture.sheet import Sheet
from wedmcam.reports.picture.threads import SIZE, draw_threads, kept_ticks

NAME = re.compile(r'<text x="(\S+)" y="(\S+)" font-size="10.5"[^>]*>(T\d+|START)</text>')


def names(svg):
    found = {name: (float(x), float(y)) for x, y, name in NAME.findall(svg)}
    assert len(found) == len(NAME.findall(svg))
    return found


def sheet_of(points):
    x, y = zip(*points, strict=True)
    sheet = Sheet((min(x), min(y), max(x), max(y)), "t", 0)
    rows = [(u, v, f"T{k}", "") for k, (u, v) in enumerate(points, 1)]
    legend = draw_threads(sheet, rows, "START")
    return sheet, legend, sheet.print("d", {}, legend)


def boxes(sheet, svg):
    return [
        sheet.label_box(x, y - 0.36 * SIZE, name, SIZE)
        for name, (x, y) in names(svg).items()
        if name != "START"
    ]


@pytest.mark.parametrize("count", [1, 11, 60, 150])
@pytest.mark.parametrize("pitch", [(1.0, 1.0), (1.0, 0.2)])
def test_names_of_thread_points_never_overprint(count, pitch):
    """More than ten of them did: those without room were printed all the same."""
    points = [(pitch[0] * (k % 12), pitch[1] * (k // 12)) for k in range(count)]
    sheet, legend, svg = sheet_of(points)
    taken = boxes(sheet, svg)
    for k, a in enumerate(taken):
        for b in taken[:k]:
            assert (
                a[2] <= b[0] + 1.6 or b[2] <= a[0] + 1.6 or a[3] <= b[1] + 1.6 or b[3] <= a[1] + 1.6
            )
    (entry,) = legend
    missing = count - len(taken)
    assert entry[1] == (
        "thread point" if not missing else f"thread point, {missing} without room for a number"
    )
    assert missing <= count // 3


def holes(doc, space):
    space.add_lwpolyline([(0, 0), (120, 0), (120, 30), (0, 30)], close=True)
    for k in range(36):
        space.add_circle((6 + 9.5 * (k % 12), 6 + 9 * (k // 12)), 2)


def test_every_thread_point_of_a_plate_of_36_holes_has_its_name():
    made = wedmcam.compile(drawing(holes), name="h.dxf", offset=0.1)
    svg = wedmcam.plot(made, "h")
    assert set(names(svg)) == {"START", *(f"T{k}" for k in range(1, 38))}
    assert "cuts" in svg
    assert "1 outer, 36 holes" in svg
    row = made.understood.rows[0]
    told = f"thread point of cut 1 at ({row.thread.at[0] / 1000:.3f}, "
    assert told in svg
    assert "placed by wedmcam; hole, 4.000 x 4.000 mm, keeps the outside" in svg


PUNCH_AND_DIE = b"""contour k { from (0, 0) line to (20, 0) line to (20, 20) line to (0, 20) close }
contour m { from (40, 0) line to (60, 0) line to (60, 20) line to (40, 20) close }
cut k inside offset 0.1
cut m outside offset 0.1
"""


def test_kept_material_around_a_die_beside_a_punch_has_ticks():
    svg = wedmcam.plot(wedmcam.compile(PUNCH_AND_DIE, name="k.wed"), "k")
    (ticks,) = re.findall(r'<path id="kept-side" d="([^"]+)"', svg)
    pairs = re.findall(r"M(\S+) (\S+)L(\S+) (\S+?)(?=M|$)", ticks)
    assert len(pairs) > 8
    for _, _, x, y in pairs:  # all end outside of the die's outline
        assert not (0 <= float(x) <= 20 and 0 <= float(y) <= 20)
    assert 'id="kept-material"' in svg
    assert "kept side" in svg


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize("turn", [1, -1])
def test_ticks_lie_on_the_kept_side(inside, turn):
    angle = turn * np.linspace(0, 2 * np.pi, 200, endpoint=False)
    sheet = Sheet((-10, -10, 10, 10), "t", 0)
    text = kept_ticks([(10 * np.cos(angle), 10 * np.sin(angle), inside)], sheet)
    ends = np.array(re.findall(r"L(\S+) (\S+?)(?=M|$)", text), float)
    assert len(ends) >= 4
    assert ((np.hypot(*ends.T) < 10) == inside).all()


def test_the_page_lists_the_contours():
    made = wedmcam.compile(drawing(holes), name="h.dxf", offset=0.1)
    from wedmcam import api

    page = api.plot_html(made, "h")
    assert "<summary>cuts 1 outer, 36 holes</summary>" in page
    assert page.count("<li>") == 37
    assert "material: keeps the inside" in page
