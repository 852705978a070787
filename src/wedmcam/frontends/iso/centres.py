"""From where I and J count: four rules, by profile, option or the codes G90.1 and G91.1.

Source of G90.1 and G91.1: LinuxCNC's handbook, *G-codes*, Arc Distance Mode. Under G90.1 I and J
are places, whatever G90 and G91 say, and both must stand there; under G91.1 they count from the
start.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from wedmcam.formats.iso import PER_CODE
from wedmcam.formats.listing import Values
from wedmcam.frontends.iso import dialect as dialects
from wedmcam.frontends.iso.arcs import fits
from wedmcam.frontends.iso.reading import ArcTeller, Reading, filled

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


class Rule(IntEnum):
    """What I and J are."""

    START = 0
    ABSOLUTE = 1  # under G90 alone
    TO_START = 2
    PLACE = 3  # always: G90.1


_RULES = {
    None: Rule.START,
    "start": Rule.START,
    "absolute": Rule.ABSOLUTE,
    "to-start": Rule.TO_START,
}
#: G90.1 and G91.1 in tenths -> the rule.
CODES = {901: Rule.PLACE, 911: Rule.START}
#: Answers of --centres-in, in the order in which they are looked at.
_ANSWERS = {"absolute": Rule.ABSOLUTE, "start": Rule.START, "to-start": Rule.TO_START}


@dataclass(frozen=True, slots=True, eq=False)
class Rules:
    """The rule at every line, and whether neither file, option nor profile says it."""

    rule: Ints
    is_open: Bools


def rules_of(r: Reading, codes: Ints, has: Bools) -> Rules:
    """Return the rule of every line; ``codes`` in tenths where a line ``has`` one."""
    default = _RULES[r.dialect.centres]
    rule = np.full(r.lines, int(default))
    unsaid = np.full(r.lines, r.dialect.is_open(r.dialect.centres, "ij"))
    lines = np.flatnonzero(has)
    if len(lines):
        of_code = np.zeros(len(codes), np.int64)
        for code, one in CODES.items():
            of_code[codes == code] = one
        rule = filled(of_code, has, int(default))
        unsaid &= np.arange(r.lines) < lines[0]
        code = int(codes[lines[0]])
        # G90.1 is what `absolute` says, but under G91 too.
        same = {Rule.PLACE: "absolute", Rule.START: "start"}[CODES[code]]
        if r.user_dialect.centres not in (None, same):
            r.tell_stated(lines[:1], f"G{code / PER_CODE:g}", "--centres-in")
    return Rules(rule, unsaid)


@dataclass(frozen=True, slots=True, eq=False)
class Centres:
    """The centres of arcs by each rule, um, and where the arcs start and end."""

    rule: Ints
    is_open: Bools
    by: dict[Rule, list[Floats]]
    exact_nm: list[Ints]
    shift: Floats
    ends: list[tuple[Floats, Floats]]

    @property
    def by_place(self) -> Bools:
        """Which arcs have the place of their centre."""
        found: Bools = (self.rule == Rule.ABSOLUTE) | (self.rule == Rule.PLACE)
        return found


def centres_by_rule(
    arcs: Ints,
    rules: Rules,
    nm: dict[str, Ints],
    absolute: Bools,
    befores: dict[str, Ints],
    starts_nm: dict[str, Ints],
    ends_nm: dict[str, Ints],
) -> Centres:
    """Return the centres of arcs that state I or J.

    Args:
        arcs: their lines.
        rules: of every line.
        nm: I and J of every line.
        absolute: lines in G90.
        befores: coordinates before every line, in those that G92 sets.
        starts_nm, ends_nm: of every line.
    """
    rule = rules.rule[arcs]
    here = absolute[arcs] | (rule == Rule.PLACE)
    start = [starts_nm[k][arcs] for k in "XY"]
    way = [nm[k][arcs] for k in "IJ"]
    # How far the zero of I and J lies from the start, were they places.
    away = [np.where(here, befores[k][arcs], 0) for k in "XY"]
    by_nm = {
        Rule.START: [s + i for s, i in zip(start, way, strict=True)],
        Rule.ABSOLUTE: [s + i - a for s, i, a in zip(start, way, away, strict=True)],
        Rule.TO_START: [s - i for s, i in zip(start, way, strict=True)],
    }
    by_place = (rule == Rule.ABSOLUTE) | (rule == Rule.PLACE)
    exact = [
        np.select([by_place, rule == Rule.TO_START], [p, t], default=s)
        for p, t, s in zip(
            *(by_nm[k] for k in (Rule.ABSOLUTE, Rule.TO_START, Rule.START)), strict=True
        )
    ]
    return Centres(
        rule,
        rules.is_open[arcs],
        {k: [c / 1000.0 for c in v] for k, v in by_nm.items()},
        exact,
        np.hypot(*away),
        [(starts_nm[k][arcs] / 1000.0, ends_nm[k][arcs] / 1000.0) for k in "XY"],
    )


def ask(r: Reading, arcs: Ints, stated: Bools, centres: Centres) -> None:
    """Ask for the rule where no arc proves it: ``stated`` arcs have I or J alone."""
    open_arcs = stated & centres.is_open
    if not r.dialect.named:  # [R] a way is from the start where no machine is named
        open_arcs &= centres.shift > 1000
    if not open_arcs.any():
        return
    fit = {rule: open_arcs & fits(centres.ends, centres.by[rule]) for rule in _ANSWERS.values()}
    fit[Rule.ABSOLUTE] &= centres.shift > 1000
    if not r.dialect.named:
        del fit[Rule.TO_START]
    many = sum((f.astype(np.int64) for f in fit.values()), np.zeros(len(arcs), np.int64))
    both = fit[Rule.START] & (many > 1) & ~r.bad[arcs]
    # An arc of one rule proves it; one of none is an error with its own hint.
    if both.any() and not (open_arcs & (many < 2)).any():
        first = int(arcs[np.argmax(both)])
        r.questions += dialects.of_centres(first, int(both.sum()), r.words, r.plain)


#: What is wrong with an arc that ends beside its circle.
_FAR = (
    "the end lies {off_um:.1f} um from the circle: the start is {start_mm:.3f} mm from the centre, "
    "the end {end_mm:.3f} mm"
)


def tell_far(
    teller: ArcTeller, far: Bools, stated: Bools, values: Values, centres: Centres
) -> None:
    """Report arcs that end beside their circle, with the rule that they would fit."""
    left = far.copy()
    for name, rule in _ANSWERS.items():
        if not (left & stated).any():
            break
        one = left & stated & (centres.rule != rule) & fits(centres.ends, centres.by[rule])
        teller.tell(
            one, _FAR, values, hint="I and J fit as --centres-in {rule} reads them", rule=name
        )
        left &= ~one
    teller.tell(left, _FAR, values, hint="check I and J: from the start to the centre, signed")
