"""What came of a simulated run, as people read it on standard error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wedmcam.cli.terminal import print_text
from wedmcam.operations.simulate import Simulation
from wedmcam.reports.picture.simulation import hours
from wedmcam.simulate.record import Event, Record

#: So many events are listed without -v, half of them the first ones and half the last.
LISTED = 30


def print_simulation(simulation: Simulation, verbose: bool, state: str | None) -> None:
    """Print a run: what was entered, its events, where it ended."""
    record = simulation.record
    if record is None:
        return
    setup, route = record.setup, record.route
    x, y = setup.backlash
    dry = setup.dry_ms is not None
    print_text(
        f"runs       {_number(len(route.program.blocks), 'block')}, {route.steps} steps on the "
        f"{record.controller}: {'drawn dry' if dry else 'cut'}",
        err=True,
    )
    play = "" if setup.play == setup.backlash else ", play X {} Y {} um".format(*setup.play)
    delay = f"{setup.dry_ms} ms a step; " if dry else ""
    print_text(f"enter      {delay}backlash X {x} Y {y} um{play}{_approach(record)}", err=True)
    _print_events(record, verbose)
    _print_end(record)
    if state is not None:
        print_text(f"state      {state}: --resume {state} goes on", err=True)


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
    rows = list(enumerate(record.events, 1))
    left = len(rows) - LISTED
    if verbose or left <= 0:
        shown, rest = rows, []
    else:
        shown, rest = rows[: LISTED // 2], rows[-LISTED // 2 :]
    head = ("", "time", "step", "block", "J", "x mm", "y mm", "event")
    lines = [(str(n), *_row(event)) for n, event in shown]
    if rest:
        lines.append(("...", "", "", "", "", "", "", f"{left} more; -v lists all"))
        lines += [(str(n), *_row(event)) for n, event in rest]
    widths = [max(map(len, column)) for column in zip(head, *lines, strict=True)]
    for line in (head, *lines):
        *cells, what = line
        text = "  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=False))
        print_text(f"{text}  {what}", err=True)


def _row(event: Event) -> tuple[str, ...]:
    x, y = (f"{um / 1000 + 0.0:.3f}" for um in event.table_um)
    what = _SENTENCES[event.kind].format(**_filled(event.more))
    return hours(event.time_s), str(event.step), str(event.block), str(event.j), x, y, what


def _filled(more: Mapping[str, Any]) -> dict[str, Any]:
    cut = more.get("pulses", 0)
    return {**more, "within": f", behind {cut} steps of taking up play" if cut else ""}


#: What happened, as a sentence.
_SENTENCES = {
    "pause": "pause",
    "thread-point": "thread point: the machine stops",
    "short": "short circuit: no feed signal; {length} um back it is free",
    "clear": "the feed signal is back: cut on",
    "alarm": "ALARM: still shorted; the machine stops",
    "clear-alarm": "the fault is cleared: cut on",
    "break": "ALARM: the wire is broken",
    "back": "returned to {where}: cut on",
    "power-cut": "the power fails{within}; the state is saved",
    "resume": "resume from the saved state",
    "end": "end of the program",
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
