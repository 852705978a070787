"""The room of batches, without a command line: items, one as a task, processes."""

import os
import pickle
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

import parts
import wedmcam
from wedmcam.batch.items import Item, Recipe, WrongInputs, find_items
from wedmcam.batch.pool import compile_items
from wedmcam.batch.work import Outcome, compile_item
from wedmcam.machines import default
from wedmcam.options import Options

RECIPE = Recipe(default("3b"), Options.of(offset_um=100.0))


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "in" / "deeper").mkdir(parents=True)
    for k, name in enumerate(("a.dxf", "b.dxf", "deeper/c.dxf", "deeper/d.DXF")):
        drawing = parts.dxf_bytes((parts.rectangle(5_000 + 1_000 * k, 4_000),))
        (tmp_path / "in" / name).write_bytes(drawing)
    return tmp_path


def items_of(folder, out="out"):
    return find_items([str(folder / "in")], str(folder / out), lambda _: RECIPE)


def tree(place):
    return {str(p.relative_to(place)): p.read_bytes() for p in place.rglob("*") if p.is_file()}


def test_items_mirror_a_folder(folder):
    items = items_of(folder)
    assert [Path(i.output).relative_to(folder / "out").as_posix() for i in items] == [
        "a.3b",
        "b.3b",
        "deeper/c.3b",
        "deeper/d.3b",
    ]
    assert all(i.recipe is RECIPE for i in items)


@pytest.mark.parametrize(
    ("inputs", "text"),
    [(["none*.dxf"], "no drawing"), (["in/a.dxf", "in/deeper/../a.dxf"], "would both become")],
)
def test_wrong_inputs_are_wrong_use(folder, monkeypatch, inputs, text):
    monkeypatch.chdir(folder)
    with pytest.raises(WrongInputs, match=text):
        find_items(inputs, "out", lambda _: RECIPE)


def test_what_cannot_be_read_is_an_item(folder):
    (folder / "in" / "lost.dxf").symlink_to(folder / "nowhere")
    outcome = next(compile_item(i) for i in items_of(folder) if "lost" in i.source)
    assert outcome.status == 1
    assert "leads nowhere" in outcome.failure
    assert outcome.record["error"] == outcome.failure


def test_an_outcome_is_data(folder):
    (folder / "in" / "bad.dxf").write_bytes(b"no drawing")
    by_name = {Path(i.source).name: compile_item(i) for i in items_of(folder)}
    bad, good = by_name["bad.dxf"], by_name["a.dxf"]
    assert bad.status == 1
    assert [d.code for d in bad.findings] == ["not-dxf"]
    assert bad.figures is None
    assert not Path(bad.item.output).exists()
    assert good.status == 0
    assert good.figures.blocks == good.record["blocks"]
    for outcome in (bad, good):
        assert pickle.loads(pickle.dumps(outcome)) == outcome
        assert "\x1b" not in repr(outcome)


def test_outcomes_and_bytes_do_not_depend_on_the_number_of_processes(folder):
    (folder / "in" / "bad.dxf").write_bytes(b"no drawing")
    outcomes = []
    for jobs in (1, 2):
        outcomes.append(list(compile_items(items_of(folder), jobs)))
        (folder / "out").rename(folder / f"out{jobs}")
    assert outcomes[0] == outcomes[1]
    assert [o.status for o in outcomes[0]] == [0, 0, 1, 0, 0]
    assert tree(folder / "out1") == tree(folder / "out2")
    assert len(tree(folder / "out1")) == 4


def killed_at(source: str, marks: str, once: bool, item: Item) -> Outcome:
    """Compile an item; but the process of one is killed, every time or the first time."""
    mark = Path(marks) / str(os.getpid())
    if item.source.endswith(source) and not (once and any(Path(marks).iterdir())):
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return compile_item(item)


@pytest.mark.parametrize("once", [True, False])
def test_a_process_that_dies_takes_no_other_item_with_it(folder, once):
    (folder / "marks").mkdir()
    work = partial(killed_at, "b.dxf", str(folder / "marks"), once)
    outcomes = list(compile_items(items_of(folder), 2, work))
    assert [Path(o.item.source).name for o in outcomes] == ["a.dxf", "b.dxf", "c.dxf", "d.DXF"]
    assert [o.status for o in outcomes] == [0, 0 if once else 70, 0, 0]
    if not once:
        assert "the process ended" in outcomes[1].failure
        assert outcomes[1].record["error"] == outcomes[1].failure
    assert len(list((folder / "marks").iterdir())) == (1 if once else 2)
    assert len(tree(folder / "out")) == (4 if once else 3)


def test_who_stops_early_waits_for_nothing(folder):
    outcomes = compile_items(items_of(folder), 2)
    assert next(outcomes).status == 0
    outcomes.close()
    assert not [n for n in tree(folder / "out") if Path(n).name.startswith(".")]


def test_the_library_compiles_many(folder):
    outcomes = list(wedmcam.compile_all(folder / "in", folder / "out", offset=0.1, jobs=1))
    assert [o.status for o in outcomes] == [0] * 4
    one = wedmcam.compile(folder / "in" / "a.dxf", offset=0.1)
    assert (folder / "out" / "a.3b").read_bytes() == one.data
    with pytest.raises(wedmcam.WrongUse, match="no drawing"):
        wedmcam.compile_all(folder / "none", folder / "out", offset=0.1)


def test_it_needs_no_command_line():
    code = "import sys, wedmcam.batch.compile; sys.exit('click' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
