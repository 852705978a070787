"""Where a program starts in the drawing: on a thread point that is given, or as somebody says."""

from __future__ import annotations

from typing import Any

import pytest

from drawings import drawing
from wedmcam import api
from wedmcam.diag import Severity
from wedmcam.judge.origin import may_start
from wedmcam.judge.track import LOST
from wedmcam.options import WrongUse


def two_holes(starts: list[tuple[float, float]]) -> bytes:
    """Return a plate with two holes of different size, and thread points in the holes."""

    def draw(_: Any, m: Any) -> None:
        m.add_lwpolyline([(0, 0), (1.8, 0), (1.8, 1), (0, 1)], close=True)
        m.add_circle((0.4, 0.5), 0.25)
        m.add_circle((1.2, 0.5), 0.3)
        for at in starts:
            m.add_point(at, dxfattribs={"layer": "START"})

    return drawing(draw)


GIVEN = two_holes([(0.4, 0.5), (1.3, 0.5), (-0.2, 0.3)])
FREE = two_holes([])


def program(source: bytes, **more: Any) -> bytes:
    made = api.compile(source, offset=0.05, **more)
    assert made.ok
    return made.data


def proof(data: bytes, source: bytes, **more: Any) -> api.Proof:
    return api.verify(data, against=source, name="a.3b", offset=0.05, **more)


def codes(found: Any, severity: Severity) -> set[str]:
    return {d.code for d in found if d.severity is severity}


@pytest.mark.parametrize("order", ["given", "nearest", "inner-first"])
def test_a_program_starts_on_any_thread_point_that_is_given(order):
    first = api.compile(GIVEN, offset=0.05).plan.cuts[0].thread
    data = program(GIVEN, order=order)
    done = proof(data, GIVEN)
    assert done.status == 0, [d.message for d in done.findings]
    assert not codes(done.findings, Severity.WARNING)
    (said,) = [
        d.message for d in done.findings if d.message.startswith("the program starts at")
    ] or [""]
    assert bool(said) == (done.program.origin != first)
    if said:
        assert "where the plan threads cut" in said


def test_threaded_elsewhere_it_has_to_be_said():
    """Threaded 0.1 mm beside every thread point of the drawing."""
    other = two_holes([(0.45, 0.5), (1.25, 0.5), (-0.3, 0.3)])
    data = program(other)
    done = proof(data, GIVEN)
    assert done.status == 3
    assert codes(done.findings, Severity.ERROR) == {"origin-unknown"}
    (said,) = [d for d in done.findings if d.code == "origin-unknown"]
    assert said.message == (
        "the program does not prove with its start on any of the 3 thread points that is given; it "
        "would prove if it started at (1.250, 0.500) mm"
    )
    assert "--fit-origin" in said.hint
    fitted = proof(data, GIVEN, fit_origin=True)
    assert fitted.status == 0, [d.message for d in fitted.findings]
    assert codes(fitted.findings, Severity.WARNING) == {"origin-fitted"}
    stated = proof(data, GIVEN, origin_mm=(1.25, 0.5))
    assert stated.status == 0
    assert not codes(stated.findings, Severity.WARNING)
    assert proof(data, GIVEN, origin_mm=(1.26, 0.5)).status == 3


def test_a_wrong_program_on_a_thread_point_that_is_given_has_a_known_origin():
    *lines, end = program(GIVEN).decode().split()
    for k, line in enumerate(lines):
        if "GYNR1" in line:  # a hole, 0.02 mm too large
            x = int(line[1:].split("B")[0])
            lines[k - 1], lines[k + 1] = (
                old.replace(str(int(old[1:].split("B")[0])), str(int(old[1:].split("B")[0]) + 20))
                for old in (lines[k - 1], lines[k + 1])
            )
            lines[k] = f"B{x + 20}B0B{4 * (x + 20)}GYNR1"
            break
    done = proof("\n".join([*lines, end]).encode(), GIVEN)
    assert done.status == 3
    said = codes(done.findings, Severity.ERROR)
    assert said
    assert "origin-unknown" not in said


def test_starts_that_are_typed_are_given_too():
    data = program(FREE, starts=[(1.25, 0.5)])
    assert proof(data, FREE, starts=[(1.25, 0.5)]).status == 0
    assert codes(proof(data, FREE, starts=[(1.2, 0.55)]).findings, Severity.ERROR) == {
        "origin-unknown"
    }


def test_without_a_thread_point_the_fit_is_the_default():
    done = proof(program(two_holes([(1.25, 0.5)])), FREE)
    assert done.status == 0
    assert "origin-fitted" in codes(done.findings, Severity.NOTE)
    asked = proof(program(FREE), FREE, fit_origin=True)
    assert asked.status == 0
    assert not codes(asked.findings, Severity.WARNING)  # the plan's own start is no fit


def test_a_displaced_program_does_not_pass_where_thread_points_are_given():
    """The first lead-in is 10 um too long: the whole part would be cut 10 um beside its place."""
    data = program(GIVEN)
    first, *rest = data.decode().split("\n")
    x = int(first[1:].split("B")[0])
    forged = "\n".join([first.replace(f"B{x}", f"B{x + 10}"), *rest]).encode()
    assert forged != data
    assert proof(forged, GIVEN).status == 3


def test_origin_and_fit_origin_contradict():
    with pytest.raises(WrongUse, match="nothing to fit"):
        proof(program(FREE), FREE, origin_mm=(0, 0), fit_origin=True)


def test_g92_is_no_origin_in_the_drawing():
    """An absolute file in coordinates of its own: it starts on the thread point all the same."""
    made = api.compile(GIVEN, offset=0.05, profile="iso-mm")
    text = made.data.decode()
    assert "G92" in text
    absolute = api.verify(text.encode(), against=GIVEN, profile="iso-mm", offset=0.05, name="a.nc")
    assert absolute.status == 0
    moved = text.replace("G92 X", "G92 X1", 1)
    if moved != text and "G91" in text:
        other = api.verify(
            moved.encode(), against=GIVEN, profile="iso-mm", offset=0.05, name="a.nc"
        )
        assert other.status == 0


def test_of_many_thread_points_only_those_are_tried_that_may_be():
    made = api.compile(GIVEN, offset=0.05)
    many = [(400 + k, 500) for k in range(1, 5000)]
    start = made.plan.cuts[0].thread
    stepping = made.machine.stepping
    may = may_start(made.program, made.plan, [*many, start], stepping=stepping)
    assert start in may
    assert all(abs(x - start[0]) <= LOST for x, _ in may)
