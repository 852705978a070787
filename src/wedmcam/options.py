"""What a user can ask of a compile, as one value: the same for the command line and the library.

Each stage takes the group that stands beside it; `Options` composes them. Which options there are
is said in `option_table`. Lengths are um here; the command line and `wedmcam.compile` take mm. The
certificate carries these options, so that ``verify --against`` can repeat them.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from wedmcam.diag import option_texts
from wedmcam.diag.run import WrongUse as WrongUse
from wedmcam.frontends.options import DrawingReading, ProgramReading
from wedmcam.ir.choices import Order, Side
from wedmcam.judge.options import Judging
from wedmcam.option_table import ROWS, Kind, Row, check_kinds, field_rows, option_of, usual
from wedmcam.targets.options import Operator
from wedmcam.transforms.plan.options import Cutting, Leading, Portion

#: In what formulas can run.
ARITHMETICS = ROWS["arithmetic"].words
#: The groups by the fields of `Options` that hold them, in the order in which they are checked.
GROUPS: dict[str, type] = {
    "program": ProgramReading,
    "drawing": DrawingReading,
    "judging": Judging,
    "portion": Portion,
    "cutting": Cutting,
    "leading": Leading,
    "operator": Operator,
}
#: Fields that are words of an enumeration.
CHOICES: dict[str, type[enum.StrEnum]] = {"side": Side, "layer_sides": Side, "order": Order}


@dataclass(frozen=True, slots=True)
class Options:
    """How to compile, and to prove.

    Attributes:
        drawing: what of a drawing is read.
        cutting: where the wire runs.
        leading: where it is threaded, how it comes to its path and leaves it.
        portion: which part of the program is cut.
        operator: what is entered at the controller.
        program: what a program that is read leaves open.
        judging: how strictly a program is judged.
        arithmetic: "decimal8", in which the ZD-065 computes, or "float64": in what formulas run.
        wishes: names of the fields that were asked for with this source in mind (typed; wire_um
            and gap_um beside offset_um where they state it), in contrast to the defaults of a
            shop; None where whatever is not the usual counts as a wish. They change no program: a
            wish without effect is said.
    """

    drawing: DrawingReading = field(default_factory=DrawingReading)
    cutting: Cutting = field(default_factory=Cutting)
    leading: Leading = field(default_factory=Leading)
    portion: Portion = field(default_factory=Portion)
    operator: Operator = field(default_factory=Operator)
    program: ProgramReading = field(default_factory=ProgramReading)
    judging: Judging = field(default_factory=Judging)
    arithmetic: str = usual("arithmetic")
    wishes: frozenset[str] | None = None

    def __post_init__(self) -> None:
        check_kinds(self)
        if self.arithmetic not in ARITHMETICS:
            raise WrongUse(
                f"no arithmetic is called '{self.arithmetic}': {' or '.join(ARITHMETICS)}"
            )

    @classmethod
    def of(cls, *, wishes: frozenset[str] | None = None, **values: Any) -> Options:
        """Return the options with these values of fields; the others are as usual.

        >>> Options.of(offset_um=100.0, strict=True).cutting.offset_um
        100.0

        Raises:
            TypeError: there is no such field.
            WrongUse: values that do not fit their field, or each other.
        """
        options = cls(wishes=wishes, **_grouped(values))
        options.cutting.check_offsets()
        if "clearance_um" in options.wished:
            options.cutting.check_clearance()  # a contour takes it that has an offset
        return options

    def with_values(self, **values: Any) -> Options:
        """Return these options with other values of some fields; the wishes stay."""
        parts = {
            name: replace(getattr(self, name), **own) if isinstance(own, dict) else own
            for name, own in _by_group(values).items()
        }
        return replace(self, **parts)

    def value(self, row: Row) -> Any:
        """Return the value of a field."""
        return getattr(getattr(self, row.group) if row.group else self, row.name)

    @property
    def wished(self) -> frozenset[str]:
        """Names of the fields that were asked for; a default of a shop is no wish."""
        if self.wishes is not None:
            return self.wishes
        return frozenset(row.name for row in field_rows() if self.value(row) != row.usual)

    @property
    def texts(self) -> dict[str, str | bytes]:
        """What the options say in the part language, by the names that places of findings have."""
        return {
            **option_texts(option_of("transforms"), self.drawing.transforms),
            **option_texts(option_of("defines"), self.drawing.defines),
        }

    def as_data(self) -> dict[str, Any]:
        """Return the options as plain data for the certificate; defaults are left out."""
        stated = [row for row in field_rows() if self.value(row) != row.usual]
        return {row.name: _plain(self.value(row), row) for row in stated}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Options:
        """Return the options of a certificate.

        Raises:
            WrongUse: an unknown key or value, or one of another type.
        """
        try:
            if "wishes" in data:
                raise ValueError("wishes are of whoever types them")
            return cls.of(**{name: _from_plain(value, name) for name, value in data.items()})
        except (TypeError, ValueError, OverflowError) as why:
            raise WrongUse(f"these options cannot be read: {why}") from why


def _by_group(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values of fields by the field of `Options` that holds them: a group, or their own."""
    parts: dict[str, Any] = {}
    for name, value in values.items():
        row = ROWS.get(name)
        if row is None or row.group is None:
            raise TypeError(f"Options.__init__() got an unexpected keyword argument '{name}'")
        if row.group:
            parts.setdefault(row.group, {})[name] = value
        else:
            parts[name] = value
    return parts


