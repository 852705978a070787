"""What came of a compile, a proof and a comparison, as people read it on standard error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wedmcam.cli.terminal import print_text
from wedmcam.compiler.results import Compilation, Proof
from wedmcam.compiler.sources import Drawn
from wedmcam.geom import measure
from wedmcam.ir.understanding import HEADINGS, Understanding
from wedmcam.judge.verdict import Verdict
from wedmcam.programs.places import with_time

if TYPE_CHECKING:
    from wedmcam.judge.difference import Difference


def print_time(summary: dict[str, Any], feed_um: float | None) -> None:
    """Print the cutting time where a feed was given."""
    timed = with_time(summary, feed_um)
    if "minutes" in timed:
        whole = round(timed["minutes"])
        hours = f" ({whole // 60} h {whole % 60:02d} min)" if whole >= 60 else ""
        print_text(
            f"time       {timed['minutes']:.1f} min{hours} of cutting at "
            f"{timed['feed_mm_per_min']:.3f} mm/min",
            err=True,
        )


def print_difference(d: Difference, a: str, b: str) -> None:
    """Print how two programs differ, on standard output: it is what was asked for."""
    if d.equal:
        apart = f"at most {d.largest_um:.2f} um apart" if d.largest_um else "the same places"
        print_text(f"equal: {apart}")
        return
    x, y = d.at[0] / 1000 + 0.0, d.at[1] / 1000 + 0.0
    away = f"{d.distance_um:.2f} um apart" if d.distance_um < float("inf") else d.what
    names = " and ".join(
        f"block {n} of {name}" if n else f"the end of {name}"
        for n, name in ((d.block_a, a), (d.block_b, b))
    )
    print_text(
        f"different: {away} at ({x:.3f}, {y:.3f}) mm from the start, in {names}; up to there at "
        f"most {d.largest_um:.2f} um"
    )


def print_figures(proof: Proof) -> None:
    """Print what a program does by itself, without a drawing."""
    s = proof.summary
    ends = (
        "no cut ends where it began"
        if s["closure_um"] is None
        else f"cuts end within {s['closure_um']:.0f} um of where they began"
    )
    back = s["reversals"]
    key, what = (
        ("count_um", "largest J") if "count_um" in s["limits"] else ("line_um", "longest way")
    )
    most, limit = (s["limits"][key][k] / 1000 for k in ("largest", "limit"))
    for line in (
        f"program    {s['blocks']} blocks, {s['moves']} moves, {s['steps']} steps, path "
        f"{s['path_mm']:.3f} mm",
        f"contours   {s['contours']}; {ends}",
        f"axes       reverse {back['x']} times on x, {back['y']} on y",
        f"limits     the {what} is {most:.3f} of {limit:.3f} mm",
        "give --against DRAWING to prove the part",
    ):
        print_text(line, err=True)


#: So many contours are listed; the rest where more is asked for (-v).
LISTED = 12


def understood_lines(known: Understanding, verbose: bool = False) -> list[str]:
    """Return a line a contour, and who placed the thread points; not more than fits a screen."""
    shown = known.rows if verbose else known.rows[:LISTED]
    left_out = () if verbose else ("lead", "stop", "overcut")
    columns = [k for k, heading in enumerate(HEADINGS) if heading not in left_out]
    cells = [[row.cells[k] for k in columns] for row in shown]
    wide = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = [
        f"{'':11}" + "  ".join(c.ljust(w) for c, w in zip(row, wide, strict=True)).rstrip()
        for row in cells
    ]
    if len(known.rows) > len(shown):
        lines.append(f"{'':11}and {len(known.rows) - len(shown)} more contours (-v lists all)")
    heads = ["threads", *[""] * len(known.threads)]
    return lines + [f"{h:11}{sentence}" for h, sentence in zip(heads, known.threads, strict=False)]


def counts_line(known: Understanding) -> str:
    """Return how many contours are cut as what."""
    return f"understood cuts {known.counts}"


def print_report(
    compilation: Compilation, output: str, verbose: bool = False, rows: bool = True
) -> None:
    """Print what was understood and what came of it.

    Args:
        compilation: a compile that is ok.
        output: where the program goes.
        verbose: all contours, with the figures of each.
        rows: say of each contour how it was understood; else only how many are what.
    """
    v, drawn, known = compilation.verdict, compilation.drawn, compilation.understood
    if v is None or drawn is None or known is None:
        return
    assert compilation.plan is not None
    info = drawn.sketch.info
    s = compilation.summary
    for line in (
        f"{s['input']}  {info.units} ({info.units_from})  {_size(drawn)}",
        f"contours   {v.contours} cut, offset {compilation.plan.offsets_text}, side {v.side}",
        *(understood_lines(known, verbose) if rows else ()),
        f"program    {output}  {v.blocks} blocks, path {v.path_mm:.3f} mm, {v.steps} steps, "
        f"profile {compilation.machine.name}",
        counts_line(known),
        proof_line(compilation),
    ):
        print_text(line, err=True)
    if compilation.entries is not None and compilation.entries.d:
        pairs = ", ".join(f"{name} = {length}" for name, length in compilation.entries.lines())
        print_text(f"enter      {pairs} at the controller: it offsets the path itself", err=True)
    if compilation.entries is not None and compilation.entries.turns:
        pairs = ", ".join(f"{name} {value}" for name, value in compilation.entries.turn_lines())
        print_text(f"enter      {pairs}, at the controller: it turns the figure itself", err=True)
    if compilation.entries is not None and compilation.entries.gap_um is not None:
        side = "die (inwards)" if v.side == "die" else "part (outwards)"
        gap = f"gap {v.offset_um / 1000:.3f} mm, {side}"
        print_text(f"enter      {gap}, at the controller: it offsets arcs itself", err=True)
    if verbose:
        _print_cuts(compilation)


def _print_cuts(compilation: Compilation) -> None:
    """Print the contours in the order of cutting, and the options that are no defaults."""
    assert compilation.verdict is not None
    assert compilation.plan is not None
    print_text(
        "cut     blocks         thread point mm    length mm  deviation um  closure um", err=True
    )
    for c, cut in zip(compilation.verdict.cuts, compilation.plan.cuts, strict=False):
        x, y = cut.thread[0] / 1000, cut.thread[1] / 1000
        blocks = f"{c.first_block}-{c.last_block}"
        closure = "open" if c.closure_um is None else f"{c.closure_um:.0f}"
        print_text(
            f"{c.number:3d} {blocks:>10} {x:12.3f} {y:12.3f} {c.length_mm:12.3f} "
            f"{c.max_deviation_um:13.2f} {closure:>11}",
            err=True,
        )
    options = ", ".join(f"{k} {v}" for k, v in compilation.summary.get("options", {}).items())
    print_text(f"options    {options or 'all by default'}", err=True)


def print_arithmetic(apart: dict[str, Any]) -> None:
    """Print by how much the arithmetics differ, where it was measured."""
    if "arithmetic_difference_um" not in apart:
        return
    um = apart["arithmetic_difference_um"]
    text = "one of them refuses this part" if um is None else f"up to {um:.4f} um apart"
    print_text(f"arithmetic decimal8 and float64: wire paths {text}", err=True)


def _size(drawn: Drawn) -> str:
    boxes = measure.extents_of_all([(c.vertices, c.closed) for c in drawn.contours])
    width, height = boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)
    return f"{width / 1000:.3f} x {height / 1000:.3f} mm"


def print_proof(proof: Proof, verbose: bool) -> None:
    """Print what a program is beside its drawing, or by itself where there is none."""
    if proof.verdict is None:
        if proof.program is not None and proof.ok:
            print_figures(proof)
        return
    v = proof.verdict
    print_text(
        f"contours   {v.contours}, {v.blocks} blocks, {v.steps} steps, {v.path_mm:.3f} mm, "
        f"starts at ({v.origin_um[0] / 1000:.3f}, {v.origin_um[1] / 1000:.3f}) mm",
        err=True,
    )
    if proof.understood is not None:
        for line in understood_lines(proof.understood, verbose):
            print_text(line, err=True)
        print_text(counts_line(proof.understood), err=True)
    print_text(proof_line(proof), err=True)
    if verbose:
        _print_blocks(v)
    for image in proof.summary.get("metamorphic", ()):
        off = "-" if image["deviation_um"] is None else f"{image['deviation_um']:.2f} um"
        print_text(f"image      {image['name']}: {off} {image['why']}".rstrip(), err=True)


def _print_blocks(v: Verdict) -> None:
    """Print where each block ends, and how far it is from the plan."""
    t = v.table
    print_text("block    cut        ends at (mm)   error um     right      left", err=True)
    for k in range(len(t.block)):
        x, y = t.stepped[k] / 1000
        print_text(
            f"{t.block[k]:5d} {t.cut[k]:6d} {x:10.3f} {y:10.3f} {t.error[k]:8.2f} "
            f"{t.low[k]:9.2f} {t.high[k]:9.2f}",
            err=True,
        )


def proof_line(of: Compilation | Proof) -> str:
    """Return the figures of the proof in one line."""
    v = of.verdict
    assert v is not None
    closure = "no closed contour" if v.closure_um is None else f"closure {v.closure_um:.0f} um"
    gouge = "" if v.gouge_um is None else f", gouge {v.gouge_um:.2f} um"
    head = "verified  " if of.ok else "REFUSED   "
    return f"{head} decoded and stepped: deviation {v.max_deviation_um:.2f} um, {closure}{gouge}"
