"""The counters of the pulse analysis: shorts and open pulses of 255, handed over by handshake.

The computer is too slow to look at pulses, so counters do. When the pulse counter has 255, the
strobes of both ports are given; the ports take the counts over and raise their input-buffer-full
lines; when both are there, all counters are reset, and a new cycle begins [S]. A port that the
computer has not read yet takes nothing over, so the counters stand until it is read [R].
"""

from __future__ import annotations

from dataclasses import dataclass, replace

#: Pulses of a cycle [S].
CYCLE = 255


@dataclass(frozen=True, slots=True)
class PulseCounters:
    """The counters, and the two ports that they are read from.

    Attributes:
        pulses, shorts, opens: of the cycle under way.
        sc, op: what stands in the ports SC and OP.
        sc_full, op_full: the ports' input-buffer-full lines.
    """

    pulses: int = 0
    shorts: int = 0
    opens: int = 0
    sc: int = 0
    op: int = 0
    sc_full: bool = False
    op_full: bool = False

    @property
    def waits(self) -> bool:
        """Whether the counters stand: a cycle is full, and a port was not read."""
        return self.pulses == CYCLE

    def counted(self, pulses: int, shorts: int, opens: int) -> PulseCounters:
        """Return them behind more pulses of one cycle.

        Args:
            pulses: how many; no more than are left of the cycle, 0 or more.
            shorts, opens: of them.

        Raises:
            ValueError: more pulses than the cycle has, or more shorts and opens than pulses.

        >>> full = PulseCounters().counted(255, 3, 40)
        >>> full.sc, full.op, full.sc_full, full.pulses
        (3, 40, True, 0)
        """
        if not 0 <= pulses <= CYCLE - self.pulses or shorts < 0 or opens < 0:
            raise ValueError("no such pulses are left of the cycle")
        if shorts + opens > pulses:
            raise ValueError("a pulse is a short or open, or neither")
        grown = replace(
            self,
            pulses=self.pulses + pulses,
            shorts=self.shorts + shorts,
            opens=self.opens + opens,
        )
        return grown._handed_over()

    def read_sc(self) -> tuple[PulseCounters, int]:
        """Return them behind the reading of port SC, and its word."""
        return replace(self, sc_full=False)._handed_over(), self.sc

    def read_op(self) -> tuple[PulseCounters, int]:
        """Return them behind the reading of port OP, and its word."""
        return replace(self, op_full=False)._handed_over(), self.op

    def _handed_over(self) -> PulseCounters:
        """Return them reset, the counts in the ports, where the cycle is full and both free."""
        if self.pulses < CYCLE or self.sc_full or self.op_full:
            return self
        return PulseCounters(sc=self.shorts, op=self.opens, sc_full=True, op_full=True)
