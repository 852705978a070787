"""ISO programs that the controller offsets itself: what is read, and what is refused where."""

import pytest

from wedmcam import api
from wedmcam.api import positions
from wedmcam.frontends.identify import identify
from wedmcam.ir.program import Kind
from wedmcam.machines import builtin
from wedmcam.operations import convert
from wedmcam.options import WrongUse
from wedmcam.targets import Entries, g41, target_of

UM = builtin("iso-um")
#: A slot of 10 by 5 mm with a round end, cut counter-clockwise from below; the wire outside.
SLOT = """G92 X0 Y0
G91
G42 D1 G01 X0 Y5000
G01 X5000 Y0
G01 X0 Y5000
G03 X-10000 Y0 I-5000 J0
G01 X0 Y-5000
G01 X5000 Y0
G40 G01 X0 Y-5000
M02
"""


def read(text, table=(), machine=UM):
    program, found = g41.decode(text.encode(), machine, "x.nc", Entries(d=tuple(table)).offset_of())
    return program, found


def ends(program):
    return [tuple(p) for p in positions(program, UM)[1].tolist()]


def test_the_wire_runs_beside_the_outline_with_arcs_at_outer_corners():
    program, found = read(SLOT, [(1, 100.0)])
    assert not found
    assert ends(program) == [
        (0, 4900),  # on the normal of the first block
        (5000, 4900),
        (5100, 5000),  # about the corner
        (5100, 10000),
        (-5100, 10000),
        (-5100, 5000),
        (-5000, 4900),
        (0, 4900),
        (0, 0),
        (0, 0),
    ]
    lines = [span.line for span in program.spans]
    assert lines == [3, 4, 4, 5, 6, 7, 7, 8, 9, 10]


def test_inner_corners_are_cut_where_neighbours_cross():
    program, found = read(SLOT.replace("G42", "G41"), [(1, 100.0)])
    assert not found
    assert ends(program)[:5] == [
        (0, 5100),
        (4900, 5100),
        (4900, 10000),
        (-4900, 10000),
        (-4900, 5100),
    ]


def test_d_of_zero_is_the_outline_itself():
    program, _ = read(SLOT, [(1, 0.0)])
    plain, _ = read(SLOT.replace("G42 D1 ", "").replace("G40 ", ""))
    assert (program.blocks == plain.blocks).all()


def test_absolute_millimetres_are_the_same_path():
    text = SLOT.replace("G91", "G90")
    for old, new in (
        ("X0 Y5000", "X0. Y5.D1"),
        ("X5000 Y0", "X5. Y5."),
        ("X0 Y5000", "X5. Y10."),
        ("X-10000 Y0 I-5000 J0", "X-5. Y10. R5."),
        ("X0 Y-5000", "X-5. Y5."),
        ("X5000 Y0", "X0. Y5."),
        ("X0 Y-5000", "X0. Y0."),
    ):
        text = text.replace(old, new, 1)
    one, two = read(SLOT, [(1, 100.0)])[0], read(text.replace("G42 D1", "G42"), [(1, 100.0)])[0]
    assert (one.blocks == two.blocks).all()


def test_modes_on_lines_of_their_own_take_effect_with_the_next_motion():
    text = SLOT.replace("G42 D1 G01", "D1\nG42\nG01").replace("G40 G01", "G40\nG01")
    one, two = read(SLOT, [(1, 100.0)])[0], read(text, [(1, 100.0)])[0]
    assert (one.blocks == two.blocks).all()


def test_a_pause_on_the_way_stays_where_it_is():
    program, found = read(SLOT.replace("G03", "M00\nG03"), [(1, 100.0)])
    assert not found
    kinds = program.blocks["kind"].tolist()
    assert kinds[4] == Kind.PAUSE
    assert ends(program)[4] == (5100, 10000)


def test_an_open_contour_ends_on_the_normal_of_its_last_block():
    program, found = read("G91\nG41 D7 G01 X0 Y500\nG01 X900 Y900\nG40\nM02\n", [(7, 100.0)])
    assert not found
    assert ends(program) == [(-71, 571), (829, 1471), (829, 1471)]


def test_a_move_to_the_next_contour_starts_where_the_wire_stands():
    text = "G91\nG41 D1 G01 Y500\nG01 X900\nG40\nM00\nG01 X1000 Y-500\nM00\nG01 X5\nG01 Y5\nM02\n"
    program, found = read(text, [(1, 100.0)])
    assert not found
    assert program.blocks["kind"].tolist()[3] == Kind.MOVE
    assert ends(program)[1:4] == [(900, 600), (900, 600), (1900, 0)]


