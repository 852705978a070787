import random

import pytest

from wedmcam.frontends import decoder
from wedmcam.frontends.identify import identify
from wedmcam.machines import builtin
from wedmcam.programs.rows import dump

LINE = bytes.fromhex("01 017000 005000")
ARC = bytes.fromhex("21 00009900 00000000 056003")


@pytest.mark.parametrize(
    ("data", "want"),
    [
        (b"", ("empty", 0, None, None, True)),
        (bytes(4096), ("empty", 0, None, None, True)),
        (b"N1 B9900B0B9900GXL1\nDD\n", ("3b", 1, 18, None, True)),
        ("钢 B9900B0B9900GXL1".encode("gbk"), ("3b", 1, 17, None, True)),
        (LINE + ARC + b"\0", ("compact", 2, 19, None, True)),
        (LINE * 3 + bytes(100), ("compact", 3, 21, None, False)),
        (LINE + ARC + b"\0\0\x07", ("compact", 2, 19, 21, True)),
        (LINE + ARC, ("compact", 2, 18, None, False)),
        (LINE + ARC + b"\x99\x01", ("compact", 2, 18, 19, False)),
        (LINE + ARC + b"\x01\x0a\0\0\0\0\0\0", ("compact", 2, 18, 20, False)),
        (LINE + ARC[:5], ("unknown", 0, None, 7, False)),
        (b"hello, world", ("unknown", 0, None, 0, False)),
        (b"A123456B123456B123456", ("unknown", 0, None, 21, False)),
        (b"\x7fELF\0\0", ("unknown", 0, None, 0, False)),
        (b"1010110101", ("unknown", 0, None, 10, False)),
    ],
)
def test_identify(data, want):
    got = identify(data)
    assert (got.format, got.blocks, got.last_address, got.bad_address, got.certain) == want


def test_random_data_is_recognised():
    source = random.Random(65)
    kinds = [identify(source.randbytes(4096)).format for _ in range(300)]
    assert set(kinds) == {"unknown"}


def test_reasons():
    assert identify(LINE + b"\0").reason.endswith("the compensation format has the same bytes")
    assert identify(LINE + ARC + b"\x99").reason.endswith("damaged at 0x0013")
    assert "random" in identify(b"\x99\x88\x00").reason


def test_dump_b3():
    machine = builtin("b3-compact")
    text = b"B9900B0B9900GXL1\nB9900B0B39600GYNR1\nM02\nB9900B0B9900GXL3\nDD\n"
    program, _ = decoder("3b")(text, machine, "k.3b")
    rows = list(dump(program, machine))
    assert [r.number for r in rows] == [1, 2, 3, 4, 5]
    assert [r.where for r in rows] == ["1:1", "2:1", "3:1", "4:1", "5:1"]
    assert [r.kind for r in rows] == ["line", "arc", "M02", "line", "stop"]
    assert [r.instruction for r in rows] == ["L1", "NR1", "", "L3", ""]
    assert [r.end for r in rows] == [(9900, 0), (9900, 0), (9900, 0), (0, 0), (0, 0)]
    assert (rows[1].x, rows[1].y, rows[1].axis, rows[1].count) == (9900, 0, "Y", 39600)
    assert rows[2].x is None
    assert rows[0].steps == 9900


def test_dump_compact():
    machine = builtin("zd065")
    program, _ = decoder("compact")(LINE + LINE + b"\0", machine, "k.zd")
    rows = list(dump(program, machine))
    assert [r.where for r in rows] == ["0x0000", "0x0007", "0x000e"]
    assert [r.end for r in rows] == [(17000, 5000), (34000, 10000), (34000, 10000)]


ROTATION = bytes.fromhex("01 02 30000000 020000  21 00 00000000 00010000 02 90000000")
GAP = bytes.fromhex("01 006000 000000  24 01 00002000 00000000 00002000 002828")


@pytest.mark.parametrize(
    ("data", "want", "reason"),
    [
        (ROTATION + b"\0", ("rotation", 2, 24, None, True), "rotation format: 2 blocks"),
        (ROTATION[:9] + b"\0", ("rotation", 1, 9, None, False), "would also do as compact cutting"),
        (ROTATION, ("rotation", 2, 23, None, False), "then the data stop without an end byte"),
        (ROTATION + ROTATION + b"\x77", ("rotation", 4, 47, 48, False), "damaged at 0x0030"),
        (GAP + b"\0\0", ("compensation", 2, 24, None, True), "gap-compensation format: 2 blocks"),
        (GAP[:7] + b"\0", ("compact", 1, 7, None, False), "the compensation format has the same"),
    ],
)
def test_the_three_formats_are_told_apart(data, want, reason):
    got = identify(data)
    assert (got.format, got.blocks, got.last_address, got.bad_address, got.certain) == want
    assert reason in got.reason


def test_random_bytes_are_called_random():
    import random

    rng = random.Random(65)
    named = sum(
        identify(rng.randbytes(rng.randrange(1, 400))).format != "unknown" for _ in range(3000)
    )
    assert named <= 3  # a lone 0 is empty memory


@pytest.mark.parametrize(
    ("data", "format_"),
    [
        (b"G92 X0 Y0\nG91\nG01 X100 Y5\nM02\n", "iso"),
        (b"%\n(part)\ng90g1x1.5y-.5\ng2x0y0i1j0\nm2\n%\n", "iso"),
        (b"Dear Sir,\nG1 is a letter and a digit.\nYours\n", "unknown"),
        (b"M02\n", "unknown"),
        (b"A1 B2 C3\nX1 Y2\n", "unknown"),
    ],
)
def test_iso_is_words_and_nothing_else(data, format_):
    assert identify(data).format == format_
