"""The commands. Each fetches what it needs when it runs, so that ``--help`` answers at once."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wedmcam import __version__
from wedmcam.cli import asked as ask
from wedmcam.cli.config import config_command
from wedmcam.cli.convert import convert_command
from wedmcam.cli.files import (
    Failed,
    Unreadable,
    check_outputs,
    read_input,
    read_program,
    write_outputs,
)
from wedmcam.cli.lengths import POINT, length
from wedmcam.cli.observer import Observer, dump_option
from wedmcam.cli.pictures import check_picture, picture, print_nothing_written, write_refused
from wedmcam.cli.profiles import profile_group
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import Configured, ReadsPrograms, also_read, machine_for, typed
from wedmcam.cli.terminal import print_text

if TYPE_CHECKING:
    from wedmcam.diag import Diagnostic
    from wedmcam.machines import Machine

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

EPILOG = """Exit status: 0 done, 1 the input has errors, 2 wrong use, 3 verification failed,
70 internal error, 130 interrupted. Lengths take a unit (0.1mm, 100um, 0.004in); bare numbers
are mm. Defaults of a shop stand in a wedmcam.toml (see wedmcam config)."""


@click.group(context_settings=CONTEXT, epilog=EPILOG)
@click.version_option(__version__, prog_name="wedmcam")
def cli() -> None:
    """Compile drawings to wire-EDM programs, and prove every program that is written."""


@cli.command("compile", cls=Configured, short_help="Source to program, proven.")
@click.argument("input_", metavar="INPUT")
@click.option(
    "-o", "--output", required=True, metavar="FILE", help="Where the program goes; - for stdout."
)
@click.option(
    "--to",
    metavar="FORMAT",
    help="3b, compact, rotation, compensation, iso, 4b, or dxf (the stepped path); by default from "
    "the output's name. Several (3b,iso): NAME with the ending of each.",
)
@ask.compile_options
@click.option(
    "--split",
    is_flag=True,
    help="Over the memory: several files NAME-1, NAME-2, ..., cut at thread points.",
)
@click.option("--certificate", metavar="FILE.json", help="Write the certificate there.")
@click.option(
    "--plot", "plot_", metavar="FILE.svg|png|html", help="Draw the verified program there."
)
@click.option(
    "--map", "map_", metavar="FILE.json", help="Write there which block was drawn by what."
)
@click.option(
    "--setup-sheet",
    "sheet",
    metavar="FILE.md|txt|html",
    help="Write there what the machine needs: start holes, zero, what to do at each stop.",
)
@ask.feed_option
@dump_option
@ask.said_options
def compile_command(
    input_: str,
    output: str,
    to: str | None,
    certificate: str | None,
    plot_: str | None,
    map_: str | None,
    split: bool,
    sheet: str | None,
    dump_after: tuple[str, ...],
    **asked: Any,
) -> int:
    """Source to program: the main job.

    Nothing is written that was not decoded again, stepped on the controller and compared with the
    drawing.
    """
    if dump_after and (output == "-" or asked["json_"] or split or (to is not None and "," in to)):
        raise click.UsageError(
            "--dump-after takes standard output, of one program: not with -o -, --json, --split or "
            "many formats"
        )
    if sheet is not None and (split or (to is not None and "," in to)):
        raise click.UsageError("--setup-sheet is for one program: not with --split or many formats")
    if to is not None and "," in to:
        from wedmcam.cli.several import compile_several

        if split:
            raise click.UsageError("--split takes one format: formats part at other places")
        if plot_ is not None:
            check_picture(plot_)
        return compile_several(input_, output, to, certificate, map_, plot_, **asked)
    feed = ask.feed_of(asked)
    machine = ask.machine_of(asked["profile"], None) if asked["profile"] else None
    drawn = to == "dxf" or (to is None and Path(output).suffix.lower() == ".dxf")
    machine = ask.machine_of(
        asked["profile"], None if drawn else ask.format_of(output, to, machine)
    )
    if not drawn:
        ask.warn_of_name(output, machine.format)
    outputs = [n for n in (output, certificate, plot_, map_, sheet) if n is not None]
    check_outputs([input_, *also_read(click.get_current_context())], outputs)
    if output == "-" and asked["json_"]:
        raise click.UsageError("--json and the program cannot both be standard output")
    if plot_ is not None:
        check_picture(plot_)
    if split:
        if drawn or output == "-":
            raise click.UsageError("--split writes several programs: give -o NAME of a program")
        if asked["from_block"]:
            raise click.UsageError("--split parts a whole program: not what --from-block leaves")
        from wedmcam.cli.split import compile_split

        return compile_split(input_, machine, output, certificate, plot_, map_, feed, asked)
    made, apart = _compiled(input_, machine, output, asked, Observer(dump_after))
    if not made.ok:
        drawn = plot_ is not None and write_refused(
            made, Path(_name(input_)).name, plot_, _name(input_)
        )
        print_nothing_written(output, drawn)
        return int(made.status)
    assert made.data is not None
    from wedmcam.targets import target_of

    if output == "-" and not target_of(machine).is_text and not drawn and sys.stdout.isatty():
        raise click.UsageError("a binary program is not for a terminal: give -o FILE")
    from wedmcam import api
    from wedmcam.cli import report, terminal

    files = [(output, api.path_drawing(made.program, machine) if drawn else made.data)]
    if certificate is not None:
        files.append((certificate, report.certificate_bytes(made.summary)))
    if plot_ is not None:
        files.append((plot_, picture(made, Path(output).name, plot_)))
    if map_ is not None:
        files.append((map_, report.map_bytes(api.source_map(made))))
    if sheet is not None:
        from wedmcam.reports.setup_sheet import written

        beside = "" if plot_ is None else os.path.relpath(plot_, Path(sheet).parent)
        more = {"wire_um": asked["wire_um"], "gap_um": asked["gap_um"], "picture": beside}
        files.append((sheet, written(made, Path(output).name, sheet, feed, **more)))
    write_outputs(files)
    if not asked["quiet"]:
        report.print_report(made, output, asked["verbose"])
        report.print_arithmetic(apart)
        report.print_time(made.summary, feed)
    if asked["json_"]:
        terminal.print_json({**report.with_time(made.summary, feed), **apart})
    return 0


@cli.command("check", cls=Configured, short_help="Everything but writing.")
@click.argument("input_", metavar="INPUT")
@click.option(
    "--to", metavar="FORMAT", help="3b (default), compact, rotation, compensation, iso or 4b."
)
@click.option(
    "--plot", "plot_", metavar="FILE.svg|png|html", help="Draw the verified program there."
)
@ask.compile_options
@ask.feed_option
@dump_option
@ask.said_options
def check_command(
    input_: str, to: str | None, plot_: str | None, dump_after: tuple[str, ...], **asked: Any
) -> int:
    """Everything but writing a program."""
    from wedmcam.cli import report, terminal

    if dump_after and asked["json_"]:
        raise click.UsageError("--dump-after takes standard output: not with --json")

    machine = ask.machine_of(asked["profile"], to)
    if plot_ is not None:
        check_outputs([input_, *also_read(click.get_current_context())], [plot_])
        check_picture(plot_)
    made, apart = _compiled(input_, machine, "", asked, Observer(dump_after))
    if plot_ is not None:
        title = Path(_name(input_)).name
        if made.ok:
            write_outputs([(plot_, picture(made, title, plot_))])
        else:
            write_refused(made, title, plot_, _name(input_))
    feed = ask.feed_of(asked)
    if made.ok and not asked["quiet"]:
        report.print_report(made, "(not written)", asked["verbose"])
        report.print_arithmetic(apart)
        report.print_time(made.summary, feed)
    if asked["json_"]:
        terminal.print_json({**report.with_time(made.summary, feed), **apart})
    return int(made.status)


def _compiled(
    input_: str, machine: Any, output: str, asked: dict[str, Any], observer: Observer
) -> tuple[Any, dict[str, Any]]:
    """Compile and print the findings; with what --json adds of the other arithmetic."""
    from wedmcam import api
    from wedmcam.cli import terminal

    ask.check_source(input_, asked["from_"])
    options = ask.options_of(asked)
    data = read_input(input_)
    with waiting(f"compiling {_name(input_)}"):
        made = api.compile(
            data,
            to=machine.format,
            profile=machine if asked["profile"] else None,
            name=_name(input_),
            output_name=output,
            options=options,
            observe=observer,
        )
    observer.print_stages(machine)
    texts: dict[str, str | bytes] = {_name(input_): data, **options.texts}
    terminal.print_findings(made.findings, _name(input_), asked["quiet"], texts)
    if asked["verbose"]:
        observer.print_times()
    if not made.ok and asked["json_"] and output:
        terminal.print_json(made.summary)
    apart = {}
    if made.ok and (asked["json_"] or options.arithmetic == "float64"):
        apart["arithmetic_difference_um"] = api.arithmetic_difference(made, data)
    return made, apart


def _name(path: str) -> str:
    return "stdin" if path == "-" else path


@cli.command("batch", cls=Configured, short_help="Many drawings and folders to programs.")
@click.argument("inputs", nargs=-1, required=True)
@click.option("-o", "--output", required=True, metavar="DIR", help="Folder of the programs.")
@click.option(
    "--to", metavar="FORMAT", help="3b (default), compact, rotation, compensation, iso or 4b."
)
@click.option("--jobs", type=click.IntRange(0, 256), default=0, help="Processes; 0: one a core.")
@click.option("--force-units", is_flag=True, help="--units overrides what drawings say.")
@ask.compile_options
@ask.feed_option
@ask.said_options
def batch_command(
    inputs: tuple[str, ...],
    output: str,
    to: str | None,
    jobs: int,
    force_units: bool,
    **asked: Any,
) -> int:
    """The same for many files, folders and patterns, into a mirrored tree.

    --json prints one line an item. One bad file never stops the others; the exit status is the
    largest of the items'. Each drawing is made as the wedmcam.toml of its own folder says.
    """
    from wedmcam.cli import batch
    from wedmcam.cli.settings import by_folder

    if Path(output).exists() and not Path(output).is_dir():
        raise click.UsageError(f"{output} is a file: -o takes a folder")
    items = batch.find(inputs, output, by_folder(click.get_current_context(), batch.how))
    return batch.run(
        items,
        force_units=force_units,
        jobs=jobs,
        json_=asked["json_"],
        quiet=asked["quiet"],
    )


@cli.command("verify", cls=Configured, short_help="Prove a program against its drawing.")
@click.argument("program")
@click.option("--against", metavar="INPUT", help="The drawing that the program is to cut.")
@click.option(
    "--format",
    "format_",
    metavar="FORMAT",
    help="3b, compact, rotation, compensation, iso, 4b; else by name, content.",
)
@click.option("--origin", type=POINT, help="Where the program starts in the drawing, X,Y in mm.")
@click.option(
    "--fit-origin",
    is_flag=True,
    help="Find where it starts by fitting, also where thread points are given.",
)
@click.option(
    "--certificate",
    metavar="FILE.json",
    help="Re-check this certificate where it exists (options and origin come from it); else write "
    "it there.",
)
@click.option("--plot", "plot_", metavar="FILE.svg|png|html", help="Draw the program there.")
@click.option(
    "--metamorphic",
    is_flag=True,
    help="Also compile the drawing rotated, mirrored, reversed, threaded elsewhere: its programs "
    "must be images of each other.",
)
@ask.d_option
@ask.reading_options
@ask.compile_options
@ask.feed_option
@ask.said_options
def verify_command(
    program: str,
    against: str | None,
    format_: str | None,
    origin: tuple[float, float] | None,
    fit_origin: bool,
    certificate: str | None,
    plot_: str | None,
    metamorphic: bool,
    **asked: Any,
) -> int:
    """Decode a program, run it on the controller's interpolator, compare it with the drawing."""
    from wedmcam import api
    from wedmcam.cli import report, terminal

    feed = ask.feed_of(asked)
    issued = _issued(certificate)
    if issued is not None and against is None:
        against = _drawing_of(issued, str(certificate))
    if issued is not None:
        asked = ask.as_issued(asked, issued, typed(click.get_current_context()))
    options = ask.options_of(asked)
    machine = None
    if named := ask.profile_in(asked, typed(click.get_current_context())):
        machine = ask.machine_of(named, format_)
    outputs = [name for name in (plot_, None if issued else certificate) if name is not None]
    context = click.get_current_context()
    check_outputs([program, *([against] if against else []), *also_read(context)], outputs)
    if plot_ is not None:
        check_picture(plot_)
    if against is None:
        names = {*ask.DRAWING_NAMES, *ask.PATH_NAMES} - {"offset_um", "wire_um", "gap_um", "side"}
        ask.warn_of_idle(names, "there is no --against DRAWING")
    data, drawing = read_program(program), None if against is None else read_input(against)
    with waiting(f"verifying {_name(program)}"):
        proof = api.verify(
            data,
            against=drawing,
            profile=machine,
            format=format_,
            name=_name(program),
            against_name=against,
            origin_mm=None if origin is None else (origin[0] / 1000, origin[1] / 1000),
            fit_origin=fit_origin,
            certificate=issued,
            options=options,
        )
    if metamorphic:
        if against is None or drawing is None:
            raise click.UsageError("--metamorphic compiles the drawing: give --against INPUT")
        with waiting("compiling images"):
            proof = api.with_images(proof, drawing, against, options)
    texts: dict[str, str | bytes] = (
        {} if against is None or drawing is None else {against: drawing, **options.texts}
    )
    terminal.print_findings(proof.findings, _name(program), asked["quiet"], texts)
    files = []
    if certificate is not None and issued is None and proof.ok:
        files.append((certificate, report.certificate_bytes(proof.summary)))
    if plot_ is not None and proof.program is not None:
        files.append((plot_, picture(proof, Path(program).name, plot_)))
    write_outputs(files)
    if plot_ is not None and proof.program is None:
        write_refused(proof, Path(program).name, plot_, _name(program))
    if asked["json_"]:
        terminal.print_json(report.with_time(proof.summary, feed))
    elif not asked["quiet"]:
        _print_proof(proof, asked["verbose"])
        report.print_time(proof.summary, feed)
    return proof.status


