"""Subprograms of ISO programs: run where they are called, or refused with the place."""

import re
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wedmcam import api
from wedmcam.api import positions
from wedmcam.diag import Severity
from wedmcam.frontends.iso.subprograms import DEEPEST, MOST_LINES
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin
from wedmcam.operations import convert
from wedmcam.targets import Entries

#: As Sodick's writers put it: the main program ends with M199, the outline stands behind it.
INLINE = (
    "G90\nG92 X0.0 Y0.0\nG01 X5.0 Y0.0\nM98 P0001\nG01 X0.0 Y0.0\nM199\n"
    "N0001\nX5.0 Y5.0\nX10.0\nY-5.0\nX5.0\nY0.0\nM99\n"
)
HEAD = "G21\nG90\nG92 X0.0 Y0.0\n"


def read(text, style="N-label", d=(), **said):
    entered = Entries(d=tuple(d)) if d else None
    said = {"profile": "iso-mm", "subprograms_in": style, **said}
    program, _, found = api.read_program(text.encode(), name="a.nc", entered=entered, **said)
    return program, found


def ends(program):
    moving = program.blocks["kind"] <= Kind.MOVE
    return np.round(positions(program, builtin("iso-mm"))[1][moving] / 1000, 3).tolist()


def refused(text, style="N-label", **said):
    """The message of the only error, all of its lines, and the hint."""
    program, found = read(text, style, **said)
    errors = [d for d in found if d.severity is Severity.ERROR]
    assert program is None
    assert [d.code for d in errors] == ["subprogram"], errors
    return errors[0]


# --- the oracle: text lines, written out one by one -----------------------------------------------


def written_out(text, style):
    """The lines of a program in the order in which they are run: (line number, text)."""
    lines = text.splitlines()
    letter = style[0]

    def run(at, out):
        while True:
            words = lines[at].split()
            if at and words and words[0][0] == letter and words[0][1:].isdigit():
                words = words[1:]
            plain = [x for x in words if x not in ("M98", "M99") and x[0] not in "PL"]
            if plain:
                out.append((at + 1, " ".join(plain)))
            if "M98" in words:
                p = next(int(x[1:]) for x in words if x[0] == "P")
                times = next((int(x[1:]) for x in words if x[0] == "L"), 1)
                label = f"{letter}{p:04d}"
                to = next(i for i, x in enumerate(lines) if x.split()[:1] == [label])
                for _ in range(times):
                    run(to, out)
            if "M99" in words or "M02" in words or "M199" in words:
                return
            at += 1

    out = []
    run(0, out)
    return out


def same_as_written_out(text, style, d=()):
    out = written_out(text, style)
    program, found = read(text, style, d)
    plain = "\n".join(x.replace("M199", "M02") for _, x in out) + "\n"
    expected, told = read(plain, "none", d)
    codes = {d.code for d in found} - {"subprogram-run", "after-end"}
    quiet = {"text-skipped"} | ({"iso-ignored"} if text.startswith("O") else set())  # its number
    assert codes - quiet == {d.code for d in told} - quiet
    if expected is None:
        assert program is None
        return None
    assert program.blocks.tolist() == expected.blocks.tolist()
    assert program.words == expected.words
    at = [s.line for s in program.spans]
    assert at == [out[s.line - 1][0] for s in expected.spans]
    return program


coordinate = st.integers(-30, 30).map(lambda n: f"{n / 10}")
motions = st.one_of(
    st.tuples(coordinate, coordinate).map(lambda p: f"G01 X{p[0]} Y{p[1]}"),
    coordinate.map(lambda x: f"X{x}"),
    st.tuples(coordinate, coordinate).map(lambda p: f"G00 X{p[0]} Y{p[1]}"),
    st.integers(1, 9).map(lambda r: f"G91 G02 X{r}. Y{r}. J{r}.\nG01"),
    st.integers(1, 9).map(lambda r: f"G91 G03 R{r}.5 X1. Y1.\nG01"),
    st.sampled_from(
        [
            "G02",  # what follows is an arc without a centre, here and written out
            "G90",
            "G91",
            "G20",
            "G21",
            "M00",
            "M50",
            "G92 X1.5 Y0.0",
            "",
            "(text)",
        ]
    ),
)


