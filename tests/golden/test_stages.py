"""What the stages of a compile give for a few samples, as text, byte for byte.

A change of a stage shows here before it shows in programs, and tells which stage it was.
"""

from pathlib import Path

import pytest

from wedmcam import api
from wedmcam.reports.stages import STAGES, stage_text

HERE = Path(__file__).parent / "stages"
SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.parametrize("name", ["bracket-inch.dxf", "cam.dxf", "quarter.wed", "row.wed"])
def test_golden_stages(name, update_golden):
    values = {}
    options = {} if name.endswith(".wed") else {"offset": 0.1}
    source = (SAMPLES / name).read_bytes()
    compilation = api.compile(source, name=name, observe=values.__setitem__, **options)
    assert compilation.ok
    stepping = compilation.machine.stepping
    for stage, source_stage in STAGES.items():
        text = stage_text(stage, values[source_stage], stepping)
        path = HERE / f"{name}.{stage}.txt"
        if update_golden:
            path.write_text(text, "utf-8", newline="\n")
        assert path.read_text("utf-8") == text


def test_stages_stop_where_the_compile_stops():
    seen = []
    refused = api.compile(b"0\nSECTION\n0\nENDSEC\n0\nEOF\n", observe=lambda s, v: seen.append(s))
    assert not refused.ok
    assert "plan" not in seen
