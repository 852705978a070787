"""Every drawing of tests/bad says in its first comment what must be found in it."""

from __future__ import annotations

from pathlib import Path

import pytest

from wedmcam.diag import has_errors
from wedmcam.frontends.dxf import read
from wedmcam.transforms.chain import chain, open_contour_findings

BAD = sorted((Path(__file__).parents[1] / "bad").glob("*.dxf"))


@pytest.mark.parametrize("path", BAD, ids=lambda p: p.stem)
def test_bad_drawing(path):
    data = path.read_bytes()
    expected = data.decode().split("\n")[1]
    sketch, found = read(data, path.name)
    if sketch is not None and not has_errors(found):
        contours, _, more = chain(sketch)
        found = (*found, *more, *open_contour_findings(contours))
    assert expected in [f"{d.severity}[{d.code}]" for d in found], found
    others = {f"{d.severity}[{d.code}]" for d in found if d.severity.name == "ERROR"}
    assert others <= {expected, "error[no-units]", "error[open-contour]"}


def test_there_are_some():
    assert len(BAD) > 30