@st.composite
def programs(draw, style):
    """A tree of calls: subprogram n calls only larger numbers, at most eight deep."""
    count = draw(st.integers(1, 6))
    letter = style[0]

    def body(above):
        lines = []
        for _ in range(draw(st.integers(0, 4))):
            if above < count and draw(st.integers(0, 2)) == 0:
                times = draw(st.sampled_from(["", "", " L1", " L2", " L3"]))
                call = f"M98 P{draw(st.integers(above + 1, count)):04d}{times}"
                if style == "O-number" and draw(st.booleans()):
                    call = f"G01 X{draw(coordinate)} {call}"
                lines.append(call)
            else:
                lines.append(draw(motions))
        return lines

    first = ["O9999"] if style == "O-number" else []
    main = [*first, "G21 G90", "G92 X0.0 Y0.0", "G01 X1.0", *body(0), "M98 P0001", "G01 X0.0"]
    end = draw(st.sampled_from(["M02", "M199"])) if style == "N-label" else "M02"
    parts = [
        "\n".join(
            [f"{letter}{n:04d}", *body(n), "G01 X2.5 M99" if style == "O-number" else "M99", ""]
        )
        for n in draw(st.permutations(range(1, count + 1)))
    ]
    return "\n".join([*main, end, *parts])


@pytest.mark.parametrize("style", ["N-label", "O-number"])
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_a_call_is_the_subprogram_written_in_its_place(style, data):
    same_as_written_out(data.draw(programs(style)), style)


# --- the field ------------------------------------------------------------------------------------


def test_field_m98_inline():
    program, found = read(INLINE, profile=None, units_in="mm")
    assert [d.code for d in found] == ["subprogram-run"]
    assert found[0].message == ("subprograms: N0001 run once; 13 blocks are run from 13 lines")
    assert ends(program) == [[5, 0], [5, 5], [10, 5], [10, -5], [5, -5], [5, 0], [0, 0]]
    assert [s.line for s in program.spans] == [3, 8, 9, 10, 11, 12, 5, 6]
    made = convert.convert(
        INLINE.encode(), to="3b", name="a.nc", profile_in="iso-mm", subprograms_in="N-label"
    )
    assert made.data is not None
    assert len(made.data.splitlines()) == 8


def test_two_subprograms_are_named_with_how_often_each_runs():
    text = f"{HEAD}G91\nM98 P1 L2\nM98 P2\nM02\nN1 G01 X1.0\nM98 P2\nM99\nN2 G01 Y1.0\nM99\n"
    assert read(text)[1][-1].message == (
        "subprograms: N1 run 2 times, N2 3 times; 19 blocks are run from 12 lines"
    )


def test_the_example_of_the_page_is_read():
    page = (Path(__file__).parents[2] / "docs" / "iso.md").read_text()
    section = page.split("\n## Subprograms\n")[1].split("\n## ")[0]
    text = re.search(r"```gcode\n(.*?)```", section, re.S)[1]
    program, found = read(text)
    assert ends(program)[-2:] == [[5, 0], [0, 0]]
    assert found[0].message in section


def test_field_m98_inline_asks_who_says_nothing():
    error = refused(INLINE, None, profile="iso-mm")
    assert error.span.line == 4
    assert "In this file every call finds its N-label" in error.message
    assert "--subprograms-in N-label" in error.hint
    program, found = read(INLINE, None, shown=True)
    assert ends(program)[-2] == [5, 0]
    assert "assumed: N-label" in found[0].message
    # Where no style fits there is no picture either: the body from another place is a wrong one.
    _, found = read(INLINE.replace("P0001", "P0007"), None, shown=True)
    assert [d.code for d in found if d.severity is Severity.ERROR] == ["subprogram"]


def test_a_profile_that_is_named_says_the_style():
    mine = replace(builtin("iso-mm"), name="mine")
    labels = replace(mine, iso=replace(mine.iso, subprograms="N-label"))
    assert ends(read(INLINE, None, profile=labels)[0])[-2] == [5, 0]
    programs = replace(mine, iso=replace(mine.iso, subprograms="O-number"))
    said = [d.message for d in read(INLINE, None, profile=programs)[1]]
    assert any("no line opens with O0001" in m for m in said)
    # What is said beside the profile wins.
    assert ends(read(INLINE, "N-label", profile=programs)[0])[-2] == [5, 0]
    assert "runs none" in refused(INLINE, "none", profile=labels).message


