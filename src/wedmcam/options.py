"""What a user can ask of a compile, as one value: the same for the command line and the library.

Lengths are um here; the command line and `wedmcam.compile` take mm. The certificate carries these
options, so that ``verify --against`` can repeat them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

from wedmcam.diag import option_texts
from wedmcam.ir.colours import colour_of
from wedmcam.ir.plan import Order, Side
from wedmcam.ranges import LENGTHS, PLACE

#: File name endings of programs, and the format each means; the first of a format is written.
FORMAT_OF_SUFFIX = {
    ".3b": "3b",
    ".zd": "compact",
    ".zdr": "rotation",
    ".zdc": "compensation",
    ".nc": "iso",
    ".4b": "4b",
    ".ngc": "iso",
    ".gcode": "iso",
    ".iso": "iso",
    ".eia": "iso",
}
SUFFIX_OF_FORMAT: dict[str, str] = {}
for _ending, _format in FORMAT_OF_SUFFIX.items():
    SUFFIX_OF_FORMAT.setdefault(_format, _ending)
PROGRAM_FORMATS = ("3b", "compact", "rotation", "compensation", "iso", "4b")
SOURCE_FORMATS = ("dxf", "wed")
ARITHMETICS = ("decimal8", "float64")
#: What can be said of a program that is read, beside its profile -> the answers; a unit is "um",
#: "mm", "inch" or a length.
READING: dict[str, tuple[str, ...]] = {
    "units_in": ("mm", "um", "inch"),
    "whole_in": ("um", "mm", "inch"),
    "coordinates_in": ("absolute", "incremental"),
    "centres_in": ("start", "absolute", "to-start"),
    "semicolon_in": ("block", "comment"),
    "subprograms_in": ("N-label", "O-number", "none"),
}
#: Sides that need an offset.
SIDED = (Side.PART, Side.DIE, Side.LEFT, Side.RIGHT)
#: Who can take a clearance -> the side on which it is cut.
CLEARANCE_ON = {"die": Side.DIE, "punch": Side.PART}
#: Fields that say what of a drawing is taken and left out.
FILTERS = (
    "layers",
    "ignore_layers",
    "types",
    "ignore_types",
    "linetypes",
    "ignore_linetypes",
    "colours",
    "ignore_colours",
)
#: Fields that are lists of texts.
_TEXTS = frozenset({*FILTERS, "transforms", "defines"})
#: No whole number that is asked for is larger.
LARGEST = 10**12
#: Fields that are a word, or None.
_WORDS = frozenset({"source", "count", "units", "arithmetic", "clearance_on"})
_UNIT = re.compile(r"\s*(\d+\.?\d*|\.\d+)?\s*(um|mm|inch|in)\s*")


class WrongUse(Exception):  # noqa: N818 - a kind of stop, not of error
    """Options that do not fit together or to the input: exit status 2."""


def check_reading(said: Mapping[str, str | None]) -> None:
    """Refuse what is said of a program that is read, where it is no answer.

    Raises:
        WrongUse: an unknown keyword or value.
    """
    for name, value in said.items():
        answers = READING.get(name)
        if answers is None:
            raise WrongUse(f"there is no '{name}': {', '.join(READING)}")
        if value is None or value in answers:
            continue
        option = f"--{name.replace('_', '-')}"
        if name != "whole_in":
            raise WrongUse(f"{option} takes {' or '.join(answers)}, not '{value}'")
        try:
            nm_of(str(value))
        except ValueError as why:
            raise WrongUse(f"{option} {why}") from None


def nm_of(unit: str) -> int:
    """Return a unit, or a length with one, in nanometres.

    >>> nm_of("um"), nm_of("10um"), nm_of("0.0001in")
    (1000, 10000, 2540)

    Raises:
        ValueError: it is none, or no whole number of nanometres up to a metre.
    """
    from fractions import Fraction

    if len(unit) <= 40 and (found := _UNIT.fullmatch(unit)):
        nm = Fraction(found[1] or 1) * {"um": 1000, "mm": 10**6}.get(found[2], 25_400_000)
        if nm.denominator == 1 and 0 < nm <= 10**9:
            return int(nm)
    raise ValueError(f"takes um, mm, inch, or a length such as 10um or 0.0001in, not '{unit}'")


@dataclass(frozen=True, slots=True)
class Options:
    """How to compile. Lengths in um.

    Attributes:
        units: "mm", "um" or "inch" whatever the drawing says; None to take its own.
        fill_in_units: ``units`` only where the drawing says none (batch, ruling 7).
        layers: layers to take, names or wildcards; empty for all.
        ignore_layers: likewise to leave out.
        types, ignore_types: likewise DXF entity types.
        linetypes, ignore_linetypes: likewise line types, as they are seen.
        colours, ignore_colours: colours to take and to leave out; see ``ir.colours``.
        join_um: the largest gap closed between entities.
        transforms: figure transforms in the words of the part language, in their order.
        tolerance_um: how far arcs may lie from a spline or an ellipse.
        thin_wall_um: kept material thinner than this is a warning; 0 for none.
        offset_um: from the outline to the wire's centre; None where none was given.
        side: None for ``part`` with an offset and ``on`` without.
        layer_sides: name or wildcard of a layer, and the side of its contours.
        layer_offsets: likewise, and wire / 2 + gap of its contours.
        clearance_um: what punch and die leave between them on each side; whoever takes it is cut
            that much nearer to its outline, and behind it where that is more than the offset.
        clearance_on: who takes it, "die" or "punch".
        corner_um: radius rounded onto the part's own corners; 0 for none.
        sharp: at a corner that the wire goes round the offset lines are prolonged to meet.
        trim: leave out what the wire cannot reach instead of refusing.
        starts_um: thread points, drawing coordinates.
        lead_um: length of a lead where no thread point is given.
        stop_um: how far before its end each closed path pauses; 0 for no pause.
        overcut_um: how far past its start each closed path is cut.
        order: see `Order`; None for inner-first.
        reverse: clockwise instead of counter-clockwise; cuts of a part program the other way than
            it says.
        count: "exact", "textbook", or None for what the profile says.
        strict: warnings are errors.
        cuts: only these contours of the program, first and last, 1-based; None for all.
        from_block: only the rest of the program from this block on, 1-based; 0 for all of it.
        backwards: the rest of the contour of ``from_block`` from its end back to that block.
        d: offsets of a controller that compensates itself (G41, G42): D number and um.
        arithmetic: "decimal8", in which the ZD-065 computes, or "float64": in what formulas run.
        feed_um: cutting speed, um a minute: F of a program whose profile writes one, and the time.
        units_in: of an ISO program that is verified: what a number with a point is where no G20 or
            G21 stands, "mm", "um" or "inch"; None where it is not given.
        whole_in: what 1 is in a number without a point: "um", "mm", "inch", or a length ("10um").
        coordinates_in: "absolute" or "incremental", before the first G90 or G91.
        centres_in: "start" (I and J lead from the start to the centre), "absolute" (they are its
            place) or "to-start" (they lead from the centre to the start).
        semicolon_in: what stands behind a semicolon, a "block" or a "comment".
        subprograms_in: what M98 runs: from an "N-label" to M99, an "O-number", or "none".
        wishes: names of the fields that were asked for with this source in mind (typed; wire_um
            and gap_um beside offset_um where they state it), in contrast to the defaults of a
            shop; None where whatever is not the usual counts as a wish. They change no program: a
            wish without effect is said.
    """

    units: str | None = None
    fill_in_units: bool = False
    layers: tuple[str, ...] = ()
    ignore_layers: tuple[str, ...] = ()
    types: tuple[str, ...] = ()
    ignore_types: tuple[str, ...] = ()
    linetypes: tuple[str, ...] = ()
    ignore_linetypes: tuple[str, ...] = ()
    colours: tuple[str, ...] = ()
    ignore_colours: tuple[str, ...] = ()
    join_um: float = 10.0
    tolerance_um: float = 1.0
    thin_wall_um: float = 50.0
    transforms: tuple[str, ...] = ()
    offset_um: float | None = None
    side: Side | None = None
    layer_sides: tuple[tuple[str, Side], ...] = ()
    layer_offsets: tuple[tuple[str, float], ...] = ()
    clearance_um: float = 0.0
    clearance_on: str = "die"
    corner_um: float = 0.0
    sharp: bool = False
    trim: bool = False
    starts_um: tuple[tuple[float, float], ...] = ()
    lead_um: float = 1000.0
    stop_um: float = 0.0
    overcut_um: float = 0.0
    order: Order | None = None
    reverse: bool = False
    count: str | None = None
    strict: bool = False
    source: str | None = None
    defines: tuple[str, ...] = ()
    arithmetic: str = "decimal8"
    cuts: tuple[int, int] | None = None
    from_block: int = 0
    backwards: bool = False
    d: tuple[tuple[int, float], ...] = ()
    feed_um: float | None = None
    units_in: str | None = None
    whole_in: str | None = None
    coordinates_in: str | None = None
    centres_in: str | None = None
    semicolon_in: str | None = None
    subprograms_in: str | None = None
    wishes: frozenset[str] | None = None

    def __post_init__(self) -> None:
        self._check_kinds()
        check_reading(self.reading)
        if self.units not in (None, "mm", "um", "inch"):
            raise WrongUse(f"no unit is called '{self.units}': mm, um or inch")
        for name in ("colours", "ignore_colours"):
            for text in getattr(self, name):
                try:
                    colour_of(text)
                except ValueError as why:
                    raise WrongUse(f"--{name.replace('_', '-')[:-1]}: {why}") from None
        if self.count not in (None, "exact", "textbook"):
            raise WrongUse(f"no way of counting is called '{self.count}': exact or textbook")
        if self.arithmetic not in ARITHMETICS:
            raise WrongUse(
                f"no arithmetic is called '{self.arithmetic}': {' or '.join(ARITHMETICS)}"
            )
        if self.cuts is not None and not 1 <= self.cuts[0] <= self.cuts[1]:
            raise WrongUse("--cuts takes the first and the last contour, such as 2-5")
        if self.backwards and not self.from_block:
            raise WrongUse("--backwards goes with --from-block N: back to where that block starts")
        offset = self.offset_um or 0.0
        if self.side in SIDED and not offset:
            raise WrongUse(f"--side {self.side} needs an offset (--offset, or --wire and --gap)")
        if self.side is Side.ON and offset and not self.layer_sides:
            raise WrongUse("--side on runs on the line: it takes no offset")
        self._check_layers()
        if self.clearance_on not in CLEARANCE_ON:
            raise WrongUse(f"--clearance-on takes die or punch, not '{self.clearance_on}'")
        asked = self._asked_sides()
        takes = CLEARANCE_ON[self.clearance_on]
        if (
            self.wished("clearance_um")
            and self.clearance_um
            and not any(s is takes and o for s, o in asked)
        ):
            raise WrongUse(
                f"--clearance is taken by the {self.clearance_on}, and nothing is cut as one: "
                f"--side {takes}, --layer-side NAME={takes}, or --clearance-on "
                f"{'punch' if self.clearance_on == 'die' else 'die'}"
            )
        least = min((o - self.taken_um(s) for s, o in asked if s in SIDED), default=0.0)
        if 0 < self.corner_um < least:
            raise WrongUse(
                f"--corner {self.corner_um / 1000:.3f} mm is below the offset "
                f"{least / 1000:.3f} mm: the wire could not follow it"
            )

    def _check_kinds(self) -> None:
        """Refuse a value of another kind, or out of its range, whoever says it.

        Raises:
            WrongUse: it names the option, and what it takes.
        """
        for field in fields(self):
            name, value = field.name, getattr(self, field.name)
            option = f"--{name.removesuffix('_um').replace('_', '-')}"
            if name in LENGTHS:
                takes = LENGTHS[name]
                if not takes.holds(value) and not (value is None and field.default is None):
                    raise WrongUse(f"{option} takes a length, {takes}, not {value!r} um")
            elif isinstance(field.default, bool):
                if not isinstance(value, bool):
                    raise WrongUse(f"{option} takes true or false, not {value!r}")
            elif isinstance(field.default, int):
                if type(value) is not int or abs(value) > LARGEST:
                    raise WrongUse(f"{option} takes a whole number, not {value!r:.40}")
            elif name in _TEXTS:
                if isinstance(value, str) or not all(isinstance(v, str) for v in value):
                    raise WrongUse(f"{option} takes a list of texts, not {value!r}")
            elif name in _WORDS and not isinstance(value, str | None):
                raise WrongUse(f"{option} takes text, not {value!r}")
        if self.cuts is not None and [type(n) for n in self.cuts] != [int, int]:
            raise WrongUse(f"--cuts takes the first and the last contour, not {self.cuts!r:.40}")
        if not all(PLACE.holds(v) for point in self.starts_um for v in point):
            raise WrongUse(f"--start takes coordinates of {PLACE}, not {self.starts_um!r} um")
        if not all(PLACE.holds(um) for _, um in self.d):
            raise WrongUse(f"--d takes lengths of {PLACE}, not {self.d!r} um")
        takes = LENGTHS["offset_um"]
        if not all(takes.holds(um) for _, um in self.layer_offsets):
            raise WrongUse(f"--layer-offset takes lengths of {takes}, not {self.layer_offsets!r}")

    def _check_layers(self) -> None:
        """Refuse sides and offsets of layers that do not fit together."""
        for option, said in (("side", self.layer_sides), ("offset", self.layer_offsets)):
            names = [name.casefold() for name, _ in said]
            for name in names:
                if not name or names.count(name) > 1:
                    what = "is said twice" if name else "names no layer"
                    raise WrongUse(f"--layer-{option} {name}: {what}")
        offsets = {name.casefold(): um for name, um in self.layer_offsets}
        for name, um in self.layer_offsets:
            if um <= 0:
                raise WrongUse(f"--layer-offset {name} must be above 0: the side says which way")
        for name, side in self.layer_sides:
            own = offsets.get(name.casefold())
            if side in SIDED and not (own or self.offset_um):
                raise WrongUse(f"--layer-side {name}={side} needs an offset")
            if side is Side.ON and own:
                raise WrongUse(f"--layer-side {name}=on runs on the line: it takes no offset")

    def _asked_sides(self) -> list[tuple[Side, float]]:
        """Return every side that is asked for, with its offset."""
        every = self.offset_um or 0.0
        sides = {name.casefold(): side for name, side in self.layer_sides}
        offsets = {name.casefold(): um for name, um in self.layer_offsets}
        return [
            (self.effective_side, every),
            *((side, offsets.get(name, every)) for name, side in sides.items()),
            *((sides.get(name, self.side or Side.PART), um) for name, um in offsets.items()),
        ]

    def taken_um(self, side: Side) -> float:
        """Return by how much less than wire / 2 + gap the wire keeps from outlines of a side."""
        return self.clearance_um if side is CLEARANCE_ON[self.clearance_on] else 0.0

    def wished(self, name: str) -> bool:
        """Return whether a field was asked for; a default of a shop is no wish."""
        if self.wishes is not None:
            return name in self.wishes
        usual = {f.name: f.default for f in fields(self)}[name]
        return bool(getattr(self, name) != usual)

    @property
    def effective_side(self) -> Side:
        """The side in force."""
        if self.side is not None:
            return self.side
        return Side.PART if self.offset_um else Side.ON

    @property
    def reading(self) -> dict[str, str]:
        """What is said of a program that is read."""
        return {name: getattr(self, name) for name in READING if getattr(self, name) is not None}

    @property
    def texts(self) -> dict[str, str | bytes]:
        """What the options say in the part language, by the names that places of findings have."""
        return {
            **option_texts("--transform", self.transforms),
            **option_texts("-D", self.defines),
        }

    def as_data(self) -> dict[str, Any]:
        """Return the options as plain data for the certificate; defaults are left out."""
        data = asdict(self)
        del data["wishes"]  # of whoever typed them, not of the program
        kept = {
            f.name: data[f.name] for f in fields(self) if data.get(f.name, f.default) != f.default
        }
        if "layer_sides" in kept:
            kept["layer_sides"] = tuple((name, str(side)) for name, side in self.layer_sides)
        return {k: str(v) if isinstance(v, Side | Order) else v for k, v in kept.items()}

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Options:
        """Return the options of a certificate.

        Raises:
            WrongUse: an unknown key or value, or one of another type.
        """
        values = dict(data)
        try:
            if "wishes" in values:
                raise ValueError("wishes are of whoever types them")
            if "side" in values:
                values["side"] = Side(values["side"])
            if "order" in values:
                values["order"] = Order(values["order"])
            for name in _TEXTS & set(values):
                given = values[name]
                values[name] = given if isinstance(given, str) else tuple(given)
            for name, of in (("layer_sides", Side), ("layer_offsets", float)):
                if name in values:
                    values[name] = tuple((str(n), of(v)) for n, v in _pairs(values[name]))
            if values.get("cuts") is not None:
                values["cuts"] = tuple(values["cuts"])
            if "d" in values:
                values["d"] = tuple((int(n), float(um)) for n, um in values["d"])
            if "starts_um" in values:
                values["starts_um"] = tuple((float(x), float(y)) for x, y in values["starts_um"])
            return cls(**values)
        except (TypeError, ValueError, OverflowError) as why:
            raise WrongUse(f"these options cannot be read: {why}") from why


def _pairs(said: Any) -> Any:
    """Return pairs of a mapping, or of a list of them."""
    return said.items() if isinstance(said, Mapping) else said


def options_in_mm(**mm: Any) -> Options:
    """Return `Options` from keywords in mm: a length ``x`` stands for the field ``x_um``.

    >>> options_in_mm(offset=0.1, side="die", starts=[(1, 2)]).starts_um
    ((1000.0, 2000.0),)

    Raises:
        WrongUse: an unknown keyword or value.
    """
    values: dict[str, Any] = {}
    known = set(Options.__dataclass_fields__)
    for key, value in mm.items():
        if key == "starts":
            values["starts_um"] = [(1000.0 * x, 1000.0 * y) for x, y in value]
        elif key == "layer_offsets":
            pairs = value.items() if isinstance(value, Mapping) else value
            values[key] = [(layer, 1000.0 * mm) for layer, mm in pairs]
        elif f"{key}_um" in known:
            if value is not None and not isinstance(value, int | float):
                raise WrongUse(f"{key}={value!r} is no length in mm")
            values[f"{key}_um"] = None if value is None else 1000.0 * value
        else:
            values[key] = value
    return Options.from_data(values)
