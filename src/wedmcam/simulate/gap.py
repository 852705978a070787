"""The workpiece end of the loop: how a gap answers to pulses and steps. A model of ours, all [R].

No source says it, so it is small, and every number of it stands in `Workpiece`. The gap is one
length, um: a step of the path closes it by a step, a step back opens it, a discharge erodes it
open by a third of a nanometre. What becomes of a pulse is drawn from chances that depend on the
gap, on the debris in it, and on whether a chip bridges it:

* the wider the gap, the more pulses find no way through (open), and the later the others do;
* the narrower and the dirtier it is, the more of them are short circuits;
* debris is the share of pulses that discharged lately; steps back flush it;
* now and then a chip bridges the gap: nearly all pulses are shorts until the gap is wider than it.

Chances are looked up anew after every step and after every `Workpiece.hold` discharges, by cells of
the gap and levels of the debris. Between two such moments pulses are independent of each other,
which lets `runs` draw hundreds of them at once; `one_by_one` draws each.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from wedmcam.simulate.servo import Pulse

#: Gaps below and above which no chance changes any more, um.
FLAT = (-30.0, 90.0)


@dataclass(frozen=True, slots=True)
class Workpiece:
    """Every number of the model.

    Attributes:
        start_um: the gap when the wire begins, and after a break.
        unit_um: the gap is counted in this; a discharge erodes two, a delayed one, whose current
            pulse is shortened, one.
        cell_um: chances are those of the middle of a cell of the gap.
        hold: discharges for which chances hold.
        open_um, open_width_um: gap at which half of the pulses find no way through, and how fast
            their share grows about it.
        late_um, late_width_um: the same of pulses that discharge late, among those that do.
        short_um, short_width_um: gap at which half of the pulses are shorts, in clean water.
        dirt_um: by how much debris at its most moves that gap.
        levels: of debris.
        memory: pulses in which debris is washed out to 1 / e.
        flush: what is left of the debris behind a step back.
        chip: how many chips bridge the gap a discharge, with the debris at its most.
        chip_um: by how much a chip is longer than the gap that it bridges, on average.
        chip_short: chance of a short while it does.
    """

    start_um: float = 30.0
    unit_um: float = 1 / 6000
    cell_um: float = 0.125
    hold: int = 1024
    open_um: float = 20.0
    open_width_um: float = 2.0
    late_um: float = 16.0
    late_width_um: float = 3.0
    short_um: float = 4.0
    short_width_um: float = 1.5
    dirt_um: float = 5.0
    levels: int = 16
    memory: float = 8000.0
    flush: float = 0.9
    chip: float = 1 / 200_000
    chip_um: float = 3.0
    chip_short: float = 0.97


class Chances(NamedTuple):
    """Of a pulse: to be each kind of `Pulse`; their sum is 1."""

    open: float
    discharge: float
    delayed: float
    short: float


class Counts(NamedTuple):
    """How many pulses were of each kind of `Pulse`."""

    open: int
    discharge: int
    delayed: int
    short: int


def _share(x: float) -> float:
    return 1 / (1 + math.exp(-max(min(x, 60.0), -60.0)))


@lru_cache(maxsize=100_000)
def chances(piece: Workpiece, cell: int, level: int, chip: bool) -> Chances:
    """Return what may become of a pulse.

    Args:
        piece: the model.
        cell: of the gap.
        level: of the debris, 0 to ``piece.levels``.
        chip: whether a chip bridges the gap.
    """
    if chip:
        return Chances(0.0, 1 - piece.chip_short, 0.0, piece.chip_short)
    gap = (cell + 0.5) * piece.cell_um
    bridged = piece.short_um + piece.dirt_um * level / piece.levels
    short = _share((bridged - gap) / piece.short_width_um)
    opened = (1 - short) * _share((gap - piece.open_um) / piece.open_width_um)
    rest = 1 - short - opened
    late = rest * _share((gap - piece.late_um) / piece.late_width_um)
    return Chances(opened, rest - late, late, short)


class Gap:
    """The gap of one run: what it is, and what was counted in it.

    Attributes:
        piece: the model.
        rng: all chance of the run comes from it.
        counted: pulses of each kind, indexed by `Pulse`.
        narrowest_um: of all gaps; below 0 the wire leans against the workpiece.
    """

    def __init__(self, piece: Workpiece, rng: np.random.Generator) -> None:
        self.piece, self.rng = piece, rng
        self.counted = [0, 0, 0, 0]
        self.narrowest_um = piece.start_um
        self._per_um = round(1 / piece.unit_um)
        self._cell = round(piece.cell_um / piece.unit_um)
        self._pulses = self._discharges = 0
        self._cells = [round(um / piece.cell_um) for um in FLAT]
        self._sums: tuple[int, float, float] = (0, 0.0, 0.0)
        self.renew()

    def renew(self) -> None:
        """Begin with a clean gap: a wire that was threaded, a contour that begins."""
        self._units = round(self.piece.start_um * self._per_um)
        self._debris = 0.0
        self._chip: int | None = None
        self._look_up()

    @property
    def um(self) -> float:
        """The gap."""
        return self._units / self._per_um

    @property
    def debris(self) -> float:
        """The share of pulses that discharged lately, 0 to 1."""
        return self._debris

    @property
    def bridged(self) -> bool:
        """Whether a chip lies in it."""
        return self._chip is not None

    @property
    def pulses(self) -> int:
        """All that were counted."""
        return self._sums[0]

    @property
    def left(self) -> int:
        """Discharges for which the chances still hold."""
        return self.piece.hold - self._discharges

    @property
    def mean_um(self) -> float:
        """Mean gap over the pulses."""
        n, total, _ = self._sums
        return total / n if n else self.um

    @property
    def spread_um(self) -> float:
        """Standard deviation of the gap over the pulses: how steady the servo holds it."""
        n, total, squares = self._sums
        return math.sqrt(max(squares / n - (total / n) ** 2, 0.0)) if n else 0.0

    def take(self, counts: Sequence[int]) -> None:
        """Take pulses that were drawn: they erode; chances are renewed when it is time.

        Args:
            counts: by kind of `Pulse`, with no more discharges than `left`.
        """
        opened, discharges, delayed, shorts = counts
        counted = self.counted
        counted[0] += opened
        counted[1] += discharges
        counted[2] += delayed
        counted[3] += shorts
        pulses = opened + discharges + delayed + shorts
        held, (n, total, squares) = self._held_um, self._sums
        self._sums = (n + pulses, total + pulses * held, squares + pulses * held * held)
        self._units += 2 * discharges + delayed
        self._pulses += pulses
        self._discharges += discharges + delayed
        assert self._discharges <= self.piece.hold
        if self._discharges == self.piece.hold:
            self._wash()
            self._drop_chip()
            self._look_up()

    def step(self, um: float) -> None:
        """Step along the path: forward (+) closes the gap, back (-) opens and flushes it."""
        self._wash()
        self._units -= round(um * self._per_um)
        if um < 0:
            self._debris *= self.piece.flush
        self.narrowest_um = min(self.narrowest_um, self.um)
        if self._chip is not None and self._units > self._chip:
            self._chip = None
        self._look_up()

    def idle(self, pulses: float) -> None:
        """Let time pass without pulses, as long as so many would take: debris is washed out."""
        self._wash()
        self._debris *= math.exp(-pulses / self.piece.memory)
        self._look_up()

    def clear_chip(self) -> None:
        """Take a chip out by hand."""
        self._chip = None
        self._look_up()

    def _wash(self) -> None:
        kept = math.exp(-self._pulses / self.piece.memory)
        made = self._discharges / self._pulses if self._pulses else 0.0
        self._debris = self._debris * kept + made * (1 - kept)
        self._pulses = self._discharges = 0

    def _drop_chip(self) -> None:
        piece = self.piece
        if self._chip is None and self.rng.random() < piece.chip * piece.hold * self._debris:
            more = self.rng.exponential(piece.chip_um)
            self._chip = self._units + round(more * self._per_um)
        elif self._chip is not None and self._units > self._chip:
            self._chip = None

    def _look_up(self) -> None:
        self._pulses = self._discharges = 0
        level = round(self._debris * self.piece.levels)
        cell = min(max(self._units // self._cell, self._cells[0]), self._cells[1])
        self._held_um = self.um
        self.chances = chances(self.piece, cell, level, self.bridged)


def one_by_one(gap: Gap) -> Iterator[Pulse]:
    """Yield pulse after pulse, each drawn by itself: the reference of all that draws many at once.

    A pulse has eroded the gap when the next one is asked for; steps may be made between two.
    """
    single = [Counts(*(int(k == kind) for k in range(4))) for kind in range(4)]
    kinds = list(Pulse)
    while True:
        draw, kind = gap.rng.random(), 0
        for chance in gap.chances[:3]:
            draw -= chance
            if draw < 0:
                break
            kind += 1
        gap.take(single[kind])
        yield kinds[kind]