def test_a_profile_that_refuses_calls_gives_way_to_what_is_said():
    _, found = read(INLINE, None, profile="makino")
    assert "M98: calls a subprogram; no source states" in " ".join(d.message for d in found)
    text = INLINE.replace("M199", "M02")
    assert ends(read(text, "N-label", profile="makino")[0])[-2] == [5, 0]


def test_field_m98_inline_with_the_profile_of_its_machine():
    program, found = read(INLINE, None, profile="sodick")
    assert [d.code for d in found] == ["subprogram-run"]
    assert ends(program)[-2:] == [[5, 0], [0, 0]]


def test_none_is_refused_in_pictures_too():
    assert "--subprograms-in none runs none" in refused(INLINE, "none").message
    assert "none" in refused(INLINE, "none", shown=True).message


# --- what flows through a call --------------------------------------------------------------------


def test_modes_and_places_go_on_through_a_call():
    text = HEAD + "G01 X1.0\nM98 P1 L3\nX1.0\nM02\nN1 G91 Y2.0\nM99\n"
    program, found = read(text)
    # G91 stays in force behind the call.
    assert ends(program) == [[1, 0], [1, 2], [1, 4], [1, 6], [2, 6]]
    assert found[-1].message == "subprograms: N1 run 3 times; 13 blocks are run from 9 lines"


def test_four_passes_with_an_offset_each():
    """Four offsets, one outline: the table and the H of the main program count in every pass."""
    table = "H001 = 0.2\nH002 = 0.15\nH003 = 0.13\nH004 = 0.12\n"
    passes = "".join(f"G41 H00{n} G01 X5.0 Y0.0\nM98 P0001\n" for n in (1, 2, 3, 4))
    outline = "Y-5.0\nX15.0\nY5.0\nX5.0\nY0.0\nG40 X0.0\nM99\n"
    text = f"{table}G90\nG92 X0.0 Y0.0\n{passes}M199\nN0001\n{outline}"
    program = same_as_written_out(text, "N-label")
    lowest = np.array(ends(program))[:, 1].reshape(4, 7).min(axis=1)
    assert lowest.tolist() == [-4.8, -4.85, -4.87, -4.88]


def test_a_table_set_behind_the_call_that_uses_it_comes_too_late():
    """In the order of running, not of the text: the call uses the offset before it is set."""
    body = "N1\nG42 H001 G01 X5.0\nY-5.0\nX15.0\nY5.0\nX5.0\nY0.0\nG40 X0.0\nM99\n"
    early, late = f"H001 = 0.1\n{HEAD}M98 P1\n", f"{HEAD}M98 P1\nH001 = 0.1\n"
    assert read(f"{early}M02\n{body}")[0] is not None
    program, found = read(f"{late}M02\n{body}")
    assert program is None
    assert [d.code for d in found if d.severity is Severity.ERROR] == ["iso-d"]
    # Set at the start of the subprogram, it counts: it is run before it is used.
    inside = body.replace("N1\n", "N1\nH001 = 0.1\n")
    assert read(f"{HEAD}M98 P1\nM02\n{inside}")[0] is not None


def test_compensation_may_begin_and_end_inside():
    body = "N0001\nG42 D1 G01 X5.0\nY-5.0\nX15.0\nY5.0\nX5.0\nY0.0\nG40 X0.0\nM99\n"
    text = f"{HEAD}M98 P0001 L2\nM02\n{body}"
    assert same_as_written_out(text, "N-label", d=((1, 100.0),)) is not None


def test_a_motion_stands_before_the_call_of_an_o_number():
    text = f"O0009\n{HEAD}G01 X5.0 M98 P0001\nX0.0\nM30\nO0001\nG01 Y5.0\nG01 X7.0 M99\n"
    program, _ = read(text, "O-number")
    assert ends(program) == [[5, 0], [5, 5], [7, 5], [0, 5]]
    said = [d.message for d in read(text.replace("O0", "N0"))[1] if d.code == "subprogram"]
    assert [m[:30] for m in said] == [
        "X5.0: a motion in a line with ",
        "X7.0: a motion in a line with ",
    ]