def test_a_full_circle():
    text = "G91\nG41 D1 G01 X5000 Y0\nG03 X0 Y0 I-5000 J0\nG40 G01 X-5000 Y0\nM02\n"
    program, found = read(text, [(1, 100.0)])
    assert not found
    assert ends(program)[:2] == [(4900, 0), (4900, 0)]
    assert program.blocks["count"].tolist()[:2] == [4900, 4 * 4900]


@pytest.mark.parametrize(
    ("text", "code", "line", "said"),
    [
        ("G91\nG41 G01 X500\nG01 Y500\nM02", "iso-d", 2, "without a D"),
        ("G91\nG41 D2 G01 X500\nG01 Y500\nM02", "iso-d", 2, "no offset was given for D2"),
        ("G91\nG41 D-1 G01 X500\nG01 Y500\nM02", "iso-d", 2, "whole, from 0 on"),
        ("G91\nG41 D1.5 G01 X500\nG01 Y500\nM02", "iso-d", 2, "whole, from 0 on"),
        ("G91\nG41 D1 G03 X9 Y9 J9\nG01 Y500\nM02", "compensation-place", 2, "on in an arc"),
        (
            "G91\nG41 D1 G01 X500\nG01 Y500\nG40 G03 X9 Y9 J9\nM02",
            "compensation-place",
            4,
            "off in an arc",
        ),
        (
            "G91\nG41 D1 G01 X500\nG01 Y500\nG42 G01 X500\nM02",
            "compensation-place",
            4,
            "change places",
        ),
        (
            "G91\nG41 D1 G01 X500\nG01 Y500\nD3 G01 X500\nM02",
            "compensation-place",
            4,
            "another D",
        ),
        (
            "G91\nG41 D1 G01 X500\nG01 Y500\nD0 G01 X500\nM02",
            "compensation-place",
            4,
            "another D",
        ),
        ("G91\nG41 D1 G01 X500\nG00 Y500\nM02", "compensation-place", 3, "G00"),
        ("G91\nG41 D1 G01 X500\nG40 G01 Y500\nM02", "compensation-place", 2, "no motion follows"),
        ("G91\nG41 D1 G01 X500\nM02", "compensation-place", 2, "no motion follows"),
        (
            "G91\nG41 D1 G01 X500\nG01 Y500\nG40\nG41 D1 G01 X500\nG01 Y500\nM02",
            "compensation-place",
            5,
            "between G40 and this line",
        ),
        ("G91\nG41 D1 G01 X99\nG01 Y500\nM02", "compensation-lead", 2, "0.099 mm long"),
        (
            "G91\nG41 D1 G01 X500\nG01 Y500\nG03 X-50 Y50 I-50\nG01 X-500\nM02",
            "compensation-lost",
            4,
            "inside radius of 0.050 mm",
        ),
        (  # a step lower than the offset in an inner corner: one block ahead is not enough
            "G91\nG41 D1 G01 X500\nG01 Y500\nG01 X-50\nG01 Y50\nG01 X-50\nG01 Y500\nM02",
            "compensation-lost",
            4,
            "nothing is left",
        ),
        (  # a slot narrower than two offsets
            "G91\nG41 D1 G01 X500\nG01 Y500\nG01 X-150\nG01 Y-500\nM02",
            "compensation-lost",
            4,
            "nothing is left",
        ),
    ],
)
def test_what_no_controller_can_be_held_to_is_refused_with_its_place(text, code, line, said):
    _, found = read(text, [(1, 100.0), (3, 50.0), (0, 0.0)])
    errors = [d for d in found if d.severity.name == "ERROR"]
    assert errors[0].code == code
    assert errors[0].span.line == line
    assert said in errors[0].message
    assert errors[0].hint


def test_axes_are_the_controllers_own():
    """With a mirrored axis what runs to the left at the machine runs to the right as drawn."""
    from dataclasses import replace

    from wedmcam.machines.machine import Axes

    mirrored = replace(UM, axes=Axes(mirror_x=True))
    program, found = read(SLOT, [(1, 100.0)], mirrored)
    assert not found
    there = positions(program, mirrored)[1] * [-1, 1]
    assert there.tolist() == positions(read(SLOT, [(1, 100.0)])[0], UM)[1].tolist()


