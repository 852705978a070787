"""Write the reference pages that are made from the program: ``make docs``.

``docs/codes.md``: every diagnostic with an example that was run, from ``tests/bad``; the same
examples go into the package for ``wedmcam explain``. ``docs/profiles.md``: every key of a profile.
``docs/probe.md``: what the readings of `profile probe` mean. ``docs/modules.md``: what each module
is for, from the first sentence of its docstring. ``docs/zd065.md`` and its pictures: what
``step_tables`` and ``step_figures`` make of them. ``docs/machines.md``: ``machine_tables``.
``tests/unit/test_pages.py`` demands that they are up to date.
"""

from __future__ import annotations

import ast
import contextlib
import io
import itertools
import json
import os
import re
import shlex
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import Any

ROOT = Path(__file__).parents[1]
BAD = ROOT / "tests" / "bad"
EXAMPLES = ROOT / "src" / "wedmcam" / "diag" / "examples.json"
EXPECTED = re.compile(r"(?:note|warning|error)\[([a-z0-9-]+)\]")

# --- drawings -------------------------------------------------------------------------------------


def drawing(lines: list[str], units: int = 4) -> str:
    """Return a DXF of one entity a line: ``line x y x y [layer] [z]``, ``rect``, ``circle x y r``,
    ``poly x,y ...`` (closed), ``bow x y x y r`` (an arc, counter-clockwise), ``ring x y r`` (a
    circle as a spline), ``solid x y x y`` (a filled rectangle), ``spline``, ``closed-spline`` and
    ``fit`` with points, ``other TYPE``."""
    tags: list[tuple[int, object]] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER")]
    tags += [(1, "AC1015"), (9, "$INSUNITS"), (70, units), (0, "ENDSEC")]
    tags += [(0, "SECTION"), (2, "ENTITIES")]
    handle = 0x20
    for line in lines:
        for kind, subclass, layer, more in _entities(line.split()):
            handle += 1
            tags += [(0, kind), (5, f"{handle:X}"), (100, "AcDbEntity"), (8, layer)]
            tags += [(100, subclass), *more]
    tags += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code:3d}\n{value}\n" for code, value in tags)


Entity = tuple[str, str, str, list[tuple[int, object]]]


def _entities(words: list[str]) -> Iterator[Entity]:
    import math

    kind, given = words[0], words[1:]
    if kind in ("poly", "spline", "closed-spline", "fit"):
        points = [tuple(map(float, p.split(","))) for p in given]
        if kind == "poly":
            more: list[tuple[int, object]] = [(90, len(points)), (70, 1)]
            more += [t for x, y in points for t in ((10, x), (20, y))]
            yield "LWPOLYLINE", "AcDbPolyline", "CUT", more
        else:
            yield "SPLINE", "AcDbSpline", "CUT", _spline(kind, points)
        return
    if kind == "other":
        yield given[0], "AcDbModelerGeometry", "CUT", []
        return
    if kind == "ring":
        x, y, r = map(float, given)
        w = math.sqrt(0.5)
        unit = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
        knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
        more = [(70, 12), (71, 2), (72, 12), (73, 9), (74, 0), *((40, float(k)) for k in knots)]
        more += [(41, w if k % 2 else 1.0) for k in range(9)]
        more += [t for a, b in unit for t in ((10, x + r * a), (20, y + r * b), (30, 0.0))]
        yield "SPLINE", "AcDbSpline", "CUT", more
        return
    numbers = [float(g) for g in given if re.fullmatch(r"-?[\d.]+", g)]
    layer = next((g for g in given if not re.fullmatch(r"-?[\d.]+", g)), "CUT")
    if kind == "circle":
        x, y, r = numbers
        yield "CIRCLE", "AcDbCircle", layer, [(10, x), (20, y), (30, 0.0), (40, r)]
    elif kind == "bow":
        x0, y0, x1, y1, r = numbers
        half = math.dist((x0, y0), (x1, y1)) / 2
        up = math.sqrt(r * r - half * half) / (2 * half)
        cx, cy = (x0 + x1) / 2 - up * (y1 - y0), (y0 + y1) / 2 + up * (x1 - x0)
        a, b = (math.degrees(math.atan2(y - cy, x - cx)) % 360 for x, y in ((x0, y0), (x1, y1)))
        more = [(10, cx), (20, cy), (30, 0.0), (40, r), (100, "AcDbArc"), (50, a), (51, b)]
        yield "ARC", "AcDbCircle", layer, more
    elif kind == "solid":
        x0, y0, x1, y1 = numbers
        corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)]
        more = [t for k, (x, y) in enumerate(corners) for t in ((10 + k, x), (20 + k, y))]
        yield "SOLID", "AcDbTrace", layer, more
    else:
        x0, y0, x1, y1, *z = numbers
        corners = [(x0, y0), (x1, y1)]
        if kind == "rect":
            corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        height = z[0] if z else 0.0
        for (ax, ay), (bx, by) in itertools.pairwise(corners):
            start = [(10, ax), (20, ay), (30, height)]
            yield "LINE", "AcDbLine", layer, [*start, (11, bx), (21, by), (31, height)]