def _issued(certificate: str | None) -> dict[str, Any] | None:
    """Return the certificate of a file; None where there is no file yet.

    Raises:
        UsageError: the file is no certificate.
    """
    if certificate is None or not Path(certificate).exists():
        return None
    from wedmcam.judge.claims import parsed

    try:
        return parsed(read_input(certificate))
    except ValueError as why:
        raise click.UsageError(f"{certificate} is no certificate: {why}") from why


def _drawing_of(issued: dict[str, Any], certificate: str) -> str:
    """Return the drawing that a certificate names: from here, or from a folder above it.

    Raises:
        Failed: it is not there.
    """
    name = str(issued.get("input") or "")
    folder = Path(certificate).resolve().parent
    places = [Path(name), *(above / name for above in (folder, *folder.parents))]
    for place in (*places, folder / Path(name).name):
        if name and place.is_file():
            return str(place)
    raise Failed(
        f"{certificate}: the drawing {name or '(none)'} of the certificate is not there, so "
        "nothing can be proven; give --against DRAWING"
    )


def _print_proof(proof: Any, verbose: bool) -> None:
    from wedmcam.cli import report

    if proof.verdict is not None:
        v = proof.verdict
        print_text(
            f"contours   {v.contours}, {v.blocks} blocks, {v.steps} steps, {v.path_mm:.3f} mm, "
            f"starts at ({v.origin_um[0] / 1000:.3f}, {v.origin_um[1] / 1000:.3f}) mm",
            err=True,
        )
        if proof.understood is not None:
            for line in report.understood_lines(proof.understood, verbose):
                print_text(line, err=True)
            print_text(report.counts_line(proof.understood), err=True)
        print_text(report.proof_line(proof), err=True)
        if verbose:
            t = v.table
            print_text("block    cut        ends at (mm)   error um     right      left", err=True)
            for k in range(len(t.block)):
                x, y = t.stepped[k] / 1000
                print_text(
                    f"{t.block[k]:5d} {t.cut[k]:6d} {x:10.3f} {y:10.3f} {t.error[k]:8.2f} "
                    f"{t.low[k]:9.2f} {t.high[k]:9.2f}",
                    err=True,
                )
        for image in proof.summary.get("metamorphic", ()):
            off = "-" if image["deviation_um"] is None else f"{image['deviation_um']:.2f} um"
            print_text(f"image      {image['name']}: {off} {image['why']}".rstrip(), err=True)
    elif proof.program is not None and proof.ok:
        report.print_figures(proof)


