"""The options of a compile on the command line, shared by compile, check, plot and verify."""

from __future__ import annotations

from collections.abc import Callable, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.core import ParameterSource

from wedmcam.cli.lengths import CUTS, OFFSET, POINT, UNIT, OfLayer, length
from wedmcam.cli.terminal import print_text

if TYPE_CHECKING:
    from wedmcam.ir.plan import Side
    from wedmcam.machines import Machine
    from wedmcam.options import Options

F = TypeVar("F", bound=Callable[..., Any])

SIDES = click.Choice(["part", "die", "left", "right", "on"])
LAYER_SIDE = OfLayer(SIDES, "side", "DIE=die")
LAYER_OFFSET = OfLayer(length("offset_um"), "length", "DIE=0.12mm")


def _stack(*options: Callable[[F], F]) -> Callable[[F], F]:
    def apply(command: F) -> F:
        for option in reversed(options):
            command = option(command)
        return command

    return apply


#: What filters go by: option, what it takes, what that is in a sentence.
_FILTERS = (
    ("layer", "NAME", "this layer"),
    ("type", "NAME", "entities of this DXF type, such as HATCH"),
    ("linetype", "NAME", "what is drawn in this line type, such as CENTER"),
    ("colour", "NAME", "what is drawn in this colour: red to white, 1 to 255, #rrggbb"),
)


def _filters() -> list[Callable[[F], F]]:
    """Return the options that take and leave out: names or wildcards, any number of them."""
    made = []
    for name, metavar, what in _FILTERS:
        for prefix, sentence in (("", f"Take only {what}"), ("ignore-", f"Leave out {what}")):
            words: dict[str, Any] = {"metavar": metavar, "help": f"{sentence}; repeat."}
            field = f"{prefix}{name}s".replace("-", "_")
            other = [f"--{prefix}color"] if name == "colour" else []
            made.append(click.option(f"--{prefix}{name}", *other, field, multiple=True, **words))
    return made


drawing_options = _stack(
    click.option("--from", "from_", metavar="FORMAT", help="Format of the input: dxf or wed."),
    click.option(
        "--units",
        type=click.Choice(["mm", "um", "inch"]),
        help="Unit of the drawing, whatever it says itself.",
    ),
    *_filters(),
    click.option(
        "--join", "join_um", type=length("join_um"), default="0.01mm", help="Largest gap closed."
    ),
    click.option(
        "--tolerance",
        "tolerance_um",
        type=length("tolerance_um"),
        default="0.001mm",
        help="Between a spline or an ellipse and its arcs.",
    ),
    click.option(
        "--thin-wall",
        "thin_wall_um",
        type=length("thin_wall_um"),
        default="0.05mm",
        help="Kept material thinner than this is warned of; 0 for none.",
    ),
    click.option(
        "--transform",
        "transforms",
        multiple=True,
        metavar="TEXT",
        help="Such as 'rotate 10 copies 35 about (0, 0)', lengths in mm; repeat, in order.",
    ),
    click.option(
        "-D",
        "defines",
        multiple=True,
        metavar="NAME=VALUE",
        help="Set a let of a .wed program from outside; repeat.",
    ),
    click.option(
        "--arithmetic",
        type=click.Choice(["decimal8", "float64"]),
        default="decimal8",
        help="In what figures are computed: 8-digit decimals, as the ZD-065 does, or float64 to "
        "compare.",
    ),
)

layer_side_option = click.option(
    "--layer-side",
    "layer_sides",
    type=LAYER_SIDE,
    multiple=True,
    metavar="NAME=SIDE",
    help="Side of the contours of a layer, such as DIE=die; repeat.",
)

