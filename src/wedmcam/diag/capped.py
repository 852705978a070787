"""How many findings are shown: of each kind the first, and how many more there are.

A drawing of 100,000 thread points beside one circle has 100,000 errors of one kind. Whoever mends
it reads the first few; a terminal, a certificate and the memory of the process need not hold the
rest. Findings are capped in the one place where they are gathered (`diag.run.Run`) and once more
where they are shown, so that screen, JSON and certificate say the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

from wedmcam.diag.finding import Diagnostic, Severity

#: So many findings of one kind a stage makes, and one that sums up the others: for stages that may
#: find very many.
LISTED = 20
#: So many of one code and severity are kept; a last one stands for the others. A list of a stage
#: with its sum fits, and a few of another stage.
KEPT = 30
#: Places that one finding names beside its own.
NOTES = 8
#: Places of one finding that a picture marks.
POINTS = 200

Kind = tuple[Severity, str]


def capped(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return findings with at most `KEPT` of a kind, and one more that counts the others.

    Equal ones (same code, place and sentence) count as one. Their order stays; capping twice is
    capping once, and what comes later is counted by the same last finding.
    """
    every = [_with_few_places(d) for d in findings]
    sizes = Counter((d.severity, d.code) for d in every)
    if all(size <= KEPT for size in sizes.values()):
        return every
    out: list[Diagnostic] = []
    at: dict[tuple[Kind, str, str], int] = {}
    rest: dict[Kind, int] = {}
    kept: Counter[Kind] = Counter()
    for d in every:
        kind = d.severity, d.code
        key = kind, d.message, str(d.span)
        if sizes[kind] <= KEPT:
            out.append(d)
        elif not d.rest and key in at:
            same = out[at[key]]
            out[at[key]] = replace(same, times=same.times + d.times)
        elif not d.rest and kept[kind] < KEPT:
            kept[kind] += 1
            at[key] = len(out)
            out.append(d)
        elif kind in rest:
            out[rest[kind]] = rest_of(d, out[rest[kind]].count + d.count * d.times)
        else:
            rest[kind] = len(out)
            out.append(rest_of(d, d.count * d.times))
    return out


def rest_of(of: Diagnostic, count: int) -> Diagnostic:
    """Return the finding that stands for ``count`` more of the kind of ``of``."""
    return Diagnostic(
        of.severity, of.code, "and {count:,} more of this kind", count=count, rest=True
    )


def _with_few_places(d: Diagnostic) -> Diagnostic:
    if len(d.notes) > NOTES + 1:
        more = len(d.notes) - NOTES
        d = replace(d, notes=(*d.notes[:NOTES], (f"and {more:,} more", None)))
    if len(d.points_mm) > POINTS:
        d = replace(d, points_mm=d.points_mm[:POINTS])
    return d
