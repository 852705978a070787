"""Programs of the samples, byte for byte. They change on purpose or not at all.

``pytest tests/golden --update-golden`` writes them anew; the difference is a change of what
machines will cut, and belongs into CHANGELOG.
"""

from pathlib import Path

import pytest

from wedmcam import api

HERE = Path(__file__).parent
SAMPLES = HERE.parents[1] / "samples"
CASES = [
    (drawing, ending, options)
    for drawing, options in {
        "key-punch": {"offset": 0.1},
        "stator-36": {"offset": 0.1},
        "gear-24": {"offset": 0.1},
        "plate": {"offset": 0.1},
        "bracket-inch": {"offset": 0.1},
        "cam": {"offset": 0.1},
        "cover": {"offset": 0.1},
        "damaged": {"offset": 0.1, "units": "mm"},
    }.items()
    for ending in (".3b", ".zd", ".nc")
] + [
    (
        "key-punch",
        ".die.3b",
        {"offset": 0.1, "side": "die", "corner": 0.15, "ignore_layers": ["START"]},
    ),
    ("gear-24", ".textbook.3b", {"offset": 0.1, "count": "textbook"}),
    ("plate", ".4b", {"offset": 0.1, "corner": 0.3, "ignore_layers": ["START"]}),
    ("key-punch", ".n15", {"offset": 0.1}),
    ("cover", ".n15", {"offset": 0.1}),
    ("cam", ".die.4b", {"offset": 0.1, "corner": 0.3, "side": "die", "ignore_layers": ["START"]}),
    ("key-punch", ".d15", {"offset": 0.1, "feed": 1.0}),
    ("gear-24", ".d15", {"offset": 0.1, "feed": 2.0}),
]
PROFILES = {
    "plate.columns.3b": "b3-columns",
    "plate.numbered.3b": "b3-numbered",
    "plate.um.nc": "iso-um",
    "plate.fixed.nc": "iso-fixed",
    "plate.g41.nc": "iso-g41",
    "plate.g41-mm.nc": "iso-g41-mm",
}


def compiled(drawing, ending, options, profile=None):
    data = (SAMPLES / f"{drawing}.dxf").read_bytes()
    formats = {".zd": "compact", ".nc": "iso", ".4b": "4b", "d15": "dem15", "n15": "nby15"}
    to = formats.get(ending[-3:], "3b")
    made = api.compile(data, to=to, name=drawing, profile=profile, **options)
    assert made.ok, [d.message for d in made.findings]
    return made


@pytest.mark.parametrize(("drawing", "ending", "options"), CASES)
def test_golden(drawing, ending, options, update_golden):
    made = compiled(drawing, ending, options)
    judge(HERE / f"{drawing}{ending}", made.data, update_golden)


@pytest.mark.parametrize("name", sorted(PROFILES))
def test_golden_layouts(name, update_golden):
    made = compiled("plate", name[-3:], {"offset": 0.1}, PROFILES[name])
    judge(HERE / name, made.data, update_golden)


PARTS = sorted(p.stem for p in SAMPLES.glob("*.wed"))


@pytest.mark.parametrize(
    ("name", "ending", "defines"),
    [(name, ".3b", ()) for name in PARTS]
    + [("washer", ".m8.3b", ("bore=8.4", "size=16")), ("gear", ".zd", ())],
)
def test_golden_parts(name, ending, defines, update_golden):
    data = (SAMPLES / f"{name}.wed").read_bytes()
    to = "compact" if ending == ".zd" else "3b"
    made = api.compile(data, to=to, name=f"{name}.wed", defines=defines)
    assert made.ok, [d.message for d in made.findings]
    assert made.verdict.max_deviation_um <= 2.0
    assert (made.verdict.gouge_um or 0.0) <= 1.6
    assert made.verdict.closure_um == 0
    judge(HERE / f"{name}.wed{ending}", made.data, update_golden)


def judge(path, data, update):
    if update:
        path.write_bytes(data)
    assert path.is_file(), f"{path.name} is missing: run with --update-golden and look at it"
    assert path.read_bytes() == data, f"{path.name} differs"


@pytest.mark.parametrize(("drawing", "ending", "options"), CASES)
def test_figures_of_the_issue(drawing, ending, options):
    made = compiled(drawing, ending, options)
    v, step_um = made.verdict, made.machine.axes.step_um
    # A degree of the NBY-15 is a straight move: its sagitta comes on top.
    coarse = v.path_limit_um / step_um - 2.0 if ending == ".n15" else 0.0
    assert v.max_deviation_um <= (2.0 + coarse) * step_um
    assert v.gouge_um <= (1.6 + coarse + (0.5 if coarse else 0.0)) * step_um
    assert v.closure_um == 0


def test_all_formats_describe_the_same_steps():
    """One lowering serves every format: the same ends of the same blocks."""
    one = compiled("stator-36", ".3b", {"offset": 0.1})
    two = compiled("stator-36", ".zd", {"offset": 0.1})
    ends_one = api.positions(one.program, one.machine)[1]
    ends_two = api.positions(two.program, two.machine)[1]
    drop = one.program.blocks["kind"] <= 2
    drop_two = two.program.blocks["kind"] <= 2
    assert (ends_one[drop] == ends_two[drop_two]).all()