path_options = _stack(
    click.option("--offset", "offset_um", type=length("offset_um"), help="Outline to wire centre."),
    click.option("--wire", "wire_um", type=length("wire_um"), help="Wire diameter (with --gap)."),
    click.option(
        "--gap", "gap_um", type=length("gap_um"), help="Spark gap: offset = wire / 2 + gap."
    ),
    click.option(
        "--side",
        type=SIDES,
        help="part keeps the material inside outer contours (default with an offset), die the "
        "reverse; on runs on the line.",
    ),
    layer_side_option,
    click.option(
        "--layer-offset",
        "layer_offsets",
        type=LAYER_OFFSET,
        multiple=True,
        metavar="NAME=LENGTH",
        help="Offset of the contours of a layer; repeat.",
    ),
    click.option(
        "--clearance",
        "clearance_um",
        type=length("clearance_um"),
        help="Between punch and die on each side: offset = wire / 2 + gap - clearance.",
    ),
    click.option(
        "--clearance-on",
        type=click.Choice(["die", "punch"]),
        default="die",
        help="Who takes the clearance; a punch is what --side part cuts.",
    ),
    click.option(
        "--corner", "corner_um", type=length("corner_um"), help="Round the part's own corners."
    ),
    click.option(
        "--convex",
        type=click.Choice(["arc", "sharp"]),
        default="arc",
        help="At corners that the wire goes round.",
    ),
    click.option(
        "--on-interference",
        type=click.Choice(["error", "trim"]),
        default="error",
        help="Where the wire does not fit.",
    ),
    click.option(
        "--start", "starts_um", type=POINT, multiple=True, help="A thread point, X,Y in mm."
    ),
    click.option(
        "--lead", "lead_um", type=length("lead_um"), default="1mm", help="Lead without a start."
    ),
    click.option("--stop", "stop_um", type=length("stop_um"), help="Pause so far before the end."),
    click.option(
        "--overcut", "overcut_um", type=length("overcut_um"), help="Cut so far past the start."
    ),
    click.option("--order", type=click.Choice(["given", "inner-first", "nearest"])),
    click.option(
        "--reverse/--no-reverse",
        help="Clockwise instead of counter-clockwise; cuts of a .wed each the other way.",
    ),
    click.option(
        "--cuts",
        type=CUTS,
        metavar="A-B",
        help="Only contours A to B of the program, in its order.",
    ),
    click.option(
        "--from-block",
        type=click.IntRange(1),
        metavar="N",
        help="After a broken wire: only from block N of the program on, threaded there.",
    ),
    click.option(
        "--backwards/--no-backwards",
        help="With --from-block: the rest of its contour from the thread point back to there.",
    ),
    click.option("--count", type=click.Choice(["exact", "textbook"]), help="How J is found."),
)

machine_options = _stack(
    click.option(
        "--profile", metavar="NAME|FILE", help="Controller or dialect (see wedmcam profile list)."
    ),
)

d_option = click.option(
    "--d",
    "d",
    type=OFFSET,
    multiple=True,
    metavar="N=LENGTH",
    help="Of an ISO program with G41 or G42: the offset entered at the controller for D number N; "
    "repeat.",
)


def _reading(suffix: str = "", of: str = "Of an ISO program: ") -> list[Callable[[F], F]]:
    """Return the options of `options.READING`; each answers what a program leaves open."""
    lengths: dict[str, Any] = {"metavar": "um|mm|inch|LENGTH", "type": UNIT}
    told: dict[str, tuple[dict[str, Any], str]] = {
        "units-in": (
            {"type": click.Choice(["mm", "um", "inch"])},
            "unit of numbers with a point where no G20 or G21 stands.",
        ),
        "whole-in": (lengths, "what 1 is in a number without a point; or a length such as 10um."),
        "coordinates-in": (
            {"type": click.Choice(["absolute", "incremental"])},
            "what holds before the first G90 or G91.",
        ),
        "centres-in": (
            {"type": click.Choice(["start", "absolute", "to-start"])},
            "I and J lead from the start to the centre, are its place, or lead to the start.",
        ),
        "semicolon-in": (
            {"type": click.Choice(["block", "comment"])},
            "what stands behind a semicolon.",
        ),
        "subprograms-in": (
            {"type": click.Choice(["N-label", "O-number", "none"], case_sensitive=False)},
            "M98 P0001 runs from the line N0001, or O0001, to M99.",
        ),
    }
    return [
        click.option(f"--{name}{suffix}", help=of + means, **taken)
        for name, (taken, means) in told.items()
    ]


reading_options = _stack(
    click.option("--profile-in", metavar="NAME|FILE", help="Profile of the program that is read."),
    *_reading(),
)
reading_options_b = _stack(*_reading("-b", "Of the second, where it is read otherwise: "))


def said_of(asked: dict[str, Any]) -> dict[str, Any]:
    """Return what is said of a program that is read, taken out of what click collected."""
    from wedmcam.options import READING

    names = [*READING, *(f"{name}_b" for name in READING)]
    values = {name: asked.pop(name) for name in names if name in asked}
    return {name: value for name, value in values.items() if value is not None}


