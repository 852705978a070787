"""The options of a compile on the command line, shared by compile, check, plot and verify.

Each is a row of `option_table`. ``params`` are the values that click collected; ``options`` are
`wedmcam.options.Options`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.core import ParameterSource

from wedmcam.cli.lengths import CUTS, DEGREES, OFFSET, POINT, UNIT, Length, OfLayer
from wedmcam.option_table import ROWS, Kind, Panel, Row, field_rows, rows_of

if TYPE_CHECKING:
    from wedmcam.controllers.nby15.data import Switches
    from wedmcam.machines import Machine
    from wedmcam.options import Options
    from wedmcam.targets.entries import Entries

F = TypeVar("F", bound=Callable[..., Any])


def _stack(*options: Callable[[F], F]) -> Callable[[F], F]:
    def apply(command: F) -> F:
        for option in reversed(options):
            command = option(command)
        return command

    return apply


def _type(row: Row) -> click.ParamType | None:  # type: ignore[type-arg]
    """Return what click makes of the text of an option; None for the text itself."""
    words = click.Choice(row.words, case_sensitive=not row.folds)
    if row.kind is Kind.LAYER_WORDS:
        return OfLayer(words, "side", "DIE=die")
    if row.kind is Kind.LAYER_LENGTHS:
        return OfLayer(Length(row.takes), "length", "DIE=0.12mm")
    if row.kind is Kind.LENGTH:
        return Length(row.takes)
    of_kind: dict[Kind, click.ParamType] = {  # type: ignore[type-arg]
        Kind.UNIT: UNIT,
        Kind.POINTS: POINT,
        Kind.NUMBERS: CUTS,
        Kind.OFFSETS: OFFSET,
        Kind.WHOLE: click.IntRange(1),
    }
    return of_kind.get(row.kind, words if row.words else None)


#: Kinds of options that are repeated.
_REPEATED = frozenset({Kind.TEXTS, Kind.POINTS, Kind.OFFSETS, Kind.LAYER_WORDS, Kind.LAYER_LENGTHS})


def option(row: Row, suffix: str = "", of: str = "", help: str | None = None) -> Callable[[F], F]:
    """Return a row of the table as an option of a command.

    Args:
        row: of the table.
        suffix: of its name, where a command takes it twice.
        of: what its help begins with.
        help: another text.
    """
    names = [f"{row.option}{suffix}", *([row.also] if row.also else [])]
    if row.kind is Kind.FLAG and not row.words:
        names = [f"{row.option}/--no-{row.option.removeprefix('--')}"]
    more: dict[str, Any] = {"type": _type(row), "help": help or (row.help and of + row.help)}
    if row.metavar:
        more["metavar"] = row.metavar
    if row.kind in _REPEATED:
        more["multiple"] = True
    elif row.usual:
        more["default"] = f"{row.usual / 1000:g}mm" if row.kind is Kind.LENGTH else row.usual
    if row.kind is Kind.FLAG and row.words:
        more["default"] = row.words[row.usual]
    return click.option(*names, f"{row.param}{suffix.replace('-', '_')}", **more)


def _options(panel: Panel, suffix: str = "", of: str = "") -> list[Callable[[F], F]]:
    return [option(row, suffix, of) for row in rows_of(panel)]


drawing_options = _stack(*_options(Panel.DRAWING))
path_options = _stack(*_options(Panel.PATH))
machine_options = _stack(
    click.option(
        "--profile", metavar="NAME|FILE", help="Controller or dialect (see wedmcam profile list)."
    ),
)
layer_side_option = option(ROWS["layer_sides"])
#: Of a command that looks for the largest offset.
side_option = option(ROWS["side"], help="For the largest offset: part (default) or die.")
d_option = option(ROWS["d"])
feed_option = option(ROWS["feed_um"])
#: Switches of an NBY-15.
_SWITCHES = (
    click.option(
        "--correct",
        "correct_um",
        type=int,
        default=0,
        metavar="UM",
        help="Radius corrector of the NBY-15, whole um; above 0 the path moves to its right.",
    ),
    click.option(
        "--scale",
        type=click.Choice(["1", "2", "5", "10"]),
        default="1",
        help="Scale switch of the NBY-15.",
    ),
    click.option(
        "--mirror-axes",
        type=click.Choice(["", "x", "y", "xy"]),
        default="",
        help="Direction switches of the NBY-15.",
    ),
    click.option(
        "--run-off",
        is_flag=True,
        help="Run what corrector or scale are not safe for all the same, into the limit switches.",
    ),
)
switch_options = _stack(*_SWITCHES)
#: What the operator enters beside a file in the ZD-065's rotation or compensation format.
turning_options = _stack(
    click.option("--copies", type=int, help="Of a figure in rotation format, 0 to 99."),
    click.option("--angle", type=DEGREES, help="Degrees from copy to copy."),
    click.option(
        "--lead-in",
        type=POINT,
        help="Line entered before such a figure, from the thread point to its start: X,Y in mm; or "
        "for the lead of a compensation file of one contour, to the start of its outline.",
    ),
    click.option(
        "--lead-out",
        type=POINT,
        help="Line entered behind the last copy, or for the lead back of such a file, X,Y in mm.",
    ),
    click.option(
        "--open-loop",
        is_flag=True,
        help="The ZD-065 processes such data literally: roundings add up from block to block.",
    ),
    *_SWITCHES,
)
reading_options = _stack(
    click.option("--profile-in", metavar="NAME|FILE", help="Profile of the program that is read."),
    *_options(Panel.PROGRAM, of="Of an ISO program: "),
)
reading_options_b = _stack(
    *_options(Panel.PROGRAM, "-b", "Of the second, where it is read otherwise: ")
)
said_options = _stack(
    *_options(Panel.OUTPUT),
    click.option("--json", "json_", is_flag=True, help="Summary on standard output."),
    click.option("-q", "--quiet", is_flag=True, help="Say only what is wrong."),
    click.option("-v", "--verbose", is_flag=True, help="Say more."),
)
dump_option = click.option(
    "--dump-after",
    "dump_after",
    type=click.Choice(["sketch", "contours", "plan", "program"]),
    multiple=True,
    help="Print what this stage gives, on standard output; repeat.",
)

#: Parameters that say how a drawing is read, and how it is cut.
DRAWING_NAMES = frozenset(row.param for row in rows_of(Panel.DRAWING))
PATH_NAMES = frozenset(row.param for row in rows_of(Panel.PATH))

compile_options = _stack(drawing_options, path_options, machine_options)


def _values_of(params: dict[str, Any], rows: Iterable[Row]) -> dict[str, Any]:
    """Return the values of fields, by their names, as far as they are stated."""
    stated = [row for row in rows if params.get(row.param) is not None]
    return {row.name: _value(params[row.param], row) for row in stated}


def _value(given: Any, row: Row) -> Any:
    """Return the value of a field from what click made of its option."""
    if row.kind is Kind.FLAG and row.words:
        return given == row.words[True]
    if row.kind is Kind.CHOICE:
        from wedmcam.options import CHOICES

        return CHOICES[row.name](given)
    if row.kind is Kind.LAYER_WORDS:
        from wedmcam.options import CHOICES

        return tuple((layer, CHOICES[row.name](word)) for layer, word in given)
    return given


def answers_of(params: dict[str, Any]) -> dict[str, Any]:
    """Return the answers about a program that is read, taken out of the parameters."""
    names = [f"{row.param}{suffix}" for suffix in ("", "_b") for row in rows_of(Panel.PROGRAM)]
    values = {name: params.pop(name) for name in names if name in params}
    return {name: value for name, value in values.items() if value is not None}


def options_of(params: dict[str, Any], *, answers: bool = True) -> Options:
    """Return the options of a compile, or of a proof.

    Args:
        params: of the command.
        answers: with the answers about programs that are read; False where none is.

    Raises:
        WrongUse: options that do not fit together.
    """
    from wedmcam.options import Options

    rows = [row for row in field_rows() if answers or row.panel is not Panel.PROGRAM]
    values = _values_of(params, rows)
    if (offset := _offset_of(params)) is not None:
        values["offset_um"] = offset
    return Options.of(**values, wishes=wishes_of(params))


def options_to_inspect(
    params: dict[str, Any], side: str | None = None, layer_sides: Iterable[tuple[str, str]] = ()
) -> Options:
    """Return the options of a drawing that is only looked at: no path is asked for.

    Args:
        params: of the command.
        side: for the largest offset; no offset goes with it.
        layer_sides: likewise, of layers.
    """
    from wedmcam.ir.choices import Side
    from wedmcam.options import Options

    rows = (*rows_of(Panel.DRAWING), *rows_of(Panel.OUTPUT), ROWS["fill_in_units"])
    options = Options.of(**_values_of(params, rows), wishes=wishes_of(params))
    sides = tuple((layer, Side(word)) for layer, word in layer_sides)
    return options.with_values(side=Side.DIE if side == "die" else None, layer_sides=sides)


def options_to_read(params: dict[str, Any]) -> Options:
    """Return the options of a program that is read as it stands."""
    from wedmcam.options import Options

    return Options.of(d=params["d"], **answers_of(params))


def _offset_of(params: dict[str, Any]) -> float | None:
    """Return the offset, um, however it is stated.

    Raises:
        WrongUse: it is stated twice, or half.
    """
    from wedmcam.diag.run import WrongUse

    offset: float | None = params["offset_um"]
    wire, gap = params["wire_um"], params["gap_um"]
    if offset is not None and (wire is not None or gap is not None):
        raise WrongUse("give --offset, or --wire and --gap, not both")
    if wire is not None and gap is not None:
        return float(wire / 2 + gap)
    if wire is not None or gap is not None:
        raise WrongUse("--wire and --gap go together: offset = wire / 2 + gap")
    return offset


def wishes_of(params: dict[str, Any]) -> frozenset[str] | None:
    """Return the fields that were typed, and wire_um and gap_um where these were.

    None where it is not known what was typed.
    """
    typed: frozenset[str] | None = params.get("wishes")
    if typed is None:
        return None
    rows = [row for row in ROWS.values() if row.param in typed]
    return typed | {row.fills or row.name for row in rows}


def feed_of(params: dict[str, Any]) -> float | None:
    """Return ``--feed`` in um a minute."""
    feed: float | None = params["feed_um"]
    return feed


def machine_of(profile: str | None, to: str | None) -> Machine:
    """Return the machine of ``--profile`` (a built-in name or a TOML file) and ``--to``.

    Raises:
        WrongUse: no such profile, or one of another format.
    """
    from wedmcam import api, machines
    from wedmcam.cli.files import Failed, read_input
    from wedmcam.cli.terminal import print_findings
    from wedmcam.diag.run import WrongUse

    if profile is None or (profile in machines.names()):
        return api.machine_for(to, profile)
    if not profile.lower().endswith(".toml"):
        return api.machine_for(to, profile)  # says which names are near
    try:
        text = read_input(profile).decode("utf-8")
    except Failed as why:
        raise WrongUse(f"the profile {why.message}") from None
    except UnicodeDecodeError:
        raise WrongUse(f"{profile}: not UTF-8") from None
    machine, findings = machines.of_file(text, profile)
    print_findings(findings, profile, texts={profile: text})
    if machine is None:
        raise WrongUse(f"{profile}: this profile cannot be used")
    return api.machine_for(to, machine)


def profile_in(params: dict[str, Any], typed: set[str]) -> str | None:
    """Return the profile of the program that is read: ``--profile-in``, else ``--profile``.

    Raises:
        WrongUse: two are given for one program.
    """
    from wedmcam.diag.run import WrongUse

    named: str | None = params.pop("profile_in")
    profile: str | None = params["profile"]
    if {"profile", "profile_in"} <= typed and named != profile:
        raise WrongUse("--profile and --profile-in name two profiles of one program: give one")
    return profile if named is None or "profile" in typed else named


def as_issued(
    params: dict[str, Any], certificate: dict[str, Any], typed: set[str]
) -> dict[str, Any]:
    """Return what was typed, with the certificate's options where nothing was typed.

    Raises:
        WrongUse: options that this version does not know.
    """
    from wedmcam.options import Options

    data: dict[str, Any] = certificate.get("options", {})
    issued = Options.from_data(data)  # says what is wrong with them
    merged = dict(params)
    if {"offset_um", "wire_um", "gap_um"} & typed:
        typed = typed | {"offset_um"}
    if params["side"] == "on":
        typed = typed | {"offset_um"}
    for row in (ROWS[name] for name in data):
        if row.param not in typed and row.panel is not Panel.OUTPUT:
            value = issued.value(row)
            merged[row.param] = row.words[value] if row.kind is Kind.FLAG and row.words else value
    return merged


def entered_in(params: dict[str, Any]) -> Entries:
    """Take what is entered for a figure in rotation format out of parameters.

    Raises:
        WrongUse: a lead that is no whole um, or entries that do not fit together.
    """
    from wedmcam.targets.entries import entered_of

    def of(*names: str) -> list[Any]:
        return [params.pop(name) for name in names]

    switches, run_off = switches_in(params)
    copies, angle, lead_in, lead_out = of("copies", "angle", "lead_in", "lead_out")
    return entered_of(
        copies,
        angle,
        lead_in,
        lead_out,
        open_loop=params.pop("open_loop"),
        switches=switches,
        run_off=run_off,
    )


def switches_in(params: dict[str, Any]) -> tuple[Switches, bool]:
    """Take the switches of an NBY-15 out of parameters, and whether it may run off."""
    from wedmcam.controllers.nby15.data import Switches

    mirror = params.pop("mirror_axes")
    correct, scale = params.pop("correct_um"), int(params.pop("scale"))
    return Switches(correct, scale, "x" in mirror, "y" in mirror), params.pop("run_off")


def check_source(name: str, from_: str | None) -> None:
    """Refuse sources of a format that is not read.

    Raises:
        WrongUse: with what can be read.
    """
    from wedmcam.diag.run import WrongUse
    from wedmcam.formats.names import FORMAT_OF_SUFFIX, SOURCE_FORMATS

    if from_ is not None and from_ not in SOURCE_FORMATS:
        raise WrongUse(f"no source format is called '{from_}': {', '.join(SOURCE_FORMATS)}")
    if from_ is None and Path(name).suffix.lower() in FORMAT_OF_SUFFIX:
        raise WrongUse(f"{name} is a program: see wedmcam verify, dump and plot")


def format_of(output: str, to: str | None, profile: Machine | None = None) -> str | None:
    """Return the format of an output from ``--to`` or its name.

    Raises:
        WrongUse: neither says.
    """
    from wedmcam.diag.run import WrongUse
    from wedmcam.formats.names import FORMAT_OF_SUFFIX, PROGRAM_FORMATS

    if to is not None:
        if to not in PROGRAM_FORMATS:
            raise WrongUse(f"no program format is called '{to}': {', '.join(PROGRAM_FORMATS)}")
        return to
    if profile is not None:
        return profile.format
    format_ = FORMAT_OF_SUFFIX.get(Path(output).suffix.lower())
    if format_ is None:
        known = ", ".join(FORMAT_OF_SUFFIX)
        raise WrongUse(f"the name {output} does not tell the format ({known}): give --to")
    return format_


def warn_of_idle(names: Set[str], why: str) -> None:
    """Say which of the options of some parameters were typed and have no effect."""
    from wedmcam.cli.terminal import print_text

    context = click.get_current_context()
    for option in context.command.params:
        typed = context.get_parameter_source(str(option.name)) is ParameterSource.COMMANDLINE
        if option.name in names and typed:
            print_text(f"warning: {option.opts[0]} has no effect: {why}", err=True)


def warn_of_name(output: str, format_: str) -> None:
    """Say so when the name of an output tells another format than is written."""
    from wedmcam.cli.terminal import print_text
    from wedmcam.formats.names import FORMAT_OF_SUFFIX

    named = FORMAT_OF_SUFFIX.get(Path(output).suffix.lower())
    if named is not None and named != format_:
        print_text(f"warning: the name {output} says {named}, but {format_} is written", err=True)
