import pytest

from drawings import codes, drawing, got
from wedmcam.frontends.dxf import read
from wedmcam.frontends.options import DrawingReading


def line(length):
    return lambda doc, msp: msp.add_line((0, 0), (length, 0))


@pytest.mark.parametrize(
    ("insunits", "um"),
    [
        (1, 25_400),
        (2, 304_800),
        (3, 1_609_344_000),
        (4, 1_000),
        (5, 10_000),
        (6, 1_000_000),
        (7, 1_000_000_000),
        (8, 0.0254),
        (9, 25.4),
        (10, 914_400),
        (11, 1e-4),
        (12, 1e-3),
        (13, 1),
        (14, 100_000),
        (15, 10_000_000),
        (16, 100_000_000),
    ],
)
def test_insunits(insunits, um):
    length = 100_000 / um  # 100 mm in any unit
    sketch, found = got(drawing(line(length), units=insunits))
    assert sketch.segments["x1"][0] == pytest.approx(100_000, rel=1e-12)
    assert sketch.info.units_from == f"$INSUNITS {insunits}"
    assert not found


@pytest.mark.parametrize("insunits", [0, 99, None])
def test_no_units(insunits):
    data = drawing(line(80), units=0)
    if insunits is None:
        text = data.decode()
        at = text.index("$INSUNITS")
        data = (text[: text.rindex("9", 0, at)] + text[text.index("9\n$", at) :]).encode()
    elif insunits:
        data = data.replace(b"$INSUNITS\n 70\n0", b"$INSUNITS\n 70\n99")
    sketch, found = read(data, "part.dxf")
    assert sketch is None
    assert codes(found) == ["no-units"]
    assert "80.000 x 0.000 drawing units" in found[0].message
    assert "--units" in found[0].hint
    sketch, found = got(data, units="inch")
    assert sketch.segments["x1"][0] == pytest.approx(80 * 25_400)
    assert codes(found) == ["unlikely-units"]  # 2 m as inches, 80 mm as mm


def test_asked_units_win_with_a_warning():
    data = drawing(line(10), units=1)
    sketch, found = got(data, units="mm")
    assert sketch.segments["x1"][0] == 10_000
    assert (sketch.info.units, sketch.info.units_from) == ("mm", "--units")
    assert codes(found) == ["units-overridden"]
    sketch, found = got(data, units="inch")
    assert not found
    sketch, found = got(data, units="mm", fill_in_units=True)
    assert sketch.info.units == "inch"
    assert not found
    unitless = drawing(line(10), units=0)
    assert got(unitless, units="mm", fill_in_units=True)[0].info.units == "mm"


@pytest.mark.parametrize(
    ("units", "length", "words"),
    [
        (
            1,
            256,
            "($INSUNITS 1) the part is 6502.400 x 0.000 mm; as mm it would be 256.000",
        ),
        (6, 100, "as mm it would be 100.000"),
        (4, 0.5, "as inch it would be 12.700"),
        (1, 12, None),
        (4, 300, None),
        (4, 5, None),
    ],
)
def test_unlikely_units(units, length, words):
    _, found = got(drawing(line(length), units=units))
    assert codes(found) == (["unlikely-units"] if words else [])
    if words:
        assert words in found[0].message


@pytest.mark.parametrize(
    ("units", "measurement", "said"), [(4, 1, []), (4, 0, ["c"]), (1, 0, []), (1, 1, ["c"])]
)
def test_measurement_contradicts(units, measurement, said):
    def draw(doc, msp):
        msp.add_line((0, 0), (12, 0))
        doc.header["$MEASUREMENT"] = measurement

    _, found = got(drawing(draw, units=units))
    assert codes(found) == ["units-contradict"] * len(said)


def test_size_counts_the_bellies_of_arcs():
    data = drawing(lambda doc, msp: msp.add_circle((5, 5), 20), units=0)
    _, found = read(data, "part.dxf", DrawingReading())
    assert "40.000 x 40.000 drawing units" in found[0].message
