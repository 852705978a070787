"""Real drawings: what each must come to, in ``expected.tsv``.

The drawings are not part of the project: WEDMCAM_CORPUS names their folder, and without it these
tests skip. Columns:

- ``units``, given where the drawing has none, or wrong ones;
- ``contours``, closed and open ones, - where none is found;
- ``errors`` and ``others``: codes found in reading and chaining;
- ``compile``, of parts: "offset" compiles with an offset of 0.05 mm on the kept side, else the
  codes that refuse it, and ";on" where it compiles on the line;
- ``comment``: why not as drawn, or not as the collectors counted.
"""

import csv
from collections import Counter
from pathlib import Path

import pytest

from wedmcam import api
from wedmcam.diag import Severity
from wedmcam.frontends.dxf import read
from wedmcam.frontends.options import DrawingReading
from wedmcam.operations import convert
from wedmcam.transforms.chain import chain

with (Path(__file__).parent / "expected.tsv").open(encoding="utf-8") as table:
    ROWS = list(csv.DictReader(table, delimiter="\t"))
PARTS = [r for r in ROWS if r["compile"] != "-"]


@pytest.fixture(scope="module")
def folder(corpus):
    """Folder with the drawings themselves."""
    inner = Path(corpus) / "dev"
    return inner if inner.is_dir() else Path(corpus)


def named(row):
    return row["file"].removesuffix(".dxf")


def of(found, *, errors):
    got = {d.code for d in found if (d.severity is Severity.ERROR) == errors}
    return ",".join(sorted(got)) or "-"


@pytest.mark.parametrize("row", ROWS, ids=named)
def test_drawing(row, folder):
    data = (folder / row["file"]).read_bytes()
    options = DrawingReading(units=row["units"] or None)
    if row["units"]:
        _, found = read(data, row["file"])
        assert {"no-units", "unlikely-units"} & {d.code for d in found}
    sketch, found = read(data, row["file"], options)
    contours = "-"
    if sketch is not None and len(sketch.segments):
        made, _, more = chain(sketch)
        found = (*found, *more)
        n = Counter(c.closed for c in made)
        contours = f"{n[True]}/{n[False]}"
        assert sketch.info.extra.get("spline_um", 0.0) <= 1.0
    assert (contours, of(found, errors=True)) == (row["contours"], row["errors"])
    assert of(found, errors=False) == row["others"]
    for d in found:
        if d.severity is Severity.ERROR:
            assert d.span is not None or d.points_mm or "further" in d.message, d


@pytest.mark.parametrize("row", PARTS, ids=named)
def test_part(row, folder):
    data = (folder / row["file"]).read_bytes()
    units = {"units": row["units"]} if row["units"] else {}
    made = api.compile(data, name=row["file"], offset=0.05, **units)
    refused, _, then = row["compile"].partition(";")
    if refused == "offset":
        assert made.ok, [d.message for d in made.findings]
        assert made.verdict.max_deviation_um <= 2.0
        assert made.verdict.gouge_um <= 2.0
        assert f"{made.summary['contours']}/0" == row["contours"]
    else:
        assert not made.ok
        assert of(made.findings, errors=True) == refused
    if then == "on":
        made = api.compile(data, name=row["file"], side="on", **units)
        assert made.ok, [d.message for d in made.findings]


@pytest.mark.parametrize("row", [r for r in PARTS if r["compile"] == "offset"], ids=named)
def test_a_program_of_a_part_becomes_a_part_program(row, folder):
    data = (folder / row["file"]).read_bytes()
    made = api.compile(data, name=row["file"], units=row["units"] or None, offset=0.05)
    assert made.ok
    came_back = convert.convert(made.data, to="wed", name="part.3b")
    assert came_back.ok, [d.message for d in came_back.findings]


def test_every_drawing_is_in_the_table(folder):
    assert sorted(p.name for p in folder.glob("*.dxf")) == sorted(r["file"] for r in ROWS)


def test_counts_are_the_collectors_or_argued(folder):
    with (folder / "MANIFEST.tsv").open(encoding="utf-8") as table:
        theirs = {r["file"]: r for r in csv.DictReader(table, delimiter="\t")}
    for row in ROWS:
        manifest = theirs[row["file"]]
        same = row["contours"].replace("-", "0/0") == f"{manifest['closed']}/{manifest['open']}"
        assert same or row["comment"], row["file"]
        assert row["class"] == manifest["class"]
        assert row["compile"] in ("-", "offset") or row["comment"], row["file"]


def test_the_table_is_whole():
    """Runs without the drawings: 145 rows, each once, and every part has an outcome."""
    assert len({r["file"] for r in ROWS}) == len(ROWS) == 145
    assert {named(r) for r in ROWS if r["class"] == "part"} == {named(r) for r in PARTS}
    compiled = Counter(r["compile"].split(";")[0] == "offset" for r in PARTS)
    assert compiled[True] >= 48
