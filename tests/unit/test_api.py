"""Wrong use of the library is said in words."""

import pytest

import parts
import wedmcam
from wedmcam.batch.compile import compile_all
from wedmcam.operations.convert import convert
from wedmcam.options import Options

DRAWING = parts.dxf_bytes((parts.rectangle(20_000, 10_000),))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"side": "foo"}, "foo"),
        ({"bogus": 1}, "bogus"),
        ({"units": "ft"}, "ft"),
        ({"offset": "x"}, "length"),
        ({"to": "stl"}, "stl"),
        ({"profile": "b3-colums"}, "b3-columns"),
        ({"count": "guess"}, "guess"),
    ],
)
def test_wrong_use(options, said):
    with pytest.raises(wedmcam.WrongUse, match=said):
        wedmcam.compile(DRAWING, **{"offset": 0.1, **options})


def test_plot_and_inspect():
    made = wedmcam.compile(DRAWING, offset=0.1)
    assert "<svg" in wedmcam.plot(made)
    seen = wedmcam.inspect(DRAWING)
    assert seen.facts["size_mm"] == [20.0, 10.0]
    assert "<svg" in wedmcam.plot(seen)


MADE = b"B17000B5000B17000GXL1 DD"


@pytest.mark.parametrize("keyword", [{"ofset": 0.1}, {"offset": 0.1}])
def test_no_keyword_falls_away_beside_options(keyword, tmp_path):
    """A misspelt one is wrong use, and so is one that the options say otherwise."""
    options = Options.of(offset_um=200.0)
    for call in (
        lambda: wedmcam.compile(DRAWING, options=options, **keyword),
        lambda: wedmcam.inspect(DRAWING, options=options, **keyword),
        lambda: wedmcam.verify(MADE, name="a.3b", options=options, fit_origin=True, **keyword),
        lambda: compile_all(tmp_path, tmp_path, options=options, **keyword),
    ):
        with pytest.raises(wedmcam.WrongUse, match=f"{next(iter(keyword))}: 'options' is given"):
            call()


def test_a_misspelt_keyword_is_wrong_use():
    certificate = wedmcam.compile(DRAWING, offset=0.1).summary
    for call in (
        lambda: wedmcam.verify(MADE, name="a.3b", ofset=0.1),
        lambda: wedmcam.verify(MADE, name="a.3b", certificate=certificate, fit_orign=True),
        lambda: convert(MADE, to="compact", fed_um=0.1),
        lambda: convert(MADE, to="svg", units_on="mm"),
    ):
        with pytest.raises(wedmcam.WrongUse, match=r"ofset|fit_orign|fed_um|units_on"):
            call()
