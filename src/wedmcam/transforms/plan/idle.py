"""Warnings on options that were given and have no effect on what is cut.

Whoever gave them expects another program. Defaults of a shop are for every part: no wish of this
one, and passed over.

Stages note in a set which fields of the options they took up (`Used`); what was wished for and is
not in it had no effect. Options whose effect hangs on what is drawn (a tolerance without splines)
are no matter of this: they are limits, and hold.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass, field

from wedmcam.diag import Diagnostic, warning
from wedmcam.ir.part import Part
from wedmcam.option_table import ROWS, option_of
from wedmcam.transforms.plan.options import Cutting, Leading
from wedmcam.transforms.plan.wording import Wording

#: Fields that are of drawings, and what a part program has in their place.
_OF_DRAWINGS = (
    ("layers", "a part program has no layers"),
    ("ignore_layers", "a part program has no layers"),
    ("types", "a part program has no entities"),
    ("ignore_types", "a part program has no entities"),
    ("linetypes", "a part program has no line types"),
    ("ignore_linetypes", "a part program has no line types"),
    ("colours", "a part program has no colours"),
    ("ignore_colours", "a part program has no colours"),
    ("join_um", "chains whose ends meet within 1 um join"),
    ("tolerance_um", "a part program has no splines"),
    ("side", "each cut names its side"),
    ("layer_sides", "a part program has no layers"),
    ("layer_offsets", "a part program has no layers"),
    ("clearance_um", "each cut names its offset"),
    ("starts_um", "each cut names its start"),
    ("order", "cuts are made in the order in which they are written"),
)
#: Fields of the wire path, in the order in which findings name them.
_OF_PATH = ("offset_um", "corner_um", "paper", "sharp", "trim", "lead_um", "stop_um", "overcut_um")


@dataclass(slots=True)
class Used:
    """Names of the fields of the options that had an effect; stages add to it.

    Attributes:
        wishes: names of the fields that were asked for.
        names: of those that had an effect.
    """

    wishes: Set[str] = frozenset()
    names: set[str] = field(default_factory=set)

    def add(self, name: str, when: bool = True) -> None:
        """Note that a field had an effect, if it had."""
        if when:
            self.names.add(name)

    def wished(self, name: str) -> bool:
        """Return whether a field was asked for; a default of a shop is no wish."""
        return name in self.wishes


def of_source(part: Part, units: str | None, wished: Set[str]) -> list[Diagnostic]:
    """Return warnings on options that are for drawings: a part program says these itself.

    Args:
        part: the part program.
        units: that are stated for a drawing.
        wished: names of the fields that were asked for.
    """
    findings: list[Diagnostic] = []
    for name, instead in _OF_DRAWINGS:
        if name in wished:
            findings.append(
                warning(
                    "wed-option",
                    "{option} has no effect: {reason}",
                    option=option_of(name),
                    reason=instead,
                )
            )
    if "units" in wished and units not in (None, part.units):
        findings.append(
            warning(
                "wed-option",
                "--units {units} has no effect: the part program is in {own_units}",
                hint="units stand in its first line",
                units=units,
                own_units=part.units,
            )
        )
    return findings


def of_path(used: Used, cutting: Cutting, leading: Leading, words: Wording) -> list[Diagnostic]:
    """Return warnings on options of the wire path that were wished for and not used.

    Args:
        used: which fields had an effect.
        cutting: as asked for.
        leading: likewise.
        words: of the source.
    """
    findings: list[Diagnostic] = []
    for name in _OF_PATH:
        why = words.idle_reasons.get(name)
        group = cutting if hasattr(cutting, name) else leading
        # 0 asks for nothing, unless a cut says something else.
        empty = not getattr(group, name) and name not in words.stated
        if why and not empty and name not in used.names and used.wished(name):
            options = _fillers(name, used) or [option_of(name)]
            findings.append(
                warning(
                    words.idle,
                    "{option} have no effect: {reason}"
                    if len(options) > 1
                    else "{option} has no effect: {reason}",
                    option=" and ".join(options),
                    reason=why,
                )
            )
    return findings


def _fillers(name: str, used: Used) -> list[str]:
    """Return the options that were given in the place of one, and state its field."""
    rows = [row for row in ROWS.values() if row.fills == name]
    return [row.option for row in rows if used.wished(row.name)]
