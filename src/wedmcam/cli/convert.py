"""``wedmcam convert``: one program format into another, proven equal before it is written."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from wedmcam.cli import asked as ask
from wedmcam.cli.files import check_outputs, read_input, write_outputs
from wedmcam.cli.lengths import DEGREES, length
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import ReadsPrograms, also_read, machine_for, profile_for
from wedmcam.cli.terminal import print_text


@click.command("convert", cls=ReadsPrograms)
@click.argument("program")
@click.option("-o", "--output", required=True, help="Where the other program goes; - for stdout.")
@click.option("--to", metavar="FORMAT", help="Of the output; by default from its name.")
@click.option("--format", "format_", metavar="FORMAT", help="Of PROGRAM; else by name, content.")
@click.option("--profile", metavar="NAME|FILE", help="Profile of the output.")
@click.option(
    "--copies",
    type=int,
    default=0,
    help="Of a figure in rotation format, 1 to 99.",
)
@click.option("--angle", type=DEGREES, default=0.0, help="Degrees from copy to copy.")
@click.option("--gap", "gap_um", type=length("gap_um"), help="Of a compensation or 4B file.")
@click.option(
    "--side",
    type=click.Choice(["part", "die"]),
    default="part",
    help="Of such a file: part outwards, die inwards.",
)
@ask.d_option
@ask.reading_options
@ask.feed_option
@click.option("--json", "json_", is_flag=True, help="Summary as JSON on standard output.")
@click.option("--strict", is_flag=True, help="Warnings are errors: nothing may get lost.")
@click.option("-q", "--quiet", is_flag=True, help="Errors only.")
def convert_command(
    program: str,
    output: str,
    to: str | None,
    format_: str | None,
    profile_in: str | None,
    profile: str | None,
    copies: int,
    angle: float,
    gap_um: float | None,
    side: str,
    d: tuple[tuple[int, float], ...],
    feed_um: float | None,
    json_: bool,
    strict: bool,
    quiet: bool,
    **asked: Any,
) -> int:
    """One program format into another, from the path that its controller steps.

    The result is decoded again and must be the same path within 1 um, else nothing is written. Exit
    status: 0 done, 1 the program cannot be read or the other format cannot state it, 3 the paths
    differ.
    """
    from wedmcam.cli import terminal
    from wedmcam.operations import convert as conversion
    from wedmcam.targets import Entries, target_of

    target = to if to in conversion.TARGETS else None if to else conversion.output_of(output)
    machine = None
    if target is None:
        profile = profile or _set_profile(output, to)
        named = ask.machine_of(profile, None) if profile else None
        machine = ask.machine_of(profile, ask.format_of(output, to, named))
        ask.warn_of_name(output, machine.format)
    if machine is None or not machine.iso.feed_um:
        which = f"the profile {machine.name}" if machine else f"a {target} file"
        ask.warn_of_idle({"feed_um"}, f"{which} holds no F")
    machine_in = machine_for(program, profile_in, format_)
    check_outputs([program, *also_read(click.get_current_context())], [output])
    if output == "-" and json_:
        raise click.UsageError("--json and the program cannot both be standard output")
    if output == "-" and machine and not target_of(machine).is_text and sys.stdout.isatty():
        raise click.UsageError("a binary program is not for a terminal: give -o FILE")
    name = "stdin" if program == "-" else program
    data = read_input(program)
    with waiting(f"converting {name}"):
        made = conversion.convert(
            data,
            to=target or (machine.format if machine else None),
            profile=machine if profile else None,
            profile_in=machine_in,
            format=format_,
            name=name,
            strict=strict,
            entered=Entries(copies, angle, gap_um, side == "part", d),
            feed_um=feed_um,
            **ask.said_of(asked),
        )
    terminal.print_findings(made.findings, name, quiet)
    if made.data is None:
        if Path(output).exists() and output != "-":
            print_text(f"nothing was written; {output} is as it was", err=True)
        else:
            print_text("nothing was written", err=True)
    else:
        write_outputs([(output, made.data)])
        if not quiet:
            as_set = machine_in is not None and not (profile_in or format_)
            read_as = f"; read as {made.machine_in.name}" if as_set else ""
            print_text(_line(made, output, target) + read_as, err=True)
    if json_:
        terminal.print_json(_summary(made, program, output, target))
    return made.status


def _set_profile(output: str, to: str | None) -> str | None:
    """Return the profile that a settings file gives for the format of the output, if any."""
    from wedmcam.options import FORMAT_OF_SUFFIX

    setting = profile_for(to or FORMAT_OF_SUFFIX.get(Path(output).suffix.lower()))
    return setting.value if setting else None


def _line(made: Any, output: str, target: str | None) -> str:
    size = f"{len(made.data)} bytes"
    if target == "wed":
        return f"{output}: {size}; it compiles to the same path within 1 um"
    if made.machine is None or made.difference is None:
        return f"{output}: {size}"
    return (
        f"{output}: {made.machine.format} ({made.machine.name}), {len(made.made.blocks)} blocks, "
        f"{size}; the same path, at most {made.difference.largest_um:.2f} um apart"
    )


def _summary(made: Any, program: str, output: str, target: str | None) -> dict[str, Any]:
    from wedmcam.judge.certificate import finding_data

    apart = made.difference
    return {
        "input": program,
        "output": output if made.ok else None,
        "format_in": made.machine_in.format,
        "profile_in": made.machine_in.name,
        "format": made.machine.format if made.machine else target,
        "profile": made.machine.name if made.machine else None,
        "blocks_in": len(made.program.blocks) if made.program is not None else None,
        "blocks": len(made.made.blocks) if made.made is not None else None,
        "largest_um": round(apart.largest_um, 3) if apart and apart.equal else None,
        "diagnostics": [finding_data(d) for d in made.findings],
        "ok": made.ok,
    }