@cli.command("diff", cls=ReadsPrograms, short_help="Compare two programs as step paths.")
@click.argument("a")
@click.argument("b")
@click.option(
    "--within", "within_um", type=length("within_um"), default="1um", help="As far apart is equal."
)
@click.option("--profile", metavar="NAME|FILE", help="Of the first; by name and content else.")
@click.option("--profile-b", metavar="NAME|FILE", help="Of the second.")
@ask.d_option
@ask.reading_options
@ask.reading_options_b
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
@click.option("-q", "--quiet", is_flag=True, help="Only the exit status.")
def diff_command(
    a: str,
    b: str,
    within_um: float,
    profile: str | None,
    profile_b: str | None,
    profile_in: str | None,
    d: tuple[tuple[int, float], ...],
    json_: bool,
    quiet: bool,
    **asked: Any,
) -> int:
    """Two programs, any formats, compared as step paths.

    Exit status: 0 equal, 1 different, 2 one cannot be read. Blocks need not match; leads and moves
    count. Where the programs start does not.
    """
    from wedmcam import api
    from wedmcam.cli import report, terminal

    machines = (
        _machine_of_either(a, profile, profile_in, "--profile"),
        _machine_of_either(b, profile_b, profile_in, "--profile-b"),
    )
    try:
        one, two = read_program(a), read_program(b)
    except Failed as why:
        raise Unreadable(why.message) from why
    with waiting(f"comparing {_name(a)} and {_name(b)}"):
        found, said = api.diff(
            one,
            two,
            within_mm=within_um / 1000,
            names=(_name(a), _name(b)),
            profiles=machines,
            d=d,
            **ask.said_of(asked),
        )
    if found is None:
        terminal.print_findings(said, a)
        return 2
    if not quiet:
        terminal.print_findings([d for d in said if d.code in ("no-gap", "iso-stated")], a)
    if json_:
        terminal.print_json(api.difference_data(found, a, b))
    elif not quiet:
        report.print_difference(found, a, b)
    return 0 if found.equal else 1