def test_offsets_are_um_whatever_a_step_is():
    from dataclasses import replace

    from wedmcam.machines.machine import Axes

    coarse = replace(UM, axes=Axes(step_um=2))
    program, found = read(SLOT, [(1, 200.0)], coarse)
    assert not found
    assert (program.blocks == read(SLOT, [(1, 100.0)])[0].blocks).all()


def test_without_a_table_the_d_numbers_are_told():
    _, found = read(SLOT)
    assert found[0].code == "iso-compensation"
    assert found[0].hint == "give what is entered at the controller: --d 1=0.1mm"


def test_the_number_that_the_program_uses_is_the_one_to_give():
    _, found = read(SLOT.replace("D1", "D3"), [(1, 100.0)])
    assert found[0].code == "iso-d"
    assert found[0].hint.endswith("such as --d 3=0.1mm")


def test_tables():
    with pytest.raises(WrongUse, match="not negative"):
        Entries(d=((1, -1.0),)).offset_of()
    with pytest.raises(WrongUse, match="twice"):
        Entries(d=((1, 1.0), (1, 2.0))).offset_of()


def test_the_library_takes_the_table():
    program, _, found = api.read_program(
        SLOT.encode(), name="x.nc", entered=Entries(d=((1, 100.0),)), whole_in="um"
    )
    assert not found
    assert len(program.blocks) == 10
    proof = api.verify(SLOT.encode(), name="x.nc", d=((1, 100.0),), whole_in="um")
    assert proof.ok
    table = Entries(d=((1, 100.0),))
    made = convert.convert(SLOT.encode(), to="3b", name="x.nc", entered=table, whole_in="um")
    assert made.ok
    apart, _ = api.diff(
        SLOT.encode(), made.data, names=("x.nc", "x.3b"), d=((1, 100.0),), whole_in="um"
    )
    assert apart.equal
    with pytest.raises(WrongUse, match="--d is for ISO"):
        convert.convert(made.data, to="iso", name="x.3b", entered=Entries(d=((1, 100.0),)))


def test_identify_tells_the_numbers():
    from wedmcam.frontends.identify import identify

    assert identify(SLOT.encode()).reason.endswith(
        "the controller offsets outlines (G41, G42) by its table: D1"
    )


