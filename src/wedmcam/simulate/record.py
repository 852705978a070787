"""What a simulated machine did: every step, every event, and the figures of the run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from wedmcam.diag import Diagnostic
from wedmcam.simulate.axis import AxisState
from wedmcam.simulate.controller import Controller
from wedmcam.simulate.motion import Motion, Setup, batches, commanded_at
from wedmcam.simulate.process import Leg, Mode, Way
from wedmcam.simulate.route import Route
from wedmcam.simulate.state import State


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened, with what the display showed.

    Attributes:
        kind: as of `process.Incident`.
        step: number of the place on the path.
        block: of the program as it is written, 1-based.
        j: the count that is left of it.
        time_s: since the start of the program.
        walked: steps made before it in this run, back and forth.
        table_um: where the table stands.
        lamps: of its panel, those that are lit then; none where it has none.
        more: what else there is to say.
    """

    kind: str
    step: int
    block: int
    j: int
    time_s: float
    walked: int
    table_um: tuple[int, int]
    lamps: tuple[str, ...] = ()
    more: Mapping[str, Any] = field(default_factory=dict)


def table_of(axes: tuple[AxisState, AxisState], setup: Setup) -> tuple[int, int]:
    """Return where the table stands, steps from the start of the program.

    It is at 0 there, whichever end of the play it came from.
    """
    x, y = (
        axis.motor + axis.slack - (0 if true > 0 else play)
        for axis, true, play in zip(axes, setup.true_approach, setup.play, strict=True)
    )
    return x, y


def in_um(route: Route, steps: tuple[int, int]) -> tuple[int, int]:
    """Return steps of both axes as um."""
    return steps[0] * route.step_um, steps[1] * route.step_um


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """What a machine did between two power cuts.

    Attributes:
        legs: its path.
        began: the state at its beginning.
    """

    legs: tuple[Leg, ...]
    began: State


@dataclass(frozen=True, eq=False)
class Record:
    """A run from its start to its end.

    Attributes:
        controller: of the machine.
        route: of the program.
        setup: of the machine.
        feeds: from which step on the feed signal had another frequency.
        sessions: in their order.
        events: likewise.
        state: at the end.
        walked: how many steps of the path were made, back and forth.
        pulses: how many steps the motors made.
        seconds: what each kind of way took, s; a take-up goes with the step behind it.
        off_um: by how much the table was off the commanded place, the largest on x and on y.
        findings: what to say of it.
    """

    controller: Controller
    route: Route
    setup: Setup
    feeds: tuple[tuple[int, float], ...]
    sessions: tuple[Session, ...]
    events: tuple[Event, ...]
    state: State
    walked: int
    pulses: int
    off_um: tuple[int, int]
    seconds: Mapping[Way, float]
    findings: tuple[Diagnostic, ...] = ()

    @property
    def finished(self) -> bool:
        """Whether the program was run to its end."""
        return self.state.stand.mode is Mode.END

    @property
    def spent(self) -> dict[str, float]:
        """How long this run cut (or drew), moved with the generator off, and went back, s."""
        began, seconds = self.sessions[0].began.time_s, self.seconds
        back = seconds[Way.RETREAT] + seconds[Way.RETURN] + seconds[Way.SHORTEST]
        # A take-up that the power cut into goes with the step before which it is made.
        forward = self.state.time_s - began - back - seconds[Way.MOVE]
        first = "cutting" if self.setup.dry_ms is None else "drawing"
        again = seconds[Way.SERVO_FEED]
        return {
            first: max(forward - again, 0.0),
            "moving": seconds[Way.MOVE],
            "back": back,
            **({"servo-feed": again} if again else {}),
        }

    @property
    def final_um(self) -> tuple[int, int]:
        """Where the table stands at the end, from the start of the program."""
        return in_um(self.route, table_of(self.state.axes, self.setup))

    @property
    def commanded_um(self) -> tuple[int, int]:
        """Where the controller has the machine at the end, from the start of the program."""
        return in_um(self.route, commanded_at(self.route, self.state.stand))

    def motions(self) -> Iterator[Motion]:
        """Yield every step of the run, some at a time; times from the start of the program.

        Places are steps.
        """
        for one in self.sessions:
            yield from self.parts_of(one)

    def parts_of(self, one: Session) -> Iterator[Motion]:
        """Yield the steps of a session, some at a time."""
        began = one.began
        for part in batches(self.route, one.legs, began.axes, self.setup, self.feeds):
            yield replace(part, time=part.time + began.time_s)
