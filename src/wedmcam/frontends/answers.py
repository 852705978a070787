"""What can be said of a program that is read, and what is no answer."""

from __future__ import annotations

import re
from collections.abc import Mapping

from wedmcam.diag.run import WrongUse
from wedmcam.option_table import ROWS, Kind, Panel, rows_of

#: What can be said of a program that is read, beside its profile -> the answers; a unit is "um",
#: "mm", "inch" or a length.
ANSWERS: dict[str, tuple[str, ...]] = {row.name: row.words for row in rows_of(Panel.PROGRAM)}
_UNIT = re.compile(r"\s*(\d+\.?\d*|\.\d+)?\s*(um|mm|inch|in)\s*")


def check_answers(answers: Mapping[str, str | None]) -> None:
    """Refuse what is said of a program that is read, where it is no answer.

    Raises:
        WrongUse: an unknown keyword or value.
    """
    for name, value in answers.items():
        if name not in ANSWERS:
            raise WrongUse(f"there is no '{name}': {', '.join(ANSWERS)}")
        row = ROWS[name]
        if value is None or value in row.words:
            continue
        if row.kind is not Kind.UNIT:
            raise WrongUse(f"{row.option} takes {' or '.join(row.words)}, not '{value}'")
        try:
            nm_of(str(value))
        except ValueError as why:
            raise WrongUse(f"{row.option} {why}") from None


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
