"""From contours to cuts: on which side the wire runs, beside which outline, and in which order.

The side follows from what is kept, and from nothing else: with ``part`` the material inside outer
contours and around holes is kept, with ``die`` the reverse. Closed outlines come counter-clockwise,
so the wire keeps to their right outside and to their left inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, error, has_errors, note, warning
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Order, Side
from wedmcam.ir.sketch import ThreadPoint
from wedmcam.transforms.chain import open_contour_findings
from wedmcam.transforms.compensate import Interference, compensate, largest_offset
from wedmcam.transforms.plan.idle import NEARER_END, Used, of_path
from wedmcam.transforms.plan.leads import PlannedPath, Threaded, lead
from wedmcam.transforms.plan.order import order

if TYPE_CHECKING:
    from wedmcam.options import Options
    from wedmcam.transforms.nest import Nesting

#: Places of interference that are listed; a summary stands for the rest.
LISTED = 10


@dataclass(frozen=True, slots=True, eq=False)
class Lanes:
    """Wire paths, and the contour (index) that each belongs to."""

    lanes: list[PlannedPath]
    contour: list[int]


def unfit(contours: Sequence[Contour], options: Options, side: Side) -> list[Diagnostic]:
    """Return errors where contours do not fit the side: open ones to cut round, closed ones left.

    An open contour is followed only where that was asked for by name (left, right, on): a gap in an
    outline must not become a cut with a gap.
    """
    found: list[Diagnostic] = []
    if side in (Side.PART, Side.DIE) or options.side is None:
        found += open_contour_findings(contours, options.join_um)
    if side in (Side.LEFT, Side.RIGHT):
        for c in contours:
            if c.closed:
                x, y = float(c.vertices["x"][0]) / 1000, float(c.vertices["y"][0]) / 1000
                found.append(
                    error(
                        "closed-left-right",
                        f"the closed contour at ({x:.3f}, {y:.3f}) mm has an inside and an "
                        f"outside, not a {side} side",
                        c.source_of(0),
                        points_mm=((x, y),),
                        hint="--side part keeps what is inside, --side die what is outside",
                    )
                )
    if side is Side.ON and options.side is None:
        found.append(
            warning(
                "no-offset",
                "no offset is given: the wire runs on the line, and the part will be smaller by "
                "half the kerf on every side",
                hint="--offset, or --wire and --gap; --side on says that it is meant",
            )
        )
    return found


def shifts(contours: Sequence[Contour], nesting: Nesting, side: Side, offset: float) -> list[float]:
    """Return for each contour how far the wire runs to its left (negative: right)."""
    if side is Side.LEFT:
        return [offset] * len(contours)
    if side is Side.RIGHT:
        return [-offset] * len(contours)
    kept_inside = 0 if side is Side.PART else 1
    return [-offset if d % 2 == kept_inside else offset for d in nesting.depths]


def lanes(
    contours: list[Contour], nesting: Nesting, options: Options, side: Side, ar: Arithmetic
) -> tuple[Lanes | None, list[Diagnostic]]:
    """Return the wire paths of all contours, each in the direction of its contour."""
    offset = options.offset_um or 0.0
    if side is Side.ON:
        found: list[Diagnostic] = []
        paths = [
            PlannedPath(c, c, None, 0.0, k, nesting.parents[k]) for k, c in enumerate(contours)
        ]
        of = list(range(len(contours)))
    else:
        shift = shifts(contours, nesting, side, offset)
        result, found = compensate(contours, shift, arithmetic=ar, sharp=options.sharp)
        if found:
            return None, found
        found += interference(contours, shift, result.interference, options)
        if not result.paths:
            return None, found if has_errors(found) else [*found, _nothing_left(options)]
        left = side in (Side.LEFT, Side.RIGHT)
        paths = [
            PlannedPath(
                p.path,
                contours[p.outline],
                None if left else shift[p.outline] > 0,
                offset,
                p.outline,
                nesting.parents[p.outline],
            )
            for p in result.paths
        ]
        of = [p.outline for p in result.paths]
        if result.inner_corners and not options.corner_um and not left:
            found.append(
                note(
                    "inner-corners",
                    f"{result.inner_corners} sharp inner corners keep the radius of the wire, "
                    f"{offset / 1000:.3f} mm",
                    hint="--corner rounds the part's own corners, so that punch and die fit",
                )
            )
    if options.reverse:
        paths = [
            replace(
                p,
                path=p.path.reversed(),
                outline=p.outline.reversed(),
                scrap_left=None if p.scrap_left is None else not p.scrap_left,
            )
            for p in paths
        ]
    return Lanes(paths, of), found


def _nothing_left(options: Options) -> Diagnostic:
    return error(
        "nothing-to-cut",
        f"with an offset of {(options.offset_um or 0.0) / 1000:.3f} mm no contour is left to cut",
        hint="a smaller offset",
    )


def interference(
    contours: Sequence[Contour],
    shifts: Sequence[float],
    places: Sequence[Interference],
    options: Options,
) -> list[Diagnostic]:
    """Return a finding for each place where the wire does not fit: error, or warning if trimmed."""
    if not places:
        return []
    make = warning if options.trim else error
    offset = (options.offset_um or 0.0) / 1000
    hints: dict[int, str] = {}
    found = []
    for item in places[:LISTED]:
        contour = contours[item.outline]
        if item.outline not in hints:
            sign = float(np.sign(shifts[item.outline]))
            most, _ = largest_offset([contour], [sign], 1000.0 * offset)
            hints[item.outline] = f"at most {most / 1000:.3f} mm fits this contour"
            if not options.trim:
                hints[item.outline] += "; --on-interference trim cuts what the wire can reach"
        x, y = item.at[0] / 1000, item.at[1] / 1000
        place = f"({x:.3f}, {y:.3f}) mm"
        lost = f", {len(item.rows)} segments are not reached" if len(item.rows) > 1 else ""
        if item.kind == "radius":
            text = (
                f"the inside radius {item.size / 1000:.3f} mm at {place} is smaller than the "
                f"offset {offset:.3f} mm{lost}"
            )
        elif item.kind == "neighbour":
            text = f"the wire beside this contour meets another contour at {place}"
        elif item.kind == "vanished":
            text = f"the contour at {place} is too small for the offset {offset:.3f} mm"
        else:
            text = f"a passage at {place} is too narrow for a wire at offset {offset:.3f} mm{lost}"
        found.append(
            make(
                "interference",
                text,
                contour.source_of(item.row),
                points_mm=((x, y),),
                hint=hints[item.outline] if item.kind != "neighbour" else None,
            )
        )
    if len(places) > LISTED:
        found.append(make("interference", f"{len(places) - LISTED} further places like these"))
    return found


def cuts(
    made: Lanes, threads: Sequence[ThreadPoint], nesting: Nesting, options: Options
) -> tuple[list[Cut] | None, list[Diagnostic]]:
    """Return the cuts in their order, each with its lead."""
    led, found = lead(made.lanes, threads, options.lead_um)
    if led is None:
        return None, found
    parents = parents_of(made.contour, nesting.parents)
    first_drawn = [int(lane.outline.vertices["source"].min(initial=1 << 30)) for lane in made.lanes]
    how = options.order or Order.INNER_FIRST
    sequence = order(parents, [item.thread for item in led], first_drawn, how)
    result = []
    for k in sequence:
        lane, item = made.lanes[k], led[k]
        closed = item.path.closed
        result.append(
            Cut(
                lane.outline,
                item.path,
                item.thread,
                nesting.depths[made.contour[k]],
                None if lane.scrap_left is None else not lane.scrap_left,
                options.stop_um if closed else 0.0,
                options.overcut_um if closed else 0.0,
                made.contour[k] + 1,
            )
        )
    found += _too_long(result, options)
    if not has_errors(found):
        found += _idle(made, led, options)
    return result, found


def overruled(lane: PlannedPath, led: Threaded) -> bool:
    """Return whether a thread point lets an open path be run the other way than it was to be."""
    if led.path.closed:
        return False
    a, b = lane.path.vertices, led.path.vertices
    return bool(a["x"][0] != b["x"][0] or a["y"][0] != b["y"][0])


def _idle(made: Lanes, led: Sequence[Threaded], options: Options) -> list[Diagnostic]:
    """Return warnings on options that had no effect on a drawing."""
    used = Used()
    for lane, one in zip(made.lanes, led, strict=True):
        used.add("lead_um", one.measured)
        for name in ("stop_um", "overcut_um"):
            used.add(name, one.path.closed)
        for name in ("sharp", "trim"):
            used.add(name, lane.offset_um > 0)
    found = of_path(used.names, options, part=False)
    turned = [lane for lane, one in zip(made.lanes, led, strict=True) if overruled(lane, one)]
    if turned and options.reverse and options.wished("reverse"):
        found.append(
            warning(
                "idle-option",
                f"--reverse has no effect: {NEARER_END}",
                turned[0].path.source_of(0),
                count=len(turned),
            )
        )
    return found


def parents_of(contour: Sequence[int], parents: Sequence[int]) -> list[int]:
    """Return for each path the first path of the contour around its own, -1 for none."""
    first: dict[int, int] = {}
    for k, c in enumerate(contour):
        first.setdefault(c, k)
    result = []
    for c in contour:
        parent = parents[c]
        while parent >= 0 and parent not in first:
            parent = parents[parent]
        result.append(first.get(parent, -1))
    return result


def _too_long(made: Sequence[Cut], options: Options) -> list[Diagnostic]:
    """Return errors where a stop or an overcut is longer than the path."""
    from wedmcam.geom import measure

    found = []
    for name, length in (("stop", options.stop_um), ("overcut", options.overcut_um)):
        if not length:
            continue
        for cut in made:
            whole = measure.length(cut.path.vertices, cut.path.closed)
            if cut.path.closed and length >= whole - 1.0:
                x, y = cut.thread[0] / 1000, cut.thread[1] / 1000
                found.append(
                    error(
                        f"{name}-too-long",
                        f"--{name} {length / 1000:.3f} mm is longer than the path of "
                        f"{whole / 1000:.3f} mm that starts at ({x:.3f}, {y:.3f}) mm",
                        cut.path.source_of(0),
                        hint=f"a shorter --{name}",
                    )
                )
    return found
