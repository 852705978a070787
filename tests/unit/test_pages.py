"""The reference pages are up to date, and every code has an example that was run."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import pages

from wedmcam import machines
from wedmcam.cli.commands.explain import examples, explain_code
from wedmcam.diag import CODES
from wedmcam.machines.write import as_toml, entries

SRC = Path(machines.__file__).parents[1]


@pytest.fixture(scope="module")
def made():
    return pages.pages()


def test_every_code_has_an_example_or_says_why_not(made):
    _, wrong = made
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    "name", ["examples.json", "codes.md", "profiles.md", "probe.md", "modules.md"]
)
def test_pages_are_up_to_date(made, name):
    path, text = next((p, t) for p, t in made[0].items() if p.name == name)
    assert path.read_text("utf-8") == text, f"{name} is old: run `make docs`"


def test_every_code_is_used():
    text = "".join(p.read_text("utf-8") for p in SRC.rglob("*.py") if p.name != "codes.py")
    # Four are made of a word: f"{name}-too-long".
    unused = [
        c for c in CODES if f'"{c}"' not in text and not c.endswith(("-too-long", "-too-short"))
    ]
    assert not unused
    assert 'f"{name}-too-long"' in text
    assert 'f"{name}-too-short"' in text


def test_every_code_explains_itself():
    for code in CODES:
        text = explain_code(code)
        assert text.startswith(f"{code}\n  what ")
        if "run" in examples()[code]:
            assert f"[{code}]: " in text


@pytest.mark.parametrize("name", machines.names())
def test_a_printed_profile_is_the_same_profile(name):
    machine = machines.builtin(name)
    again, found = machines.parse(as_toml(machine), name)
    assert found == []
    assert again == machine


def test_every_key_of_a_profile_says_what_it_means():
    assert not [e.key for e in entries() if not e.means]
    assert {e.section for e in entries()} >= {"", "limits", "words", "layout"}
