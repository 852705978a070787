"""Controllers and dialects as data: one TOML profile each, and the loader.

A profile says what a format leaves open: limits, layout, control words, which table a line is
stepped by. The built-in profiles lie beside this module.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import PurePath

from wedmcam.diag import Diagnostic, TextSpan, error, note
from wedmcam.machines.machine import Axes, Iso, Layout, Limits, Machine, Words
from wedmcam.machines.read import parse
from wedmcam.machines.vocabulary import Known, Vocabulary

#: The profile that a format is written with when none is named.
DEFAULTS: dict[str, str] = {
    "3b": "b3-compact",
    "compact": "zd065",
    "rotation": "zd065-rotation",
    "compensation": "zd065-compensation",
    "iso": "iso-mm",
    "4b": "b4-compact",
    "dem15": "dem15",
    "nby15": "nby15",
}
#: The profile it is read with, where that is another: an ISO program that is only shown is assumed
#: to be in G91 and whole um where it says neither.
READ_AS: dict[str, str] = {"iso": "iso-um"}
#: What a default was one release ago: whoever names none is told.
BEFORE: dict[str, str] = {"iso": "iso-um"}


@cache
def names() -> tuple[str, ...]:
    """Return the names of the built-in profiles, sorted.

    >>> "b3-compact" in names() and "zd065" in names()
    True
    """
    here = files("wedmcam.machines")
    return tuple(sorted(f.name[:-5] for f in here.iterdir() if f.name.endswith(".toml")))


def text(name: str) -> str:
    """Return the TOML of a built-in profile.

    Raises:
        KeyError: no profile has this name.
    """
    if name not in names():
        raise KeyError(name)
    return files("wedmcam.machines").joinpath(f"{name}.toml").read_text("utf-8")


@cache
def builtin(name: str) -> Machine:
    """Return a built-in profile.

    Raises:
        KeyError: no profile has this name; `find` reports that as a finding.

    >>> builtin("zd065").limits.memory_bytes
    4096
    """
    machine, findings = parse(text(name), name)
    assert machine is not None, findings  # a profile that we ship
    return machine


def iso_profiles(where: Callable[[Machine], bool]) -> tuple[str, ...]:
    """Return the names of the built-in profiles of ISO for which ``where`` holds, sorted.

    >>> iso_profiles(lambda machine: machine.iso.offset_change == "skewed")
    ('fanuc',)
    """
    return tuple(n for n in names() if (m := builtin(n)).is_of("iso") and where(m))


@cache
def knowing(letter: str, tenths: int) -> tuple[str, ...]:
    """Return the built-in ISO profiles that know a word, by their tables or as the F they write.

    Args:
        letter, tenths: of the word: ("M", 600) for M60, ("G", 911) for G91.1.

    >>> knowing("M", 99_9990), knowing("F", 10)
    ((), ('grbl', 'linuxcnc', 'mitsubishi', 'sodick'))
    """
    return iso_profiles(
        lambda m: (
            m.iso.words.class_of(letter, tenths) is not Known.NOT
            or (letter == "F" and m.iso.feed_um > 0)
        )
    )


def of_file(text: str, file: str) -> tuple[Machine | None, list[Diagnostic]]:
    """Return the profile that a file holds; it is named after the file, findings point into it.

    >>> of_file("", "shop.toml")[1][0].span
    FileSpan(file='shop.toml')
    """
    machine, findings = parse(text, file)
    findings.sort(key=lambda d: d.span.line if isinstance(d.span, TextSpan) else 0)
    return (replace(machine, name=PurePath(file).stem) if machine else None), findings


def default(format_: str) -> Machine:
    """Return the profile that a format is written with when none is named.

    Raises:
        KeyError: the format has none.
    """
    return builtin(DEFAULTS[format_])


def reading(format_: str) -> Machine:
    """Return the profile that a format is read with when none is named.

    Raises:
        KeyError: the format has none.

    >>> default("iso").name, reading("iso").name, reading("3b").name
    ('iso-mm', 'iso-um', 'b3-compact')
    """
    return builtin(READ_AS.get(format_) or DEFAULTS[format_])


def unnamed(machine: Machine) -> list[Diagnostic]:
    """Return a note where the default that a program is written with has changed."""
    before = BEFORE.get(machine.format)
    if before is None:
        return []
    return [
        note(
            "default-profile",
            "profile {profile} (before: {before})",
            hint="--profile {before} writes what was written before",
            profile=machine.name,
            before=before,
        )
    ]


def is_builtin(machine: Machine) -> bool:
    """Return whether a machine is a built-in profile, unchanged."""
    return machine.name in names() and machine == builtin(machine.name)


def find(name: str) -> tuple[Machine | None, list[Diagnostic]]:
    """Return the built-in profile ``name``, or a finding that names the nearest."""
    if name in names():
        return builtin(name), []
    near = difflib.get_close_matches(name, names(), 1, 0.5)
    return None, [
        error(
            "profile-name",
            "no profile is called '{name}'",
            hint="did you mean '{near}'?" if near else "built in are {profiles}",
            name=name,
            near=near[0] if near else None,
            profiles=", ".join(names()),
        )
    ]


__all__ = [
    "BEFORE",
    "DEFAULTS",
    "READ_AS",
    "Axes",
    "Iso",
    "Known",
    "Layout",
    "Limits",
    "Machine",
    "Vocabulary",
    "Words",
    "builtin",
    "default",
    "find",
    "is_builtin",
    "iso_profiles",
    "knowing",
    "names",
    "of_file",
    "parse",
    "reading",
    "text",
    "unnamed",
]