def _machine_of_either(
    program: str, profile: str | None, either: str | None, option: str
) -> Machine | None:
    """Return the machine of one of two programs; None for what its name and content say.

    Args:
        program: its file.
        profile: as typed for it.
        either: as typed for both: it is taken for those of its format.
        option: how ``profile`` is typed.

    Raises:
        WrongUse: the profile is of another format than the program.
    """
    from wedmcam.cli.settings import format_of_program
    from wedmcam.options import PROGRAM_FORMATS, WrongUse

    format_ = format_of_program(program)
    for typed_ in (profile, either):
        if typed_ is None:
            continue
        machine = machine_for(program, typed_)
        if machine is None or format_ not in PROGRAM_FORMATS or machine.is_of(str(format_)):
            return machine
        if typed_ is profile:
            raise WrongUse(
                f"{option} {profile} is for {machine.format}, and {program} is {format_}"
            )
    return machine_for(program, None)


@cli.command("inspect", cls=Configured, short_help="What is in a drawing.")
@click.argument("input_", metavar="INPUT")
@ask.drawing_options
@click.option("--side", type=ask.SIDES, help="For the largest offset: part (default) or die.")
@ask.layer_side_option
@ask.said_options
def inspect_command(input_: str, **asked: Any) -> int:
    """What the reader saw: units, size, entities, contours, gaps, the largest offset that fits."""
    from wedmcam import api
    from wedmcam.cli import terminal
    from wedmcam.cli.tables import print_inspection
    from wedmcam.ir.plan import Side
    from wedmcam.options import FILTERS, Options

    ask.check_source(input_, asked["from_"])
    side = Side.DIE if asked["side"] == "die" else None
    options = Options(
        units=asked["units"],
        fill_in_units=asked.get("fill_in_units", False),
        **{name: asked[name] for name in FILTERS},
        join_um=asked["join_um"],
        tolerance_um=asked["tolerance_um"],
        thin_wall_um=asked["thin_wall_um"],
        transforms=asked["transforms"],
        arithmetic=asked["arithmetic"],
        side=side,
        layer_sides=(sides := ask.sides_of(asked)),
        offset_um=1.0 if side or sides else None,  # a side needs one; it is not used
        strict=asked["strict"],
        wishes=ask.wishes_of(asked),
    )
    data = read_input(input_)
    with waiting(f"inspecting {_name(input_)}"):
        seen = api.inspect(data, name=_name(input_), options=options)
    texts: dict[str, str | bytes] = {_name(input_): data, **options.texts}
    terminal.print_findings(seen.findings, _name(input_), asked["quiet"], texts)
    if asked["json_"]:
        terminal.print_json(seen.facts)
    elif seen.drawn is not None:
        print_inspection(seen.facts, asked["verbose"])
    return seen.status