def _grouped(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what `Options` is made of: groups, in the order in which they are checked."""
    parts = _by_group(values)
    groups = {name: make(**parts.pop(name)) for name, make in GROUPS.items() if name in parts}
    return {**groups, **parts}


def _plain(value: Any, row: Row) -> Any:
    """Return the value of a field as a certificate has it."""
    if row.kind is Kind.LAYER_WORDS:
        return tuple((name, str(word)) for name, word in value)
    return str(value) if row.kind is Kind.CHOICE else value


def _from_plain(value: Any, name: str) -> Any:
    """Return the value of a field from that of a certificate, or from one of a user.

    Raises:
        TypeError, ValueError, OverflowError: of another type.
    """
    row = ROWS.get(name)
    if row is None:
        return value
    if row.kind is Kind.CHOICE:
        return CHOICES[name](value)
    if row.kind is Kind.TEXTS:
        return value if isinstance(value, str) else tuple(value)
    if row.kind is Kind.LAYER_WORDS:
        return tuple((str(n), CHOICES[name](word)) for n, word in _pairs(value))
    if row.kind is Kind.LAYER_LENGTHS:
        return tuple((str(n), float(um)) for n, um in _pairs(value))
    if row.kind is Kind.NUMBERS:
        return None if value is None else tuple(value)
    if row.kind is Kind.OFFSETS:
        return tuple((int(n), float(um)) for n, um in value)
    if row.kind is Kind.POINTS:
        return tuple((float(x), float(y)) for x, y in value)
    return value


def _pairs(values: Any) -> Any:
    """Return pairs of a mapping, or of a list of them."""
    return values.items() if isinstance(values, Mapping) else values


def options_in_mm(**mm: Any) -> Options:
    """Return `Options` from keywords in mm: a length ``x`` stands for the field ``x_um``.

    >>> options_in_mm(offset=0.1, side="die", starts=[(1, 2)]).leading.starts_um
    ((1000.0, 2000.0),)

    Raises:
        WrongUse: an unknown keyword or value.
    """
    rows = {row.keyword: row for row in field_rows()}
    values: dict[str, Any] = {}
    for key, value in mm.items():
        if key in rows:
            values[rows[key].name] = _in_um(value, rows[key])
        else:  # as in a certificate, or unknown
            values[key] = value
    return Options.from_data(values)


def take_options(options: Options | None, mm: Mapping[str, Any]) -> Options:
    """Return options as a function of the library gets them: whole, else as keywords in mm.

    Raises:
        WrongUse: both are given, or an unknown keyword or value.
    """
    if options is None:
        return options_in_mm(**mm)
    if mm:
        raise WrongUse(f"{', '.join(mm)}: 'options' is given, and says all that there is to ask")
    return options


def _in_um(value: Any, row: Row) -> Any:
    """Return the value of a field from one of the library, where lengths are mm."""
    if row.kind is Kind.POINTS:
        return [(1000.0 * x, 1000.0 * y) for x, y in value]
    if row.kind is Kind.LAYER_LENGTHS:
        return [(layer, 1000.0 * mm) for layer, mm in _pairs(value)]
    if row.kind is not Kind.LENGTH or value is None:
        return value
    if not isinstance(value, int | float):
        raise WrongUse(f"{row.keyword}={value!r} is no length in mm")
    return 1000.0 * value
