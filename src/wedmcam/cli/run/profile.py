"""``wedmcam profile``: the controllers and dialects that are known, and whether one is good."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam import machines, probe
from wedmcam.cli.files import check_outputs, read_input, shown_name, write_outputs
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import Diagnostic, FileSpan, error
from wedmcam.diag.run import WrongUse
from wedmcam.formats.names import FORMAT_OF_SUFFIX
from wedmcam.judge.certificate import finding_data
from wedmcam.machines import Machine
from wedmcam.machines.write import as_toml, entries


def run_list(json_: bool) -> int:
    """Run ``wedmcam profile list``; return the exit status."""
    rows = [
        {
            "name": name,
            "format": machine.format,
            "title": machine.title,
            "default": machines.DEFAULTS.get(machine.format) == name,
        }
        for name in machines.names()
        for machine in (machines.builtin(name),)
    ]
    if json_:
        print_json(rows)
        return 0
    for row in rows:
        mark = " (default)" if row["default"] else ""
        print_text(f"{row['name']:18}  {row['format']:12}  {row['title']}{mark}")
    return 0


def run_show(name: str, json_: bool) -> int:
    """Run ``wedmcam profile show``; return the exit status."""
    machine, findings, text = _read(name)
    print_findings(findings, name, texts={name: text})
    if machine is None:
        return 2
    if not json_:
        print_text(as_toml(machine), nl=False)
        return 0
    tables: dict[str, dict[str, Any]] = {}
    for entry in entries(machine):
        table = tables.setdefault(entry.section, {})
        if entry.key:  # a class without words has none
            table[entry.key] = entry.value
    print_json({"name": machine.name, **tables.pop("", {}), **tables})
    return 0


def run_check(file: str, json_: bool) -> int:
    """Run ``wedmcam profile check``; return the exit status."""
    machine, findings, text = _read(file)
    print_findings(findings, file, texts={file: text})
    if json_:
        print_json(
            {
                "file": file,
                "ok": machine is not None,
                "name": machine.name if machine else None,
                "diagnostics": [finding_data(d) for d in findings],
            }
        )
    elif machine is not None:
        print_text(f"{file}: {machine.format}, {machine.title}")
    return 0 if machine is not None else 2


def run_probe(output: str | None, profile: str, read_: str | None) -> int:
    """Run ``wedmcam profile probe``; return the exit status."""
    if (output is None) == (read_ is None):
        raise click.UsageError("give -o FILE.3b, or --read SHEET")
    return _read_probe(read_) if read_ is not None else _write_probe(str(output), profile)


def _write_probe(output: str, profile: str) -> int:
    """Write the programs of the probe and its sheet; return the exit status."""
    machine, findings, text = _read(profile)
    print_findings(findings, profile, texts={profile: text})
    if machine is None:
        return 2
    _check_probe(output, machine)
    stem = Path(output).with_suffix("")
    names = {
        part: output if part == "main" else f"{stem}-{part}{Path(output).suffix}"
        for part in probe.PARTS
    }
    files = [(name, probe.text(part, machine)) for part, name in names.items()]
    blank = probe.sheet(names).encode("utf-8")
    there = Path(f"{stem}.txt")
    if there.exists() and there.read_bytes() != blank:
        raise WrongUse(f"{there} is there already and is no empty sheet: give another name")
    files.append((str(there), blank))
    check_outputs([], [name for name, _ in files])
    write_outputs(files)
    for part, name in names.items():
        x0, y0, x1, y1 = (v * machine.axes.step_um / 1000 for v in probe.extents(part))
        print_text(f"{name}  needs x {x0:g} to {x1:g}, y {y0:g} to {y1:g} mm around the start")
    print_text(f"{stem}.txt  the sheet: fill it in, then wedmcam profile probe --read {stem}.txt")
    return 0


def _check_probe(output: str, machine: Machine) -> None:
    """Refuse a machine that the probe is not for, and names that it cannot have.

    Raises:
        WrongUse: exit status 2.
    """
    if not machine.is_of("3b"):
        why = (
            "an ISO block states where it ends, and its reader goes there"
            if machine.is_of("iso")
            else "the ZD-065's line table and counting are published: its profiles have them"
        )
        raise WrongUse(f"the probe is a program in 3B, not in {machine.format}: {why}")
    if output == "-" or Path(output).suffix.lower() == ".txt":
        raise WrongUse("the probe is several files: give -o NAME.3b")
    if FORMAT_OF_SUFFIX.get(Path(output).suffix.lower(), "3b") != "3b":
        raise WrongUse(f"the probe is a program in 3B, and {output} has the name of another format")


def _read_probe(name: str) -> int:
    """Print what a sheet says of a controller; return the exit status."""
    text = read_input(name).decode("utf-8", "replace")
    readings, findings = probe.read_sheet(text, name)
    keys, more = probe.answers(readings, name)
    print_findings([*findings, *more], name, texts={name: text})
    if keys or readings.moved:
        print_text("# Of a profile: start one with `wedmcam profile show b3-compact`.")
        print_text(probe.toml(keys, readings.moved), nl=False)
    elif not findings and not more:
        raise click.UsageError(f"{name}: nothing is filled in")
    return 1 if findings or more else 0


def _read(name: str) -> tuple[Machine | None, list[Diagnostic], str | None]:
    """Return a profile by name or of a file, what is wrong with it, and the file's text."""
    looks_like_a_file = name == "-" or Path(name).suffix.lower() == ".toml" or Path(name).exists()
    if name in machines.names() or not looks_like_a_file:
        machine, findings = machines.find(name)
        return machine, findings, None
    try:
        text = read_input(name).decode("utf-8")
    except UnicodeDecodeError:
        return None, [error("profile-syntax", "not UTF-8", FileSpan(name))], None
    machine, findings = machines.of_file(text, shown_name(name))
    return machine, findings, text
