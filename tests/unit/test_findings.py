"""A finding is a template and values: nothing in the sources forms its text beforehand."""

from __future__ import annotations

import ast
import json
import re
from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner

from finding_texts import Maker, Makers, Module, Texts, imported, literals_in, makers_in, shared
from wedmcam.cli.main import cli
from wedmcam.diag import ByteSpan, Severity, error, note
from wedmcam.formats.listing import ERRORS, in_order, listed

ROOT = Path(__file__).parents[2]
SRC = ROOT / "src" / "wedmcam"


#: Rooms whose findings are looked at.
ROOMS = sorted(p.stem for p in SRC.iterdir() if p.suffix == ".py" or (p / "__init__.py").exists())

#: Modules that are not looked at, and why.
EXEMPT = {"diag/finding.py": "it hands the templates of its callers on, and forms them"}

#: Values that no text shows: a program that reads findings wants them. (code of the finding, name)
UNSHOWN: set[tuple[str, str]] = set()

#: Makers that add values themselves: name of a maker -> its values, and why it has them.
GIVEN: dict[str, dict[str, str]] = {
    "backends/checks.py:Checks.tell": {"block": "each is about a block, by its number"},
    "frontends/b3/reader.py:_TextTeller.tell": {"text": "each is about a text, and quotes it"},
    "frontends/iso/dialect.py:Question": {"text": "a question quotes where it first matters"},
    "frontends/iso/dialect.py:_of_words": {"text": "as of Question"},
    "frontends/iso/reading.py:Reading.tell_words": {"words": "it is about words, and lists them"},
    "frontends/iso/known.py:tell_unknown": {
        "words": "as of tell_words",
        "profiles": "it looks up who knows the words",
    },
    "frontends/iso/subprograms.py:_check_lines.refuse": {
        "word": "each is about a word in a line",
        "code": "of the call or the return in that line",
    },
    "frontends/iso/subprograms.py:_check_bodies.refuse": {"label": "each is about a subprogram"},
    "frontends/iso/table.py:_refusal": {"text": "each is about an entry, and quotes it"},
    "frontends/zd065/memory.py:Stream.tell": {"block": "each is about a block, by its number"},
}


@cache
def _sources() -> dict[Path, ast.Module]:
    return {path: ast.parse(path.read_text()) for path in sorted(SRC.rglob("*.py"))}


def _path(path: Path) -> str:
    return path.relative_to(SRC).as_posix()


@cache
def _makers() -> dict[str, Makers]:
    return {_path(p): makers_in(_path(p), tree, GIVEN) for p, tree in _sources().items()}


@cache
def _constants() -> dict[str, Texts]:
    """Return the literals that modules name, those from other modules included."""
    constants: dict[str, Texts] = {}
    for path, tree in _sources().items():
        name = ".".join(("wedmcam", *path.relative_to(SRC).with_suffix("").parts))
        constants[name.removesuffix(".__init__")] = literals_in(tree, {})
    return {
        name: {**imported(tree, constants), **texts}
        for (name, texts), tree in zip(constants.items(), _sources().values(), strict=True)
    }


def faults_of(path: str, tree: ast.Module, others: Makers) -> list[str]:
    """Return what is wrong with the findings that a module makes."""
    return Module(path, tree, others, _constants(), UNSHOWN, GIVEN).faults


@pytest.mark.parametrize("room", ROOMS)
def test_texts_are_literals_and_each_field_has_its_value(room: str) -> None:
    others = shared(_makers().values())
    mine = [p for p in _sources() if p.relative_to(SRC).with_suffix("").parts[0] == room]
    assert mine, f"no such room: {room}"
    faults = [
        fault
        for path in mine
        if _path(path) not in EXEMPT
        for fault in faults_of(_path(path), _sources()[path], others)
    ]
    assert not faults, "\n".join(faults)


def test_the_sources_have_many_findings() -> None:
    """A search that sees no call finds no fault."""
    others = shared(_makers().values())
    modules = [Module(_path(p), tree, others, _constants()) for p, tree in _sources().items()]
    assert sum(module.calls for module in modules) > 600


@pytest.mark.parametrize("name", GIVEN)
def test_each_maker_adds_the_values_of_the_table(name: str) -> None:
    path, _, qualified = name.partition(":")
    assert any(maker.name == name for makers in _makers()[path].values() for maker in makers)
    source = (SRC / path).read_text()
    for value, why in GIVEN[name].items():
        other = re.match(r"as of (\w+)", why)
        added = rf"\b{other[1]}\(" if other else rf'"{value}": |\b{value}='
        assert re.search(added, source), f"{qualified} adds no {value}"


