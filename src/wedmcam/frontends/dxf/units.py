"""What one drawing unit is: what the drawing says, what the user says, and what is plausible.

A DXF states its unit in ``$INSUNITS`` or not at all, and many exporters state a wrong one: R12 has
no units, libraries write 6 (metres) into everything, and 'inch' at millimetre size is common. So
the raw header counts, never a default of the reader; a drawing without units is refused with its
size; and an unlikely size is reported.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from wedmcam.diag import Diagnostic, FileSpan, error, warning

#: ``$INSUNITS``: value -> (name, um in one unit). AutoCAD DXF reference, HEADER section; the US
#: survey units (21 to 24) by the definition 1 ft = 1200/3937 m.
INSUNITS: Mapping[int, tuple[str, float]] = {
    1: ("inch", 25_400.0),
    2: ("ft", 304_800.0),
    3: ("mile", 1_609_344_000.0),
    4: ("mm", 1_000.0),
    5: ("cm", 10_000.0),
    6: ("m", 1_000_000.0),
    7: ("km", 1_000_000_000.0),
    8: ("microinch", 0.0254),
    9: ("mil", 25.4),
    10: ("yd", 914_400.0),
    11: ("angstrom", 1e-4),
    12: ("nm", 1e-3),
    13: ("um", 1.0),
    14: ("dm", 100_000.0),
    15: ("dam", 10_000_000.0),
    16: ("hm", 100_000_000.0),
    17: ("Gm", 1e15),
    18: ("au", 1.495_978_707e17),
    19: ("ly", 9.460_730_472_580_8e21),
    20: ("pc", 3.085_677_581_491_367_3e22),
    21: ("ft-us", 1_200_000_000 / 3937),
    22: ("inch-us", 100_000_000 / 3937),
    23: ("yd-us", 3_600_000_000 / 3937),
    24: ("mile-us", 5280 * 1_200_000_000 / 3937),
}
#: Units that ``--units`` takes, um in one.
ASKED: Mapping[str, float] = {"mm": 1_000.0, "um": 1.0, "inch": 25_400.0}
#: ``$INSUNITS`` values that belong to the inch system, for the comparison with ``$MEASUREMENT``.
ENGLISH = frozenset({1, 2, 3, 8, 9, 10, 21, 22, 23, 24})
#: A part for a wire machine is unlikely to be larger or smaller than this, um.
LARGEST_UM, SMALLEST_UM = 1_000_000.0, 1_000.0


@dataclass(frozen=True, slots=True)
class Unit:
    """The unit in force: its name, um in one, and where it comes from. ``scale`` 0: unknown."""

    name: str
    scale: float
    stated_by: str


def choose(
    insunits: int | None, measurement: int | None, asked: str | None, fill_in: bool, file: str
) -> tuple[Unit, list[Diagnostic]]:
    """Return the unit in which the numbers of a drawing are taken.

    Args:
        insunits: ``$INSUNITS`` as the raw header has it, None where it has none.
        measurement: ``$MEASUREMENT`` likewise: 0 English, 1 metric.
        asked: the user's choice, a key of `ASKED`, or None.
        fill_in: whether the user's choice only stands in where the drawing has none.
        file: for the findings.
    """
    where = FileSpan(file)
    findings: list[Diagnostic] = []
    drawn = INSUNITS.get(insunits) if insunits is not None else None
    if asked is not None and not (fill_in and drawn):
        if drawn is not None and drawn[1] != ASKED[asked]:
            findings.append(
                warning(
                    "units-overridden",
                    "the drawing says {stated} ($INSUNITS {insunits}); its numbers are taken as "
                    "{units}, as --units says",
                    where,
                    stated=drawn[0],
                    insunits=insunits,
                    units=asked,
                )
            )
        return Unit(asked, ASKED[asked], "--units"), findings
    if drawn is None:
        return Unit("", 0.0, ""), findings
    if measurement is not None and (insunits in ENGLISH) != (measurement == 0):
        findings.append(
            warning(
                "units-contradict",
                "$INSUNITS {insunits} says {units}, $MEASUREMENT {measurement} says {system}; "
                "{units} is taken",
                where,
                hint="--units {units} settles it" if drawn[0] in ASKED else "--units mm settles it",
                insunits=insunits,
                units=drawn[0],
                measurement=measurement,
                system="English" if measurement == 0 else "metric",
            )
        )
    return Unit(drawn[0], drawn[1], f"$INSUNITS {insunits}"), findings


def missing(width: float, height: float, insunits: int | None, file: str) -> Diagnostic:
    """Return the error about a drawing without units; its size is in drawing units."""
    finding = error(
        "no-units",
        "the drawing has no units (no $INSUNITS)"
        if insunits is None
        else "the drawing has no units ($INSUNITS {insunits})",
        FileSpan(file),
        hint="give --units mm, --units inch or --units um",
        insunits=insunits,
    )
    if not width and not height:
        return finding
    return finding.extended(
        ". Its size is {width:.3f} x {height:.3f} drawing units: {width:.3f} x {height:.3f} mm, or "
        "{inch_width_mm:.3f} x {inch_height_mm:.3f} mm if they are inches",
        width=width,
        height=height,
        inch_width_mm=width * 25.4,
        inch_height_mm=height * 25.4,
    )


def doubt(unit: Unit, width: float, height: float, file: str) -> Diagnostic | None:
    """Return a warning where a part is unlikely in its unit and likely in mm or inch.

    Args:
        unit: in which the numbers were taken.
        width: of the part, um.
        height: of the part, um.
        file: for the finding.
    """
    size = max(width, height)
    if SMALLEST_UM <= size <= LARGEST_UM or size <= 0.0:
        return None
    for name in ("mm", "inch"):
        factor = ASKED[name] / unit.scale
        if name != unit.name and SMALLEST_UM <= size * factor <= LARGEST_UM:
            return warning(
                "unlikely-units",
                "taken as {units} ({stated_by}) the part is {width_mm:.3f} x {height_mm:.3f} mm; "
                "as {likely} it would be {likely_width_mm:.3f} x {likely_height_mm:.3f} mm",
                FileSpan(file),
                hint="--units {likely}, if that is right",
                units=unit.name,
                stated_by=unit.stated_by,
                width_mm=width / 1e3,
                height_mm=height / 1e3,
                likely=name,
                likely_width_mm=width * factor / 1e3,
                likely_height_mm=height * factor / 1e3,
            )
    return None
