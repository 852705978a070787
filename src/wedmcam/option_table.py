"""What a user can ask for: one table, a row for each option.

The options of the command line, the keys of a ``wedmcam.toml``, the keywords of the library, the
options of a certificate and the checks of their values all follow from these rows, and the groups
of `options.Options` take their defaults from them: what is to be known of an option stands here and
nowhere else. In the order in which help lists them. Plain data: every command fetches it.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from dataclasses import fields
from typing import Any, NamedTuple

from wedmcam.ranges import PLACE, Range

#: No whole number that is asked for is larger.
LARGEST = 10**12


class Kind(enum.Enum):
    """What a value is: as a field of a group, and as it is written in a certificate."""

    LENGTH = "a length, um; or None"
    FLAG = "true or false"
    WHOLE = "a whole number"
    WORD = "text, or None"
    CHOICE = "a word of an enumeration, or None"
    UNIT = "a unit or a length with one, or None"
    TEXTS = "texts"
    POINTS = "places, um"
    NUMBERS = "the first and the last of some numbers, or None"
    OFFSETS = "numbers, each with a length, um"
    LAYER_WORDS = "names of layers, each with a word of an enumeration"
    LAYER_LENGTHS = "names of layers, each with a length, um"


class Panel(enum.Enum):
    """Options that commands take together."""

    DRAWING = "how a drawing is read"
    PATH = "where the wire runs"
    PROGRAM = "what a program leaves open"
    OPERATOR = "what the operator enters"
    OUTPUT = "what is said"


class Row(NamedTuple):
    """One option.

    Attributes:
        name: of the field, and of the option in certificates, which were issued with it: um, where
            it is a length.
        group: field of `options.Options` that holds its group; empty for a field of `Options`
            itself, None for no field.
        kind: of the value.
        usual: the value where nothing is asked for.
        option: as it is typed; without its dashes it is the key in a ``wedmcam.toml``.
        panel: with which others commands take it; None where no command does.
        help: of the option, as a sentence.
        takes: the range of a length.
        words: what a word can be; for a flag that is typed as a word what stands for false, true.
        metavar: what help calls the value, where the kind does not tell.
        parameter: name of the value in a command, where it is not ``name``.
        also: another spelling of the option.
        fills: the field that it helps to state, where it is none itself.
        folds: the case of a word does not count.
        unoffered: why no command takes it.
    """

    name: str
    kind: Kind
    group: str | None = ""
    usual: Any = None
    option: str = ""
    panel: Panel | None = None
    help: str | None = None
    takes: Range = PLACE
    words: tuple[str, ...] = ()
    metavar: str | None = None
    parameter: str = ""
    also: str = ""
    fills: str = ""
    folds: bool = False
    unoffered: str = ""

    @property
    def param(self) -> str:
        """The name of its value in a command."""
        return self.parameter or self.name

    @property
    def keyword(self) -> str:
        """The name of its value in the library, where lengths are mm."""
        in_mm = self.kind in (Kind.LENGTH, Kind.POINTS)
        return self.name.removesuffix("_um") if in_mm else self.name

    @property
    def typed(self) -> str:
        """The option as a message names it; by its keyword where no command takes it."""
        return self.option or self.keyword


_TAKE = "Take only"
_LEAVE = "Leave out"
_TYPE = "entities of this DXF type, such as HATCH; repeat."
_LINETYPE = "what is drawn in this line type, such as CENTER; repeat."
_COLOUR = "what is drawn in this colour: red to white, 1 to 255, #rrggbb; repeat."

_ROWS = (
    # --- of a drawing ----------------------------------------------------------------------------
    Row(
        name="source",
        group="drawing",
        kind=Kind.WORD,
        option="--from",
        parameter="from_",
        panel=Panel.DRAWING,
        metavar="FORMAT",
        help="Format of the input: dxf or wed.",
    ),
    Row(
        name="units",
        group="drawing",
        kind=Kind.WORD,
        option="--units",
        panel=Panel.DRAWING,
        words=("mm", "um", "inch"),
        help="Unit of the drawing, whatever it says itself.",
    ),
    Row(
        name="fill_in_units",
        group="drawing",
        kind=Kind.FLAG,
        usual=False,
        unoffered="batch, and a wedmcam.toml, state units that are weaker than a drawing's own",
    ),
    Row(
        name="layers",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--layer",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_TAKE} this layer; repeat.",
    ),
    Row(
        name="ignore_layers",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--ignore-layer",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_LEAVE} this layer; repeat.",
    ),
    Row(
        name="types",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--type",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_TAKE} {_TYPE}",
    ),
    Row(
        name="ignore_types",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--ignore-type",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_LEAVE} {_TYPE}",
    ),
    Row(
        name="linetypes",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--linetype",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_TAKE} {_LINETYPE}",
    ),
    Row(
        name="ignore_linetypes",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--ignore-linetype",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_LEAVE} {_LINETYPE}",
    ),
    Row(
        name="colours",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--colour",
        also="--color",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_TAKE} {_COLOUR}",
    ),
    Row(
        name="ignore_colours",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--ignore-colour",
        also="--ignore-color",
        panel=Panel.DRAWING,
        metavar="NAME",
        help=f"{_LEAVE} {_COLOUR}",
    ),
    Row(
        name="join_um",
        group="drawing",
        kind=Kind.LENGTH,
        usual=10.0,
        option="--join",
        panel=Panel.DRAWING,
        takes=Range(0.0),
        help="Largest gap closed.",
    ),
    Row(
        name="tolerance_um",
        group="drawing",
        kind=Kind.LENGTH,
        usual=1.0,
        option="--tolerance",
        panel=Panel.DRAWING,
        # Below a nanometre no arcs follow a spline: that is said of the drawing (`coarse-spline`).
        takes=Range(1e-6, 10_000.0),
        help="Between a spline or an ellipse and its arcs.",
    ),
    Row(
        name="thin_wall_um",
        group="cutting",
        kind=Kind.LENGTH,
        usual=50.0,
        option="--thin-wall",
        panel=Panel.DRAWING,
        takes=Range(0.0),
        help="Kept material thinner than this is warned of; 0 for none.",
    ),
    Row(
        name="transforms",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="--transform",
        panel=Panel.DRAWING,
        metavar="TEXT",
        help="Such as 'rotate 10 copies 35 about (0, 0)', lengths in mm; repeat, in order.",
    ),
    Row(
        name="defines",
        group="drawing",
        kind=Kind.TEXTS,
        usual=(),
        option="-D",
        panel=Panel.DRAWING,
        metavar="NAME=VALUE",
        help="Set a let of a .wed program from outside; repeat.",
    ),
    Row(
        name="arithmetic",
        kind=Kind.WORD,
        usual="decimal8",
        option="--arithmetic",
        panel=Panel.DRAWING,
        words=("decimal8", "float64"),
        help="In what figures are computed: 8-digit decimals, as the ZD-065 does, or float64 to "
        "compare.",
    ),
    # --- where the wire runs ---------------------------------------------------------------------
    Row(
        name="offset_um",
        group="cutting",
        kind=Kind.LENGTH,
        option="--offset",
        panel=Panel.PATH,
        takes=Range(0.0),
        help="Outline to wire centre.",
    ),
    Row(
        name="wire_um",
        group=None,
        kind=Kind.LENGTH,
        fills="offset_um",
        option="--wire",
        panel=Panel.PATH,
        takes=Range(0.001),
        help="Wire diameter (with --gap).",
    ),
    Row(
        name="gap_um",
        group=None,
        kind=Kind.LENGTH,
        fills="offset_um",
        option="--gap",
        panel=Panel.PATH,
        takes=Range(0.0),
        help="Spark gap: offset = wire / 2 + gap.",
    ),
    Row(
        name="side",
        group="cutting",
        kind=Kind.CHOICE,
        option="--side",
        panel=Panel.PATH,
        words=("part", "die", "left", "right", "on"),
        help="part keeps the material inside outer contours (default with an offset), die the "
        "reverse; on runs on the line.",
    ),
    Row(
        name="layer_sides",
        group="cutting",
        kind=Kind.LAYER_WORDS,
        usual=(),
        option="--layer-side",
        panel=Panel.PATH,
        words=("part", "die", "left", "right", "on"),
        metavar="NAME=SIDE",
        help="Side of the contours of a layer, such as DIE=die; repeat.",
    ),
    Row(
        name="layer_offsets",
        group="cutting",
        kind=Kind.LAYER_LENGTHS,
        usual=(),
        option="--layer-offset",
        panel=Panel.PATH,
        takes=Range(0.0),
        metavar="NAME=LENGTH",
        help="Offset of the contours of a layer; repeat.",
    ),
    Row(
        name="clearance_um",
        group="cutting",
        kind=Kind.LENGTH,
        usual=0.0,
        option="--clearance",
        panel=Panel.PATH,
        takes=Range(0.0),
        help="Between punch and die on each side: offset = wire / 2 + gap - clearance.",
    ),
    Row(
        name="clearance_on",
        group="cutting",
        kind=Kind.WORD,
        usual="die",
        option="--clearance-on",
        panel=Panel.PATH,
        words=("die", "punch"),
        help="Who takes the clearance; a punch is what --side part cuts.",
    ),
    Row(
        name="corner_um",
        group="cutting",
        kind=Kind.LENGTH,
        usual=0.0,
        option="--corner",
        panel=Panel.PATH,
        takes=Range(0.0),
        help="Round the part's own corners; with --corners paper the radius of their arcs.",
    ),
    Row(
        name="paper",
        group="cutting",
        kind=Kind.FLAG,
        usual=False,
        option="--corners",
        parameter="corners",
        panel=Panel.PATH,
        words=("outer", "paper"),
        help="Arcs where the wire goes round; or as the ZD-065 has them, on every corner of the "
        "outline with a line, for punch and die alike.",
    ),
    Row(
        name="sharp",
        group="cutting",
        kind=Kind.FLAG,
        usual=False,
        option="--convex",
        parameter="convex",
        panel=Panel.PATH,
        words=("arc", "sharp"),
        help="At corners that the wire goes round.",
    ),
    Row(
        name="trim",
        group="cutting",
        kind=Kind.FLAG,
        usual=False,
        option="--on-interference",
        parameter="on_interference",
        panel=Panel.PATH,
        words=("error", "trim"),
        help="Where the wire does not fit.",
    ),
    Row(
        name="starts_um",
        group="leading",
        kind=Kind.POINTS,
        usual=(),
        option="--start",
        panel=Panel.PATH,
        help="A thread point, X,Y in mm.",
    ),
    Row(
        name="lead_um",
        group="leading",
        kind=Kind.LENGTH,
        usual=1000.0,
        option="--lead",
        panel=Panel.PATH,
        takes=Range(0.0),
        help="Lead without a start.",
    ),
    Row(
        name="stop_um",
        group="leading",
        kind=Kind.LENGTH,
        usual=0.0,
        option="--stop",
        panel=Panel.PATH,
        takes=Range(1.0, none=True),  # no step is shorter than 1 um
        help="Pause so far before the end.",
    ),
    Row(
        name="overcut_um",
        group="leading",
        kind=Kind.LENGTH,
        usual=0.0,
        option="--overcut",
        panel=Panel.PATH,
        takes=Range(1.0, none=True),
        help="Cut so far past the start.",
    ),
    Row(
        name="order",
        group="leading",
        kind=Kind.CHOICE,
        option="--order",
        panel=Panel.PATH,
        words=("given", "inner-first", "nearest"),
    ),
    Row(
        name="reverse",
        group="leading",
        kind=Kind.FLAG,
        usual=False,
        option="--reverse",
        panel=Panel.PATH,
        help="Clockwise instead of counter-clockwise; cuts of a .wed each the other way.",
    ),
    Row(
        name="cuts",
        group="portion",
        kind=Kind.NUMBERS,
        option="--cuts",
        panel=Panel.PATH,
        metavar="A-B",
        help="Only contours A to B of the program, in its order.",
    ),
    Row(
        name="blocks",
        group="portion",
        kind=Kind.NUMBERS,
        option="--blocks",
        panel=Panel.PATH,
        metavar="A-B",
        help="Only blocks A to B of the program: a load that begins or ends in the kerf.",
    ),
    Row(
        name="from_block",
        group="portion",
        kind=Kind.WHOLE,
        usual=0,
        option="--from-block",
        panel=Panel.PATH,
        metavar="N",
        help="After a broken wire: only from block N of the program on, threaded there.",
    ),
    Row(
        name="backwards",
        group="portion",
        kind=Kind.FLAG,
        usual=False,
        option="--backwards",
        panel=Panel.PATH,
        help="With --from-block: the rest of its contour from the thread point back to there.",
    ),
    Row(
        name="count",
        group="judging",
        kind=Kind.WORD,
        option="--count",
        panel=Panel.PATH,
        words=("exact", "textbook"),
        help="How J is found.",
    ),
    # --- beside a program ------------------------------------------------------------------------
    Row(
        name="d",
        group="operator",
        kind=Kind.OFFSETS,
        usual=(),
        option="--d",
        panel=Panel.OPERATOR,
        metavar="N=LENGTH",
        help="Of an ISO program with G41 or G42: the offset entered at the controller for D "
        "number N; repeat.",
    ),
    Row(
        name="feed_um",
        group="operator",
        kind=Kind.LENGTH,
        option="--feed",
        panel=Panel.OPERATOR,
        takes=Range(0.001),
        help="Cutting speed, a length a minute: tells the time; F of profiles that write one.",
    ),
    Row(
        name="units_in",
        group="program",
        kind=Kind.WORD,
        option="--units-in",
        panel=Panel.PROGRAM,
        words=("mm", "um", "inch"),
        help="unit of numbers with a point where no G20 or G21 stands.",
    ),
    Row(
        name="whole_in",
        group="program",
        kind=Kind.UNIT,
        option="--whole-in",
        panel=Panel.PROGRAM,
        words=("um", "mm", "inch"),
        metavar="um|mm|inch|LENGTH",
        help="what 1 is in a number without a point; or a length such as 10um.",
    ),
    Row(
        name="coordinates_in",
        group="program",
        kind=Kind.WORD,
        option="--coordinates-in",
        panel=Panel.PROGRAM,
        words=("absolute", "incremental"),
        help="what holds before the first G90 or G91.",
    ),
    Row(
        name="centres_in",
        group="program",
        kind=Kind.WORD,
        option="--centres-in",
        panel=Panel.PROGRAM,
        words=("start", "absolute", "to-start"),
        help="I and J lead from the start to the centre, are its place, or lead to the start.",
    ),
    Row(
        name="semicolon_in",
        group="program",
        kind=Kind.WORD,
        option="--semicolon-in",
        panel=Panel.PROGRAM,
        words=("block", "comment"),
        help="what stands behind a semicolon.",
    ),
    Row(
        name="subprograms_in",
        group="program",
        kind=Kind.WORD,
        option="--subprograms-in",
        panel=Panel.PROGRAM,
        words=("N-label", "O-number", "none"),
        folds=True,
        help="M98 P0001 runs from the line N0001, or O0001, to M99.",
    ),
    Row(
        name="strict",
        group="judging",
        kind=Kind.FLAG,
        usual=False,
        option="--strict",
        panel=Panel.OUTPUT,
        help="Warnings are errors.",
    ),
    Row(
        name="within_um",
        group=None,
        kind=Kind.LENGTH,
        takes=Range(0.0),
        unoffered="diff has an option of its own",
    ),
)
#: Name -> row, in the order of help.
ROWS: dict[str, Row] = {row.name: row for row in _ROWS}


def usual(name: str) -> Any:
    """Return the value of a field where nothing is asked for."""
    return ROWS[name].usual


def option_of(name: str) -> str:
    """Return the option that states a field, as it is typed.

    >>> option_of("sharp"), option_of("ignore_layers")
    ('--convex', '--ignore-layer')
    """
    return ROWS[name].option


def rows_of(panel: Panel) -> list[Row]:
    """Return the options that commands take together, as help lists them."""
    return [row for row in _ROWS if row.panel is panel]


def field_rows() -> Iterator[Row]:
    """Yield the rows that are fields of the options."""
    return (row for row in _ROWS if row.group is not None)


def check_kinds(group: Any) -> None:
    """Refuse values of a group that are of another kind, or out of their range, whoever says them.

    Raises:
        WrongUse: it names the option, and what it takes.
    """
    for field in fields(group):
        row = ROWS.get(field.name)
        if row is not None and (takes := _takes(row, getattr(group, field.name))):
            from wedmcam.diag.run import WrongUse

            raise WrongUse(takes)


def _takes(row: Row, value: Any) -> str:
    """Return why a value cannot be that of an option; empty where it can."""
    name = row.typed
    if row.kind is Kind.LENGTH:
        if not row.takes.holds(value) and not (value is None and row.usual is None):
            return f"{name} takes a length, {row.takes}, not {value!r} um"
    elif row.kind is Kind.FLAG:
        if not isinstance(value, bool):
            return f"{name} takes true or false, not {value!r}"
    elif row.kind is Kind.WHOLE:
        if type(value) is not int or abs(value) > LARGEST:
            return f"{name} takes a whole number, not {value!r:.40}"
    elif row.kind is Kind.TEXTS:
        if isinstance(value, str) or not all(isinstance(v, str) for v in value):
            return f"{name} takes a list of texts, not {value!r}"
    elif row.kind is Kind.WORD:
        if not isinstance(value, str | None):
            return f"{name} takes text, not {value!r}"
    elif row.kind is Kind.NUMBERS:
        if value is not None and [type(n) for n in value] != [int, int]:
            return f"{row.option} takes the first and the last contour, not {value!r:.40}"
    elif row.kind is Kind.POINTS:
        if not all(row.takes.holds(v) for point in value for v in point):
            return f"{row.option} takes coordinates of {row.takes}, not {value!r} um"
    elif row.kind is Kind.OFFSETS:
        if not all(row.takes.holds(um) for _, um in value):
            return f"{row.option} takes lengths of {row.takes}, not {value!r} um"
    elif row.kind is Kind.LAYER_LENGTHS and not all(row.takes.holds(um) for _, um in value):
        return f"{row.option} takes lengths of {row.takes}, not {value!r}"
    return ""