feed_option = click.option(
    "--feed",
    "feed_um",
    type=length("feed_um"),
    help="Cutting speed, a length a minute: tells the time; F of profiles that write one.",
)

said_options = _stack(
    click.option("--strict/--no-strict", help="Warnings are errors."),
    click.option("--json", "json_", is_flag=True, help="Summary on standard output."),
    click.option("-q", "--quiet", is_flag=True, help="Say only what is wrong."),
    click.option("-v", "--verbose", is_flag=True, help="Say more."),
)


def _names(*stacks: Callable[[Any], Any]) -> frozenset[str]:
    """Return the names of the parameters that stacks of options make."""

    def probe() -> None: ...

    for stack in stacks:
        probe = stack(probe)
    return frozenset(str(option.name) for option in probe.__click_params__)  # type: ignore[attr-defined]


#: Parameters that say how a drawing is read, and how it is cut.
DRAWING_NAMES = _names(drawing_options)
PATH_NAMES = _names(path_options)

compile_options = _stack(drawing_options, path_options, machine_options)


def sides_of(asked: dict[str, Any]) -> tuple[tuple[str, Side], ...]:
    """Return the sides of layers."""
    from wedmcam.ir.plan import Side

    return tuple((name, Side(side)) for name, side in asked["layer_sides"])


def options_of(asked: dict[str, Any]) -> Options:
    """Return `Options` from what click collected.

    Raises:
        WrongUse: options that do not fit together.
    """
    from wedmcam.ir.plan import Order, Side
    from wedmcam.options import FILTERS, READING, Options, WrongUse

    offset = asked["offset_um"]
    wire, gap = asked["wire_um"], asked["gap_um"]
    if offset is not None and (wire is not None or gap is not None):
        raise WrongUse("give --offset, or --wire and --gap, not both")
    if wire is not None and gap is not None:
        offset = wire / 2 + gap
    elif wire is not None or gap is not None:
        raise WrongUse("--wire and --gap go together: offset = wire / 2 + gap")
    read: dict[str, Any] = {name: asked.get(name) for name in READING}
    taken: dict[str, Any] = {name: asked[name] for name in FILTERS}
    return Options(
        units=asked["units"],
        fill_in_units=asked.get("fill_in_units", False),
        **taken,
        join_um=asked["join_um"],
        tolerance_um=asked["tolerance_um"],
        thin_wall_um=asked["thin_wall_um"],
        transforms=asked["transforms"],
        source=asked["from_"],
        defines=asked["defines"],
        offset_um=offset,
        side=Side(asked["side"]) if asked["side"] else None,
        layer_sides=sides_of(asked),
        layer_offsets=asked["layer_offsets"],
        clearance_um=asked["clearance_um"] or 0.0,
        clearance_on=asked["clearance_on"],
        corner_um=asked["corner_um"] or 0.0,
        sharp=asked["convex"] == "sharp",
        trim=asked["on_interference"] == "trim",
        starts_um=asked["starts_um"],
        lead_um=asked["lead_um"],
        stop_um=asked["stop_um"] or 0.0,
        overcut_um=asked["overcut_um"] or 0.0,
        order=Order(asked["order"]) if asked["order"] else None,
        reverse=asked["reverse"],
        count=asked["count"],
        feed_um=asked.get("feed_um"),
        arithmetic=asked["arithmetic"],
        strict=asked.get("strict", False),
        cuts=asked["cuts"],
        from_block=asked["from_block"] or 0,
        backwards=asked["backwards"],
        d=asked.get("d", ()),
        wishes=wishes_of(asked),
        **read,
    )


#: Fields that an option of another name fills in.
_FILLS = {
    "wire_um": "offset_um",
    "gap_um": "offset_um",
    "convex": "sharp",
    "from_": "source",
    "on_interference": "trim",
}


def wishes_of(asked: dict[str, Any]) -> frozenset[str] | None:
    """Return the fields of `Options` that were typed, and wire_um and gap_um where these were.

    None where it is not known what was typed.
    """
    typed: frozenset[str] | None = asked.get("wishes")
    return None if typed is None else typed | {_FILLS.get(name, name) for name in typed}


def feed_of(asked: dict[str, Any]) -> float | None:
    """Return ``--feed`` in um a minute."""
    feed: float | None = asked["feed_um"]
    return feed


