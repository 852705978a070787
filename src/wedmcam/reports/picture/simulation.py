"""A picture of a simulated run: where the table went, forth and back, and J over time.

Above the path of the table, its ways back beside it in another colour; below the count J as the
display showed it. Faults are numbered in both as in the list of events. However long a run is, some
thousand places of each curve are drawn, the extremes among them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.reports.picture.page import page
from wedmcam.reports.picture.sheet import GREY, INK, nice, number, words
from wedmcam.simulate.process import Way
from wedmcam.simulate.record import Event, Record

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: So many places of the path and of J are drawn at most.
MOST = 4000
#: Sheet units: A4 across, 4 a mm of paper.
WIDTH, HEIGHT = 1188.0, 840.0
#: Of the path (left, top, right, bottom), and of J.
PATH_FRAME = (44.0, 64.0, 1160.0, 560.0)
J_FRAME = (110.0, 612.0, 1160.0, 770.0)
PAD = 30.0

_WAYS = list(Way)
#: Kind of a way -> colour and width of its line, and what the legend calls it.
STYLES = {
    Way.CUT: ("#c1121f", 1.5, "cut"),
    Way.MOVE: ("#2563a8", 1.5, "move, generator off"),
    Way.RETREAT: ("#f59e0b", 4.0, "back from a short circuit"),
    Way.RETURN: ("#7b2cbf", 3.0, "back along the path"),
    Way.SHORTEST: ("#0b7a55", 2.0, "the shortest way back"),
}
#: Events that are marked.
MARKED = ("short", "alarm", "break", "power-cut")
#: So many of them have a number in the picture.
NUMBERS = 60


@dataclass(frozen=True, slots=True)
class _Curves:
    """Places of a run, thinned out: of each its way, time (s), table (um), J."""

    way: Ints
    time: Floats
    table: Ints
    j: Ints


def plot_run(record: Record, title: str = "") -> str:
    """Return a run as SVG."""
    curves = _thinned(record)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="1123" height="794" '
        f'viewBox="0 0 {number(WIDTH)} {number(HEIGHT)}" '
        'font-family="Helvetica, Arial, DejaVu Sans, sans-serif" '
        f'fill="{INK}" font-size="13">',
        f'<rect width="{number(WIDTH)}" height="{number(HEIGHT)}" fill="#fff"/>',
        f'<text x="44" y="38" font-size="22" font-weight="bold">{words(title)}</text>',
        f'<text x="1160" y="38" text-anchor="end">{words(_facts(record))}</text>',
        *_path(record, curves),
        *_count(record, curves),
        *_legend(record),
        "</svg>",
    ]
    return "\n".join(out) + "\n"


def numbered(events: Sequence[Event]) -> list[tuple[int, Event]]:
    """Return the events that are marked, each with its number in the list of events, from 1."""
    return [(n, event) for n, event in enumerate(events, 1) if event.kind in MARKED]


def _facts(record: Record) -> str:
    setup = record.setup
    what = "dry run" if setup.dry_ms is not None else "cutting"
    end = "to the end" if record.finished else f"stopped at step {record.state.stand.step}"
    return (
        f"{record.controller}, {what}, {record.route.steps} steps, {record.walked} made, {end}, "
        f"{hours(record.state.time_s)}"
    )


def hours(seconds: float) -> str:
    """Return a time as h:mm:ss.

    >>> hours(59.6), hours(3723.4)
    ('0:01:00', '1:02:03')
    """
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def _thinned(record: Record) -> _Curves:
    """Return places of a run: every so many, where the way changes, and the extremes of J."""
    every = max(1, record.walked // MOST)
    parts: list[tuple[Ints, Floats, Ints, Ints]] = []
    done = 0
    for part in record.motions():
        count = len(part.step)
        *_, j = record.route.readings(part.step)
        keep = np.zeros(count, bool)
        keep[(-done) % every :: every] = True
        keep[[0, count - 1]] = True
        turns = np.flatnonzero(np.diff(part.ways))
        keep[turns] = keep[turns + 1] = True
        whole = count // every * every
        if whole:
            rows = j[:whole].reshape(-1, every)
            base = np.arange(len(rows)) * every
            keep[base + rows.argmin(axis=1)] = keep[base + rows.argmax(axis=1)] = True
        at = np.flatnonzero(keep)
        parts.append((part.ways[at].astype(np.int64), part.time[at], part.table[at], j[at]))
        done += count
    if not parts:
        empty = np.zeros(0, np.int64)
        return _Curves(empty, empty.astype(float), np.zeros((0, 2), np.int64), empty)
    way, time, table, j = (np.concatenate(column) for column in zip(*parts, strict=True))
    return _Curves(way, time, table, j)


class _Frame:
    """A rectangle of the sheet in which a curve is drawn; x to the right, y up."""

    def __init__(
        self, frame: tuple[float, float, float, float], low: Floats, high: Floats, equal: bool
    ) -> None:
        left, top, right, bottom = frame
        pad = PAD if equal else 0.0
        span = np.maximum(high - low, 1e-9)
        room = np.array([right - left - 2 * pad, bottom - top - 2 * pad])
        self.scale = np.full(2, (room / span).min()) if equal else room / span
        middle = np.array([(left + right) / 2, (top + bottom) / 2])
        self._flip = np.array([1.0, -1.0])
        self._shift = middle - self.scale * self._flip * (low + high) / 2
        self.frame = frame

    def at(self, places: NDArray[np.generic]) -> Floats:
        """Return places on the sheet, shape (n, 2)."""
        out: Floats = self._shift + self.scale * self._flip * places
        return out

    def border(self) -> str:
        left, top, right, bottom = self.frame
        return (
            f'<rect x="{number(left)}" y="{number(top)}" width="{number(right - left)}" '
            f'height="{number(bottom - top)}" fill="none" stroke="{GREY}" stroke-width="0.8"/>'
        )


def _line(points: Floats, colour: str, width: float, more: str = "") -> str:
    text = " ".join(f"{number(x, 2)},{number(y, 2)}" for x, y in points.tolist())
    return (
        f'<polyline points="{text}" fill="none" stroke="{colour}" '
        f'stroke-width="{number(width)}" stroke-linejoin="round"{more}/>'
    )


def _path(record: Record, curves: _Curves) -> list[str]:
    """Return the path of the table, threads and faults."""
    threads = record.route.place[record.route.threads]
    route = record.route
    every = max(1, route.steps // MOST)
    steps = np.concatenate([np.arange(0, route.steps, every), route.first, [route.steps]])
    steps = np.unique(steps)
    seen = np.concatenate([route.place[steps], curves.table]).astype(float)
    frame = _Frame(PATH_FRAME, seen.min(axis=0), seen.max(axis=0), equal=True)
    out = [frame.border(), _line(frame.at(route.place[steps]), "#cbd2d9", 1.0)]
    begin = np.concatenate([[0], 1 + np.flatnonzero(np.diff(curves.way)), [len(curves.way)]])
    pieces = []
    for first, last in zip(begin[:-1].tolist(), begin[1:].tolist(), strict=True):
        if first < last:
            # A stretch begins where the one before ends.
            places = curves.table[max(first - 1, 0) : last]
            if first == 0:
                places = np.concatenate([np.zeros((1, 2), np.int64), places])
            pieces.append((_WAYS[int(curves.way[first])], places))
    # Ways back lie below the path, so that both are seen.
    for kind in (Way.RETREAT, Way.RETURN, Way.SHORTEST, Way.MOVE, Way.CUT):
        colour, width, _ = STYLES[kind]
        more = ' stroke-dasharray="7 5"' if kind in (Way.MOVE, Way.SHORTEST) else ""
        out += [
            _line(frame.at(places), colour, width, more)
            for way, places in pieces
            if way is kind and len(places) > 1
        ]
    for x, y in frame.at(np.unique(threads, axis=0)).tolist():
        out.append(
            f'<path d="M{number(x - 6)} {number(y)}h12M{number(x)} {number(y - 6)}v12" '
            f'stroke="{INK}" stroke-width="1.6" fill="none"/>'
        )
    marks = numbered(record.events)
    places = np.array([event.table_um for _, event in marks], dtype=float).reshape(-1, 2)
    taken: set[tuple[int, int]] = set()
    for k, ((n, _), (x, y)) in enumerate(zip(marks, frame.at(places).tolist(), strict=True)):
        cell = (int(x // 18), int(y // 18))
        show = k < NUMBERS and cell not in taken
        taken.add(cell)
        out += _mark(x, y, n if show else None)
    out.append(_scale(frame))
    return out


def _mark(x: float, y: float, n: int | None) -> list[str]:
    out = [
        f'<circle cx="{number(x, 2)}" cy="{number(y, 2)}" r="4" fill="#fff" stroke="#d00000" '
        'stroke-width="1.8"/>'
    ]
    if n is not None:
        out.append(
            f'<text x="{number(x + 6, 2)}" y="{number(y - 6, 2)}" font-size="12" fill="#d00000" '
            f'stroke="#fff" stroke-width="3" paint-order="stroke">{n}</text>'
        )
    return out


def _scale(frame: _Frame) -> str:
    """Return a bar of a round length."""
    um = nice(120.0 / float(frame.scale[0]) / 2.5)
    units = um * float(frame.scale[0])
    text = f"{number(um / 1000)} mm" if um >= 1000 else f"{number(um)} um"
    left, bottom = PATH_FRAME[0] + 14, PATH_FRAME[3] - 14
    return (
        f'<path d="M{number(left)} {number(bottom)}h{number(units)}m0 -4v8m{number(-units)} -8v8" '
        f'stroke="{INK}" fill="none"/><text x="{number(left + units + 8)}" '
        f'y="{number(bottom + 4)}">{text}</text>'
    )


def _count(record: Record, curves: _Curves) -> list[str]:
    """Return J over time, with the faults."""
    seconds = max(record.state.time_s, 1e-6)
    most = float(max(curves.j.max(initial=1), 1))
    first = min(float(curves.time[0]), seconds) if len(curves.time) else 0.0
    begin = record.sessions[0].began.time_s
    first = min(first, begin)
    frame = _Frame(J_FRAME, np.array([first, 0.0]), np.array([seconds, most]), equal=False)
    left, top, right, bottom = J_FRAME
    out = [frame.border()]
    curve = np.column_stack([curves.time, curves.j.astype(float)])
    if len(curve) > 1:
        out.append(_line(frame.at(curve), STYLES[Way.CUT][0], 1.0))
    last = -math.inf
    for n, event in numbered(record.events)[:NUMBERS]:
        x = float(frame.at(np.array([[event.time_s, 0.0]]))[0, 0])
        out.append(
            f'<path d="M{number(x, 2)} {number(top)}V{number(bottom)}" stroke="#d00000" '
            'stroke-width="0.8" stroke-dasharray="3 3"/>'
        )
        if x - last > 16:
            out.append(
                f'<text x="{number(x, 2)}" y="{number(top - 4)}" font-size="11" fill="#d00000" '
                f'text-anchor="middle">{n}</text>'
            )
            last = x
    out.append(
        f'<text x="{number(left - 8)}" y="{number(top + 10)}" text-anchor="end">'
        f"{number(most)} um</text>"
        f'<text x="{number(left - 8)}" y="{number(bottom)}" text-anchor="end">J 0</text>'
        f'<text x="{number(left)}" y="{number(bottom + 18)}">{hours(first)}</text>'
        f'<text x="{number(right)}" y="{number(bottom + 18)}" text-anchor="end">'
        f"{hours(seconds)}</text>"
        f'<text x="{number((left + right) / 2)}" y="{number(bottom + 18)}" text-anchor="middle">'
        "time, h:mm:ss</text>"
    )
    return out


def _legend(record: Record) -> list[str]:
    """Return what the colours mean, as far as they are used."""
    used = {leg.way for session in record.sessions for leg in session.legs}
    out, x, y = [], 44.0, 816.0
    for way, (colour, width, name) in STYLES.items():
        if way in used:
            out.append(
                f'<path d="M{number(x)} {number(y - 4)}h26" stroke="{colour}" '
                f'stroke-width="{number(width)}"/><text x="{number(x + 32)}" y="{number(y)}">'
                f"{name}</text>"
            )
            x += 60 + 7.2 * len(name)
    if numbered(record.events):
        text = "numbers: events of the report"
        out += _mark(x + 8, y - 4, None)
        out.append(f'<text x="{number(x + 20)}" y="{number(y)}">{text}</text>')
        x += 60 + 7.2 * len(text)
    out.append(f'<text x="{number(x)}" y="{number(y)}">+ thread point</text>')
    return out


def plot_run_html(record: Record, title: str = "") -> str:
    """Return a page with the picture of `plot_run` and a table of the events."""
    rows = [
        (
            str(n),
            hours(event.time_s),
            event.kind,
            str(event.j),
            str(event.block),
            str(event.step),
        )
        for n, event in enumerate(record.events, 1)
    ]
    head = ("", "time", "event", "J", "block", "step")
    return page(plot_run(record, title), title=title, head=head, rows=rows)