def _spline(kind: str, points: list[tuple[float, ...]]) -> list[tuple[int, object]]:
    at = 11 if kind == "fit" else 10
    placed = [t for x, y in points for t in ((at, x), (at + 10, y), (at + 20, 0.0))]
    if kind == "fit":
        return [(70, 8), (71, 3), (72, 0), (73, 0), (74, len(points)), *placed]
    knots = [0.0] * 4 + [float(k) for k in range(1, len(points) - 3)]
    knots += [float(len(points) - 3)] * 4
    flags = 9 if kind == "closed-spline" else 8
    head: list[tuple[int, object]] = [(70, flags), (71, 3), (72, len(knots)), (73, len(points))]
    return [*head, (74, 0), *((40, k) for k in knots), *placed]


# --- running examples -----------------------------------------------------------------------------


def cases() -> dict[str, dict[str, Any]]:
    """Return code -> how to see it: from cases.toml, and from the files of tests/bad."""
    made: dict[str, dict[str, Any]] = tomllib.loads((BAD / "cases.toml").read_text("utf-8"))
    for path in sorted(BAD.iterdir()):
        if path.name == "cases.toml":
            continue
        lines = path.read_text("utf-8", "replace").split("\n")
        drawn = path.suffix == ".dxf"
        for line in lines[1:2] if drawn else lines[:3]:
            for code in EXPECTED.findall(line):
                name = path.name.removesuffix(".txt")
                made.setdefault(code, {"run": f"{'inspect' if drawn else 'dump'} {name}"})
    return made


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    """Yield a folder with the samples, the bad files and the shared ones; it is the current one."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as name:
        here = Path(name)
        for path in [*(ROOT / "samples").glob("*.dxf"), *BAD.glob("*.*")]:
            if path.suffixes[-2:] == [".zd", ".txt"]:
                data = bytes.fromhex(re.sub("#.*", "", path.read_text("ascii")))
                (here / path.name.removesuffix(".txt")).write_bytes(data)
            else:
                shutil.copy(path, here)
        os.chdir(here)
        os.environ["XDG_CONFIG_HOME"] = str(here / "nobody")
        try:
            _prepare(here, cases()["shared"])
            yield here
        finally:
            os.chdir(before)


def _prepare(here: Path, case: dict[str, Any]) -> list[Path]:
    """Make the files of a case; return them."""
    made = []
    for kind in ("draw", "write", "hex", "edit"):
        for name, what in case.get(kind, {}).items():
            made.append(here / name)
            made[-1].parent.mkdir(exist_ok=True)
            if kind == "draw":
                made[-1].write_text(drawing(what), "ascii")
            elif kind == "write":
                made[-1].write_text(what, "utf-8")
            elif kind == "hex":
                made[-1].write_bytes(bytes.fromhex(what))
            else:
                text = (here / what[0]).read_text("ascii")
                assert text.count(what[1]) == 1, (name, text)
                made[-1].write_text(text.replace(what[1], what[2]), "ascii")
    for line in case.get("first", []):
        status, text = run(line)
        assert status == 0, text
    return made


def run(line: str) -> tuple[int, str]:
    """Run a command of wedmcam in this process; return its exit status and what it told people."""
    from wedmcam.__main__ import report_stop
    from wedmcam.cli.main import cli

    heard, data = io.StringIO(), io.TextIOWrapper(io.BytesIO(), "utf-8")
    with contextlib.redirect_stderr(heard), contextlib.redirect_stdout(data):
        try:
            status = cli.main(shlex.split(line), prog_name="wedmcam", standalone_mode=False)
        except Exception as why:
            status = report_stop(why)
    return int(status or 0), heard.getvalue()


def finding(text: str, code: str) -> str:
    """Return the first finding of a code in what was told, with its notes and its hint."""
    lines = text.split("\n")
    for k, line in enumerate(lines):
        if f"[{code}]: " in line:
            more = 1
            while k + more < len(lines) and lines[k + more].startswith("  "):
                more += 1
            return "\n".join(lines[k : k + more])
    return ""


def examples() -> tuple[dict[str, dict[str, str]], list[str]]:
    """Return code -> its example (run, said) or reason (cannot), and what is wrong."""
    from wedmcam.diag import CODES

    all_cases = cases()
    made: dict[str, dict[str, str]] = {}
    wrong = [
        f"cases.toml: there is no code '{c}'" for c in all_cases if c not in {*CODES, "shared"}
    ]
    with folder() as here:
        for code in CODES:
            case = all_cases.get(code)
            if case is None:
                wrong.append(f"{code}: no example; add a file to tests/bad or a case to cases.toml")
            elif "cannot" in case:
                made[code] = {"cannot": case["cannot"]}
            else:
                files = _prepare(here, case)
                _, text = run(case["run"])
                said = finding(text, code)
                if not said:
                    wrong.append(f"{code}: '{case['run']}' does not say it, but:\n{text}")
                made[code] = {"run": f"wedmcam {case['run']}", "said": said}
                for file in files:
                    file.unlink()
    return made, wrong


# --- pages ----------------------------------------------------------------------------------------


def codes_page(shown: dict[str, dict[str, str]]) -> str:
    """Return docs/codes.md."""
    from wedmcam.diag import CODES

    lines = [
        "# Diagnostics",
        "",
        "Written by `make docs`; do not edit. A message reads `place: severity[code]: what is",
        "wrong`, and often a hint. `wedmcam explain CODE` tells here what stands below; a code",
        "never changes its meaning. Every example was run.",
        "",
    ]
    lines += [f"* [`{code}`](#{code}): {CODES[code].what}" for code in sorted(CODES)]
    for code in sorted(CODES):
        entry, example = CODES[code], shown.get(code, {})
        lines += ["", f"## {code}", "", entry.what, "", f"*Why it matters.* {entry.why}", ""]
        lines += [f"*What to do.* {entry.cure}", ""]
        if "run" in example:
            lines += ["```", f"$ {example['run']}", example["said"], "```"]
        else:
            lines.append(f"*No example:* {example.get('cannot', '')}.")
    return "\n".join(lines) + "\n"


def profiles_page() -> str:
    """Return docs/profiles.md."""
    from wedmcam import machines
    from wedmcam.machines.read import FORMATS
    from wedmcam.machines.vocabulary import Vocabulary
    from wedmcam.machines.write import Entry, about, entries, section_types

    lines = [
        "# Profiles",
        "",
        "Written by `make docs`; do not edit. A profile is a TOML that says what a format leaves",
        "open: limits, layout, control words. Give it with `--profile NAME` or `--profile",
        "FILE.toml`. `wedmcam profile show NAME` prints one with every value in force, to start",
        "from; `wedmcam profile check FILE.toml` says everything that is wrong with it. A key that",
        "is not known is an error: a misspelt limit would be no limit. Which line table and",
        "counting a controller has, how its axes lie: [probe.md](probe.md).",
        "",
        "## Built in",
        "",
        "| name | format | |",
        "|---|---|---|",
    ]
    for name in machines.names():
        machine = machines.builtin(name)
        mark = " (default)" if machines.DEFAULTS.get(machine.format) == name else ""
        lines.append(f"| `{name}` | {machine.format}{mark} | {machine.title} |")
    section = None
    words: list[Entry] = []
    for entry in entries():
        if entry.section.startswith("iso.words."):
            words.append(entry)
            continue
        if entry.section != section:
            section = entry.section
            title = f"`[{section}]`" if section else "At the top"
            lines += [
                "",
                f"## {title}",
                "",
                *(line for p in about(section_types()[section]) for line in (*wrap(p, 88), "")),
                "| key | takes | formats | means |",
                "|---|---|---|---|",
            ]
        must = " (must be there)" if entry.required else ""
        formats = "all" if entry.formats == FORMATS else ", ".join(entry.formats)
        takes, means = (t.replace("|", "\\|") for t in (entry.takes, entry.means))
        lines.append(f"| `{entry.key}`{must} | {takes} | {formats} | {means} |")
    lines += ["", "## `[iso.words]`", ""]
    lines += [line for p in about(Vocabulary) for line in (*wrap(p, 88), "")]
    lines += ["| table | keys | means |", "|---|---|---|"]
    lines += [f"| `[{e.section}]` | {e.takes} | {e.means} |" for e in words]
    return "\n".join(lines) + "\n"


def modules_page() -> str:
    """Return docs/modules.md."""
    source = ROOT / "src" / "wedmcam"
    lines = [
        "# Modules",
        "",
        "Written by `make docs`; do not edit: the first sentence of each module's docstring. Which",
        "layer may import which, and where to change what: [ARCHITECTURE.md](../ARCHITECTURE.md).",
    ]
    rooms: dict[str, list[Path]] = {}
    for path in sorted(source.rglob("*.py")):
        room = path.relative_to(source).parent
        rooms.setdefault("wedmcam" if room == Path() else str(room), []).append(path)
    for room, paths in sorted(rooms.items(), key=lambda entry: (entry[0] != "wedmcam", entry[0])):
        lines += ["", f"## {room}", ""]
        for path in paths:
            docstring = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
            sentence = re.split(r"(?<=[.!?])\s+(?=[A-Z`])|\n\n", docstring, maxsplit=1)[0]
            name = "the room" if path.name == "__init__.py" else f"`{path.stem}`"
            lines += wrap(f"* {name}: {' '.join(sentence.split())}", 100, subsequent_indent="  ")
    return "\n".join(lines) + "\n"


def pages() -> tuple[dict[Path, str], list[str]]:
    """Return path -> text of every made file, and what is wrong with the examples."""
    shown, wrong = examples()
    text = json.dumps(dict(sorted(shown.items())), indent=1, ensure_ascii=False) + "\n"
    docs = ROOT / "docs"
    import machine_tables
    import step_figures

    from wedmcam.probe.page import page as probe_page

    made = {docs / "codes.md": codes_page(shown), docs / "profiles.md": profiles_page()}
    made |= {docs / "probe.md": probe_page(), docs / "modules.md": modules_page()}
    return {EXAMPLES: text, **made, **step_figures.made(), **machine_tables.made()}, wrong


def main() -> int:
    made, wrong = pages()
    for what in wrong:
        print(what, file=sys.stderr)
    for path, text in made.items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, "utf-8")
    print(f"{len(made)} files written, {len(wrong)} examples wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
