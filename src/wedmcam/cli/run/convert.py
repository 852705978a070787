"""``wedmcam convert``: one program format into another, proven equal before it is written."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.files import read_input, shown_name, write_outputs
from wedmcam.cli.outputs import check_names, check_terminal, print_nothing_written
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings.profiles import machine_for, profile_for
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import option_texts
from wedmcam.formats.names import FORMAT_OF_SUFFIX
from wedmcam.judge.certificate import finding_data
from wedmcam.machines import Machine
from wedmcam.operations.convert import OUTPUTS, Conversion, convert, output_of
from wedmcam.targets.entries import Entries, entered_of

#: Options of a figure in rotation format.
TURNING = ("copies", "angle", "lead_in", "lead_out", "open_loop")


def run_convert(
    program: str, output: str, to: str | None, format_: str | None, **params: Any
) -> int:
    """Run ``wedmcam convert``; return the exit status."""
    target, machine, profile = _target(output, to, params["profile"])
    if machine is None or not machine.iso.feed_um:
        which = f"the profile {machine.name}" if machine else f"a {target} file"
        ask.warn_of_idle({"feed_um"}, f"{which} holds no F")
    machine_in = machine_for(program, params["profile_in"], format_)
    check_names([program], [output])
    if output == "-" and params["json_"]:
        raise click.UsageError("--json and the program cannot both be standard output")
    if machine is not None:
        check_terminal(output, machine)
    data, name = read_input(program), shown_name(program)
    with waiting(f"converting {name}"):
        conversion = convert(
            data,
            to=target or (machine.format if machine else None),
            profile=machine if profile else None,
            profile_in=machine_in,
            format=format_,
            name=name,
            strict=params["strict"],
            entered=_entries(params),
            transforms=params["transforms"],
            feed_um=params["feed_um"],
            **ask.answers_of(params),
        )
    typed = option_texts("--transform", params["transforms"])
    print_findings(conversion.findings, name, params["quiet"], dict(typed))
    if conversion.data is None:
        print_nothing_written(output)
    else:
        write_outputs([(output, conversion.data)])
        if not params["quiet"]:
            as_set = machine_in is not None and not (params["profile_in"] or format_)
            read_as = f"; read as {conversion.machine_in.name}" if as_set else ""
            print_text(_line(conversion, output, target) + read_as, err=True)
            for what, text in conversion.images.lines() if conversion.images else ():
                print_text(f"{what:<10} {text}", err=True)
    if params["json_"]:
        print_json(_summary(conversion, program, output, target))
    return conversion.status


def _entries(params: dict[str, Any]) -> Entries:
    """Return what the operator enters beside the programs."""
    turned = entered_of(*(params[name] for name in TURNING))
    outwards = params["side"] == "part"
    stated = {name: params[name] for name in ("gap_um", "corner_um", "d")}
    return replace(turned, outwards=outwards, **stated)


def _target(
    output: str, to: str | None, profile: str | None
) -> tuple[str | None, Machine | None, str | None]:
    """Return the target that is no program, else the machine and the profile that names it."""
    target = to if to in OUTPUTS else None if to else output_of(output)
    if target is not None:
        return target, None, profile
    profile = profile or _set_profile(output, to)
    named = ask.machine_of(profile, None) if profile else None
    machine = ask.machine_of(profile, ask.format_of(output, to, named))
    ask.warn_of_name(output, machine.format)
    return None, machine, profile


def _set_profile(output: str, to: str | None) -> str | None:
    """Return the profile that a settings file gives for the format of the output, if any."""
    setting = profile_for(to or FORMAT_OF_SUFFIX.get(Path(output).suffix.lower()))
    return setting.value if setting else None


def _line(conversion: Conversion, output: str, target: str | None) -> str:
    machine, program, difference = conversion.machine, conversion.program_out, conversion.difference
    size = f"{len(conversion.data or b'')} bytes"
    if target == "wed":
        return f"{output}: {size}; it compiles to the same path within 1 um"
    if machine is None or program is None or difference is None:
        return f"{output}: {size}"
    return (
        f"{output}: {machine.format} ({machine.name}), {len(program.blocks)} blocks, "
        f"{size}; the same path, at most {difference.largest_um:.2f} um apart"
    )


def _summary(
    conversion: Conversion, program: str, output: str, target: str | None
) -> dict[str, Any]:
    apart = conversion.difference
    return {
        "input": program,
        "output": output if conversion.ok else None,
        "format_in": conversion.machine_in.format,
        "profile_in": conversion.machine_in.name,
        "format": conversion.machine.format if conversion.machine else target,
        "profile": conversion.machine.name if conversion.machine else None,
        "blocks_in": len(conversion.program.blocks) if conversion.program is not None else None,
        "blocks": len(conversion.program_out.blocks)
        if conversion.program_out is not None
        else None,
        "largest_um": round(apart.largest_um, 3) if apart and apart.equal else None,
        "images": conversion.images.as_data() if conversion.images else None,
        "diagnostics": [finding_data(d) for d in conversion.findings],
        "ok": conversion.ok,
    }
