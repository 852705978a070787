"""What docs/servo.md says of the three laws is what comes out."""

import functools
import re
from pathlib import Path

import numpy as np
import pytest

from wedmcam import api
from wedmcam.diag.run import WrongUse
from wedmcam.operations.servo import compare_servos
from wedmcam.simulate.feeding import Feeding, feeding_of
from wedmcam.simulate.gap import Gap, Workpiece
from wedmcam.simulate.laws import LAWS, EindhovenLaw, EindhovenSettings, PatentLaw
from wedmcam.simulate.route import lay
from wedmcam.simulate.runs import AtOnce
from wedmcam.simulate.servo import Settings

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "servo.md").read_text("utf-8")


@functools.cache
def compared():
    program, machine, _ = api.read_program(ROOT / "tests" / "golden" / "cam.zd")
    route = lay(program, machine.stepping)
    return compare_servos(route, "cam.zd", seeds=range(3), steps=3000)


def figures(table):
    """Return law -> means and deviations of a table."""
    rows = [re.split(r"\s{2,}", line.strip()) for line in table.strip().splitlines()[1:]]
    return {row[0]: [[float(x) for x in cell.split(" ± ")] for cell in row[1:]] for row in rows}


def test_the_table_of_the_page():
    """Within four deviations: numpy may draw otherwise one day."""
    shown = re.search(r"^```text\n(servo .*?)^```$", PAGE, re.M | re.S)[1]
    fresh = compared().table
    assert shown.splitlines()[0].split() == fresh.splitlines()[0].split()
    shown, fresh = figures(shown), figures(fresh)
    assert shown.keys() == fresh.keys() == LAWS.keys()
    for law, cells in shown.items():
        for (mean, deviation), (now, _) in zip(cells, fresh[law], strict=True):
            assert abs(mean - now) <= max(4 * deviation, 0.02 * mean), law


def test_a_comparison_in_numbers():
    summary = compared().summary
    assert summary["exact"]
    assert [(t["servo"], t["seed"]) for t in summary["trials"]] == [
        (law, seed) for law in LAWS for seed in range(3)
    ]
    for trial in summary["trials"]:
        assert trial["steps"] == 3000
        assert trial["longest"] <= 100
        assert trial["retreats"] > 0


def test_what_the_page_says_of_the_laws():
    of = {law: [t for t in compared().trials if t.servo == law] for law in LAWS}
    mean = {
        law: {name: np.mean([getattr(t, name) for t in rows]) for name in ("seconds", "spread_um")}
        | {"short": np.mean([t.short_percent for t in rows])}
        for law, rows in of.items()
    }
    assert min(mean, key=lambda law: mean[law]["short"]) == "patent"
    assert min(mean, key=lambda law: mean[law]["spread_um"]) == "feed"
    assert min(mean, key=lambda law: mean[law]["seconds"]) == "eindhoven"
    assert max(mean, key=lambda law: mean[law]["short"]) == "eindhoven"


def run(law, steps=1000):
    """Return seconds and spread of some steps."""
    feeding = Feeding(law, Gap(Workpiece(), np.random.default_rng(1)), attended=True)
    feeding.forward(0, steps, 0, 100)
    return feeding.tally.seconds, feeding.gap.spread_um


def test_what_the_page_says_of_settings():
    best = run(PatentLaw(AtOnce(), 1e5, Settings()))
    assert run(PatentLaw(AtOnce(), 1e5, Settings(3, 3)))[0] > best[0]
    assert run(PatentLaw(AtOnce(), 1e5, Settings(6, 6)))[0] > best[0]
    assert run(PatentLaw(AtOnce(), 1e5, Settings(steps=40)))[1] > 1.5 * best[1]
    with_both = run(EindhovenLaw(AtOnce(), 1e5))
    alone = run(EindhovenLaw(AtOnce(), 1e5, EindhovenSettings(gain=0.0)))
    assert alone[1] > 1.3 * with_both[1]


@pytest.mark.parametrize(("servo", "hz"), [("paris", 1e5), ("feed", 0.0), ("feed", 2e6)])
def test_another_name_or_no_pulses_are_wrong_use(servo, hz):
    with pytest.raises(WrongUse):
        feeding_of(servo, hz=hz)
