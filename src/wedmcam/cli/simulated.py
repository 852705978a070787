"""What came of a simulated run, as people read it on standard error."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import accumulate
from typing import Any

from wedmcam.cli.terminal import print_text
from wedmcam.operations.simulate import Simulation
from wedmcam.reports.picture.simulation import hours
from wedmcam.simulate.process import Way
from wedmcam.simulate.record import Event, Record, in_um

#: So many events are listed without -v, half of them the first ones and half the last.
LISTED = 30


def print_simulation(simulation: Simulation, verbose: bool, state: str | None) -> None:
    """Print a run: what was entered, its events, where it ended."""
    record = simulation.record
    if record is None:
        return
    setup, route = record.setup, record.route
    dry = setup.dry_ms is not None
    print_text(
        f"runs       {_number(route.blocks, 'block')}, {route.steps} steps on the "
        f"{record.controller.title}: {'drawn dry' if dry else 'cut'}",
        err=True,
    )
    delay = f"{setup.dry_ms} ms a step; " if dry else ""
    play = "play X {} Y {} um".format(*in_um(route, setup.play))
    if record.controller.takes_up_play:
        x, y = in_um(route, setup.backlash)
        play = f", {play}" if setup.play != setup.backlash else ""
        play = f"backlash X {x} Y {y} um{play}"
    print_text(f"enter      {delay}{play}{_approach(record)}", err=True)
    _print_events(record, verbose)
    _print_end(record)
    if simulation.servo is not None:
        _print_servo(simulation.servo)
    if state is not None:
        print_text(f"state      {state}: --resume {state} goes on", err=True)


def _print_servo(figures: Mapping[str, Any]) -> None:
    """Print what the servo did."""
    f = figures
    print_text(
        f"servo      {f['servo']}: {f['pulses']} pulses, {f['open_percent']:.1f} % open, "
        f"{f['short_percent']:.1f} % shorts; {_number(f['retreats'], 'retreat')}; gap "
        f"{f['gap_um']:.1f} um, +/-{f['spread_um']:.1f}",
        err=True,
    )


def _number(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _approach(record: Record) -> str:
    setup = record.setup
    if setup.approach == setup.true_approach == (1, 1):
        return ""
    signs = {1: "+", -1: "-"}
    entered = " ".join(f"{k}{signs[v]}" for k, v in zip("XY", setup.approach, strict=True))
    true = " ".join(f"{k}{signs[v]}" for k, v in zip("XY", setup.true_approach, strict=True))
    more = "" if setup.approach == setup.true_approach else f", came {true}"
    return f", last approach {entered}{more}"


def _print_events(record: Record, verbose: bool) -> None:
    """Print the events, or the first and last of many."""
    rows = list(_told(record))
    left = len(rows) - LISTED
    if verbose or left <= 0:
        shown, rest = rows, []
    else:
        shown, rest = rows[: LISTED // 2], rows[-LISTED // 2 :]
    head = ("", "time", "step", "block", "J", "x mm", "y mm", "event")
    lines = [_row(n, event, what) for n, event, what in shown]
    if rest:
        lines.append(("...", "", "", "", "", "", "", f"{left} more; -v lists all"))
        lines += [_row(n, event, what) for n, event, what in rest]
    widths = [max(map(len, column)) for column in zip(head, *lines, strict=True)]
    for line in (head, *lines):
        *cells, what = line
        text = "  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=False))
        print_text(f"{text}  {what}", err=True)


def _told(record: Record) -> Iterator[tuple[int, Event, str]]:
    """Yield events with their numbers, and what happened as a sentence."""
    legs = [leg for session in record.sessions for leg in session.legs]
    ends = accumulate(leg.steps for leg in legs)
    straight = {end for leg, end in zip(legs, ends, strict=True) if leg.way is Way.SHORTEST}
    sentences = {**_SENTENCES, **record.controller.sentences}
    fault: Event | None = None
    for n, event in enumerate(record.events, 1):
        if event.kind in ("short", "break"):
            fault = event
        # Who goes on from a state of the way back does not know where that began.
        steps = None if fault is None else event.walked - fault.walked
        um = None if steps is None else steps * record.route.step_um
        what = sentences[event.kind].format(**_filled(event, steps, um, straight))
        yield n, event, f"{what} [{' + '.join(event.lamps)}]" if event.lamps else what
        if event.kind in ("clear", "alarm", "back"):
            fault = None


def _row(n: int, event: Event, what: str) -> tuple[str, ...]:
    x, y = (f"{um / 1000 + 0.0:.3f}" for um in event.table_um)
    cells = hours(event.time_s), str(event.step), str(event.block), str(event.j), x, y
    return str(n), *cells, what


def _filled(event: Event, steps: int | None, um: int | None, straight: set[int]) -> dict[str, Any]:
    """Return what the sentence of an event says.

    Args:
        event: itself.
        steps: from the fault until then; None where that is not known.
        um: how far that is.
        straight: where the shortest ways back end, in steps walked.
    """
    cut, until = event.more.get("pulses", 0), event.more.get("until")
    way = "the shortest way" if event.walked in straight else "along the path"
    return {
        **event.more,
        "ahead": f"what is read ahead goes on to step {until}" if until else "all of it was read",
        "switch": f": {event.more['switch']}" if "switch" in event.more else "",
        "within": f", behind {cut} steps of taking up play" if cut else "",
        "gone": "" if um is None else f"{um} um back ",
        "still": "" if um is None else f" {um} um back",
        "way": "" if steps is None else f", {steps} steps {way}",
    }


#: What happened, as a sentence.
_SENTENCES = {
    "pause": "pause",
    "thread-point": "thread point: the machine stops",
    "short": "short circuit: no feed signal; {length} um back it is free",
    "clear": "{gone}the feed signal is there: cut on",
    "alarm": "ALARM: still shorted{still}; the machine stops",
    "clear-alarm": "the fault is cleared: cut on",
    "break": "ALARM: the wire is broken",
    "back": "returned to {where}{way}: cut on",
    "power-cut": "the power fails{within}; the state is saved",
    "resume": "resume from the saved state",
    "end": "end of the program",
    "front": "where the short circuit was: cut on",
    "stop": "ALARM: emergency stop",
    "start": "the operator has seen to it: cut on",
    "limit": "ALARM: a limit switch",
    "tape": "no more of the tape is read; {ahead}",
    "no-tape": "nothing is left of what was read ahead: the machine stops",
}


def _print_end(record: Record) -> None:
    """Print where a run ended, and what it took."""
    x, y = (f"{um / 1000 + 0.0:.3f}" for um in record.final_um)
    px, py = (f"{um / 1000 + 0.0:.3f}" for um in record.commanded_um)
    motors = " ".join(f"{k} {axis.motor}" for k, axis in zip("XY", record.state.axes, strict=True))
    off = max(record.off_um)
    exact = "exact at every step" if not off else f"off the path by up to {off} um"
    end = "finished" if record.finished else "stopped"
    print_text(
        f"{end:10} table X {x} Y {y} mm (program X {px} Y {py}), {exact}; motors {motors} steps",
        err=True,
    )
    taken = record.pulses - record.walked
    there = record.route.steps
    back = f", {record.walked} back and forth" if record.walked != there else ""
    print_text(
        f"time       {hours(record.state.time_s)}; {there} steps of the program{back}, "
        f"{taken} more to take up play",
        err=True,
    )
    spent = [f"{kind} {hours(value)}" for kind, value in record.spent.items() if value]
    if len(spent) > 1:
        print_text(f"{'':11}{', '.join(spent)}", err=True)
