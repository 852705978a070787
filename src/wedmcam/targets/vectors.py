"""The DEM-15 with Eindhoven's microcomputer: programs are displacement vectors at a cutting speed.

The lower the speed, the coarser are its directions, so the path is cut into vectors for the speed
at which it is run: ``--feed``, or that of the profile.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from wedmcam.controllers.eindhoven.vectors import Vectors
from wedmcam.diag import Diagnostic, error, note
from wedmcam.diag.run import WrongUse
from wedmcam.formats import dem15
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.targets.entries import Entries
from wedmcam.targets.stated import Stated

if TYPE_CHECKING:
    from wedmcam.transforms.lower import Rules


class Dem15(Stated):
    """Text of job records."""

    pairs = False
    coarse: ClassVar[bool] = True

    @property
    def stop_word(self) -> str:
        """See `Target`."""
        return dem15.END

    @property
    def refuses_carried(self) -> Diagnostic | None:
        """The path of another program is no row of vectors for a speed."""
        return error(
            "not-in-format",
            "{machine} runs vectors that are chosen for the cutting speed: the blocks of another "
            "program are none",
            hint="compile the drawing for it, or convert the program to .dxf and compile that",
            machine=self.machine.name,
        )

    def rules(self, count: str | None, feed_um: float | None = None) -> Rules:
        """See `Target`; moves between two cuts are run at the largest speed."""
        if count == "textbook":
            raise WrongUse("--count textbook is for 3B: a vector of the DEM-15 counts nothing")
        speed = self._speed(feed_um)
        rules = super().rules(None)
        stepping = rules.stepping
        assert isinstance(stepping, Vectors)
        cutting = replace(stepping, speed=min(max(speed, 1), dem15.FASTEST))
        along = dem15.reach(self.machine.limits.travel_um, self.machine.vectors.positions)
        travel = along[::-1] if self.machine.axes.exchange else along
        return replace(rules, stepping=cutting, vectors=cutting, moving=stepping, travel=travel)

    def _speed(self, feed_um: float | None) -> int:
        """Return the speed for a feed, um a minute; it may be none that the controller takes."""
        return self.machine.vectors.speed if feed_um is None else dem15.speed_of(feed_um)

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """See `Target`."""
        speed = self._speed(feed_um)
        if feed_um is not None and not 1 <= speed <= dem15.FASTEST:
            return None, [_no_speed(feed_um)]
        data, findings = self._encoded(program)
        if data:
            findings = [*findings, *self._told(program, speed, feed_um)]
        return data, findings

    def _told(self, program: Program, speed: int, feed_um: float | None) -> list[Diagnostic]:
        """Return the note that says at which speed the vectors are run, and how long that takes.

        The speed along a vector is not quite the one that is asked for, so the time is that of the
        timers.
        """
        cutting = program.blocks[program.blocks["kind"] == Kind.LINE]
        stepping = self.machine.stepping
        assert isinstance(stepping, Vectors)
        longest = float(np.hypot(cutting["x"], cutting["y"]).max(initial=0)) * program.step_um
        return [
            note(
                "vector-speed",
                "{vectors} vectors for a cutting speed of {speed_mm:.5f} mm a minute ({speed}), "
                "the longest {longest_mm:.3f} mm, {minutes:.0f} min of cutting"
                + ("" if feed_um is not None else ": the profile's speed, no --feed was given"),
                vectors=len(cutting),
                speed_mm=speed * dem15.SPEED_UM / 1000,
                speed=speed,
                longest_mm=longest / 1000,
                minutes=float(stepping.seconds(cutting).sum()) / 60,
            )
        ]


def _no_speed(feed_um: float) -> Diagnostic:
    """Return the error on a feed that the controller has no speed for."""
    return error(
        "speed-range",
        "a feed of {feed_mm:g} mm a minute; the controller runs {least_mm:.5f} to {most_mm:.5f}",
        hint="--feed 1mm",
        feed_mm=feed_um / 1000,
        least_mm=dem15.SPEED_UM / 1000,
        most_mm=dem15.FASTEST * dem15.SPEED_UM / 1000,
    )