@cli.command("plot", cls=Configured, short_help="A picture of a drawing or a program.")
@click.argument("input_", metavar="INPUT|PROGRAM")
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FILE",
    help="FILE.svg, FILE.png, FILE.html or FILE.dxf; - for SVG to stdout.",
)
@click.option("--contours", is_flag=True, help="Only what was drawn; nothing is compiled.")
@ask.d_option
@ask.reading_options
@ask.compile_options
@ask.feed_option
@ask.said_options
def plot_command(input_: str, output: str, contours: bool, **asked: Any) -> int:
    """A picture: part, kept material, wire path, thread points, block numbers.

    The wire path of a drawing is that of the verified program. A drawing that is refused is drawn
    with the places marked.
    """
    from wedmcam import api
    from wedmcam.cli import terminal
    from wedmcam.options import FORMAT_OF_SUFFIX, Options

    check_outputs([input_, *also_read(click.get_current_context())], [output])
    if Path(output).suffix.lower() != ".dxf":
        check_picture(output)
    data = read_input(input_)
    name = _name(input_)
    made: Any
    is_program = Path(input_).suffix.lower() in FORMAT_OF_SUFFIX or _is_program(data)
    named = asked["profile"]
    if is_program:
        named = ask.profile_in(asked, typed(click.get_current_context()))
        idle = {*ask.DRAWING_NAMES, *ask.PATH_NAMES, "feed_um"}
        ask.warn_of_idle(idle, f"{name} is a program as it stands")
    elif contours:
        ask.warn_of_idle({*ask.PATH_NAMES, "feed_um"}, "with --contours nothing is compiled")
    machine = ask.machine_of(named, None) if named else None
    if contours and not is_program:
        asked |= dict.fromkeys(("side", "offset_um", "wire_um", "gap_um", "clearance_um"))
        asked |= {"layer_sides": (), "layer_offsets": ()}
    said = ask.said_of(asked)
    options = Options(d=asked["d"], **said) if is_program else ask.options_of(asked)
    # A picture shows the program; a drawing is one to cut by.
    shown = Path(output).suffix.lower() != ".dxf"
    with waiting(f"drawing {name}"):
        if is_program:
            made = api.verify(data, profile=machine, name=name, options=options, shown=shown)
        elif contours:
            made = api.inspect(data, name=name, options=options)
        else:
            made = api.compile(data, profile=machine, name=name, options=options)
    texts: dict[str, str | bytes] = {} if is_program else {name: data, **options.texts}
    terminal.print_findings(made.findings, name, asked["quiet"], texts)
    if made.status:
        if shown:
            write_refused(made, Path(name).name, output, name)
        return int(made.status)
    if shown:
        write_outputs([(output, picture(made, Path(name).name, output))])
    elif getattr(made, "program", None) is not None:
        write_outputs([(output, api.path_drawing(made.program, made.machine))])
    else:
        raise click.UsageError(f"{output}: a DXF holds the path of a good program, there is none")
    return int(made.status)


