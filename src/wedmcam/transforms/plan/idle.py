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
from wedmcam.options import Options
from wedmcam.transforms.plan.wording import Wording

#: Options of drawings, and what a part program has in their place.
_OF_DRAWINGS = (
    ("layers", "--layer", "a part program has no layers"),
    ("ignore_layers", "--ignore-layer", "a part program has no layers"),
    ("types", "--type", "a part program has no entities"),
    ("ignore_types", "--ignore-type", "a part program has no entities"),
    ("linetypes", "--linetype", "a part program has no line types"),
    ("ignore_linetypes", "--ignore-linetype", "a part program has no line types"),
    ("colours", "--colour", "a part program has no colours"),
    ("ignore_colours", "--ignore-colour", "a part program has no colours"),
    ("join_um", "--join", "chains whose ends meet within 1 um join"),
    ("tolerance_um", "--tolerance", "a part program has no splines"),
    ("side", "--side", "each cut names its side"),
    ("layer_sides", "--layer-side", "a part program has no layers"),
    ("layer_offsets", "--layer-offset", "a part program has no layers"),
    ("clearance_um", "--clearance", "each cut names its offset"),
    ("starts_um", "--start", "each cut names its start"),
    ("order", "--order", "cuts are made in the order in which they are written"),
)
#: Options of the wire path, in the order in which they are told.
_OF_PATH = (
    ("offset_um", "--offset"),
    ("corner_um", "--corner"),
    ("sharp", "--convex"),
    ("trim", "--on-interference"),
    ("lead_um", "--lead"),
    ("stop_um", "--stop"),
    ("overcut_um", "--overcut"),
)


@dataclass(slots=True)
class Used:
    """Names of the fields of the options that had an effect; stages add to it."""

    names: set[str] = field(default_factory=set)

    def add(self, name: str, when: bool = True) -> None:
        """Note that a field had an effect, if it had."""
        if when:
            self.names.add(name)


def of_source(part: Part, options: Options) -> list[Diagnostic]:
    """Return warnings on options that are for drawings: a part program says these itself."""
    found = []
    for name, word, instead in _OF_DRAWINGS:
        if options.wished(name):
            found.append(
                warning(
                    "wed-option", "{option} has no effect: {reason}", option=word, reason=instead
                )
            )
    if options.wished("units") and options.units not in (None, part.units):
        found.append(
            warning(
                "wed-option",
                "--units {units} has no effect: the part program is in {own_units}",
                hint="units stand in its first line",
                units=options.units,
                own_units=part.units,
            )
        )
    return found


def of_path(used: Set[str], options: Options, words: Wording) -> list[Diagnostic]:
    """Return warnings on options of the wire path that were wished for and not used.

    Args:
        used: names of the fields that had an effect.
        options: as asked for.
        words: of the source.
    """
    found = []
    for name, word in _OF_PATH:
        why = words.idle_reasons.get(name)
        # 0 asks for nothing, unless a cut says something else.
        empty = not getattr(options, name) and name not in words.stated
        if why and not empty and name not in used and options.wished(name):
            given = [w for w in ("wire", "gap") if f"{w}_um" in (options.wishes or ())]
            if name == "offset_um" and given:
                word = " and ".join(f"--{w}" for w in given)
            found.append(
                warning(
                    words.idle,
                    "{option} have no effect: {reason}"
                    if " and " in word
                    else "{option} has no effect: {reason}",
                    option=word,
                    reason=why,
                )
            )
    return found
