"""The picture shows the program's own arcs and ends, is deterministic, and keeps labels apart."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import parts
from plans import one_scene
from wedmcam.diag import CODES, EntityRef, error
from wedmcam.ir.contour import VERTEX, Contour
from wedmcam.ir.plan import Cut, Plan, Side
from wedmcam.ir.program import BLOCK, Axis, Kind, Program, Role
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.reports.picture.program import DETAILED, LABELS, plot, plot_contours
from wedmcam.reports.picture.sheet import Caption, Sheet

NS = {"s": "http://www.w3.org/2000/svg"}
Made = tuple[Program, np.ndarray, np.ndarray]

LINE, ARC, MOVE, PAUSE, STOP = Kind.LINE, Kind.ARC, Kind.MOVE, Kind.PAUSE, Kind.STOP


def program(rows: list[tuple], origin: tuple[int, int] = (0, 0), **more) -> Made:  # type: ignore[no-untyped-def, type-arg]
    """(kind, turn, x, y, count, end - start, role, cut) rows as a program with its ends."""
    blocks = np.zeros(len(rows), BLOCK)
    way = np.zeros((len(rows) + 1, 2), np.int64)
    for i, (kind, turn, x, y, count, step, role, cut) in enumerate(rows):
        blocks[i] = (kind, turn, Axis.X, role, x, y, count, 0 if kind == ARC else -1, cut)
        way[i + 1] = step
    way[0] = origin
    places = np.cumsum(way, axis=0)
    return Program(blocks, origin, **more), places[:-1], places[1:]


def hole() -> Made:
    """The published hole: radius 10 mm, offset 0.1 mm inside, from and back to the centre."""
    return program(
        [
            (LINE, 0, 9900, 0, 9900, (9900, 0), Role.LEAD_IN, 1),
            (ARC, 1, 9900, 0, 39600, (0, 0), Role.CONTOUR, 1),
            (LINE, 0, -9900, 0, 9900, (-9900, 0), Role.LEAD_OUT, 1),
            (STOP, 0, 0, 0, 0, (0, 0), Role.CONTOUR, 0),
        ],
        sources=(EntityRef("hole.dxf", "2F", "CIRCLE", "<CUT>"),),
    )


def hole_plan(side: Side = Side.PART) -> Plan:
    outline, path = parts.circle(0, 0, 10000), parts.circle(0, 0, 9900)
    cut = Cut(outline, path, (0, 0), keeps_left=False)
    return one_scene((cut,), (outline,), (0,), side, 100.0)


def tree(svg: str) -> ET.Element:
    assert not re.search(r"\bnan\b|\binf\b|-0[^.\d]", svg)
    return ET.fromstring(svg)


def blocks_of(root: ET.Element) -> dict[int, ET.Element]:
    """Path elements by the block number that their tool tip gives."""
    out = {}
    for path in root.iterfind(".//s:path", NS):
        told = path.find("s:title", NS)
        match = told is not None and told.text and re.match(r"block (\d+):", told.text)
        if match:
            out[int(match[1])] = path
    return out


def commands(path: ET.Element) -> list[tuple[str, list[float]]]:
    parsed = re.findall(r"([A-Z])([^A-Z]*)", path.get("d") or "")
    return [(name, [float(v) for v in values.split()]) for name, values in parsed]


def labels(root: ET.Element) -> list[str]:
    group = root.find(".//s:g[@id='labels']", NS)
    assert group is not None
    return [t.text or "" for t in group]


def test_a_hole_is_drawn_from_its_blocks() -> None:
    svg = plot(*hole(), plan=hole_plan(), caption=Caption("hole.dxf", {"blocks": "3"}))
    root = tree(svg)
    drawn = blocks_of(root)
    assert sorted(drawn) == [1, 2, 3]
    assert commands(drawn[1]) == [("M", [0, 0]), ("L", [9.9, 0])]
    circle = commands(drawn[2])
    assert circle[0] == ("M", [9.9, 0])
    assert [name for name, _ in circle[1:]] == ["A"] * 4
    ends = [(0, 9.9), (-9.9, 0), (0, -9.9), (9.9, 0)]
    for (_, values), end in zip(circle[1:], ends, strict=True):
        assert values[:5] == [9.9, 9.9, 0, 0, 1]  # sweep 1 is counter-clockwise with y up
        assert values[5:] == pytest.approx(end, abs=1e-9)
    text = [t.text or "" for t in root.iterfind(".//s:text", NS)]
    assert {"hole.dxf", "T1", "20.000"} <= set(text)
    assert "0.100 mm" in svg
    told = drawn[2].find("s:title", NS)
    assert told is not None
    assert told.text is not None
    assert told.text.endswith("J 39600 on x; hole.dxf:#2F layer <CUT>")
    assert "arc ccw R 9.900" in told.text


def test_y_points_up() -> None:
    root = tree(plot(*hole()))
    group = root.find(".//s:g[@id='drawing']", NS)
    assert group is not None
    a, b, c, d, *_ = map(float, (group.get("transform") or "")[7:-1].split())
    assert (b, c) == (0, 0)
    assert a == -d > 0


def test_the_same_twice() -> None:
    assert plot(*hole(), plan=hole_plan()) == plot(*hole(), plan=hole_plan())


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("miss", [(0, 0), (1, 0), (-1, 1), (0, -1)])
def test_a_half_circle_keeps_its_centre_whatever_its_end_misses(
    turn: int, miss: tuple[int, int]
) -> None:
    step = (-20000 + miss[0], miss[1])
    made = program([(ARC, turn, 10000, 0, 20000, step, 0, 1)])
    path = commands(blocks_of(tree(plot(*made)))[1])
    at = np.array([p[-2:] for _, p in path])
    assert at[-1] == pytest.approx(np.array(step) / 1000)
    apex = at[1:-1]
    assert len(apex) >= 1
    # The centre lies at (-10, 0) mm: every point between is on its circle, on the right side.
    assert np.hypot(apex[:, 0] + 10, apex[:, 1]) == pytest.approx(10, abs=1e-4)
    assert (apex[:, 1] * turn > 0).all()
    assert all(p[4] == (turn > 0) for name, p in path if name == "A")


def test_full_circles_and_next_to_nothing_are_told_apart() -> None:
    for miss in ((0, 0), (0, 1), (0, -1)):
        full = program([(ARC, 1, 5000, 0, 20000, miss, 0, 1)])
        assert len(commands(blocks_of(tree(plot(*full)))[1])) >= 5
        tiny = program([(ARC, 1, 5000, 0, 1, miss, 0, 1), (LINE, 0, 9, 0, 9, (9, 0), 0, 1)])
        assert len(commands(blocks_of(tree(plot(*tiny)))[1])) == 2


def test_ends_come_from_the_interpolator_not_the_plan() -> None:
    made = program([(LINE, 0, 17000, 5000, 17000, (17000, 4999), 0, 1)])
    assert commands(blocks_of(tree(plot(*made, plan=hole_plan())))[1])[-1] == ("L", [17, 4.999])


def two_cuts() -> Made:
    return program(
        [
            (LINE, 0, 5000, 0, 5000, (5000, 0), Role.LEAD_IN, 2),
            (LINE, 0, 0, 5000, 5000, (0, 5000), Role.CONTOUR, 2),
            (PAUSE, 0, 0, 0, 0, (0, 0), 0, 0),
            (LINE, 0, 0, 5000, 5000, (0, 5000), Role.CONTOUR, 2),
            (PAUSE, 0, 0, 0, 0, (0, 0), 0, 0),
            (MOVE, 0, 20000, 0, 20000, (20000, 0), 0, 1),
            (PAUSE, 0, 0, 0, 0, (0, 0), 0, 0),
            (LINE, 0, 0, -9000, 9000, (0, -9000), Role.CONTOUR, 1),
            (LINE, 0, 0, -500, 500, (0, -500), Role.OVERCUT, 1),
            (STOP, 0, 0, 0, 0, (0, 0), 0, 0),
        ],
        origin=(-7000, 3000),
    )


def test_cuts_moves_roles_and_pauses() -> None:
    root = tree(plot(*two_cuts()))
    ids = [g.get("id") for g in root.iterfind(".//s:g[@id]", NS)]
    assert ids.index("cut-2") < ids.index("cut-1")  # in the order of cutting
    moves = root.find(".//s:g[@id='moves']", NS)
    assert moves is not None
    assert moves.get("stroke-dasharray")
    assert len(moves) == 1
    classes = [g.get("class") for g in root.iterfind(".//s:g[@class]", NS)]
    assert classes == ["contour", "lead_in", "contour", "overcut"]
    waits = [t.text for t in root.iterfind(".//s:rect/s:title", NS)]
    assert waits == ["block 3: the machine waits"]  # those about a move are no pause
    assert {"T1", "T2", "1", "8"} <= set(labels(root))


def test_a_decoded_program_counts_its_cuts_from_the_moves() -> None:
    made, starts, ends = two_cuts()
    blocks = made.blocks.copy()
    blocks["cut"] = 0
    root = tree(plot(Program(blocks), starts, ends))
    assert {"T1", "T2"} <= set(labels(root))
    crosses = [t.text for t in root.iterfind(".//s:g[@id='symbols']//s:g/s:title", NS)]
    assert crosses == [
        "thread point of cut 1 at (-7.000, 3.000) mm",
        "thread point of cut 2 at (18.000, 13.000) mm",
    ]


def test_sides_decide_what_is_hatched() -> None:
    def kept(side: Side) -> str | None:
        path = tree(plot(*hole(), plan=hole_plan(side))).find(".//s:path[@id='kept-material']", NS)
        return None if path is None else path.get("d")

    part, die = kept(Side.PART), kept(Side.DIE)
    assert part is not None
    assert die is not None
    assert part.count("M") == 1
    assert die.count("M") == 2  # a frame around the outline: even-odd fills between
    assert kept(Side.ON) is None


def test_the_kerf_is_as_wide_as_the_wire_cuts() -> None:
    plan = hole_plan()
    wide = one_scene(plan.cuts, plan.outlines, plan.depths, plan.side, 150.0)
    kerf = tree(plot(*hole(), plan=wide)).find(".//s:path[@id='kerf']", NS)
    assert kerf is not None
    assert kerf.get("stroke-width") == "0.3"
    assert tree(plot(*hole(), plan=wide, kerf=False)).find(".//s:path[@id='kerf']", NS) is None


@pytest.mark.parametrize("count", [DETAILED, 20 * DETAILED])
def test_many_blocks_share_paths_and_few_are_numbered(count: int) -> None:
    k = np.arange(count)
    angle = k * 2 * math.pi / count
    places = np.round(50e3 * np.column_stack([np.cos(angle), np.sin(angle)])).astype(np.int64)
    steps = np.roll(places, -1, axis=0) - places
    blocks = np.zeros(count, BLOCK)
    blocks["x"], blocks["y"], blocks["cut"] = steps[:, 0], steps[:, 1], 1
    blocks["source"] = -1
    blocks["count"] = np.abs(steps).max(axis=1)
    svg = plot(Program(blocks), places, places + steps)
    root = tree(svg)
    numbers = [t for t in labels(root) if t.isdigit()]
    assert "1" in numbers
    assert len(numbers) <= LABELS + 1
    path = root.findall(".//s:g[@class='contour']/s:path", NS)
    assert len(path) == (count if count <= DETAILED else 1)
    assert sum((p.get("d") or "").count("L") for p in path) == count


def test_block_numbers_keep_apart() -> None:
    gear = parts.gear(400)
    v = np.round(np.column_stack([gear.vertices["x"], gear.vertices["y"]])).astype(np.int64)
    blocks = np.zeros(len(v), BLOCK)
    step = np.roll(v, -1, axis=0) - v
    blocks["x"], blocks["y"], blocks["cut"], blocks["source"] = *step.T, 1, -1
    root = tree(plot(Program(blocks), v, v + step))
    group = root.find(".//s:g[@id='labels']", NS)
    assert group is not None
    seen = [
        (float(t.get("x", 0)), float(t.get("y", 0)), len(t.text or ""))
        for t in group
        if (t.text or "").isdigit()
    ]
    assert 50 < len(seen) <= LABELS + 1
    for i, (x, y, n) in enumerate(seen):
        for u, w, m in seen[:i]:
            assert abs(y - w) > 8.9 or abs(x - u) > 2.5 * (n + m)


def test_nothing_to_draw_is_a_sheet_all_the_same() -> None:
    tree(plot(*program([(STOP, 0, 0, 0, 0, (0, 0), 0, 0)])))
    tree(plot(*program([])))
    tree(plot_contours([]))


def test_text_is_made_safe() -> None:
    odd = 'a<b>&"c"\x07\udcff' + "x" * 200
    root = tree(plot(*hole(), caption=Caption(odd, {odd: odd})))
    title = root.find("s:title", NS)
    assert title is not None
    assert (title.text or "").startswith('a<b>&"c"\\x07\\xffxx')


def test_contours_alone() -> None:
    corner = np.array([(0, 0, 0, 0, 0, 0), (9e3, 0, 0, 0, 0, 0), (9e3, 9e3, 0, 0, 0, -1)], VERTEX)
    opened = Contour(corner, False, (EntityRef("a.dxf", "1F", "LINE", "CUT"),))
    found = error(next(iter(CODES)), "a gap", points_mm=((9, 9), (0, 0)))
    svg = plot_contours(
        [parts.rectangle(40e3, 30e3, -50e3), parts.circle(-30e3, 15e3, 5e3), opened],
        thread_points=[ThreadPoint(-30e3, 15e3)],
        marks=[found],
        title="plate.dxf",
    )
    root = tree(svg)
    # It is not known here in which order contours are cut: a thread point has no number.
    assert {"1", "2", "3", "T", "59.000", "30.000"} <= set(labels(root))
    crosses = [t.text for t in root.iterfind(".//s:g[@id='symbols']//s:g/s:title", NS)]
    assert crosses == ["thread point at (-30.000, 15.000) mm"]
    rings = root.findall(".//s:g[@id='symbols']/s:circle", NS)
    assert sorted(r.get("r") or "" for r in rings) == ["5", "5", "9", "9"]
    told = [t.text or "" for t in root.iterfind(".//s:path/s:title", NS)]
    assert "contour 3: line, (0.000, 0.000) to (9.000, 0.000) mm; a.dxf:#1F layer CUT" in told
    assert any("contour 2: arc R 5.000, 360.00 degrees" in t for t in told)
    whole = root.find(".//s:path[@id='kept-material']", NS)
    assert whole is not None
    assert (whole.get("d") or "").count("Z") == 2


def test_extents_include_the_apex_of_an_arc() -> None:
    bow = parts.contour_of_bulges(np.array([(0.0, 0), (10e3, 0)]), np.array([-1.0, 0]))
    assert "5.000" in labels(tree(plot_contours([bow])))


def test_sheets_stand_upright_for_tall_parts() -> None:
    tall = Sheet((0, 0, 8.5, 40), "", 0)
    assert tall.height > tall.width
    x, y = tall.at(8.5, 40)
    assert 0 < x < tall.width
    assert 0 < y < tall.height
    assert tall.at(0, 0)[1] > y


def test_a_taken_place_is_refused_unless_forced() -> None:
    sheet = Sheet((0, 0, 10, 10), "", 0)
    assert sheet.claim((100, 100, 130, 110))
    assert not sheet.claim((125, 105, 140, 115))
    assert sheet.claim((125, 105, 140, 115), force=True)
    assert sheet.claim((141, 105, 150, 115))


def test_of_very_many_thread_points_some_are_drawn() -> None:
    from wedmcam.reports.picture.sheet import Sheet
    from wedmcam.reports.picture.threads import MOST, draw_threads

    sheet = Sheet((0.0, 0.0, 100.0, 100.0), "many", 0)
    ((_, told),) = draw_threads(sheet, [(k % 100, k // 100, "T", "") for k in range(3 * MOST)])
    assert told.endswith(", 2,000 more are not drawn")
