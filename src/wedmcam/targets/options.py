"""What the operator enters at the controller."""

from __future__ import annotations

from dataclasses import dataclass

from wedmcam.option_table import check_kinds, usual


@dataclass(frozen=True, slots=True)
class Operator:
    """What the operator enters at the controller.

    Attributes:
        d: offsets of a controller that compensates itself (G41, G42): D number and um.
        feed_um: cutting speed, um a minute: F of a program whose profile writes one, and the time.
    """

    d: tuple[tuple[int, float], ...] = usual("d")
    feed_um: float | None = usual("feed_um")

    def __post_init__(self) -> None:
        check_kinds(self)