def test_settings_take_the_table(tmp_path):
    import subprocess
    import sys

    (tmp_path / "slot.nc").write_text(SLOT)
    (tmp_path / "wedmcam.toml").write_text('d = ["1=0.1mm", "2=90um"]\nwhole-in = "um"\n')
    done = subprocess.run(
        [sys.executable, "-m", "wedmcam", "verify", "slot.nc"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "9 blocks" in done.stderr
    (tmp_path / "wedmcam.toml").write_text('d = ["2=90um"]\nwhole-in = "um"\n')
    done = subprocess.run(
        [sys.executable, "-m", "wedmcam", "verify", "slot.nc"],
        cwd=tmp_path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 1
    assert "no offset was given for D1" in done.stderr


#: A square about the start, the wire inside, whose offset stands in the file.
TABLE = """G90 G21
G92 X8.0 Y0.0
H001 = 0.14
G01 G41 H001 X10.0
Y10.0
X-10.0
Y-10.0
X10.0
Y0.0
G40 X8.0
M02
"""


def iso(text, table=(), **said):
    said = {"name": "a.nc", "format": "iso"} | said
    program, _, found = api.read_program(text.encode(), entered=Entries(d=tuple(table)), **said)
    return program, found


def codes(found):
    return [d.code for d in found]


def test_field_g41_h():
    program, found = iso(TABLE)
    assert codes(found) == ["iso-offsets"]
    assert "H1 = 0.1400 mm, of the table in the file" in found[0].message
    assert ends(program)[:2] == [(1860, 0), (1860, 9860)]
    entered, _ = iso(TABLE.replace("H001 = 0.14\n", ""), [(1, 140.0)])
    assert (program.blocks == entered.blocks).all()
    as_d, _ = iso(TABLE.replace("G41 H001", "G41 D1"))
    assert (program.blocks == as_d.blocks).all()


def test_what_is_entered_wins_over_the_table_of_the_file():
    program, found = iso(TABLE, [(1, 100.0)])
    assert ends(program)[0] == (1900, 0)
    assert codes(found) == ["iso-offsets"]
    assert str(found[0].severity) == "warning"
    assert "H1 = 0.1400 mm, of the table in the file; --d is 0.1000 mm" in found[0].message
    _, found = iso(TABLE, [(1, 140.0)])
    assert [str(d.severity) for d in found] == ["note"]
    # What is entered for another number leaves that of the file.
    assert ends(iso(TABLE, [(2, 100.0)])[0])[0] == (1860, 0)


def test_the_table_of_the_file_wins_over_the_offset_of_a_drawing():
    target = target_of(UM)
    program, found = target.read(TABLE.encode(), "a.nc", Entries(every_um=100.0))
    assert ends(program)[0] == (1860, 0)
    assert "the table of the file counts" in found[0].message


@pytest.mark.parametrize(
    ("line", "um"),
    [
        ("H001 = +000000.1400", 140),
        ("h1=.14", 140),
        ("N5 H1 = 0.1 + 0.04 ; ROUGH", 140),
        ("H000 = 0.0 H001 = .14 (ROUGH)", 140),
        ("H5 = 0.04\nH1 = 0.1 + H5", 140),
        ("H5 = 0.04\nH1 = .18 - H005 H2 = 9.0", 140),
        ("H1 = 0.14\nH1 = 0.140", 140),
        ("C001 = 10 0015 2215\nH1 = 0.14", 140),
    ],
)
def test_tables_in_other_spellings(line, um):
    program, found = iso(TABLE.replace("H001 = 0.14", line))
    assert not [d for d in found if d.severity > 1], found
    assert ends(program)[0] == (2000 - um, 0)


def test_the_unit_of_a_table_is_that_of_the_file():
    inch = TABLE.replace("G21", "G20").replace("0.14", "0.01")
    assert ends(iso(inch)[0])[0] == (50800 - 254, 0)
    late = TABLE.replace("G90 G21\n", "G90\n").replace("G01 G41", "G21 G01 G41")
    assert codes(iso(late)[1]) == ["iso-units", "iso-offsets"]  # asked of G92 alone
    asked = TABLE.replace(" G21", "")
    assert set(codes(iso(asked)[1])) == {"iso-units", "iso-offsets"}
    assert ends(iso(asked, units_in="mm")[0])[0] == (1860, 0)
    whole = TABLE.replace("0.14", "140")
    assert codes(iso(whole)[1]) == ["iso-units", "iso-offsets"]
    assert ends(iso(whole, whole_in="um")[0])[0] == (1860, 0)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("H001 = 0.14", "H001 = 0.14\nH001 = 0.15", "set twice"),
        ("H001 = 0.14", "H001 = -0.14", "G41 and G42 tell the side"),
        ("H001 = 0.14", "H001 = 0.1 + H7", "H7 is set nowhere before it"),
        ("H001 = 0.14", "H001 = H001", "H1 is set nowhere before it"),
        ("G40", "H002 = 0.14\nG40", "behind the first G41"),
        ("G41 H001", "G41 D1 H001", "D and H both"),
        ("G41 H001", "G41 H1.5", "number of an offset"),
        ("G41 H001", "G41", "no D at all"),
        ("G41 H001", "G41 H2", "H2"),
    ],
)
def test_tables_that_are_refused(old, new, what):
    program, found = iso(TABLE.replace(old, new))
    assert program is None
    assert any(what in d.message for d in found if d.code in ("iso-d", "iso-compensation")), found


def test_field_offset_header():
    text = "%\nL002\n(PLATE)\nH175 = 0.0000\nH1 =.0085 + H175\nH2 =.0064 + H175\n" + (
        "N5 G90\nN10 G92 X0.0 Y0.0\nN15 G1 X5.0 Y0.0\nN20 X5.0 Y5.0\nN25 M02\n%\n"
    )
    seen = identify(text.encode())
    assert seen.format == "iso"
    assert seen.reason.startswith("ISO G-code with an offset table (H175, H1, H2): 3 lines")
    assert seen.reason.endswith("profile that knows its words: mitsubishi (L002)")
    assert identify(TABLE.encode()).reason.endswith("by its table: H1")
    _, found = iso(text.replace("L002\n", "").replace("G90", "G90 G20"))
    assert codes(found) == ["text-skipped", "iso-offsets"]
    assert "no G41 or G42 uses this table (3 offsets)" in found[1].message


# --- what a controller makes of its table: keys of a profile -------------------------------------


def profile(**iso):
    from dataclasses import replace

    base = builtin("iso-mm")
    return replace(base, iso=replace(base.iso, **iso))


#: Two passes in one run, numbered by H, the wire outside of what it runs round clockwise.
CHANGE = """G90 G21
H000 = 0.010
H001 = 0.14
H002 = 0.1
G92 X8.0 Y0.0
G42 H000 G01 X10.0
H001
Y-10.0
X-10.0
Y10.0
X10.0
Y0.0
H002
Y-10.0
X-9.0
G40 H000 Y-8.0
M02
"""
SKEWED = profile(offset_change="skewed")


def test_another_number_is_refused_unless_a_profile_says_what_it_does():
    _, found = read(CHANGE, machine=builtin("iso-mm"))
    errors = [d for d in found if str(d.severity) == "error"]
    assert [(d.code, d.span.line) for d in errors] == [
        ("compensation-place", 8),
        ("compensation-place", 14),
    ]
    assert "another H" in errors[0].message
    assert "offset_change" in errors[0].hint


def test_a_straight_block_runs_from_the_old_offset_to_the_new_one():
    program, found = read(CHANGE, machine=SKEWED)
    assert ends(program) == [
        (1990, 0),  # 0.010 beside the first block
        (1860, -9860),  # askew
        (-17860, -9860),
        (-17860, 9860),
        (1860, 9860),
        (1860, 0),
        (1900, -9900),  # askew again
        (-17000, -9900),
        (-17000, -8000),
        (-17000, -8000),
    ]
    (said,) = [d for d in found if str(d.severity) == "warning"]
    assert said.code == "iso-offsets"
    assert said.span.line == 8
    assert "H1 = 0.1400 mm after H0 = 0.0100 mm" in said.message
    assert "(2 lines)" in said.message


def test_at_corners_the_neighbours_meet_at_their_own_offset():
    """At an outer corner with the old offset in front of the block, the new one behind it."""
    text = "G91\nG41 D1 G01 Y500\nX-900\nD2\nY900\nX-900\nG40\nM02\n"
    program, _ = read(text, [(1, 100.0), (2, 50.0)], profile(offset_change="skewed", integers="um"))
    made = ends(program)
    assert made[0] == (0, 400)
    assert (-1000, 500) in made  # the arc about the corner ends on the old normal
    assert (-950, 1350) in made


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("H001\nY-10.0\nX-10.0", "H001\nG02 X0.0 Y-10.0 I-10.0\nG01 X-10.0", "another H in an arc"),
        ("H002\nY-10.0", "G41 H002\nY-10.0", "change places"),
    ],
)
def test_what_no_source_tells_stays_refused(old, new, what):
    _, found = read(CHANGE.replace(old, new, 1), machine=SKEWED)
    assert any(what in d.message for d in found if d.code == "compensation-place"), found


