"""A picture of a simulated run: where the table went, forth and back, and J over time.

Above the path of the table, its ways back as a band below it in another colour; below the count J
as the display showed it, and once more about the first way back, where it rises. Faults are
numbered as in the list of events. However long a run is, each curve has some thousand places
(`curves`): of the path where it went for the first time, of ways back what they covered.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from wedmcam.reports.picture.curves import Points, Samples, Trail, polyline, stretches
from wedmcam.reports.picture.page import page
from wedmcam.reports.picture.sheet import FONT, GREY, INK, nice, number, words
from wedmcam.simulate.motion import Motion
from wedmcam.simulate.process import WAYS, Way
from wedmcam.simulate.record import Event, Record, table_of
from wedmcam.simulate.route import Route

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Sheet units: A4 across, 4 a mm of paper.
WIDTH, HEIGHT = 1188.0, 840.0
#: Of the path (left, top, right, bottom), and of J.
PATH_FRAME = (44.0, 64.0, 1160.0, 560.0)
J_FRAME = (110.0, 612.0, 1160.0, 770.0)
#: Of J where J about the first way back stands beside it, and of that.
J_FRAMES = ((110.0, 612.0, 780.0, 770.0), (870.0, 612.0, 1160.0, 770.0))
#: So many steps before and behind the first way back are shown there.
AROUND = 150
#: Places nearer to each other than this are one, sheet units.
APART = 0.3
#: At most so many shortest ways back are drawn; more than so many are thin.
STRAIGHT, MANY = 200, 20
PAD = 30.0
#: Average advance of a letter of the legend.
LETTER = 6.7

#: Kind of a way -> colour and width of its line, and what the legend calls it.
STYLES = {
    Way.CUT: ("#c1121f", 1.5, "cut"),
    Way.MOVE: ("#2563a8", 1.5, "move, generator off"),
    Way.RETREAT: ("#f59e0b", 4.0, "back from a short circuit"),
    Way.RETURN: ("#7b2cbf", 3.0, "back along the path"),
    Way.SHORTEST: ("#0b7a55", 2.0, "the shortest way back"),
    Way.SERVO_FEED: ("#0891b2", 2.0, "forward with a reference current"),
}
#: Events that are marked.
MARKED = ("short", "alarm", "break", "power-cut", "stop", "limit", "tape", "no-tape")
#: So many of them are marked at most, and so many have a number on the path.
MARKS = 1000
NUMBERS = 60


def plot_run(record: Record, title: str = "") -> str:
    """Return a run as SVG."""
    seen = _mm(record.route, record.route.place)
    frame = _Frame(PATH_FRAME, seen.min(axis=0), seen.max(axis=0), equal=True)
    curves = _Curves(record, APART / float(frame.scale[0]))
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="1123" height="794" '
        f'viewBox="0 0 {number(WIDTH)} {number(HEIGHT)}" '
        f'font-family="{FONT}" fill="{INK}" font-size="13">',
        f'<rect width="{number(WIDTH)}" height="{number(HEIGHT)}" fill="#fff"/>',
        f'<text x="44" y="38" font-size="22" font-weight="bold">{words(title)}</text>',
        f'<text x="1160" y="38" text-anchor="end">{words(_facts(record))}</text>',
        *_path(record, curves, frame),
        *_counts(record, curves),
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
        f"{record.controller.title}, {what}, {record.route.steps} steps, {record.walked} made, "
        f"{end}, {hours(record.state.time_s)}"
    )


def hours(seconds: float) -> str:
    """Return a time as h:mm:ss.

    >>> hours(59.6), hours(3723.4)
    ('0:01:00', '1:02:03')
    """
    whole = round(seconds)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def _window(record: Record) -> tuple[float, float] | None:
    """Return the time about the first way back, s; None where there is none."""
    events = record.events
    # J rises in a retreat, and may stand still on another way back.
    kinds = [one for kind in ("short", "break") for one in events if one.kind == kind]
    if not kinds:
        return None
    first = kinds[0]
    feeds_again = record.controller.answers.servo_feed
    ends = ("front" if feeds_again else "clear", "alarm", "back")
    back = next((one for one in events if one.kind in ends and one.walked > first.walked), None)
    around = AROUND / record.setup.feed
    until = record.state.time_s if back is None else back.time_s
    begin, end = record.sessions[0].began.time_s, record.state.time_s
    return max(first.time_s - around, begin), min(until + around, end)


class _Curves:
    """What a picture needs of the motions of a run, which are gone through once.

    Attributes:
        table: where the table went on each kind of way forward, mm.
        whole: J over the time of the run.
        near: J over the time about the first way back; empty where there is none.
    """

    def __init__(self, record: Record, apart_mm: float) -> None:
        began, route = record.sessions[0].began, record.route
        window = _window(record)
        self.table = {way: Trail(apart_mm) for way in (Way.CUT, Way.MOVE)}
        self.whole = {way: Samples(began.time_s, record.state.time_s) for way in Way}
        self.near = {} if window is None else {way: Samples(*window) for way in Way}
        j = route.readings(np.arange(route.steps + 1))[4]
        reached, runs = began.stand.step, 0
        place = np.array([table_of(began.axes, record.setup)])
        for part in record.motions():
            forward = np.isin(part.ways, [WAYS.index(way) for way in self.table])
            highest = np.maximum.accumulate(np.where(forward, part.step, reached))
            first_time = part.step > np.concatenate([[reached], highest[:-1]])
            table = np.concatenate([place, part.table])
            for way, trail in self.table.items():
                for first, last in stretches(first_time & (part.ways == WAYS.index(way))):
                    trail.add(_mm(route, table[first : last + 1]))
            run = runs + np.cumsum(np.diff(part.ways, prepend=part.ways[:1]) != 0)
            self._count(part, j[part.step], run)
            reached, runs, place = int(highest[-1]), int(run[-1]), part.table[-1:]

    def _count(self, part: Motion, j: Ints, run: Ints) -> None:
        for way in Way:
            rows = part.ways == WAYS.index(way)
            if rows.any():
                for samples in (self.whole, self.near):
                    if samples:
                        samples[way].add(part.time[rows], j[rows], run[rows])


def _mm(route: Route, places: Ints) -> Floats:
    """Return places, steps from the start, as mm."""
    return places.astype(np.float64) * (route.step_um / 1000)


def _covered(record: Record, way: Way) -> Trail:
    """Return what the ways back of a kind covered of the path, mm."""
    route = record.route
    edges = np.zeros(route.steps + 1, np.int64)
    trail = Trail(0.001)
    for session in record.sessions:
        for leg in session.legs:
            if leg.way is way:
                edges[leg.last] += 1
                edges[leg.first] -= 1
    for first, last in stretches(np.cumsum(edges) > 0):
        trail.add(_mm(route, route.place[first : last + 1]))
    return trail


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


DASHES = ' stroke-dasharray="7 5"'


def _line(frame: _Frame, points: Points, colour: str, width: float, more: str = "") -> str:
    """Return a curve, lifted where its runs end; nothing where it has no places."""
    places, runs = points
    if not len(places):
        return ""
    return (
        f'<path d="{polyline(frame.at(places), runs)}" fill="none" stroke="{colour}" '
        f'stroke-width="{number(width)}" stroke-linejoin="round"{more}/>'
    )


def _straight(record: Record) -> Points:
    """Return the ends of the shortest ways back, mm: of many some, evenly."""
    legs = [leg for session in record.sessions for leg in session.legs if leg.way is Way.SHORTEST]
    ends = list(dict.fromkeys((leg.first, leg.last) for leg in legs))
    some = np.array(ends[:: -(-len(ends) // STRAIGHT) or 1], dtype=np.int64).reshape(-1)
    return _mm(record.route, record.route.place[some]), np.arange(len(some)) // 2


def _path(record: Record, curves: _Curves, frame: _Frame) -> list[str]:
    """Return the path of the table, threads and faults."""
    route = record.route
    threads = _mm(route, route.place[route.threads])
    out = [frame.border()]
    # Ways back lie below the path, so that both are seen.
    for way in (Way.RETREAT, Way.RETURN):
        out.append(_line(frame, _covered(record, way).places(), *STYLES[way][:2]))
    straight = _straight(record)
    colour, width, _ = STYLES[Way.SHORTEST]
    thin = width if len(straight[0]) <= 2 * MANY else width / 3
    out.append(_line(frame, straight, colour, thin, DASHES))
    rest = Trail(APART / float(frame.scale[0]))
    rest.add(_mm(route, route.place))
    out.append(_line(frame, rest.places(), "#cbd2d9", 1.0))
    for way, trail in curves.table.items():
        more = DASHES if way is Way.MOVE else ""
        out.append(_line(frame, trail.places(), *STYLES[way][:2], more))
    for x, y in frame.at(np.unique(threads, axis=0)).tolist():
        out.append(
            f'<path d="M{number(x - 6)} {number(y)}h12M{number(x)} {number(y - 6)}v12" '
            f'stroke="{INK}" stroke-width="1.6" fill="none"/>'
        )
    marks = numbered(record.events)[:MARKS]
    places = np.array([event.table_um for _, event in marks], dtype=float).reshape(-1, 2) / 1000
    taken: list[tuple[float, float, float]] = []
    for (n, _), (x, y) in zip(marks, frame.at(places).tolist(), strict=True):
        wide = 8.0 * len(str(n))
        free = all(abs(y - v) > 14 or x > u + w or x + wide < u for u, v, w in taken)
        show = len(taken) < NUMBERS and free
        if show:
            taken.append((x, y, wide))
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
    um = nice(1000 * 120.0 / float(frame.scale[0]) / 2.5)
    units = um / 1000 * float(frame.scale[0])
    text = f"{number(um / 1000)} mm" if um >= 1000 else f"{number(um)} um"
    left, bottom = PATH_FRAME[0] + 14, PATH_FRAME[3] - 14
    return (
        f'<path d="M{number(left)} {number(bottom)}h{number(units)}m0 -4v8m{number(-units)} -8v8" '
        f'stroke="{INK}" fill="none"/><text x="{number(left + units + 8)}" '
        f'y="{number(bottom + 4)}">{text}</text>'
    )


def _counts(record: Record, curves: _Curves) -> list[str]:
    """Return J over time, with the faults; beside it about the first way back."""
    begin, end = record.sessions[0].began.time_s, record.state.time_s
    window = _window(record)
    if window is None:
        return _count(record, curves.whole, (begin, end), J_FRAME)
    whole, near = J_FRAMES
    return [
        *_count(record, curves.whole, (begin, end), whole),
        *_count(record, curves.near, window, near, near=True),
    ]


def _count(
    record: Record,
    samples: Mapping[Way, Samples],
    time: tuple[float, float],
    box: tuple[float, float, float, float],
    near: bool = False,
) -> list[str]:
    """Return J over a time, s, in a frame: from 0, or ``near`` as high as it goes there."""
    points = {way: one.points() for way, one in samples.items()}
    every = np.concatenate([p[:, 1] for p, _ in points.values()])
    most = float(max(every.max(initial=1), 1))
    least = float(every.min(initial=most)) if near else 0.0
    first, last = time[0], max(time[1], time[0] + 1e-6)
    frame = _Frame(box, np.array([first, least]), np.array([last, most]), equal=False)
    left, top, right, bottom = box
    out = [frame.border()]
    for way, curve in points.items():
        width = 1.0 if way in (Way.CUT, Way.MOVE) else 2.0
        out.append(_line(frame, curve, STYLES[way][0], width, ' stroke-linecap="round"'))
    lines, taken = [], -math.inf
    for n, event in numbered(record.events)[:MARKS]:
        if not first <= event.time_s <= last:
            continue
        x = float(frame.at(np.array([[event.time_s, 0.0]]))[0, 0])
        if x - taken > 7 + 8 * len(str(n)):
            lines.append(f"M{number(x, 2)} {number(top)}V{number(bottom)}")
            out.append(
                f'<text x="{number(x, 2)}" y="{number(top - 4)}" font-size="11" fill="#d00000" '
                f'text-anchor="middle">{n}</text>'
            )
            taken = x
    out.append(
        f'<path d="{"".join(lines)}" stroke="#d00000" stroke-width="0.8" stroke-dasharray="3 3"/>'
        f'<text x="{number(left - 8)}" y="{number(top + 10)}" text-anchor="end">'
        f"{number(most)} um</text>"
        f'<text x="{number(left - 8)}" y="{number(bottom)}" text-anchor="end">J '
        f"{number(least)}</text>"
        f'<text x="{number(left)}" y="{number(bottom + 18)}">{hours(first)}</text>'
        f'<text x="{number(right)}" y="{number(bottom + 18)}" text-anchor="end">'
        f"{hours(last)}</text>"
        f'<text x="{number((left + right) / 2)}" y="{number(bottom + 18)}" text-anchor="middle">'
        f"{'about the first way back' if near else 'time, h:mm:ss'}</text>"
    )
    return out


def _legend(record: Record) -> list[str]:
    """Return what the colours mean, as far as they are used, in one row."""
    used = {leg.way for session in record.sessions for leg in session.legs}
    rows: list[tuple[str, str]] = []  # a symbol as SVG, from the left end of the row; a text
    for way, (colour, width, name) in STYLES.items():
        if way in used:
            stroke = f'stroke="{colour}" stroke-width="{number(width)}"'
            rows.append((f'<path d="M0 -4h26" {stroke}/>', name))
    if numbered(record.events):
        rows.append(("".join(_mark(13, -4, None)), "numbers: events of the report"))
    rows.append((f'<path d="M8 -4h10M13 -9v10" stroke="{INK}"/>', "thread point"))
    left, right = 44.0, 1160.0
    wide = [32 + LETTER * len(text) for _, text in rows]
    gap = min(28.0, (right - left - sum(wide)) / max(len(rows) - 1, 1))
    out, x = [], left
    for (symbol, text), width in zip(rows, wide, strict=True):
        out.append(
            f'<g transform="translate({number(x)} 816)">{symbol}<text x="32">{text}</text></g>'
        )
        x += width + gap
    return out


def plot_run_html(record: Record, title: str = "") -> str:
    """Return a page with the picture of `plot_run` and a table of the events."""
    panel = record.controller.lamps is not None
    rows = [
        (
            str(n),
            hours(event.time_s),
            event.kind,
            str(event.j),
            str(event.block),
            str(event.step),
            *([" + ".join(event.lamps)] if panel else []),
        )
        for n, event in enumerate(record.events, 1)
    ]
    head = ("", "time", "event", "J", "block", "step", *(["lamps"] if panel else []))
    return page(plot_run(record, title), title=title, head=head, rows=rows)
