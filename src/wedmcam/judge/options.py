"""How strictly a program is judged."""

from __future__ import annotations

from dataclasses import dataclass

from wedmcam.diag.run import WrongUse
from wedmcam.option_table import check_kinds, usual


@dataclass(frozen=True, slots=True)
class Judging:
    """How strictly a program is judged.

    Attributes:
        strict: warnings are errors.
        count: how J is found, "exact" or "textbook"; None for what the profile says.
    """

    strict: bool = usual("strict")
    count: str | None = usual("count")

    def __post_init__(self) -> None:
        check_kinds(self)
        if self.count not in (None, "exact", "textbook"):
            raise WrongUse(f"no way of counting is called '{self.count}': exact or textbook")
