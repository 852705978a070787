import numpy as np
import pytest

from wedmcam.controllers.pointwise import LineTable, arc_quadrant
from wedmcam.formats import b3, compact, lines, quadrants
from wedmcam.ir.program import Axis, Kind


@pytest.mark.parametrize("turn", [1, -1])
def test_quadrant_agrees_with_the_controller(turn):
    points = [(x, y) for x in range(-3, 4) for y in range(-3, 4) if x or y]
    x, y = np.array(points).T
    got = quadrants.quadrant(x, y, turn)
    assert got.tolist() == [arc_quadrant(*p, turn) for p in points]
    # and the sign that the quadrant names is the sign of the point
    sx, sy = quadrants.signed(abs(x), abs(y), got)
    assert (sx == x).all()
    assert (sy == y).all()


def test_line_quadrants():
    x, y = np.array([[5, 0], [0, 5], [-5, 0], [0, -5], [1, 1], [-1, 1], [-1, -1], [1, -1]]).T
    assert quadrants.quadrant(x, y, 0).tolist() == [1, 2, 3, 4, 1, 2, 3, 4]
    assert quadrants.quadrant(0, 0, 0) == 0


def test_instruction_names():
    turn = np.array([0, 1, -1, -1])
    got = b3.instruction(turn, np.array([1, 2, 3, 4]))
    assert [b3.INSTRUCTIONS[i] for i in got] == ["L1", "NR2", "SR3", "SR4"]


def test_line_axis_ties():
    # 2-3b.md: X = Y: GY in quadrants 1, 3, GX in 2, 4; ZD-065: y at a tie
    x, y = np.array([3, -3, -3, 3]), np.array([3, 3, -3, -3])
    assert LineTable.ROTATE.line_count(x, y)[0].tolist() == [1, 0, 1, 0]
    assert LineTable.MIRROR.line_count(x, y)[0].tolist() == [1, 1, 1, 1]
    assert compact.line_count(x, y)[0].tolist() == [1, 1, 1, 1]


def test_moves():
    kinds = np.array([Kind.PAUSE, Kind.LINE, Kind.PAUSE, Kind.LINE, Kind.LINE, Kind.PAUSE], "u1")
    assert b3.moves(kinds).tolist() == [False, True, False, False, False, False]
    assert b3.moves(np.array([Kind.PAUSE, Kind.ARC, Kind.PAUSE], "u1")).sum() == 0
    assert len(b3.moves(np.zeros(1, "u1"))) == 1


@pytest.mark.parametrize("value", [0, 7, 99, 100, 999_999])
def test_bcd(value):
    packed = compact.to_bcd(value, 3)
    assert packed.hex() == f"{value:06d}"
    assert compact.from_bcd(packed) == value
    assert compact.column_to_bcd(np.array([value]), 3).tobytes() == packed


@pytest.mark.parametrize(("value", "size"), [(1_000_000, 3), (-1, 3), (100, 1)])
def test_bcd_does_not_fit(value, size):
    with pytest.raises(ValueError, match="does not fit"):
        compact.to_bcd(value, size)


def test_bad_bcd():
    with pytest.raises(ValueError, match="no packed BCD"):
        compact.from_bcd(b"\x1a")
    values, bad = compact.column_from_bcd(
        np.frombuffer(b"\x12\x3a\xf4\x12\x34\x56", "u1").reshape(2, 3)
    )
    assert bad.tolist() == [1, -1]
    assert values[1] == 123456


def test_block_lengths():
    codes = (0x01, 0x04, 0x05, 0x14, 0x21, 0x41, 0x30, 0x31, 0x32, 0x00)
    assert [compact.LENGTH[c] for c in codes] == [7, 7, 0, 12, 12, 7, 1, 1, 0, 0]


def test_loads():
    # 1-zd065.md 1: at most 585 lines (585 x 7 = 4,095)
    assert compact.loads(np.full(585, 7), 4096) == 1
    assert compact.loads(np.full(586, 7), 4096) == 2
    assert compact.loads(np.full(342, 12), 4096) == 2  # 341 arcs are 4,092
    assert compact.loads(np.full(341, 12), 4096) == 1
    assert compact.loads(np.zeros(0, dtype=np.int64), 4096) == 1
    assert compact.loads(np.full(585 * 3, 7), 4096) == 3


def test_full_lines():
    # 2-3b.md: B17B5B17000GXL1 is the line to (17000, 5000)
    x, y, ok = lines.full(
        np.array([17, -17, 5, 0]),
        np.array([5, 5, 5, 3]),
        np.array([Axis.X, Axis.SQUARE, Axis.Y, Axis.X], "u1"),
        np.array([17000, 34, 7, 9]),
    )
    assert list(zip(x.tolist(), y.tolist(), ok.tolist(), strict=True)) == [
        (17000, 5000, True),
        (-34, 10, True),
        (7, 7, True),
        (0, 3, False),
    ]


@pytest.mark.parametrize("word", ["D", "DD", "E", "M02", "STOP", "GX", "NR"])
def test_is_word(word):
    assert b3.is_word(word)


@pytest.mark.parametrize(
    "word", ["", "B", "B12", "N5", "N5A", "B1B2", "GXL1", "A B", "d", "X" * 17]
)
def test_is_no_word(word):
    assert not b3.is_word(word)
