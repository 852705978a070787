"""Pictures of what a compile, a proof or an inspection found."""

from __future__ import annotations

from dataclasses import replace

from wedmcam.backends.dxf import encode
from wedmcam.compiler.results import Compilation, Inspection, Proof
from wedmcam.compiler.sources import Seen, rows_of
from wedmcam.diag import Diagnostic, EntityRef, Severity, has_errors
from wedmcam.diag.render import merged, render
from wedmcam.diag.run import WrongUse
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.verdict import Verdict
from wedmcam.machines import Machine
from wedmcam.programs.places import block_ends
from wedmcam.programs.rows import dump
from wedmcam.reports.picture.page import page
from wedmcam.reports.picture.program import plot as plot_program
from wedmcam.reports.picture.program import plot_contours
from wedmcam.reports.picture.refused import plot_refused
from wedmcam.reports.picture.sheet import Caption


def plot(result: Compilation | Proof | Inspection, title: str = "") -> str:
    """Return an SVG picture: of the verified program where there is one, else of what was read.

    A drawing that is refused is drawn with the places of its findings numbered.

    Raises:
        WrongUse: nothing was read that could be drawn.
    """
    marks = [d for d in result.findings if d.points_mm and d.severity is not Severity.NOTE]
    if isinstance(result, Inspection) or result.program is None:
        drawn = None if isinstance(result, Proof) else result.drawn
        if drawn is None or has_errors(result.findings):
            refused = None if isinstance(result, Proof) else _refused_picture(result, title)
            if refused is None:
                raise WrongUse("nothing that could be drawn was read")
            return refused
        return plot_contours(
            drawn.contours,
            thread_points=drawn.sketch.thread_points,
            title=title,
            marks=marks,
        )
    starts, ends = block_ends(result.program, result.machine)
    return plot_program(
        _with_cuts(result.program, result.verdict),
        starts,
        ends,
        plan=result.plan,
        known=result.understood,
        caption=Caption(title, _plot_facts(result)),
        marks=marks,
    )


def plot_html(result: Compilation | Proof | Inspection, title: str = "") -> str:
    """Return a page with the picture of `plot` and a table of the blocks, to click in."""
    report = "\n".join(render(d, title) for d in merged(result.findings))
    program = None if isinstance(result, Inspection) else result.program
    if isinstance(result, Inspection) or program is None:
        return page(plot(result, title), title=title, report=report)
    rows = [
        (
            str(row.number),
            row.where,
            f"{row.kind} {row.instruction}".rstrip(),
            "" if row.count is None else str(row.count),
            f"{row.end[0] / 1000 + 0.0:.3f}",
            f"{row.end[1] / 1000 + 0.0:.3f}",
        )
        for row in dump(program, result.machine)
    ]
    head = ("block", "at", "what", "J", "end x", "end y")
    known = result.understood if not isinstance(result, Inspection) else None
    return page(plot(result, title), title=title, head=head, rows=rows, report=report, known=known)


def path_drawing(program: Program, machine: Machine) -> bytes:
    """Return the stepped wire path as a DXF: lines and arcs by layer; see ``backends.dxf``."""
    return encode(program, machine)


def _refused_picture(result: Compilation | Inspection, title: str) -> str | None:
    """Return a picture of what was read of a source that is refused; None where nothing was."""
    seen = None if result.seen is None else result.seen.whole()
    if seen is None and result.drawn is not None and len(result.drawn.contours):
        seen = Seen(rows_of(result.drawn.contours), result.drawn.sketch)
    if seen is None:
        return None
    marks = [d for d in result.findings if d.severity is not Severity.NOTE]
    facts = {"units": seen.units} if seen.units else {}
    return plot_refused(
        seen.rows,
        [_placed(d, seen) for d in marks],
        unread=seen.sketch.unread.segments if seen.rows is seen.sketch.segments else None,
        thread_points=seen.sketch.thread_points,
        title=title,
        facts={"refused": "no program", **facts},
    )


def _placed(finding: Diagnostic, seen: Seen) -> Diagnostic:
    """Return a finding with the place of the entity that it is about, where it has none."""
    if finding.points_mm or not isinstance(finding.span, EntityRef):
        return finding
    sources = seen.sketch.sources
    at = sources.index(finding.span) if finding.span in sources else -1
    rows = seen.rows[seen.rows["source"] == at] if at >= 0 else seen.rows[:0]
    if not len(rows):
        return finding
    row = rows[0]
    ring = row["turn"] != 0 and row["x0"] == row["x1"] and row["y0"] == row["y1"]
    x, y = ((row[f"{c}0"] + (0 if ring else row[f"{c}1"])) / (1000 if ring else 2000) for c in "xy")
    return replace(finding, points_mm=((float(x), float(y)),))


def _with_cuts(program: Program, verdict: Verdict | None) -> Program:
    """Return a program whose blocks have the numbers of the cuts that the verdict tells."""
    blocks = program.blocks.copy()
    blocks["cut"] = 0
    for cut in verdict.cuts if verdict is not None else ():
        blocks["cut"][cut.first_block - 1 : cut.last_block] = cut.number
    if (blocks["cut"][blocks["kind"] < Kind.MOVE] == 0).any():  # some blocks are of no cut
        return program
    return replace(program, blocks=blocks)


def _plot_facts(result: Compilation | Proof) -> dict[str, str]:
    facts = {"profile": result.machine.name}
    if result.understood is not None:
        facts["cuts"] = result.understood.counts
    v = result.verdict
    if v is not None:
        assert result.plan is not None
        facts |= {"side": v.side, "offset": result.plan.offsets_text}
        facts |= {"blocks": str(v.blocks), "steps": str(v.steps)}
        facts["deviation"] = f"{v.max_deviation_um:.2f} um"
        if v.closure_um is not None:
            facts["closure"] = f"{v.closure_um:.0f} um"
        if v.gouge_um is not None:
            facts["gouge"] = f"{v.gouge_um:.2f} um"
        facts["proof"] = "passed" if result.ok else "FAILED"
    return facts