def test_an_offset_of_0_before_begins_compensation_and_is_said():
    text = CHANGE.replace("0.010", "0.000")
    text = text[: text.index("H002\n")] + "G40 X8.0\nM02\n"
    for machine in (builtin("iso-mm"), SKEWED):
        program, found = read(text, machine=machine)
        assert ends(program)[:2] == [(2000, 0), (2000, -9860)]
        assert "after H0 = 0.0000 mm" in next(d for d in found if d.span.line == 8).message


def test_an_offset_of_0_at_the_end_is_a_way_out():
    text = CHANGE.replace("0.010", "0.000").replace(
        "H002\nY-10.0\nX-9.0\nG40 H000 Y-8.0", "H000 X8.0"
    )
    program, _ = read(text, machine=SKEWED)
    assert ends(program)[-3:-1] == [(1860, 0), (0, 0)]
    _, found = read(text, machine=builtin("iso-mm"))
    assert "compensation-place" in codes(found)


def test_the_number_in_the_line_of_g40_is_none_of_the_outline():
    once = TABLE.replace("G40 X8.0", "G40 H000 X8.0")
    assert ends(iso(once)[0]) == ends(iso(TABLE)[0])


def test_d0_is_no_offset():
    text = "G91\nG41 D0 G01 X500\nG01 Y500\nG40\nM02\n"
    program, found = read(text, [(1, 100.0)])
    assert ends(program)[:2] == [(500, 0), (500, 500)]
    again, more = read(text)
    assert again.blocks.tolist() == program.blocks.tolist()
    assert codes(found) == codes(more) == ["iso-offsets"]
    assert "no offset" in found[0].message
    assert not read(text, [(0, 0.0)])[1]
    _, found = read(text.replace("D0", "H0"))
    assert found[0].hint.endswith("--d 0=0mm")