def test_the_number_of_times_in_p_of_fanuc():
    packed = replace(builtin("iso-mm"), iso=replace(builtin("iso-mm").iso, packed_calls=True))
    text = f"{HEAD}G91\nM98 P31234\nM02\nO1234\nG01 X1.0\nM99\n"
    program, found = read(text, "O-number", profile=packed)
    assert ends(program) == [[1, 0], [2, 0], [3, 0]]
    assert "O1234 run 3 times" in found[-1].message
    twice = refused(text.replace("234\nM02", "234 L2\nM02"), "O-number", profile=packed)
    assert "holds the number of times" in twice.message
    both = refused(text + "O31234\nM99\n", "O-number", profile=packed)
    assert "both O31234 and O1234" in both.message
    # Others mean the number itself (LinuxCNC).
    assert "no line opens with O31234" in refused(text, "O-number").message
    assert ends(read(text + "O31234\nG01 X7.0\nM99\n", "O-number")[0]) == [[7, 0]]


def test_calls_stand_with_a_semicolon_and_with_line_numbers():
    text = (
        "N10 G21 G90;\nN20 G92 X0.0 Y0.0;\nN30 M98 P0001 L2;\nN40 M02;\n"
        "N0001;\nG91 G01 X1.0;\nM99;\n"
    )
    assert ends(read(text)[0]) == [[1, 0], [2, 0]]
    assert ends(read(text, semicolon_in="block")[0]) == [[1, 0], [2, 0]]
    # A line number behind the end that a call does not mean may stand there often.
    assert ends(read(text.replace("G91", "N10 G91").replace("M99", "N10 M99"))[0]) == [
        [1, 0],
        [2, 0],
    ]


def test_what_is_found_in_a_subprogram_is_found_once():
    text = f"{HEAD}M98 P1 L50\nM02\nN1\nG91 G01 X1.0\nM50 T84\nX0.0\nM99\n"
    program, found = read(text)
    assert len(program.blocks) == 101
    assert [(d.code, d.count) for d in found] == [
        ("subprogram-run", 1),
        ("unknown-word", 1),
        ("iso-ignored", 1),
        ("iso-ignored", 1),
    ]
    assert "times" not in "".join(d.message for d in found[1:])
    bad = text.replace("T84", "G05")
    program, found = read(bad)
    assert [d.code for d in found if d.severity is Severity.ERROR] == ["iso-code"]
    # An arc that fits in no pass is said once, too.
    arc = text.replace("G01 X1.0", "G02 X1.0 I9.0").replace("X0.0\nM99", "G01 X0.0\nM99")
    _, found = read(arc)
    assert [(d.code, d.count, d.span.line) for d in found if d.severity is Severity.ERROR] == [
        ("iso-arc", 1, 7)
    ]


def test_a_subprogram_that_no_call_runs_is_named():
    text = f"{HEAD}M98 P1\nM02\nN1 G01 X1.0\nM99\nN7 G01 X9.0\nN8 X3.0\nM99\n"
    program, found = read(text)
    assert ends(program) == [[1, 0]]
    warning = next(d for d in found if d.code == "after-end")
    assert warning.message == (
        "3 lines behind the end of the main program are not run; no call runs N7"
    )
    assert warning.span.line == 8


def test_every_line_shows_where_it_stands():
    text = f"{HEAD}M98 P1 L2\nM02\nN1\nG91 G01 X1.0\nM98 P2\nM99\nN2 Y1.0\nM99\n"
    program, _ = read(text)
    assert [s.line for s in program.spans] == [7, 10, 7, 10, 5]


# --- refused --------------------------------------------------------------------------------------

SUB = "N1 G01 X1.0\nM99\nN2 G01 Y1.0\nM98 P1\nM99\n"