def machine_of(profile: str | None, to: str | None) -> Machine:
    """Return the machine of ``--profile`` (a built-in name or a TOML file) and ``--to``.

    Raises:
        WrongUse: no such profile, or one of another format.
    """
    from wedmcam import api, machines
    from wedmcam.cli.files import Failed, read_input
    from wedmcam.cli.terminal import print_findings
    from wedmcam.options import WrongUse

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
    machine, found = machines.of_file(text, profile)
    print_findings(found, profile, texts={profile: text})
    if machine is None:
        raise WrongUse(f"{profile}: this profile cannot be used")
    return api.machine_for(to, machine)


def profile_in(asked: dict[str, Any], typed: set[str]) -> str | None:
    """Return the profile of the program that is read: ``--profile-in``, else ``--profile``.

    Raises:
        WrongUse: two are given for one program.
    """
    from wedmcam.options import WrongUse

    named: str | None = asked.pop("profile_in")
    profile: str | None = asked["profile"]
    if {"profile", "profile_in"} <= typed and named != profile:
        raise WrongUse("--profile and --profile-in name two profiles of one program: give one")
    return profile if named is None or "profile" in typed else named


#: Options of which the certificate says more than whether they were given.
_ISSUED = {
    "sharp": ("convex", {True: "sharp"}),
    "source": ("from_", None),
    "trim": ("on_interference", {True: "trim"}),
}


def as_issued(
    asked: dict[str, Any], certificate: dict[str, Any], typed: set[str]
) -> dict[str, Any]:
    """Return what was asked for, with the certificate's options where nothing was typed.

    Raises:
        WrongUse: options that this version does not know.
    """
    from wedmcam.options import Options

    data: dict[str, Any] = certificate.get("options", {})
    issued = Options.from_data(data)  # says what is wrong with them
    made = dict(asked)
    if {"offset_um", "wire_um", "gap_um"} & typed:
        typed = typed | {"offset_um"}
    if asked["side"] == "on":
        typed = typed | {"offset_um"}
    for field in data:
        name, words = _ISSUED.get(field, (field, None))
        if name not in typed and name != "strict":
            value = getattr(issued, field)
            made[name] = words[value] if words else value
    return made


def check_source(name: str, from_: str | None) -> None:
    """Refuse sources of a format that is not read.

    Raises:
        WrongUse: with what can be read.
    """
    from wedmcam.options import FORMAT_OF_SUFFIX, SOURCE_FORMATS, WrongUse

    if from_ is not None and from_ not in SOURCE_FORMATS:
        raise WrongUse(f"no source format is called '{from_}': {', '.join(SOURCE_FORMATS)}")
    if from_ is None and Path(name).suffix.lower() in FORMAT_OF_SUFFIX:
        raise WrongUse(f"{name} is a program: see wedmcam verify, dump and plot")


def format_of(output: str, to: str | None, profile: Machine | None = None) -> str | None:
    """Return the format of an output from ``--to`` or its name.

    Raises:
        WrongUse: neither says.
    """
    from wedmcam.options import FORMAT_OF_SUFFIX, PROGRAM_FORMATS, WrongUse

    if to is not None:
        if to not in PROGRAM_FORMATS:
            raise WrongUse(f"no program format is called '{to}': {', '.join(PROGRAM_FORMATS)}")
        return to
    if profile is not None:
        return profile.format
    found = FORMAT_OF_SUFFIX.get(Path(output).suffix.lower())
    if found is None:
        known = ", ".join(FORMAT_OF_SUFFIX)
        raise WrongUse(f"the name {output} does not tell the format ({known}): give --to")
    return found


def warn_of_idle(names: Set[str], why: str) -> None:
    """Say which of the options of some parameters were typed and have no effect."""
    context = click.get_current_context()
    for option in context.command.params:
        typed = context.get_parameter_source(str(option.name)) is ParameterSource.COMMANDLINE
        if option.name in names and typed:
            print_text(f"warning: {option.opts[0]} has no effect: {why}", err=True)


def warn_of_name(output: str, format_: str) -> None:
    """Say so when the name of an output tells another format than is written."""
    from wedmcam.options import FORMAT_OF_SUFFIX

    named = FORMAT_OF_SUFFIX.get(Path(output).suffix.lower())
    if named is not None and named != format_:
        print_text(f"warning: the name {output} says {named}, but {format_} is written", err=True)