def test_entries_that_are_diameters():
    twice = profile(offsets="diameter")
    program, found = read(TABLE, machine=twice)
    assert ends(program)[0] == (1930, 0)
    said = [d.message for d in found]
    assert "H1 = 0.1400 mm is a diameter: the wire runs 0.0700 mm beside the outline" in said
    assert "H1 = 0.1400 mm, of the table in the file" in said
    entered = TABLE.replace("H001 = 0.14\n", "")
    program, _ = target_of(twice).read(entered.encode(), "a.nc", Entries(d=((1, 200.0),)))
    assert ends(program)[0] == (1900, 0)
    # The offset of a drawing is an offset.
    program, found = target_of(twice).read(entered.encode(), "a.nc", Entries(every_um=100.0))
    assert ends(program)[0] == (1900, 0)
    assert not found


def test_a_diameter_is_said_of_the_entry_that_counts():
    twice = profile(offsets="diameter")
    table = TABLE.replace("0.14", "0.2")
    _, found = target_of(twice).read(table.encode(), "a.nc", Entries(d=((1, 0.0),)))
    said = [d.message for d in found]
    assert any("--d is 0.0000 mm: --d counts" in m for m in said)
    assert not any("is a diameter" in m for m in said)
    _, found = target_of(twice).read(table.encode(), "a.nc", Entries(d=((1, 300.0),)))
    said = [d.message for d in found]
    assert "H1 = 0.3000 mm is a diameter: the wire runs 0.1500 mm beside the outline" in said


def test_the_hint_for_an_offset_0_enters_0():
    text = "G91\nG41 D0 G01 X500\nG01 Y500\nG40\nM02\n"
    _, found = read(text, [(1, 100.0)], machine=profile(offset_word="D"))
    assert [d.hint for d in found] == ["give what is entered at the controller, such as --d 0=0mm"]


def test_linuxcnc_numbers_diameters_by_d():
    text = TABLE.replace("H001 = 0.14\n", "").replace("H001", "D1").replace("G92", "G00")
    entered = Entries(d=((1, 200.0),))
    program, _, found = api.read_program(
        text.encode(), name="a.nc", entered=entered, profile="linuxcnc"
    )
    assert ends(program)[0] == (1900, 0)
    assert "D1 = 0.2000 mm is a diameter: the wire runs 0.1000 mm beside the outline" in [
        d.message for d in found
    ]
    _, _, found = api.read_program(
        text.replace("D1", "H1").encode(), name="a.nc", entered=entered, profile="linuxcnc"
    )
    assert "H numbers no offset at this controller" in found[0].message


def test_diameters_and_h_are_written_and_said(tmp_path):
    from pathlib import Path

    from wedmcam.reports.setup_sheet import sheet

    machine = profile(
        compensation="controller", decimals=4, offsets="diameter", offset_word="H", d=3
    )
    source = Path(__file__).parents[2] / "samples" / "key-punch.dxf"
    made = api.compile(source.read_bytes(), name="k.dxf", profile=machine, offset=0.1)
    assert made.ok, [d.message for d in made.findings]
    assert b" H3 " in made.data
    assert made.entries.lines() == [("H3", "0.2000 mm (diameter)")]
    assert made.summary["d_um"] == {"3": 200.0}
    assert made.summary["d_is"] == "diameter"
    assert any("0.2000 mm (diameter)" in str(part) for part in [sheet(made, "k")])
    proof = api.verify(
        made.data, against=source, name="k.nc", offset=0.1, profile=machine, d=((3, 200.0),)
    )
    assert proof.ok
    assert "H3 = 0.2000 mm is a diameter: the wire runs 0.1000 mm beside the outline" in [
        d.message for d in proof.findings
    ]
    plain = api.verify(made.data, against=source, name="k.nc", offset=0.1, profile=machine)
    assert plain.ok
    wrong = api.verify(
        made.data, against=source, name="k.nc", offset=0.1, profile=machine, d=((3, 100.0),)
    )
    assert not wrong.ok


def test_g92_in_compensation_is_refused():
    """Whether it names the place of the outline or of the wire differs from control to control."""
    text = TABLE.replace("Y10.0\n", "Y10.0\nG92 X0.0 Y0.0\n", 1)
    program, found = iso(text)
    assert program is None
    assert "compensation-place" in codes(found)


@pytest.mark.parametrize("motion", ["", "G01 X0 Y0\n"], ids=["no motion", "length 0"])
def test_g41_without_a_motion_that_goes_anywhere_is_read(motion):
    program, found = read(f"G92 X0 Y0\nG91\nG41 D1\n{motion}G40\nM02\n", [(1, 100.0)])
    assert not [block for block in program.blocks if block["kind"] <= Kind.ARC]
    assert not motion or any(d.code == "iso-ignored" for d in found)
