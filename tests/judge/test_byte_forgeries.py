"""One nibble or one block changed: no other path passes `verify` without a word."""

from __future__ import annotations

from itertools import islice

import byte_forgeries as bf
import lead_forgeries as lf
import pytest

CASES = {"3b": {}, "compact": {"to": "compact"}, "3b, thread point": {"starts": [(-0.2, 0.3)]}}
DRAWING = lf.plate()


@pytest.mark.parametrize("certified", [False, True], ids=["against", "certificate"])
@pytest.mark.parametrize("name", CASES)
def test_no_forgery_slips_through(name, certified):
    trial = bf.Trial(DRAWING, certified, **{"offset": 0.05, "lead": 0.15, **CASES[name]})
    made = trial.made
    forged = [*islice(bf.nibbles(made.data, 1), 15), *islice(bf.edits(made, 1), 20)]
    if made.machine.format == "3b":
        forged += islice(bf.digits(made.data, 1), 10)
    outcomes = [trial.outcome(f) for f in forged]
    assert not [o.forged.what for o in outcomes if o.slipped]
    assert sum(o.status > 0 for o in outcomes) > len(outcomes) / 2


def test_every_sort_of_edit_is_tried():
    made = lf.compiled("3b")
    sorts = {f.what.partition(": ")[2] for f in islice(bf.edits(made, 1), 300)}
    assert sorts == set(bf.EDITS)


def test_an_edit_that_keeps_the_path_passes():
    trial = bf.Trial(DRAWING, False, offset=0.05, lead=0.15)
    lines = trial.made.data.decode().split("\n")
    row = next(k for k, line in enumerate(lines) if line.startswith("B1800B0B1800GX"))
    rest = lines[row][12:]
    lines[row : row + 1] = [f"B1000B0B1000{rest}", f"B800B0B800{rest}"]
    outcome = trial.outcome(bf.Forged("parted", "\n".join(lines).encode()))
    assert outcome.status == 0
    assert outcome.same_path