def _is_program(data: bytes) -> bool:
    from wedmcam.frontends.identify import identify
    from wedmcam.options import PROGRAM_FORMATS

    seen = identify(data)
    return seen.format in PROGRAM_FORMATS


@cli.command("identify", short_help="Which format a file is in.")
@click.argument("file")
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
def identify_command(file: str, json_: bool) -> int:
    """Which format a file is in."""
    from wedmcam.cli import terminal
    from wedmcam.cli.tables import identification
    from wedmcam.frontends.identify import identify

    data = read_input(file)
    seen = identify(data)
    found = _unsaid(data, file) if seen.format == "iso" else []
    terminal.print_findings(found, file)
    if json_:
        from wedmcam.judge.certificate import finding_data

        unsaid = [finding_data(d) for d in found]
        terminal.print_json({"file": file, **identification(seen), "diagnostics": unsaid})
    else:
        from wedmcam.cli.tables import memory_of

        print_text(f"{file}: {seen.reason}{memory_of(seen)}")
    return 1 if seen.format in ("unknown", "empty") else 0


def _unsaid(data: bytes, file: str) -> list[Diagnostic]:
    """Return what an ISO program leaves open to its machine."""
    from wedmcam import api
    from wedmcam.frontends.iso.dialect import QUESTIONS

    _, _, found = api.read_program(data, format="iso", name=_name(file), shown=True)
    return [d for d in found if d.code in QUESTIONS]


