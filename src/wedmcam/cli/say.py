"""What people read: findings, reports and tables on standard error, JSON on standard output."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

from wedmcam.diag import Diagnostic, Severity

if TYPE_CHECKING:
    from wedmcam.api import Compilation, Proof


def coloured() -> bool:
    """Return whether standard error takes colours."""
    return sys.stderr.isatty() and not os.environ.get("NO_COLOR")


def say_findings(found: Iterable[Diagnostic], file: str = "", quiet: bool = False) -> None:
    """Print findings; ``quiet`` leaves notes out."""
    from wedmcam.diag.render import merged, render

    for d in merged(found):
        if not (quiet and d.severity is Severity.NOTE):
            click.echo(render(d, file, coloured()), err=True)


def say_json(data: Any) -> None:
    """Print data as JSON on standard output."""
    click.echo(json.dumps(data, indent=2, ensure_ascii=False))


def certificate_bytes(data: dict[str, Any]) -> bytes:
    """Return a certificate as it is written to a file."""
    return (json.dumps(data, indent=2, ensure_ascii=False) + "\n").encode("utf-8")


def say_report(made: Compilation, output: str) -> None:
    """Print what was made, in a few lines."""
    v, drawn = made.verdict, made.drawn
    if v is None or drawn is None:
        return
    info = drawn.sketch.info
    s = made.summary
    for line in (
        f"{s['input']}  {info.units} ({info.units_from})  {_size(drawn)}",
        f"contours   {v.contours} cut, offset {v.offset_um / 1000:.3f} mm, side {v.side}",
        f"program    {output}  {v.blocks} blocks, path {v.path_mm:.3f} mm, {v.steps} steps, "
        f"profile {made.machine.name}",
        proof_line(made),
    ):
        click.echo(line, err=True)


def _size(drawn: Any) -> str:
    from wedmcam.geom import measure

    boxes = [measure.extents(c.vertices, c.closed) for c in drawn.contours]
    width = max(b[2] for b in boxes) - min(b[0] for b in boxes)
    height = max(b[3] for b in boxes) - min(b[1] for b in boxes)
    return f"{width / 1000:.3f} x {height / 1000:.3f} mm"


def proof_line(made: Compilation | Proof) -> str:
    """Return the figures of the proof in one line."""
    v = made.verdict
    assert v is not None
    closure = "no closed contour" if v.closure_um is None else f"closure {v.closure_um:.0f} um"
    gouge = "" if v.gouge_um is None else f", gouge {v.gouge_um:.2f} um"
    head = "verified  " if made.ok else "REFUSED   "
    return f"{head} decoded and stepped: deviation {v.max_deviation_um:.2f} um, {closure}{gouge}"
