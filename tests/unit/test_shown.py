"""What is shown of text that came out of files: visible, of bounded length, capped in number."""

import json
import math
from enum import Enum
from fractions import Fraction
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wedmcam.diag import (
    EntityRef,
    Place,
    Severity,
    TextSpan,
    as_data,
    capped,
    error,
    json_text,
    note,
    visible,
    warning,
)
from wedmcam.diag.capped import KEPT, NOTES
from wedmcam.diag.lists import all_of, first_of
from wedmcam.diag.render import excerpt, merged, render
from wedmcam.diag.run import Run
from wedmcam.diag.shown import LONGEST
from wedmcam.judge.certificate import finding_data
from wedmcam.reports.picture.sheet import words

ANY = st.text(st.characters(), max_size=40)
BIDI = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\u200e\u200f\u061c"


@given(ANY, ANY, ANY, ANY)
def test_a_finding_about_any_text_is_visible(message, layer, hint, other):
    found = error(
        "branch",
        "{message}",
        EntityRef(other, "1", layer, layer),
        hint="{advice}",
        notes=((other, EntityRef("a", layer, "LINE", message)),),
        message=message,
        advice=hint,
    )
    for line in render(found, other).split("\n"):
        assert visible(line) == line
        line.encode("utf-8")


@given(ANY, st.integers(1, 60), st.integers(1, 9))
def test_an_excerpt_of_any_text_is_visible(text, column, length):
    for line in excerpt(text, TextSpan("a", 1, column, length)):
        assert visible(line, "\t") == line
        line.encode("utf-8")


@pytest.mark.parametrize("character", ["\x1b", "\x07", "\x7f", "\x9b", "\ud800", "\ufeff", *BIDI])
def test_what_drives_a_terminal_or_turns_a_line_is_escaped(character):
    assert visible(f"a{character}b") == visible(visible(f"a{character}b"))
    assert character not in visible(f"a{character}b")
    assert character not in json_text(character)
    assert json.loads(json_text(character)) == character


def test_letters_of_all_languages_stay():
    text = "Schnitt-µ 切割 \u3000الطبقة \u200cنمی‌خواهم Ø Ω"
    assert visible(text) == text


@given(ANY)
def test_json_is_utf_8_and_gives_the_same_text_back(text):
    assert json.loads(json_text([text]).encode("utf-8")) == [text]


@given(ANY)
def test_any_text_is_well_formed_xml(text):
    ElementTree.fromstring(f'<a b="{words(text)}">{words(text)}</a>'.encode())


def test_a_long_line_is_shown_around_its_mark():
    lines = excerpt("a" * 10**6 + "!" + "b" * 10**6, TextSpan("x", 1, 10**6 + 1))
    assert all(len(line) < 200 for line in lines)
    assert lines[0][lines[1].index("^")] == "!"


def test_a_message_is_not_longer_than_a_page():
    assert len(error("branch", "x" * 10**6).message) < 2100
    assert len(render(error("branch", "x", EntityRef("f", "1", "L", "y" * 10**6)))) < 500


def many(count, code="branch", say=error):
    return [say(code, f"at {k}", TextSpan("a", k + 1, 1)) for k in range(count)]


def test_few_findings_are_all_there():
    found = many(KEPT)
    assert capped(found) == found


def test_of_many_findings_the_first_are_told_and_the_others_counted():
    found = capped(many(100_000))
    assert found[:KEPT] == many(KEPT)
    assert len(found) == KEPT + 1
    assert found[-1].message == f"and {100_000 - KEPT:,} more of this kind"
    assert found[-1].count == 100_000 - KEPT


def test_equal_findings_count_as_one_of_those_told():
    found = capped([*[error("overlap", "the same")] * 5000, *many(3, "overlap")])
    assert [d.message for d in found] == ["the same", "at 0", "at 1", "at 2"]
    assert "(x 5000)" in render(found[0])


@given(
    st.lists(
        st.tuples(st.sampled_from(["branch", "overlap"]), st.sampled_from([error, warning, note])),
        max_size=150,
    ),
    st.integers(0, 150),
)
def test_capping_in_parts_is_capping_at_once(kinds, cut):
    found = [say(code, f"at {k}") for k, (code, say) in enumerate(kinds)]
    once = capped(found)
    assert capped(once) == once
    assert sorted(map(str, capped([*capped(found[:cut]), *found[cut:]]))) == sorted(map(str, once))
    assert sum(d.count * d.times for d in once) == len(found)


def test_a_run_keeps_findings_capped():
    run = Run()
    run.add("x", many(1000, say=note))
    run.add("y", many(1000, "overlap", say=note))
    assert len(run.findings) == 2 * (KEPT + 1)
    assert len(merged(run.findings)) == len(run.findings)


def test_a_finding_names_few_places_beside_its_own():
    some = tuple(("this meets there", TextSpan("a", k, 1)) for k in range(10_000))
    found = capped([error("branch", "many meet", notes=some)])[0]
    assert len(found.notes) == NOTES + 1
    assert found.notes[-1][0] == "and 9,992 more"


class Wide(int, Enum):
    """A number that has a name."""

    FULL = 1


@pytest.mark.parametrize(
    ("value", "data"),
    [
        (math.nan, None),
        (-math.inf, None),
        (np.float32("inf"), None),
        (10**400, None),
        (10**15, 10**15),
        (np.bool_(True), True),
        (np.int64(3), 3),
        (-1e-9, 0.0),
        (Fraction(1, 3), 0.333333),
        (np.array([1, 2]), [1, 2]),
        (Place.of_um(1000, 1 / 3), [1.0, 0.000333]),
        (Wide.FULL, "Wide.FULL"),
        (Severity.ERROR, "error"),
        (all_of(["a", math.nan]), ["a", None]),
        (first_of(["a", "b", "c"], 2), {"first": ["a", "b"], "more": 1}),
        (list(range(KEPT + 5)), {"first": list(range(KEPT)), "more": 5}),
        (first_of(range(KEPT + 5), KEPT + 1), {"first": list(range(KEPT)), "more": 5}),
    ],
)
def test_values_are_valid_json_of_bounded_size(value, data):
    assert as_data(value) == data
    assert type(as_data(value)) is type(data)
    json.dumps(as_data(value), allow_nan=False)


def test_values_and_hints_are_as_long_as_messages_at_most():
    long = error("branch", "{a}", hint="{a}", a="x" * 10 * LONGEST)
    [value] = finding_data(long)["values"].values()
    assert len(value) < 1.1 * LONGEST
    assert long.message == long.hint == value
    assert render(long).count(" characters) ... ") == 2
