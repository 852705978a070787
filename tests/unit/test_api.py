"""Wrong use of the library is said in words."""

import pytest

import parts
import wedmcam

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