@pytest.mark.parametrize(
    ("call", "subs", "said"),
    [
        ("M98", SUB, "M98 without P"),
        ("M98 P1 P2", SUB, "P is the number of one"),
        ("M98 P-1", SUB, "P is the number of one"),
        ("M98 P1.", SUB, "P is the number of one"),
        ("M98 P1 L0", SUB, "L is how often"),
        ("M98 P1 L-2", SUB, "L is how often"),
        ("M98 P1 L2.", SUB, "L is how often"),
        ("M98 P1 L2 L3", SUB, "L is how often"),
        ("M98 P7", SUB, "no line opens with N0007; the file has N1, N2"),
        ("M98 P1", "", "no line opens with N0001; the file has no N"),
        ("M98 P1", SUB + "N0001 X2.0\nM99\n", "N1 stands twice, in lines 6 and 11"),
        ("M98 P1", "N1 G01 X1.0\n", "N1 has no M99"),
        ("M98 P1", "N1 G01 X1.0\nM02\nM99\n", "N1 ends the whole program"),
        ("M98 P1\nM99", SUB, "M99 in the main program"),
        ("N9 M98 P9", SUB, "N9 is a line of the main program"),
        ("M98 P1 Q5", SUB, "Q5: a word in a line with M98"),
        ("M98 P1 H5", SUB, "H5: a word in a line with M98"),
        ("G01 X5.0 M98 P1", SUB, "X5.0: a motion in a line with M98"),
        ("M98 P1 M00", SUB, "another M word"),
        ("M98 P1 M98 P2", SUB, "another M word"),
        ("M98 P1", "N1 G01 X1.0\nM99 P30\n", "P30 beside M99 goes on in another line"),
        ("M98 P1", "N1 G01 X1.0 M99\n", "X1.0: a motion in a line with M99"),
        ("M98 P1", "N1 G01 X1.0\nM98 P1\nM99\n", "N1 > N1: a subprogram that runs itself"),
        ("M98 P1", "N1\nM98 P2\nM99\nN2\nM98 P1\nM99\n", "N1 > N2 > N1: a subprogram that runs"),
        ("M98 P1 L999999999999", SUB, "lines would be run, and at most 1,000,000 are"),
    ],
)
def test_calls_that_cannot_be_run(call, subs, said):
    text = f"{HEAD}{call}\nM02\n{subs}"
    messages = [d.message for d in read(text)[1] if d.code == "subprogram"]
    assert len(messages) in (1, 2)
    assert any(said in m for m in messages), messages


@pytest.mark.parametrize(
    "text",
    [
        "O1\nG21 G90\nM98 P2\nO2\nG01 X1.0\nM99\n",
        "O1\nG21 G90\nM98 P2\nM30\nO2\nG01 X1.0\nO3\nM99\n",
        "O1\nG21 G90\nM98 P1\nM30\n",
        "O1\nG21 G90\nM98 P2 H3\nM30\nO2 G01 X1.0\nM99\n",
        "O1\nG21 G90\nM98 P2 K3\nM30\nO2 G01 X1.0\nM99\n",
    ],
)
def test_programs_that_run_into_another(text):
    assert read(text, "O-number")[0] is None


@pytest.mark.parametrize("word", ["M97 P1", "M198 P1", "L5", "P5"])
def test_other_words_of_subprograms_are_refused(word):
    text = f"{HEAD}{word}\nM98 P1\nM02\nN1 G01 X1.0\nM99\n"
    assert "is not run" in refused(text).message
    assert refused(text.replace("N1", "O1"), "O-number")


def test_m199_ends_a_program_of_labels_alone():
    text = f"{HEAD}G01 X1.0\nM199\n"
    assert ends(read(text)[0]) == [[1, 0]]
    for style in ("O-number", "none", None):
        assert "M199" in refused(text, style).message


def test_a_program_that_ends_with_m99_is_asked_for():
    text = f"{HEAD}G01 X1.0\nM99\n"
    for style in ("N-label", "O-number", "none", None):
        assert "in a program that calls nothing" in refused(text, style).message
    assert ends(read(text, None, shown=True)[0]) == [[1, 0]]


def nested(deep, times=""):
    subs = "".join(
        f"N{n}\n" + (f"M98 P{n + 1}{times}\n" if n < deep else "G01 X1.0\n") + "M99\n"
        for n in range(1, deep + 1)
    )
    return f"{HEAD}G91\nM98 P1{times}\nM02\n{subs}"


def test_eight_deep_and_no_deeper():
    assert ends(read(nested(DEEPEST))[0]) == [[1, 0]]
    error = refused(nested(DEEPEST + 1))
    assert error.message == (
        "N1 > N2 > N3 > N4 > N5 > N6 > N7 > N8 > N9: subprograms are nested at most 8 deep"
    )


