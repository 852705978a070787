"""Who is served first: the interrupt controller of the microcomputer, an 8259.

Limit switches, emergency stop and wire break are one interrupt, ORed, above the timers of the
stepping motors, these above the keyboard [S]. That the timer of x is above that of y is a ruling.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum


class Request(IntEnum):
    """Interrupts, the most urgent one first."""

    EMERGENCY = 0
    TIMER_X = 1
    TIMER_Y = 2
    KEYBOARD = 3


#: What is ORed into the emergency interrupt [S].
EMERGENCIES = ("stop", "limit", "break")
ALL = frozenset(Request)


@dataclass(frozen=True, slots=True)
class Interrupts:
    """The state of the interrupt controller.

    Attributes:
        pending: requests that wait.
        serving: those under way, the most urgent one last: it has broken into the others.
        enabled: those that are not masked.

    >>> both = Interrupts().requested([Request.TIMER_X, Request.EMERGENCY])
    >>> now, first = both.served()
    >>> first.name, now.disabled().served()[1]
    ('EMERGENCY', None)
    """

    pending: frozenset[Request] = frozenset()
    serving: tuple[Request, ...] = ()
    enabled: frozenset[Request] = ALL

    def requested(self, requests: Iterable[Request]) -> Interrupts:
        """Return it with more requests; one that waits already waits once."""
        return replace(self, pending=self.pending | frozenset(requests))

    def served(self) -> tuple[Interrupts, Request | None]:
        """Return it with the most urgent request served, and which that is.

        None where nothing waits that is enabled and more urgent than what is under way.
        """
        waiting = self.pending & self.enabled
        first = min(waiting, default=None)
        if first is None or (self.serving and first >= self.serving[-1]):
            return self, None
        serving = (*self.serving, first)
        return replace(self, pending=self.pending - {first}, serving=serving), first

    def ended(self) -> Interrupts:
        """Return it behind the end of the routine that is under way."""
        return replace(self, serving=self.serving[:-1])

    def disabled(self) -> Interrupts:
        """Return it with all interrupts off, as the emergency routine leaves it [S]."""
        return Interrupts(self.pending, self.serving, frozenset())
