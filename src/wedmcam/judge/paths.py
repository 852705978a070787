"""Measure: the wire runs each planned path once, in order and in its sense."""

from __future__ import annotations

import numpy as np

from wedmcam.diag import Diagnostic, error
from wedmcam.judge.deviation import SLOP
from wedmcam.judge.followed import Followed
from wedmcam.judge.measured import Measured

#: A block ends on a vertex up to the first, um along the route; up to the second it was meant for
#: it, if no other block ends there.
SLIP, SLIPPED = 1.5, 1000.0


def runs_the_paths(f: Followed) -> Measured:
    """Report, for each cut, the first block that leaves its route or its turn."""
    findings: list[Diagnostic] = []
    stray = np.zeros(len(f.index))
    stray[f.done] = f.survey.stray
    off = np.flatnonzero(np.nan_to_num(f.deviation) > f.limit)
    wild = np.flatnonzero(stray > SLOP)
    lost = dict(f.track.lost)
    wrong = np.concatenate([off, wild, np.array(list(lost), np.int64)])
    for k in np.flatnonzero(np.bincount(f.cut_of[wrong])).tolist():
        cut = f.assigned[k].cut + 1
        mine = off[f.cut_of[off] == k]
        strays = wild[f.cut_of[wild] == k]
        gone = [b for b in lost if f.cut_of[b] == k]
        if len(strays) and (not len(mine) or strays[0] <= mine[0]):
            b = int(strays[0])
            findings.append(
                error(
                    "wrong-order",
                    "block {block} does not run cut {cut} once and in its sense: it is "
                    "{stray_mm:.3f} mm along the wire path from its turn; it ends at {end}",
                    **f.of_block(int(f.index[b])),
                    cut=cut,
                    stray_mm=stray[b] / f.per,
                )
            )
        if len(mine):
            b = int(mine[0])
            leaves = error(
                "path-deviation",
                "block {block} leaves the wire path of cut {cut} by {deviation_mm:.5f} mm (limit "
                "{limit_mm:.5f} mm)",
                **f.of_block(int(f.index[b])),
                cut=cut,
                deviation_mm=f.deviation[b] / f.per,
                limit_mm=float(f.limit[b]) / f.per,
            )
            if len(mine) > 1:
                leaves = leaves.extended(
                    "; {others} more blocks of the cut do", others=len(mine) - 1
                )
            findings.append(_with_slip(leaves, f, int(f.first[k]), b))
        for b in gone:
            if lost[b] <= f.terms.path_limit_um:
                stray_block = error(
                    "wrong-order",
                    "block {block} is on the wire path of cut {cut} out of its turn",
                    **f.of_block(int(f.index[b])),
                    cut=cut,
                )
            else:
                stray_block = error(
                    "path-deviation",
                    "block {block} ends {off_mm:.3f} mm beside the wire path of cut {cut}",
                    **f.of_block(int(f.index[b])),
                    off_mm=lost[b] / f.per,
                    cut=cut,
                )
            findings.append(_with_slip(stray_block, f, int(f.first[k]), b))
    return Measured(findings)


def _with_slip(d: Diagnostic, f: Followed, low: int, high: int) -> Diagnostic:
    """Return a finding on a block with the slip before it, and with where the block ends.

    A slip is the first of blocks low to high - 1 that ends beside the vertex it is for. Along a
    smooth path a block may run on, or fall short, and be found out by a later one.
    """
    slip = _slip(f, low, high)
    if slip is not None:
        row, missed = slip
        d = d.extended(
            "; block {slip} already ends {missed_mm:.3f} mm past its vertex"
            if missed > 0
            else "; block {slip} already ends {missed_mm:.3f} mm short of its vertex",
            slip=row + 1,
            missed_mm=abs(missed) / f.per,
        )
    return d.extended("; it ends at {end}")


def _slip(f: Followed, low: int, high: int) -> tuple[int, float] | None:
    """Return the row of a slip and how far it is past its vertex, steps; None where there is none.

    See `_with_slip`.
    """
    at = f.track.high[low:high]
    at = at[~np.isnan(at)]
    if not len(at):
        return None
    after = np.searchsorted(f.route.to, at)
    near = np.stack([np.clip(after + d, 0, len(f.route.to) - 1) for d in (-1, 0)])
    nearest = np.abs(at - f.route.to[near]).argmin(axis=0)
    vertex = near[nearest, np.arange(len(at))]
    missed = at - f.route.to[vertex]
    # A block may end anywhere on a segment, if another one ends on its vertex.
    met = np.zeros(len(f.route.to), bool)
    met[vertex[np.abs(missed) <= SLIP]] = True
    slips = np.flatnonzero(~met[vertex] & (np.abs(missed) < SLIPPED))
    if not len(slips):
        return None
    return int(f.index[low + slips[0]]), float(missed[slips[0]])
