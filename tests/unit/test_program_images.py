"""Transforms of programs: every vertex as stepped within 1 um of the exact image, or nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from wedmcam import machines
from wedmcam.cli.main import cli
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.controllers.zd065.images import images
from wedmcam.controllers.zd065.moved import Link, moved
from wedmcam.diag.codes import CODES
from wedmcam.frontends.wed import parse_transform
from wedmcam.ir.figure import Rotate, Translate
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.judge.images import Said, fit
from wedmcam.machines import builtin, default
from wedmcam.operations.convert import convert
from wedmcam.operations.moved import images_of, measured
from wedmcam.targets import Entries, target_of

GOLDEN = Path(__file__).parents[1] / "golden"
LINE = b"B17000B5000B17000GXL1 DD"


def blocks_of(*rows):
    """Blocks by (kind, turn, x, y, count); lines need no count."""
    out = np.zeros(len(rows), BLOCK)
    for block, row in zip(out, rows, strict=True):
        kind, turn, x, y, *count = row
        block["kind"], block["turn"], block["x"], block["y"] = kind, turn, x, y
        if kind == Kind.ARC:
            block["axis"], block["count"] = Axis.SQUARE, count[0]
        elif kind in (Kind.LINE, Kind.MOVE):
            axis, j = MIRROR.line_count(np.array([x]), np.array([y]))
            block["axis"], block["count"] = axis[0], j[0]
    return out


def compact(*rows):
    """A program of such blocks in the cutting format."""
    rows = blocks_of(*rows, (Kind.STOP, 0, 0, 0))
    data, findings = target_of(default("compact")).write_carried(Program(rows), Entries(), None)
    assert not [d for d in findings if str(d.severity) == "error"], findings
    return data


coordinate = st.integers(-200_000, 200_000)
line = st.tuples(st.just(Kind.LINE), st.just(0), coordinate, coordinate).filter(
    lambda r: r[2] or r[3]
)
move = st.tuples(st.just(Kind.MOVE), st.just(0), coordinate, coordinate).filter(
    lambda r: r[2] or r[3]
)
arc = st.tuples(
    st.just(Kind.ARC),
    st.sampled_from([1, -1]),
    coordinate,
    coordinate,
    st.integers(1, 900_000),
).filter(lambda r: r[2] ** 2 + r[3] ** 2 >= 2)
control = st.sampled_from([(Kind.PAUSE, 0, 0, 0), (Kind.THREAD, 0, 0, 0)])
figures = st.lists(st.one_of(line, arc, arc, move, control), min_size=1, max_size=8).filter(
    lambda rows: any(r[0] <= Kind.MOVE for r in rows)
)


def exact_vertices(rows, angle=0, shift=(0, 0), about=(0, 0), over=False):
    """The vertices of a figure turned and moved, with 40 digits."""
    run = MIRROR.run(rows)
    x, y = np.concatenate([[0], np.cumsum(run.dx)]), np.concatenate([[0], np.cumsum(run.dy)])
    with mpmath.workdps(40):
        turn = mpmath.expjpi(mpmath.mpf(angle.numerator) / angle.denominator / 180)
        centre, move = mpmath.mpc(*about), mpmath.mpc(*shift)
        out = []
        for u, v in zip(x.tolist(), y.tolist(), strict=True):
            z = mpmath.mpc(u, -v if over else v)
            out.append((z - centre) * turn + centre + move)
        return out


def misses(stands, exact):
    return [
        float(mpmath.hypot(x - z.real, y - z.imag))
        for (x, y), z in zip(stands.tolist(), exact, strict=True)
    ]


@given(figures)
def test_a_symmetry_has_the_same_numbers(rows):
    figure = blocks_of(*rows)
    for text, sx, sy in (("symmetry x", 1, -1), ("symmetry y", -1, 1)):
        made = moved(figure, images([parse_transform(text)[0]])[0], MIRROR)
        assert len(made.blocks) == made.same == len(figure)
        assert made.blocks["x"].tolist() == (sx * figure["x"]).tolist()
        assert made.blocks["y"].tolist() == (sy * figure["y"]).tolist()
        assert made.blocks["count"].tolist() == figure["count"].tolist()
        run = MIRROR.run(figure)
        ends = np.cumsum(np.column_stack([sx * run.dx, sy * run.dy]), axis=0)
        assert (made.stands[0, 1:] == ends).all()  # 0 um


@given(figures, st.integers(-3_600_000, 3_600_000), st.tuples(coordinate, coordinate))
def test_a_rotated_figure_is_within_a_micron(rows, angle, about):
    figure, degrees = blocks_of(*rows), Fraction(angle, 10_000)
    made = moved(figure, images([Rotate(degrees, 3, about)])[0], MIRROR)
    # Copies that lie on the figure are left out: they are behind the others.
    for k, stands in enumerate(made.stands):
        exact = exact_vertices(figure, k * degrees, about=about)
        assert max(misses(stands, exact)) <= 1.0


@given(figures)
def test_a_reversed_figure_comes_back_to_every_vertex(rows):
    figure = blocks_of(*rows)
    made = moved(figure, images([parse_transform("reverse")[0]])[0], MIRROR)
    run = MIRROR.run(figure)
    ends = np.vstack([[0, 0], np.cumsum(np.column_stack([run.dx, run.dy]), axis=0)])
    assert (made.stands[0] == ends[::-1]).all()
    assert made.start == tuple(ends[-1].tolist())
    with_it = moved(figure, images([parse_transform("with mirror 135")[0]])[0], MIRROR)
    x, y = -ends[::-1, 1], -ends[::-1, 0]
    assert (with_it.stands[1] == np.column_stack([x, y])).all()


def test_ninety_nine_copies_of_arcs_of_ten_metres():
    r = 10_000_000
    rows = [
        (Kind.ARC, 1, r, 0, 30_000),
        (Kind.LINE, 0, -40_000, 1_234),
        (Kind.ARC, -1, -7_071_067, 7_071_067, 199_000),
        (Kind.MOVE, 0, 5_000, -70_001),
    ]
    figure = blocks_of(*rows)
    made = moved(figure, images([Rotate(Fraction(36, 10), 99, (0.0, 0.0))])[0], MIRROR)
    assert len(made.links) == 100
    for k in (1, 7, 33, 98, 99):
        exact = exact_vertices(figure, k * Fraction(36, 10))
        assert max(misses(made.stands[k], exact)) <= 1.0
    done = convert(compact(*rows), to="compact", transforms=["rotate 3.6 copies 99"])
    assert done.ok, done.findings
    assert done.images.fit.largest_um <= 1.0
    assert done.images.count == 100


def test_copies_far_away_lose_no_digits():
    figure = blocks_of((Kind.LINE, 0, 17_000, 5_000))
    every = images([Translate(10_000.3, -0.7, 9_999)])[0]
    chosen = (1, 5_000, 9_999)
    made = moved(figure, [every[k] for k in chosen], MIRROR)
    for i, k in enumerate(chosen):
        shift = (k * 10_000.3, k * -0.7)
        exact = exact_vertices(figure, Fraction(0), shift)
        assert max(misses(made.stands[i], exact)) <= 1.0


def test_the_path_goes_on_where_a_copy_starts_where_the_one_before_ends():
    done = convert(LINE, to="3b", format="3b", transforms=["translate (17, 5) copies 3"])
    assert done.data == b"B17000B5000B17000GXL1\n" * 4 + b"DD\n"
    assert done.images.made.links.tolist() == [Link.FIRST, *[Link.GOES_ON] * 3]
    # 0.9 um off each time: the vertices do not drift.
    done = convert(LINE, to="3b", format="3b", transforms=["translate (17.0009, 5) copies 9"])
    assert done.ok
    assert not done.images.moves_um()
    assert done.images.fit.largest_um <= 1.0


def test_copies_elsewhere_are_reached_with_the_generator_off():
    done = convert(LINE, to="3b", format="3b", transforms=["translate (100, 0) copies 2"])
    text = done.data.decode().split()
    assert text[1:4] == ["D", "B83000B5000B83000GXL4", "D"]
    assert done.images.moves_um() == pytest.approx([float(np.hypot(83_000, 5_000))] * 2)
    memory = convert(LINE, to="compact", format="3b", transforms=["translate (100, 0) copies 2"])
    # 0x44: a move in quadrant 4; 0x30 behind it: the thread point of the copy.
    assert memory.data[7] == 0x31
    assert memory.data[8] == 0x44
    assert memory.data[15] == 0x30


def test_symmetry_completes_a_figure():
    # From the second quadrant: y symmetry gives the first, x symmetry the fourth and third [S].
    quarter = b"B20000B0B20000GXSR2 DD"
    done = convert(
        quarter,
        to="3b",
        format="3b",
        # about its end: the figure starts at (0, 0) and ends at (20, 20)
        transforms=["translate (-20, 0)", "with symmetry y", "with symmetry x"],
    )
    assert done.ok, done.findings
    assert done.images.made.links[1:].tolist() == [Link.GOES_ON] * 3
    run = done.machine.stepping.run(done.program_out.blocks)
    assert (run.dx.sum(), run.dy.sum()) == (0, 0)
    assert done.images.fit.largest_um == 0.0


def test_a_ring_of_slots_is_one_chain():
    # A figure whose end is its start turned by 10 degrees, each rounded to the micron.
    out = round(30_000 * np.cos(np.radians(10))), round(30_000 * np.sin(np.radians(10)))
    rows = [(Kind.LINE, 0, 8_000, 0), (Kind.LINE, 0, out[0] - 38_000, out[1])]
    ring = ["rotate 10 copies 35 about (-30, 0)"]
    done = convert(compact(*rows), to="compact", transforms=ring)
    assert done.ok, done.findings
    assert not done.images.moves_um()
    assert done.images.fit.largest_um <= 1.0


@pytest.mark.parametrize("to", ["3b", "compact", "iso", "dxf", "svg", "wed"])
@pytest.mark.parametrize("name", ["plate.3b", "gear-24.zd", "cover.nc"])
def test_golden_programs_are_transformed_into_every_format(name, to):
    done = convert(GOLDEN / name, to=to, transforms=["symmetry y | translate (200, 0) copies 3"])
    assert done.ok, done.findings
    assert done.images.fit.largest_um == 0.0
    assert done.images.count == 4


def test_outlines_stay_outlines():
    # Convex and concave arcs keep their types in every image, as without a transform.
    slot = b"B0B5000B10000GXNR4 B30000B0B30000GXL3 B0B5000B10000GXNR2 B30000B0B30000GXL1 DD"
    outline = convert(slot, to="compensation", format="3b")
    target = target_of(default("compensation"))
    before = target.senses(outline.data)
    assert (before != 0).any()
    for text in ("symmetry x", "with symmetry y", "rotate 30 copies 2 about (100, 0)"):
        done = convert(outline.data, to="compensation", format="compensation", transforms=[text])
        assert done.ok, done.findings
        after = target.senses(done.data)
        assert set(after[after != 0].tolist()) == set(before[before != 0].tolist())
        same = [d.code for d in done.findings if d.code == "outline-side"]
        assert not same


def test_outlines_with_a_gap_are_within_a_micron_or_refused():
    # What the controller makes of an outline may end a um beside the path.
    slot = b"B0B5003B10007GXNR4 B30000B0B30000GXL3 B0B5003B10007GXNR2 B30000B0B30000GXL1 DD"
    made = []
    for text in ("symmetry x", "rotate 30", "rotate 7", "translate (60, 0) copies 2"):
        done = convert(slot, to="4b", format="3b", entered=Entries(gap_um=100.0), transforms=[text])
        assert done.ok or done.status == 3
        made.append(done.ok)
        assert not done.ok or done.images.fit.largest_um <= 1.0
    assert made[0]


def test_turns_of_more_than_one_and_their_images():
    twice = b"B10000B0B100000GYNR1 DD"
    for text in ("rotate 10 copies 3", "reverse", "mirror 45", "with symmetry x"):
        done = convert(twice, to="compact", format="3b", transforms=[text])
        assert done.ok, (text, done.findings)
    # Of 4 um: a um of radius is a large part of a turn.
    small = compact((Kind.LINE, 0, 4224, 1365), (Kind.ARC, 1, -4, 0, 21))
    turned = ["symmetry y", "rotate -25.511 about (9.803, -8.630) copies 4"]
    done = convert(small, to="compact", format="compact", transforms=turned)
    assert done.ok, done.findings


def test_steps_of_other_lengths_and_exchanged_axes():
    text = (
        'title = "5 um a pulse"\nformat = "3b"\nline_table = "rotate"\n'
        "[limits]\ncount_um = 999999\nline_um = 999999\narc_um = 999999\n"
        "[axes]\nstep_um = 5\nexchange = true\n"
    )
    profile = machines.parse(text, "coarse")[0]
    done = convert(
        b"B1700B500B1700GXL1 B1000B0B1000GYNR1 DD",
        to="3b",
        format="3b",
        profile=profile,
        profile_in=profile,
        transforms=["rotate 30 copies 2 about (10, 5)"],
    )
    assert done.ok, done.findings
    data = done.images.as_data()
    assert 0 < data["vertex_um"] <= 5.0
    # The first line ends at (2.5, 8.5) mm (x and y exchanged); turned by 30 degrees about (10, 5).
    z = (complex(2.5, 8.5) - complex(10, 5)) * np.exp(1j * np.pi / 6) + complex(10, 5)
    at = done.images.made.stands[1, 1] * 5 / 1000
    assert abs(complex(*at) - z) <= 0.005


def test_copies_on_the_figure_are_left_out_and_said():
    done = convert(LINE, to="3b", format="3b", transforms=["rotate 90 copies 4"])
    assert done.ok
    assert done.images.count == 4
    assert done.images.left_out == 1
    assert "duplicate" in [d.code for d in done.findings]


def codes(data, texts, **more):
    done = convert(data, to="3b", format=more.pop("format", "3b"), transforms=texts, **more)
    return done.ok, [d.code for d in done.findings]


def test_what_is_wrong_is_refused():
    assert codes(LINE, ["mirror 44"]) == (False, ["wed-value"])
    assert codes(LINE, ["rotate 1 copies 100"]) == (False, ["wed-value"])
    ok, found = codes(
        LINE, ["rotate 1 copies 99", "rotate 2 copies 99", "translate (1,1) copies 999"]
    )
    assert not ok
    assert found == ["too-large"]
    ok, found = codes(LINE + b" B17000B5000B17000GXL1 E", ["symmetry x"])
    assert not ok
    assert "not-carried" in found


def test_a_transform_that_changes_no_number_is_said():
    ok, found = codes(LINE, ["translate (3, 4)"])
    assert ok
    assert "transform-idle" in found
    assert codes(LINE, ["translate (3, 4)"], strict=True)[0] is False
    # The place is not lost where a format states one.
    done = convert(LINE, to="iso", format="3b", transforms=["translate (3, 4)"])
    assert b"G92 X3.000 Y4.000" in done.data


def test_pauses_before_the_end_of_a_contour_are_said_in_reverse():
    # A square with a lead, and a pause before its last side.
    side = 10_000
    rows = [
        (Kind.LINE, 0, 0, 1_000),
        (Kind.LINE, 0, side, 0),
        (Kind.LINE, 0, 0, side),
        (Kind.LINE, 0, -side, 0),
        (Kind.PAUSE, 0, 0, 0),
        (Kind.LINE, 0, 0, -side),
        (Kind.LINE, 0, 0, -1_000),
    ]
    for text, said in (
        ("with symmetry x", True),
        ("symmetry x", False),
        ("rotate 9 copies 2", False),
    ):
        done = convert(compact(*rows), to="compact", format="compact", transforms=[text])
        assert done.ok
        assert ("pause-reversed" in [d.code for d in done.findings]) is said


def test_control_words_keep_their_places():
    text = b"QUENCH B17000B5000B17000GXL1 WAIT B0B2000B2000GYL2 DD"
    done = convert(text, to="3b", format="3b", transforms=["with symmetry x"])
    words = done.data.decode().split()
    assert words[:4] == ["QUENCH", "B17000B5000B17000GXL1", "WAIT", "B0B2000B2000GYL2"]
    assert words[-4:-1] == ["WAIT", "B17000B5000B17000GXL2", "QUENCH"]


# --- the judge ------------------------------------------------------------------------------------


def made_of(text="rotate 20 copies 2"):
    rows = [
        (Kind.LINE, 0, 5_000, 100),
        (Kind.ARC, 1, 3_000, 0, 16_970),
        (Kind.ARC, -1, 0, 4_000, 2_000),
        (Kind.MOVE, 0, 100, 9_000),
    ]
    figure = blocks_of(*rows)
    transforms = [parse_transform(text)[0]]
    made = moved(figure, images(transforms)[0], MIRROR)
    said = Said(made.blocks, made.start, made.image, made.stands)
    return figure, transforms, said


def judged(figure, transforms, said, written=None):
    blocks = said.blocks if written is None else written
    return fit(figure, transforms, said, MIRROR, blocks, MIRROR)


@pytest.mark.parametrize("text", ["rotate 20 copies 2", "with mirror 45", "reverse", "symmetry y"])
def test_the_judge_takes_what_is_right(text):
    one = judged(*made_of(text))
    assert one.ok, one


def test_the_judge_refuses_forgeries():
    figure, transforms, said = made_of()
    other = said.stands.copy()
    other[1, 2] += 2
    assert not judged(figure, transforms, replace(said, stands=other)).ok
    assert not judged(figure, [parse_transform("rotate 20.01 copies 2")[0]], said).ok
    assert not judged(figure, [parse_transform("rotate 20 copies 3")[0]], said).ok
    rows = np.flatnonzero(said.blocks["source"] == 2)

    def changed(row, **values):
        blocks = said.blocks.copy()
        for name, value in values.items():
            blocks[name][row] = value
        return replace(said, blocks=blocks)

    # A line instead of an arc, a cut instead of a move, the long way round.
    stands = said.stands[said.image[rows[0]]]
    way = stands[3] - stands[2]
    axis, j = MIRROR.line_count(way[:1], way[1:])
    chord = changed(rows[0], kind=0, turn=0, x=way[0], y=way[1], axis=axis[0], count=j[0])
    assert "not run" in judged(figure, transforms, chord).wrong
    moves = np.flatnonzero(said.blocks["source"] == 3)
    assert "not run" in judged(figure, transforms, changed(moves[0], kind=Kind.LINE)).wrong
    # A full circle that is left out has the same ends.
    circle = np.flatnonzero(said.blocks["source"] == 1)[0]
    keep = np.arange(len(said.blocks)) != circle
    less = replace(said, blocks=said.blocks[keep], image=said.image[keep])
    assert "turn as far" in judged(figure, transforms, less).wrong
    # Other bytes than were made.
    assert "do not end within" in judged(figure, transforms, said, said.blocks[:-2]).wrong


def test_what_the_judge_refuses_is_not_written():
    program = Program(blocks_of((Kind.LINE, 0, 17_000, 5_000)))
    machine = builtin("zd065")
    one, _ = images_of(program, machine, ["rotate 20 copies 2"], machine)
    wrong = replace(one, transforms=(Rotate(Fraction(21), 2),))
    _, findings = measured(wrong, one.program, machine.stepping)
    assert [d.code for d in findings] == ["transform-differs"]
    assert "transform-differs" in CODES


# --- the command ----------------------------------------------------------------------------------


def test_the_command_says_what_it_understood(tmp_path):
    program, output = tmp_path / "a.3b", tmp_path / "b.3b"
    program.write_bytes(LINE)
    arguments = ["convert", str(program), "-o", str(output), "--no-config"]
    done = CliRunner().invoke(cli, [*arguments, "--transform", "translate (100, 0) copies 2"])
    assert done.exit_code == 0
    assert "3 images of 1 block, from (0.000, 0.000) on" in done.stderr
    assert "2 moves with the generator off, 83.150 mm each" in done.stderr
    assert "at most 0.00 um from the exact ones" in done.stderr
    more = ["--transform", "symmetry x", "--transform", "rotate 15 copies 3", "--json"]
    done = CliRunner().invoke(cli, [*arguments, *more])
    data = json.loads(done.stdout)["images"]
    assert data["images"] == 4
    assert data["transforms"] == ["symmetry x", "rotate 15 copies 3"]
    assert 0 < data["vertex_um"] <= 1.0
    before = output.read_bytes()
    done = CliRunner().invoke(cli, [*arguments, "--transform", "mirorr 45"], standalone_mode=False)
    assert done.return_value == 1
    assert "did you mean 'mirror'?" in done.stderr
    assert "1 | mirorr 45" in done.stderr
    assert output.read_bytes() == before
