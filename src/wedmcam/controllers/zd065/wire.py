"""The wire's path beside an outline: what becomes of its blocks and corners, as columns.

Vertices are whole um, where the outline's corners are, and a rest in 8-digit decimals.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.chains import Chain, Places
from wedmcam.controllers.zd065.data import decimals
from wedmcam.controllers.zd065.loop import EXACT
from wedmcam.controllers.zd065.transition import Pair, crossing, joined, transition
from wedmcam.ir.program import Kind

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Corners whose arc would be shorter than this on the outline have none, um; an arc of the wire of
#: a smaller radius is a turn on the spot.
LEAST_UM = 2.0
#: The direction of a block is known to this over its length, or over its radius, um: its numbers
#: are whole, and it ends where it steps. A turn that this explains is no corner, up to `MOST_TURN`.
ROUNDED_UM = 1.5
MOST_TURN = 0.35
#: Legs may lack this of what an arc needs, um.
ROOM_UM = 0.5
#: Arcs that are shorter than this are cut as lines, um.
SHORT_UM = 3.0
#: Sharpest corner at which punch and die do not meet where the radius of each is its gap, degrees:
#: with gaps f and f - z their clearance is z (2 - 1 / sin(angle / 2)).
ACUTE_DEG = 60.0
#: How far from the corner offset arcs may meet, gaps.
FARTHEST_GAPS = 4.0


@dataclass(frozen=True, slots=True)
class Problem:
    """What stands in the way of a gap, or was decided for the operator.

    Attributes:
        what: ``below`` (r is smaller than the gap), ``turn`` (an arc of more than a turn),
            ``sides`` (arcs contradict each other on where outwards is), ``unknown`` (nothing says
            where it is), ``doubtful`` (arcs of another contour contradict it), ``shrinks`` (an arc
            vanishes), ``touch`` (no arc of radius r touches a line and an arc), ``leg`` (a block is
            too short for the arcs at its ends), ``meet`` (offset arcs do not meet), ``vanishes``
            (nothing is left of a block); ``open`` (a contour does not quite close), ``nesting``
            (the side follows from how contours lie), ``lead`` (one runs through what is kept) and
            ``acute`` (a corner at which punch and die meet, if the radius of each is its gap) are
            no errors.
        block: number of the stated block, from 0.
        values: lengths in um, and what else there is to say.
    """

    what: str
    block: int
    values: dict[str, Any]


class Wire:
    """Joints and blocks of an outline as columns, and what becomes of them."""

    def __init__(
        self,
        figure: NDArray[np.void],
        places: Places,
        chains: list[Chain],
        shift: Ints,
        corner_um: float,
    ) -> None:
        n = len(figure)
        self.figure, self.places, self.chains, self.corner = figure, places, chains, corner_um
        self.arc: Bools = np.asarray(figure["kind"] == Kind.ARC)
        self.turn = np.where(self.arc, figure["turn"], 0).astype(np.int64)
        #: To the left of the path, um; 0 outside the outlines.
        self.shift: Ints = np.zeros(n, dtype=np.int64)
        self.body: Bools = np.zeros(n, dtype=bool)
        pairs, corners = [np.zeros((0, 2), np.int64)], [np.zeros((0, 2), np.int64)]
        for chain, by in zip(chains, shift.tolist(), strict=True):
            rows = chain.body
            self.shift[rows], self.body[rows] = by, True
            pairs.append(np.stack([rows[:-1], rows[1:]], axis=1))
            corners.append(places.start[rows[1:]])
            if chain.closed == len(rows):
                pairs.append(np.array([[rows[-1], rows[0]]]))
                corners.append(places.start[rows[:1]])
        self.before, self.after = np.concatenate(pairs).T
        self.corners: Ints = np.concatenate(corners)
        self.problems: list[Problem] = []
        self._directions()
        if self.problems:
            return
        self._joints()
        self._check_legs()
        if not self.problems:
            self._check_rest()

    def _directions(self) -> None:
        """Set normals and curvatures of blocks at their starts and ends."""
        places, arc, turn = self.places, self.arc, self.turn
        self.normal: list[Pair] = []
        self.curvature: list[Any] = []
        radius = []
        for at in (places.start, places.end):
            # Left normals: of a line to the left of its way, of an arc to or from its centre.
            way = places.end - places.start
            x = np.where(arc, turn * (places.centre - at)[:, 0], -way[:, 1])
            y = np.where(arc, turn * (places.centre - at)[:, 1], way[:, 0])
            x, y = np.where(self.body, x, 1), np.where(self.body, y, 0)
            self._endless(x, y)
            dx, dy = decimals(x), decimals(y)
            length = dx.hypot(dy)
            self.normal.append(Pair(dx / length, dy / length))
            self.curvature.append(decimals(np.where(self.body, turn, 0)) / length)
            radius.append(length.to_float())
        self.size = (radius[0] + radius[1]) / 2  # lengths of lines, radii of arcs
        wire = self.size - self.turn * self.shift
        self.problems += [
            Problem(
                "shrinks",
                int(k),
                {"radius_um": float(self.size[k]), "gap_um": abs(int(self.shift[k]))},
            )
            for k in np.flatnonzero(self.arc & self.body & (wire < 1.0))
        ]
        self.radius = np.where(self.arc, wire, 0.0)

    def _endless(self, x: Any, y: Any) -> None:
        """Let blocks without a direction pass: they have no step and are errors elsewhere."""
        none = (x == 0) & (y == 0)
        x[none] = 1

    def _joints(self) -> None:
        """Set where each block's path on the wire starts and ends, and the arcs between blocks."""
        a, b, r = self.before, self.after, self.corner
        first, second = self.normal[1].at(a), self.normal[0].at(b)
        bend, other = self.curvature[1][a], self.curvature[0][b]
        angle = np.arctan2(first.cross(second).to_float(), first.dot(second).to_float())
        unsure = np.minimum(ROUNDED_UM / self.size[a] + ROUNDED_UM / self.size[b], MOST_TURN)
        corner = (np.abs(angle) * r >= LEAST_UM) & (np.abs(angle) >= unsure)
        arcs = self.arc[a] & self.arc[b]
        self.angle = angle
        self.rounded: Bools = corner & ~arcs
        by = decimals(self.shift[a])
        zero = by - by
        # Seen from the corner: where the block before ends and the one behind starts.
        out, into = Pair(zero.copy(), zero.copy()), Pair(zero.copy(), zero.copy())
        self.sweep, self.wire_radius = np.zeros((2, len(a)))
        self.used = np.zeros((2, len(a)))  # of the block before and behind, um of the outline
        self.middle = Pair(zero.copy(), zero.copy())
        self.missing: Bools = np.zeros(len(a), dtype=bool)

        k = np.flatnonzero(~corner)
        place = joined(first.at(k), second.at(k), by[k])
        _put(out, k, place)
        _put(into, k, place)

        k = np.flatnonzero(corner & arcs)
        met = crossing(first.at(k), bend[k], second.at(k), other[k], by[k])
        _put(out, k, met.place)
        _put(into, k, met.place)
        far = np.hypot(met.place.x.to_float(), met.place.y.to_float())
        reach = FARTHEST_GAPS * np.abs(self.shift[a[k]])
        lost = ~met.exists | (far > reach)
        self.problems += [self._problem("meet", int(i), {}) for i in k[lost & (reach > 0)]]

        for k, back in (
            (np.flatnonzero(self.rounded & ~self.arc[a]), False),
            (np.flatnonzero(self.rounded & self.arc[a]), True),
        ):
            self._round(k, back, out, into)
        self.out, self.into = out, into

    def _round(self, k: Ints, back: bool, out: Pair, into: Pair) -> None:
        """Round corners of lines with what is behind them, or (``back``) of arcs before lines."""
        side, line, curve, bend = self._seen(k, back)
        by = decimals(np.where(back, -1, 1) * self.shift[self.before[k]])
        s, r = decimals(side), decimals(np.full(len(k), self.corner))
        t = transition(line, curve, bend, s, r)
        self.missing[k] = ~t.exists
        # Radius of the wire's arc: r + gap round the corner, r - gap inside it.
        wire = r - s * by
        on_line = line.times(by) - line.along().times(t.back)
        on_curve = t.centre - t.normal.times(s * wire)
        self.wire_radius[k] = wire.to_float()
        turned = np.arctan2(
            (s * line.cross(t.normal)).to_float(), line.dot(t.normal).to_float()
        ) % (2 * np.pi)
        self.sweep[k] = np.degrees(turned)
        # In the middle of the arc, for arcs that are cut as lines.
        half = line + t.normal
        size = half.dot(half).sqrt()
        size = np.where(size > 0, size, size + 1)
        middle = t.centre - Pair(half.x / size, half.y / size).times(s * wire)
        _put(self.middle, k, middle)
        _put(into if back else out, k, on_line)
        _put(out if back else into, k, on_curve)
        used_line, used_curve = t.back.to_float(), self._used(curve, t.normal, bend, t.back)
        self.used[0, k], self.used[1, k] = (
            (used_curve, used_line) if back else (used_line, used_curve)
        )

    def _seen(self, k: Ints, back: bool) -> tuple[Any, Pair, Pair, Any]:
        """Return side, line, curve and curvature of corners, as seen along the line to it."""
        a, b = self.before[k], self.after[k]
        side = np.sign(self.angle[k])
        before, behind = self.normal[1].at(a), self.normal[0].at(b)
        if not back:
            return side, before, behind, self.curvature[0][b]
        return (
            -side,
            Pair(-behind.x, -behind.y),
            Pair(-before.x, -before.y),
            -self.curvature[1][a],
        )

    @staticmethod
    def _used(curve: Pair, normal: Pair, bend: Any, back: Any) -> Floats:
        """Return how much of curves lies between the corner and the end of the arc, um."""
        bend_, back_ = _floats(bend), _floats(back)
        angle = np.abs(np.arctan2(_floats(curve.cross(normal)), _floats(curve.dot(normal))))
        bent = bend_ != 0
        return np.where(bent, angle / np.where(bent, np.abs(bend_), 1.0), back_)

    def _length(self) -> Floats:
        """Return how long blocks are on the outline, um."""
        return np.where(self.arc, np.radians(self.places.sweep) * self.size, self.size)

    def _check_legs(self) -> None:
        """Find corners that cannot have their arc."""
        need = np.zeros(len(self.figure))
        np.add.at(need, self.before, self.used[0])
        np.add.at(need, self.after, self.used[1])
        length = self._length()
        short = need > length + ROOM_UM
        untouched = np.zeros(len(self.figure), dtype=bool)
        untouched[self.before[self.missing]] = untouched[self.after[self.missing]] = True
        failed = np.flatnonzero(short | untouched)
        if not len(failed):
            return
        largest = np.full(len(self.figure), self.corner)
        largest[failed] = self._largest(failed)
        for k in np.flatnonzero(self.missing).tolist():
            most = float(min(largest[self.before[k]], largest[self.after[k]]))
            self.problems.append(
                self._problem("touch", k, {"corner_um": self.corner, "largest_um": most})
            )
        for k in np.flatnonzero(short & ~untouched).tolist():
            self.problems.append(
                Problem(
                    "leg",
                    k,
                    {
                        "corner_um": self.corner,
                        "largest_um": float(largest[k]),
                        "need_um": float(need[k]),
                        "length_um": float(length[k]),
                        "x_um": int(self.places.start[k, 0]),
                        "y_um": int(self.places.start[k, 1]),
                    },
                )
            )

    def _largest(self, blocks: Ints) -> Floats:
        """Return the largest radius with which blocks have their arcs at both ends, um."""
        at_start = np.full(len(self.figure), -1)
        at_end = at_start.copy()
        joints = np.arange(len(self.before))
        at_start[self.after], at_end[self.before] = joints, joints
        low, high = np.zeros(len(blocks)), np.full(len(blocks), self.corner)
        length = self._length()[blocks]
        for _ in range(40):
            radius = (low + high) / 2
            need = self._needed(at_start[blocks], radius, 1) + self._needed(
                at_end[blocks], radius, 0
            )
            fits = need <= length + 1e-3
            low, high = np.where(fits, radius, low), np.where(fits, high, radius)
        return np.floor(low)

    def _needed(self, joints: Ints, radius: Floats, which: int) -> Floats:
        """Return what arcs of some radii need of the blocks before (0) or behind (1) joints."""
        out = np.zeros(len(joints))
        for back in (False, True):
            arc = self.arc[self.before[joints]]
            k = np.flatnonzero((joints >= 0) & self.rounded[joints] & (arc == back))
            side, line, curve, bend = self._seen(joints[k], back)
            line, curve = (Pair(_floats(p.x), _floats(p.y)) for p in (line, curve))
            t = transition(line, curve, _floats(bend), side, radius[k])
            of_line = (which == 0) != back
            used = t.back if of_line else self._used(curve, t.normal, bend, t.back)
            out[k] = np.where(t.exists, used, np.inf)
        return out

    def _problem(self, what: str, joint: int, values: dict[str, Any]) -> Problem:
        x, y = self.corners[joint].tolist()
        return Problem(what, int(self.before[joint]), {**values, "x_um": x, "y_um": y})

    def acute(self) -> list[Problem]:
        """Return corners that are so sharp that punch and die need one radius."""
        angle = 180.0 - np.degrees(np.abs(self.angle))
        return [
            self._problem("acute", k, {"angle_deg": float(angle[k]), "corner_um": self.corner})
            for k in np.flatnonzero(self.rounded & (angle < ACUTE_DEG - 1e-3)).tolist()
        ]

    def _check_rest(self) -> None:
        """Set what is left of each block on the wire, and find blocks of which nothing is."""
        places, n = self.places, len(self.figure)
        zero = decimals(np.zeros(n))
        by = decimals(self.shift)
        self.start = Pair(*(np.where(self.body, c, zero) for c in self.normal[0].times(by)))
        self.end = Pair(*(np.where(self.body, c, zero) for c in self.normal[1].times(by)))
        _put(self.start, self.after, self.into)
        _put(self.end, self.before, self.out)
        ends = places.end.copy()
        ends[self.before] = self.corners  # a contour closes on its start
        self.ends: Ints = ends
        begin, finish = ((p.x.to_float(), p.y.to_float()) for p in (self.start, self.end))
        ahead = [_turned(self.normal[j], self.curvature[j], p, self.turn)
                 for j, p in enumerate((self.start, self.end))]  # fmt: skip
        self.begins = np.degrees(ahead[0])
        self.left = np.where(self.arc, places.sweep + np.degrees(ahead[1] - ahead[0]), 0.0)
        u = self.normal[0].along()
        dx = ends[:, 0] - places.start[:, 0] + finish[0] - begin[0]
        dy = ends[:, 1] - places.start[:, 1] + finish[1] - begin[1]
        along = u.x.to_float() * dx + u.y.to_float() * dy
        rest = np.where(self.arc, np.radians(self.left) * self.radius, along)
        # Ends that are joined may pass each other by what the turn explains.
        passed = np.zeros(n)
        moved = np.where(self.rounded, 0.0, np.abs(np.tan(np.clip(self.angle, -1, 1) / 2)))
        moved = np.minimum(moved, MOST_TURN) * np.abs(self.shift[self.before])
        np.add.at(passed, self.before, moved)
        np.add.at(passed, self.after, moved)
        lost = self.body & (rest < -passed - ROOM_UM - 1.0)
        self.problems += [
            Problem(
                "vanishes",
                k,
                {"gap_um": abs(int(self.shift[k])), "x_um": int(x), "y_um": int(y)},
            )
            for k, (x, y) in zip(
                np.flatnonzero(lost).tolist(), places.start[lost].tolist(), strict=True
            )
        ]
        self.short: Bools = self.arc & ((rest < SHORT_UM) | (self.radius < LEAST_UM))

    def rows(self) -> NDArray[np.void]:
        """Return the exact path, which starts within 1 um of (0, 0)."""
        figure, n = self.figure, len(self.figure)
        out = np.zeros(n, EXACT)
        line = self.short | ~self.body
        out["kind"] = np.where(line & self.arc, Kind.LINE, figure["kind"])
        arc = self.arc & ~line
        out["turn"] = np.where(arc, self.turn, 0)
        out["radius"] = np.where(arc, self.radius, 0.0)
        out["sweep"] = np.where(arc, np.minimum(self.left, 360.0), 0.0)
        late = self.places.start - self.places.centre
        first = np.degrees(np.arctan2(late[:, 1], late[:, 0])) + self.turn * self.begins
        out["start"] = np.where(arc, first % 360.0, 0.0)
        out["source"] = np.arange(n)
        out["x"] = self.ends[:, 0] + self.end.x.to_float()
        out["y"] = self.ends[:, 1] + self.end.y.to_float()
        origin = self._run_leads(out)
        more = self._arcs()
        order = np.concatenate([np.arange(n) * 4.0, self._order])
        path = np.concatenate([out, more])[np.argsort(order, kind="stable")]
        path["x"] -= origin[0]
        path["y"] -= origin[1]
        # Controls stand where the motion before them ends, behind the arc of a corner.
        moving = np.isin(path["kind"], (Kind.LINE, Kind.ARC, Kind.MOVE))
        last = np.maximum.accumulate(np.where(moving, np.arange(len(path)), -1))
        for name in ("x", "y"):
            path[name] = np.where(moving | (last < 0), path[name], path[name][last])
        path["x"][last < 0], path["y"][last < 0] = 0.0, 0.0
        return path

    def _run_leads(self, out: NDArray[np.void]) -> tuple[float, float]:
        """Let leads and moves run to where the wire begins; return where it starts, whole um."""
        kind, places = self.figure["kind"], self.places
        origin: tuple[float, float] | None = None
        for chain in self.chains:
            row = int(chain.body[0])
            begin = (
                places.start[row, 0] + float(self.start.x.to_float()[row]),
                places.start[row, 1] + float(self.start.y.to_float()[row]),
            )
            head = row
            if chain.lead_in >= 0:
                out["x"][chain.lead_in], out["y"][chain.lead_in] = begin
                head = chain.lead_in
                begin = tuple(places.start[head].tolist())
            moves = np.flatnonzero(kind[:head] == Kind.MOVE)
            cuts = np.flatnonzero((kind[:head] == Kind.LINE) | (kind[:head] == Kind.ARC))
            if len(moves) and (not len(cuts) or cuts[-1] < moves[-1]):
                out["x"][moves[-1]], out["y"][moves[-1]] = begin
            elif not len(cuts):
                origin = begin
        if origin is None:
            return 0.0, 0.0
        return float(np.floor(origin[0] + 0.5)), float(np.floor(origin[1] + 0.5))

    def _arcs(self) -> NDArray[np.void]:
        """Return the wire's arcs round corners, and the lines where it turns on the spot."""
        k = np.flatnonzero(self.rounded)
        side, radius, sweep = np.sign(self.angle[k]), self.wire_radius[k], self.sweep[k]
        arc = (radius >= LEAST_UM) & (np.radians(sweep) * radius >= SHORT_UM)
        spot = ~arc & (radius > 0)
        # The chord is enough unless the arc bulges from it.
        bulge = spot & (radius * (1 - np.cos(np.radians(sweep) / 2)) > 0.5)
        parts = []
        orders = []
        for which, places, order in ((bulge, self.middle, 1), (arc | spot, self.into, 2)):
            j = k[which]
            rows = np.zeros(len(j), EXACT)
            curved = arc[which] & (order == 2)
            rows["kind"] = np.where(curved, Kind.ARC, Kind.LINE)
            rows["turn"] = np.where(curved, side[which], 0)
            rows["radius"] = np.where(curved, radius[which], 0.0)
            rows["sweep"] = np.where(curved, sweep[which], 0.0)
            rows["source"] = self.before[j]
            rows["x"] = self.corners[j, 0] + places.x.to_float()[j]
            rows["y"] = self.corners[j, 1] + places.y.to_float()[j]
            parts.append(rows)
            orders.append(self.before[j] * 4.0 + order)
        self._order = np.concatenate(orders)
        return np.concatenate(parts)


def _put(into: Pair, rows: Ints, values: Pair) -> None:
    """Set some rows of vectors."""
    into.x[rows], into.y[rows] = values.x, values.y


def _floats(a: Any) -> Floats:
    """Return float64 of either kind of number."""
    return np.asarray(a.to_float() if hasattr(a, "to_float") else a, dtype=np.float64)


def _turned(normal: Pair, curvature: Any, place: Pair, turn: Ints) -> Floats:
    """Return by which angle places lie ahead on arcs of where these normals stand, radians.

    ``place`` is seen from there; of lines 0.
    """
    seen = normal - place.times(curvature)
    angle = np.arctan2(normal.cross(seen).to_float(), normal.dot(seen).to_float())
    return np.asarray(np.where(turn == 0, 0.0, turn * angle), dtype=np.float64)
