"""How stages run one after the other: findings gather, and an error stops what comes next.

A stage takes values and returns ``(value, findings)``. After a stage that found an error nothing
more runs: `Refused`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from wedmcam.diag.capped import capped
from wedmcam.diag.finding import Diagnostic, Severity, has_errors

T = TypeVar("T")


class WrongUse(Exception):  # noqa: N818 - a kind of stop, not of error
    """Options that do not fit together or to the input: exit status 2."""


class Refused(Exception):  # noqa: N818 - a kind of stop, not of error
    """The input cannot be compiled; ``Run.findings`` says why. ``stage`` names where it stopped."""

    def __init__(self, stage: str) -> None:
        super().__init__(stage)
        self.stage = stage


@dataclass
class Run:
    """Collects what the stages find, and stops after the first one that found an error.

    Attributes:
        strict: warnings are errors.
        findings: in the order in which they were found, of each kind as many as `capped`
            keeps.
        values: of the stages that came through, by their names, the last of each.
        observe: is called with the name and the value of each stage that came through.
    """

    strict: bool = False
    findings: list[Diagnostic] = field(default_factory=list)
    values: dict[str, Any] = field(default_factory=dict)
    observe: Callable[[str, Any], None] | None = None

    def forked(self) -> Run:
        """Return a run that goes on from here, and leaves this one as it is."""
        return Run(self.strict, list(self.findings), dict(self.values), self.observe)

    def __call__(self, stage: str, result: tuple[T | None, Iterable[Diagnostic]]) -> T:
        """Take a stage's findings over and return its value."""
        value, findings = result
        self.add(stage, findings)
        assert value is not None, f"{stage} returned nothing and said nothing"
        self.values[stage] = value
        if self.observe is not None:
            self.observe(stage, value)
        return value

    def add(self, stage: str, findings: Iterable[Diagnostic]) -> None:
        """Take findings over; refuse if there is an error among them."""
        new = [self._judged(d) for d in findings]
        self.findings = capped([*self.findings, *new])
        if has_errors(new):
            raise Refused(stage)

    def _judged(self, d: Diagnostic) -> Diagnostic:
        if self.strict and d.severity is Severity.WARNING:
            return replace(d, severity=Severity.ERROR)
        return d
