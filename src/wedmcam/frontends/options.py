"""What readers need to know beside a file: what of it is read, and what it leaves open."""

from __future__ import annotations

from dataclasses import dataclass, fields

from wedmcam.diag.run import WrongUse
from wedmcam.frontends.answers import check_answers
from wedmcam.ir.colours import colour_of
from wedmcam.option_table import ROWS, check_kinds, option_of, usual


@dataclass(frozen=True, slots=True)
class DrawingReading:
    """What of a drawing is read. Lengths in um.

    Attributes:
        source: format, "dxf" or "wed"; None to tell by name and content.
        units: "mm", "um" or "inch": what one drawing unit is, whatever the drawing says; None to
            go by the drawing.
        fill_in_units: ``units`` only stands in where the drawing says none (batch, ruling 7).
        layers: layers to take, in any case: names, or patterns (``*``, ``?``); none: all.
        ignore_layers: likewise to leave out; they win.
        types, ignore_types: likewise types of entities.
        linetypes, ignore_linetypes: likewise line types, as they are seen.
        colours, ignore_colours: likewise colours, as `ir.colours.colour_of` takes them.
        join_um: the largest gap closed between entities.
        tolerance_um: how far the arcs that splines and ellipses become may be from them.
        transforms: figure transforms in the words of the part language, in their order.
        defines: lets of a part program, NAME=VALUE.
    """

    source: str | None = usual("source")
    units: str | None = usual("units")
    fill_in_units: bool = usual("fill_in_units")
    layers: tuple[str, ...] = usual("layers")
    ignore_layers: tuple[str, ...] = usual("ignore_layers")
    types: tuple[str, ...] = usual("types")
    ignore_types: tuple[str, ...] = usual("ignore_types")
    linetypes: tuple[str, ...] = usual("linetypes")
    ignore_linetypes: tuple[str, ...] = usual("ignore_linetypes")
    colours: tuple[str, ...] = usual("colours")
    ignore_colours: tuple[str, ...] = usual("ignore_colours")
    join_um: float = usual("join_um")
    tolerance_um: float = usual("tolerance_um")
    transforms: tuple[str, ...] = usual("transforms")
    defines: tuple[str, ...] = usual("defines")

    def __post_init__(self) -> None:
        check_kinds(self)
        units = ROWS["units"].words
        if self.units is not None and self.units not in units:
            raise WrongUse(
                f"no unit is called '{self.units}': {', '.join(units[:-1])} or {units[-1]}"
            )
        for name in ("colours", "ignore_colours"):
            for text in getattr(self, name):
                try:
                    colour_of(text)
                except ValueError as why:
                    raise WrongUse(f"{option_of(name)}: {why}") from None


@dataclass(frozen=True, slots=True)
class ProgramReading:
    """What a program that is read leaves open to its machine; None where it is not said.

    Attributes:
        units_in: of an ISO program: what a number with a point is where no G20 or G21 stands,
            "mm", "um" or "inch".
        whole_in: what 1 is in a number without a point: "um", "mm", "inch", or a length ("10um").
        coordinates_in: "absolute" or "incremental", before the first G90 or G91.
        centres_in: "start" (I and J lead from the start to the centre), "absolute" (they are its
            place) or "to-start" (they lead from the centre to the start).
        semicolon_in: what stands behind a semicolon, a "block" or a "comment".
        subprograms_in: what M98 runs: from an "N-label" to M99, an "O-number", or "none".
    """

    units_in: str | None = usual("units_in")
    whole_in: str | None = usual("whole_in")
    coordinates_in: str | None = usual("coordinates_in")
    centres_in: str | None = usual("centres_in")
    semicolon_in: str | None = usual("semicolon_in")
    subprograms_in: str | None = usual("subprograms_in")

    def __post_init__(self) -> None:
        check_answers({field.name: getattr(self, field.name) for field in fields(self)})

    @property
    def answers(self) -> dict[str, str]:
        """What is said, by its name."""
        said = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in said.items() if value is not None}
