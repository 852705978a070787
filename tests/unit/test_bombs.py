"""Drawings that are made to be too much: an error in a few lines, in bounded time and memory."""

import pytest

from wedmcam import api
from wedmcam.diag.render import merged, render

HEAD = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n"


def dxf(*entities):
    return f"{HEAD}0\nSECTION\n2\nENTITIES\n{''.join(entities)}0\nENDSEC\n0\nEOF\n".encode()


def circle(x, y, r, layer="0"):
    return f"0\nCIRCLE\n8\n{layer}\n10\n{x}\n20\n{y}\n40\n{r}\n"


def line(x0, y0, x1, y1):
    return f"0\nLINE\n8\n0\n10\n{x0}\n20\n{y0}\n11\n{x1}\n21\n{y1}\n"


def point(x, y):
    return f"0\nPOINT\n8\nSTART\n10\n{x}\n20\n{y}\n"


def refused(data, **more):
    """Compile a drawing that is refused; return its codes, and what is printed of it."""
    made = api.compile(data, offset=0.1, **more)
    assert made.status == 1
    text = "\n".join(render(d) for d in merged(made.findings))
    assert text.count("\n") < 200
    assert len(text) < 30_000
    assert len(made.summary["diagnostics"]) < 100
    return {d.code for d in made.findings}, text


def test_field_star_junction():
    star = [line(0, 0, 100 - k * 0.01, k) for k in range(2500)]
    codes, text = refused(dxf(*star))
    assert codes == {"branch"}
    assert "2500 segments meet at (0.000, 0.000)" in text
    assert "and 2,492 more" in text


def test_field_points():
    codes, text = refused(dxf(circle(0, 0, 5), *(point(k % 50, k // 50) for k in range(300))))
    assert codes <= {"thread-point-unused", "thread-point-twice"}
    assert "further thread points were not looked at" in text


def test_field_circles_over_each_other(monkeypatch):
    # 500 circles are 125,000 pairs, of which all cross: a part of them is looked at.
    monkeypatch.setattr("wedmcam.transforms.meetings.PART", 5_000)
    monkeypatch.setattr("wedmcam.transforms.meetings.ENOUGH", 1_000)
    codes, text = refused(dxf(*(circle(round(k * 0.002, 4), 0, 5) for k in range(500))))
    assert "crossing-contours" in codes
    assert "at least" in text


def test_field_nested():
    codes, text = refused(dxf(*(circle(0, 0, 1 + k * 0.5) for k in range(250))))
    assert codes == {"too-large"}
    assert "249 contours lie in each other; no more than 200 are compiled" in text


def test_a_nesting_that_is_meant_is_compiled():
    made = api.compile(dxf(*(circle(0, 0, 1 + k * 0.5) for k in range(20))), offset=0.1)
    assert made.ok


@pytest.mark.parametrize(
    ("module", "name", "least"),
    [
        ("wedmcam.frontends.dxf.load", "MOST_LINES", 100),
        ("wedmcam.frontends.dxf.load", "MOST_BYTES", 1000),
        ("wedmcam.frontends.dxf.place", "MOST_SEGMENTS", 10),
        ("wedmcam.transforms.nest", "MOST_CLOSED", 10),
    ],
)
def test_field_what_is_larger_than_any_part_is_refused(monkeypatch, module, name, least):
    monkeypatch.setattr(f"{module}.{name}", least)
    codes, text = refused(dxf(*(circle(3 * k, 0, 1) for k in range(50))))
    assert codes == {"too-large"}
    assert text.startswith("input")


def test_copies_by_a_transform_are_counted(monkeypatch):
    monkeypatch.setattr("wedmcam.transforms.nest.MOST_CLOSED", 10)
    codes, _ = refused(dxf(circle(0, 0, 1)), transforms=["translate (3, 0) copies 20"])
    assert codes == {"too-large"}


def test_a_drawing_too_dense_to_be_looked_through_is_refused(monkeypatch):
    monkeypatch.setattr("wedmcam.transforms.meetings.MOST_PAIRS", 100)
    monkeypatch.setattr("wedmcam.transforms.meetings.PART", 50)
    codes, text = refused(dxf(*(circle(0, 0, 1 + k) for k in range(60))))
    assert codes == {"too-large"}
    assert "too dense" in text


def test_parts_of_pairs_find_what_all_pairs_find(monkeypatch):
    data = dxf(*(circle(k % 7 * 8, k // 7 * 9, 5) for k in range(40)))
    whole = api.compile(data, offset=0.1).findings
    monkeypatch.setattr("wedmcam.transforms.meetings.PART", 10)
    assert api.compile(data, offset=0.1).findings == whole
