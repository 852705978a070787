"""Which drawings files, folders and patterns name, and where the program of each goes."""

from __future__ import annotations

import glob
import itertools
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from wedmcam.diag.run import WrongUse
from wedmcam.formats.names import SUFFIX_OF_FORMAT
from wedmcam.machines import Machine
from wedmcam.options import Options

#: Endings of files that a folder is searched for.
SOURCES = (".dxf", ".wed")


class WrongInputs(WrongUse):
    """Inputs that name no drawing, or several that would have one output."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """How a drawing is compiled.

    Attributes:
        machine: the profile; None where ``wrong``.
        options: everything else.
        named: the profile was named, and is not just the default of the format.
        wrong: why nothing can be compiled so (exit status 2).
    """

    machine: Machine | None = None
    options: Options | None = None
    named: bool = True
    wrong: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """One drawing, where its program goes, and how it is made; or why it cannot be read."""

    source: str
    output: str
    recipe: Recipe
    unreadable: str = ""


def find_items(
    inputs: Sequence[str], folder: str, recipe_of: Callable[[str], Recipe]
) -> list[Item]:
    """Return the drawings that files, folders and patterns name, sorted, with their outputs.

    A folder is searched below itself and mirrored; a file or what a pattern matches lies directly
    in the output folder, below the part of the pattern that has no wildcard.

    Args:
        inputs: names of files and folders, and patterns.
        folder: of the programs.
        recipe_of: says how the drawing of a name is compiled.

    Raises:
        WrongInputs: nothing matched, two drawings would have one output, or one would overwrite an
            input.
    """
    places: dict[str, Path] = {}
    unreadable: dict[str, str] = {}
    for name in inputs:
        base, files = _matches(name)
        if not files:
            raise WrongInputs(f"{name}: no drawing ({', '.join(SOURCES)}) is there")
        for file, why in files.items():
            places.setdefault(str(file), file.relative_to(base))
            if why:
                unreadable[str(file)] = why
    items = []
    taken: dict[str, str] = {}
    sources = {os.path.realpath(source) for source in places}
    for source in sorted(places):
        recipe = recipe_of(source)
        ending = SUFFIX_OF_FORMAT[recipe.machine.format] if recipe.machine else ".3b"
        output = str(Path(folder) / places[source].with_suffix(ending))
        if output in taken:
            raise WrongInputs(
                f"{source} and {taken[output]} would both become {output}: give their folder"
            )
        taken[output] = source
        if os.path.realpath(output) in sources:
            raise WrongInputs(f"the output {output} would overwrite an input")
        items.append(Item(source, output, recipe, unreadable.get(source, "")))
    return items


def _matches(name: str) -> tuple[Path, dict[Path, str]]:
    """Return what is mirrored of a file, folder or pattern, and its drawings.

    Each drawing is with why it cannot be read, empty if it can.
    """
    place = Path(name)
    if place.is_dir():
        return place, _search(place)
    if place.exists():
        return place.parent, {place: ""}
    plain = itertools.takewhile(lambda part: not glob.has_magic(part), place.parts[:-1])
    files = (Path(p) for p in glob.glob(name, recursive=True))
    return Path(*plain), {file: "" for file in files if file.is_file()}


def _search(base: Path) -> dict[Path, str]:
    """Return the drawings below a folder, each with why it cannot be read, empty if it can.

    What is hidden is passed over. A link that leads nowhere or a pipe with the name of a drawing is
    one that cannot be read; so is a folder that may not be listed.
    """
    problems: dict[Path, str] = {}

    def closed(why: OSError) -> None:
        problems[Path(why.filename)] = f"cannot be searched: {why.strerror}"

    for folder, folders, names in os.walk(base, onerror=closed):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for name in names:
            file = Path(folder, name)
            if name.startswith(".") or file.suffix.lower() not in SOURCES:
                continue
            if file.is_file():
                problems[file] = ""
            elif file.exists():
                problems[file] = "cannot be read: no regular file"
            else:
                problems[file] = "cannot be read: a link that leads nowhere"
    return problems
