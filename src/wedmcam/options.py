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

#: File name endings of programs, and the format each means.
FORMAT_OF_SUFFIX = {
    ".3b": "3b",
    ".zd": "compact",
    ".zdr": "rotation",
    ".zdc": "compensation",
    ".nc": "iso",
    ".4b": "4b",
}
SUFFIX_OF_FORMAT = {format_: ending for ending, format_ in FORMAT_OF_SUFFIX.items()}
PROGRAM_FORMATS = ("3b", "compact", "rotation", "compensation", "iso", "4b")
SOURCE_FORMATS = ("dxf", "wed")
ARITHMETICS = ("decimal8", "float64")
#: What can be said of a program that is read, beside its profile -> the answers; a unit is "um",
#: "mm", "inch" or a length.
READING: dict[str, tuple[str, ...]] = {
    "units_in": ("mm", "um", "inch"),
    "whole_in": ("um", "mm", "inch"),
    "coordinates_in": ("absolute", "incremental"),
    "centres_in": ("start", "absolute"),
    "semicolon_in": ("block", "comment"),
}
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

    if found := _UNIT.fullmatch(unit):
        nm = Fraction(found[1] or 1) * {"um": 1000, "mm": 10**6}.get(found[2], 25_400_000)
        if nm.denominator == 1 and 0 < nm <= 10**9:
            return int(nm)
    raise ValueError(f"takes um, mm, inch, or a length such as 10um or 0.0001in, not '{unit}'")


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
        offset_um: from the outline to the wire's centre; None where none was given.
        side: None for ``part`` with an offset and ``on`` without.
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
        units_in: of an ISO program that is verified: what a number with a point is where no G20 or
            G21 stands, "mm", "um" or "inch"; None where nobody says it.
        whole_in: what 1 is in a number without a point: "um", "mm", "inch", or a length ("10um").
        coordinates_in: "absolute" or "incremental", before the first G90 or G91.
        centres_in: "start" (I and J lead from the start to the centre) or "absolute" (they are its
            place).
        semicolon_in: what stands behind a semicolon, a "block" or a "comment".
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
    transforms: tuple[str, ...] = ()
    offset_um: float | None = None
    side: Side | None = None
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
    units_in: str | None = None
    whole_in: str | None = None
    coordinates_in: str | None = None
    centres_in: str | None = None
    semicolon_in: str | None = None
    wishes: frozenset[str] | None = None

    def __post_init__(self) -> None:
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
        if offset < 0:
            raise WrongUse("--offset must not be negative: --side says on which side it is")
        if self.side in (Side.PART, Side.DIE, Side.LEFT, Side.RIGHT) and not offset:
            raise WrongUse(f"--side {self.side} needs an offset (--offset, or --wire and --gap)")
        if self.side is Side.ON and offset:
            raise WrongUse("--side on runs on the line: it takes no offset")
        if 0 < self.corner_um < offset:
            raise WrongUse(
                f"--corner {self.corner_um / 1000:.3f} mm is below the offset "
                f"{offset / 1000:.3f} mm: the wire could not follow it"
            )
        for name in ("join_um", "corner_um", "lead_um", "stop_um", "overcut_um"):
            if getattr(self, name) < 0:
                raise WrongUse(f"--{name[:-3]} must not be negative")
        for name in ("stop_um", "overcut_um"):
            if 0 < getattr(self, name) < 1:
                raise WrongUse(f"--{name[:-3]} is 0 or 1 um at least: no step is shorter")

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
        return {k: str(v) if isinstance(v, Side | Order) else v for k, v in kept.items()}

    @classmethod
    def from_data(cls, data: dict[str, Any]) -> Options:
        """Return the options of a certificate.

        Raises:
            WrongUse: an unknown key or value.
        """
        values = dict(data)
        try:
            if "side" in values:
                values["side"] = Side(values["side"])
            if "order" in values:
                values["order"] = Order(values["order"])
            for name in (*FILTERS, "transforms", "defines"):
                if name in values:
                    values[name] = tuple(values[name])
            if values.get("cuts") is not None:
                first, last = values["cuts"]
                values["cuts"] = (int(first), int(last))
            if "d" in values:
                values["d"] = tuple((int(n), float(um)) for n, um in values["d"])
            if "starts_um" in values:
                values["starts_um"] = tuple((float(x), float(y)) for x, y in values["starts_um"])
            return cls(**values)
        except (TypeError, ValueError) as why:
            raise WrongUse(f"these options cannot be read: {why}") from why