@cli.command("dump", cls=ReadsPrograms, short_help="The blocks of a program.")
@click.argument("file")
@click.option(
    "--format",
    "format_",
    metavar="FORMAT",
    help="3b, compact, rotation, compensation, iso, 4b; else by name, content.",
)
@ask.machine_options
@ask.d_option
@ask.reading_options
@click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
def dump_command(
    file: str,
    format_: str | None,
    profile: str | None,
    profile_in: str | None,
    d: tuple[tuple[int, float], ...],
    json_: bool,
    **asked: Any,
) -> int:
    """The blocks of a program, with their addresses and where they end."""
    from wedmcam import api
    from wedmcam.cli import terminal
    from wedmcam.cli.tables import dump_lines, dump_rows
    from wedmcam.diag import has_errors
    from wedmcam.frontends import stated
    from wedmcam.targets import Entries

    machine = machine_for(file, profile_in or profile, format_)
    data = read_program(file)
    program, used, found = api.read_program(
        data,
        profile=machine,
        format=format_,
        name=_name(file),
        entered=Entries(d=d),
        shown=True,
        **ask.said_of(asked),
    )
    terminal.print_findings(found, _name(file))
    if program is None:
        return 1
    said = stated(data, used)
    if json_:
        rows = dump_rows(program, used)
        terminal.print_json(
            [{**r, "stated": said[r["where"]]} if r["where"] in said else r for r in rows]
        )
    else:
        for line in dump_lines(program, used):
            more = said.get((line[7:].split() or [""])[0], "")
            print_text(f"{line}   {more}" if more else line)
    return 1 if has_errors(found) else 0


@cli.command("explain", cls=ReadsPrograms, short_help="What a diagnostic or a block means.")
@click.argument("what", metavar="CODE|FILE", required=False)
@click.option("--list", "list_", is_flag=True, help="All codes, one a line.")
@click.option("--block", type=click.IntRange(1), metavar="N", help="Explain this block of FILE.")
@ask.machine_options
@ask.d_option
@ask.reading_options
def explain_command(
    what: str | None,
    list_: bool,
    block: int | None,
    profile: str | None,
    profile_in: str | None,
    d: tuple[tuple[int, float], ...],
    **asked: Any,
) -> int:
    """A diagnostic; or one block of a program: geometry, quadrant, count axis, J, first steps."""
    from wedmcam.cli.explain import explained, listed, unknown

    if list_:
        print_text(listed())
        return 0
    if what is None:
        raise click.UsageError("give a CODE, FILE --block N, or --list")
    if block is not None:
        return _explain_block(what, block, profile_in or profile, d, ask.said_of(asked))
    text = explained(what)
    if text is None:
        raise click.UsageError(unknown(what))
    print_text(text)
    return 0


def _explain_block(
    file: str,
    number: int,
    profile: str | None,
    d: tuple[tuple[int, float], ...],
    said: dict[str, str],
) -> int:
    from wedmcam import api
    from wedmcam.cli import terminal
    from wedmcam.frontends.iso.dialect import QUESTIONS
    from wedmcam.reports.block import explain_block
    from wedmcam.targets import Entries

    machine = machine_for(file, profile)
    data = read_program(file)
    program, used, found = api.read_program(
        data, profile=machine, name=_name(file), entered=Entries(d=d), shown=True, **said
    )
    if program is None:
        terminal.print_findings(found, _name(file))
        return 1
    told = QUESTIONS | {"no-gap", "iso-stated"}
    terminal.print_findings([d for d in found if d.code in told], _name(file))
    if number > len(program.blocks):
        raise click.UsageError(f"{file} has {len(program.blocks)} blocks, there is no {number}")
    for line in explain_block(program, used, data, number):
        print_text(line)
    return 0


cli.add_command(convert_command)
cli.add_command(config_command(cli))
cli.add_command(profile_group)