def test_the_length_is_counted_before_a_line_is_repeated():
    tracemalloc.start()
    error = refused(nested(4, " L999999"))
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 10_000_000  # the lines of one call alone would be 8 MB a column
    assert "lines would be run, and at most 1,000,000 are" in error.message
    assert error.span.line == 5
    # Exactly as many as are allowed: 4 lines before the call, it, M02, and three for each run.
    most = (MOST_LINES - 6) // 3
    body = "N1\nG01 X0.001\nM99\n"
    error = refused(f"{HEAD}G91\nM98 P1 L{most + 1}\nM02\n{body}")
    assert error.message == (
        "1,000,002 lines would be run, and at most 1,000,000 are: here N1 of 3, 333,332 times"
    )


def test_many_lines_are_read():
    body = "N1\n" + "G01 X0.002\nX-0.002\n" * 49 + "M99\n"
    program, _ = read(f"{HEAD}G91\nM98 P1 L2000\nM02\n{body}")
    assert len(program.blocks) == 2000 * 98 + 1


def test_lines_that_many_labels_share_are_counted_once():
    """Ten thousand labels, each of which runs on to one M99: no work for each pair."""
    many = 10_000
    calls = "".join(f"M98 P{n}\n" for n in range(1, many + 1))
    subs = "".join(f"N{n} G01 X0.001\n" for n in range(1, many + 1))
    error = refused(f"{HEAD}G91\n{calls}M02\n{subs}M99\n")
    assert "lines would be run" in error.message


def test_a_call_behind_m199_is_a_call_of_no_label():
    """M199 ends the program of one style and is nothing in the other: both are asked for."""
    text = "G21 G90\nG01 X1.0\nM199\nM98 P1\nM02\nN1\nM99\n"
    assert "subprogram" in {d.code for d in read(text, None, shown=True)[1]}
    assert read(text, None)[0] is None
    assert ends(read(text)[0]) == [[1, 0]]


def test_a_part_is_proven_through_its_calls():
    drawing = Path(__file__).parents[2] / "samples" / "plate.dxf"
    made = api.compile(drawing, profile="linuxcnc", offset=0.1)
    lines = made.data.decode().splitlines()
    third = len(lines) // 3
    main = [*lines[:third], "M98 P0001", *lines[2 * third : -1], lines[-1]]
    text = "\n".join([*main, "O0001", *lines[third : 2 * third], "M99", ""])
    proof = api.verify(
        text.encode(),
        name="a.nc",
        against=drawing,
        offset=0.1,
        profile="linuxcnc",
        subprograms_in="O-number",
    )
    assert proof.ok


CALLED = "O1\nG21 G90 G40\nG00 X0 Y0\nM98 P100 L2\nM30\nO100\nG91 G01 X1.0 F5.0\nM99\n"


def test_linuxcnc_runs_numbered_programs():
    """Its handbook, O Codes: Fanuc-style numbered programs are on by default."""
    program, machine, found = api.read_program(CALLED.encode(), profile="linuxcnc", name="a.nc")
    assert [d.code for d in found if d.severity is Severity.ERROR] == []
    assert api.positions(program, machine)[1].tolist()[-1] == [2000, 0]


@pytest.mark.parametrize("name", ["makino", "mitsubishi"])
def test_a_refused_call_is_one_error_and_names_the_option(name):
    text = CALLED.replace("P100 L2", "P100").replace(" F5.0", "")
    if name == "mitsubishi":
        text = text.replace("G00 X0 Y0", "G92 X0 Y0")
    said = {"profile": name, "name": "a.nc"}
    _, _, found = api.read_program(text.encode(), **said)
    wrong = [d for d in found if d.severity is Severity.ERROR]
    assert [d.message.split(":")[0] for d in wrong] == ["M98"]
    assert "--subprograms-in N-label or --subprograms-in O-number runs it" in wrong[0].hint
    assert "take it out" not in wrong[0].hint
    _, _, found = api.read_program(text.encode(), **said, subprograms_in="O-number")
    assert [d for d in found if d.severity is Severity.ERROR] == []