#: Makers of the modules below.
MADE_UP: Makers = {
    "tell": [Maker("tell", ("code", "template", "values", "hint"))],
    "quote": [Maker("quote", ("code", "template"), given=frozenset({"word"}))],
}


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ('error("gap", f"{a} mm")', "the template of error() is no literal"),
        ('error("gap", "{} mm".format(a))', "the template of error() is no literal"),
        ('error("gap", "%s mm" % a)', "the template of error() is no literal"),
        ('error("gap", "x" + a)', "the template of error() is no literal"),
        ('warning("gap", "x", hint=f"{a}")', "the hint of warning() is no literal"),
        ('Diagnostic(s, "gap", "x", None, hint_template=a)', "the hint_template of Diagnostic()"),
        ('d.extended(f"; {a}")', "the more of extended() is no literal"),
        ('note("gap", "{gap_mm:.3f} mm")', "fields without a value: ['gap_mm']"),
        ('note("gap", "a gap", gap_mm=1)', "values in no text: ['gap_mm']"),
        ('tell("gap", "{a}", lambda i: {"b": i})', "fields without a value: ['a']"),
        ('tell("gap", f"{a}")', "the template of tell() is no literal"),
        (
            'def f(a):\n    text = "a"\n    text += a\n    error("gap", text)',
            "of error() is no literal",
        ),
        ('replace(d, template="x")', "replace() of a template"),
        ('d.with_hint(f"{a}")', "the hint of with_hint() is no literal"),
        ('TABLE = {"a": (error, f"{a}", None)}', "a template of a table is no literal"),
        (
            'def f(a):\n    make = error if a else note\n    make("gap", f"{a}")',
            "is no literal",
        ),
        (
            'def f():\n    d = error("gap", "a")\n    return d.extended(" {gap_mm}")',
            "fields without a value: ['gap_mm']",
        ),
        (
            'def f():\n    d = error("gap", "a", b=1)\n    return d.extended(" {c}", c=1)',
            "values in no text: ['b']",
        ),
        ('error("gap", d.template)', "the template of error() is no literal"),
        ('quote("gap", "{word} {line}")', "fields without a value: ['line']"),
    ],
)
def test_each_fault_is_seen(source: str, fault: str) -> None:
    assert fault in "\n".join(faults_of("x.py", ast.parse(source), MADE_UP))


@pytest.mark.parametrize(
    "source",
    [
        'error("gap", "{gap_mm:.3f} mm in {count} places", span, gap_mm=1, count=2)',
        'error("gap", "is open" if a else "is {what}", hint="cut {what}", what=1)',
        'TEXT = "a {b}"\nnote("gap", TEXT, b=1)',
        'tell("gap", "{a}", lambda i: {"a": i}, "not {a}")',
        'def f(a):\n    text = "a"\n    if a:\n        text = "b"\n    error("gap", text)',
        'def tell(code, template, values=None, hint=None):\n    error(code, "b: " + template)',
        'from wedmcam.operations.read import NO_GAP\nerror("no-gap", NO_GAP)',
        'def f():\n    d = error("gap", "a", b=1)\n    d = d.extended(" {b}")\n    return d',
        'error("gap", "a {b}", b=1).with_hint("{b} {c}", c=2)',
        'error("gap", "{times} times", times=2)',
        'error("gap", d.template, **d.values)',
        'quote("gap", "{word}")',
        'def _gap(template):\n    pass\n_gap("a")',
    ],
)
def test_what_is_right_passes(source: str) -> None:
    assert faults_of("x.py", ast.parse(source), MADE_UP) == []


@pytest.mark.parametrize(("severity", "one_by_one"), [(Severity.ERROR, ERRORS), (Severity.NOTE, 1)])
def test_a_list_ends_with_a_count_of_the_rest(severity: Severity, one_by_one: int) -> None:
    places = list(range(0, 100, 2))
    found = list(
        listed(
            severity,
            "zero-count",
            places,
            lambda i: ByteSpan("a", i, i + 1),
            "byte {byte} of {count}",
            lambda i: {"byte": i},
            "leave byte {byte} out",
        )
    )
    assert [i for i, _ in found] == places[:one_by_one]
    last = found[-1][1]
    assert last.count == len(places) - one_by_one + 1
    assert last.message == f"byte {places[one_by_one - 1]} of {last.count}"
    assert last.hint == f"leave byte {places[one_by_one - 1]} out"
    assert in_order(found[::-1]) == [d for _, d in found]


def test_a_finding_with_values_that_do_not_fit_is_refused_where_it_is_made() -> None:
    for template, values in (("{gap_mm}", {}), ("{gap_mm:.3f}", {"gap_mm": "wide"}), ("{", {})):
        with pytest.raises(AssertionError, match="differ"):
            error("zero-count", template, **values)
        with pytest.raises(AssertionError, match="differ"):
            note("zero-count", "J is 0", hint=template, **values)


def test_the_page_shows_a_finding_as_it_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (ROOT / "docs" / "findings.md").read_text()
    command = page.partition("$ wedmcam ")[2].partition("\n")[0]
    shown = json.loads(page.partition("```json\n")[2].partition("```")[0])
    monkeypatch.chdir(ROOT)
    run = CliRunner().invoke(cli, command.replace("plate.3b", str(tmp_path / "plate.3b")).split())
    assert shown in json.loads(run.stdout)["diagnostics"]
    assert set(shown) == {key.strip("` ") for key in re.findall(r"(?m)^\| (`\w+`) ", page)}


def test_a_list_without_values_has_none() -> None:
    [(_, only)] = listed(Severity.ERROR, "zero-count", [3], lambda i: None, "J is 0")
    assert (only.message, only.values, only.hint) == ("J is 0", {}, None)


def test_values_that_do_not_fit_are_refused_here_and_shown_to_a_user(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(AssertionError, match="differ"):
        error("gap-value", "{gap_mm:.3f} mm", gap_mm=None)
    monkeypatch.setattr("wedmcam.diag.finding.CHECKS", False)
    shown = error("gap-value", "{gap_mm:.3f} mm", hint="{way}", gap_mm=None)
    assert shown.message == "{gap_mm:.3f} mm {'gap_mm': None}"
    assert shown.hint == "{way} {'gap_mm': None}"
