"""``wedmcam convert``: one program format into another, proven equal before it is written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam.cli import options as ask
from wedmcam.cli.files import read_input, shown_name, write_outputs
from wedmcam.cli.lengths import DEGREES, length
from wedmcam.cli.outputs import check_names, check_terminal, print_nothing_written
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import ReadsPrograms
from wedmcam.cli.settings.profiles import machine_for, profile_for
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import option_texts
from wedmcam.formats.names import FORMAT_OF_SUFFIX
from wedmcam.judge.certificate import finding_data
from wedmcam.machines import Machine
from wedmcam.operations.convert import OUTPUTS, Conversion, convert, output_of
from wedmcam.targets import Entries


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
@click.option(
    "--transform",
    "transforms",
    multiple=True,
    metavar="TEXT",
    help="Write images of the program, which starts at (0, 0): such as 'translate (10, 0) copies "
    "5', 'with symmetry x', 'rotate 10 copies 35 about (0, 0)', lengths in mm; repeat, in order.",
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
    transforms: tuple[str, ...],
    d: tuple[tuple[int, float], ...],
    feed_um: float | None,
    json_: bool,
    strict: bool,
    quiet: bool,
    **params: Any,
) -> int:
    """One program format into another, from the path that its controller steps.

    The result is decoded again and must be the same path within 1 um, else nothing is written. With
    --transform it is that of the images, each of whose vertices is stepped within 1 um of the exact
    one; an image that starts elsewhere is reached with the generator off, between pauses. Exit
    status: 0 done, 1 the program cannot be read or the other format cannot state it, 3 the paths
    differ.
    """
    target, machine, profile = _target(output, to, profile)
    if machine is None or not machine.iso.feed_um:
        which = f"the profile {machine.name}" if machine else f"a {target} file"
        ask.warn_of_idle({"feed_um"}, f"{which} holds no F")
    machine_in = machine_for(program, profile_in, format_)
    check_names([program], [output])
    if output == "-" and json_:
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
            strict=strict,
            entered=Entries(copies, angle, gap_um, side == "part", d),
            transforms=transforms,
            feed_um=feed_um,
            **ask.answers_of(params),
        )
    typed = option_texts("--transform", transforms)
    print_findings(conversion.findings, name, quiet, dict(typed))
    if conversion.data is None:
        print_nothing_written(output)
    else:
        write_outputs([(output, conversion.data)])
        if not quiet:
            as_set = machine_in is not None and not (profile_in or format_)
            read_as = f"; read as {conversion.machine_in.name}" if as_set else ""
            print_text(_line(conversion, output, target) + read_as, err=True)
            for what, text in conversion.images.lines() if conversion.images else ():
                print_text(f"{what:<10} {text}", err=True)
    if json_:
        print_json(_summary(conversion, program, output, target))
    return conversion.status


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
        "images": conversion.images.as_data() if conversion.images else None,
        "largest_um": round(apart.largest_um, 3) if apart and apart.equal else None,
        "diagnostics": [finding_data(d) for d in conversion.findings],
        "ok": conversion.ok,
    }
