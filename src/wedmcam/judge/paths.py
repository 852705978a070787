"""Measure: the wire runs each planned path once, in order and in its sense."""

from __future__ import annotations

import numpy as np

from wedmcam.diag import Diagnostic
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
    off = np.flatnonzero(np.nan_to_num(f.deviation) > f.terms.path_limit_um)
    wild = np.flatnonzero(stray > SLOP)
    lost = dict(f.track.lost)
    wrong = np.concatenate([off, wild, np.array(list(lost), np.int64)])
    for k in np.flatnonzero(np.bincount(f.cut_of[wrong])).tolist():
        name = f"cut {f.assigned[k].cut + 1}"
        mine = off[f.cut_of[off] == k]
        strays = wild[f.cut_of[wild] == k]
        gone = [b for b in lost if f.cut_of[b] == k]
        if len(strays) and (not len(mine) or strays[0] <= mine[0]):
            b = int(strays[0])
            findings.append(
                f.block_error(
                    "wrong-order",
                    int(f.index[b]),
                    f"does not run {name} once and in its sense: it is "
                    f"{stray[b] / f.per:.3f} mm along the wire path from its turn",
                )
            )
        if len(mine):
            b = int(mine[0])
            more = f"; {len(mine) - 1} more blocks of the cut do" if len(mine) > 1 else ""
            more += _slip(f, int(f.first[k]), b)
            findings.append(
                f.block_error(
                    "path-deviation",
                    int(f.index[b]),
                    f"leaves the wire path of {name} by {f.deviation[b] / f.per:.5f} mm "
                    f"(limit {f.terms.path_limit_um / f.per:.5f} mm){more}",
                )
            )
        for b in gone:
            on_path = lost[b] <= f.terms.path_limit_um
            text = (
                f"is on the wire path of {name} out of its turn"
                if on_path
                else f"ends {lost[b] / f.per:.3f} mm beside the wire path of {name}"
            ) + _slip(f, int(f.first[k]), b)
            code = "wrong-order" if on_path else "path-deviation"
            findings.append(f.block_error(code, int(f.index[b]), text))
    return Measured(findings)


def _slip(f: Followed, low: int, high: int) -> str:
    """Return words on the first of blocks low to high - 1 that ends beside the vertex it is for.

    Along a smooth path a block may run on, or fall short, and be found out by a later one.
    """
    at = f.track.high[low:high]
    at = at[~np.isnan(at)]
    if not len(at):
        return ""
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
        return ""
    how = "past" if missed[slips[0]] > 0 else "short of"
    far = abs(float(missed[slips[0]])) / f.per
    return f"; block {int(f.index[low + slips[0]]) + 1} already ends {far:.3f} mm {how} its vertex"
