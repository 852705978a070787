"""The certificate: the verdict as plain data, the same for the same input, without dates.

The field names that the command line's summary shares are fixed; keys come in one order.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable
from typing import Any

from wedmcam.diag import ByteSpan, Diagnostic, EntityRef, TextSpan, plain
from wedmcam.judge.verdict import Verdict


def fingerprint(data: bytes) -> str:
    """Return the SHA-256 of bytes, hexadecimal.

    >>> fingerprint(b"abc")[:16]
    'ba7816bf8f01cfea'
    """
    return hashlib.sha256(data).hexdigest()


def _um(value: float | None) -> float | None:
    """Round a figure to a nanometre, upwards, so that nothing looks better than it is."""
    if value is None or not math.isfinite(value):
        return None
    return math.ceil(value * 1000.0 - 1e-6) / 1000.0 + 0.0


def _plain(value: float) -> float:
    return round(value, 3) + 0.0


def span_data(span: object) -> dict[str, Any] | None:
    """Return a span as plain data."""
    if isinstance(span, TextSpan):
        return {"file": span.file, "line": span.line, "column": span.column, "length": span.length}
    if isinstance(span, EntityRef):
        return {
            "file": span.file,
            "handle": span.handle,
            "type": span.dxftype,
            "layer": span.layer,
            "via": list(span.via),
        }
    if isinstance(span, ByteSpan):
        return {"file": span.file, "start": span.start, "end": span.end}
    return None if span is None else {"file": str(span)}


def finding_data(found: Diagnostic) -> dict[str, Any]:
    """Return a finding as plain data."""
    return {
        "severity": str(found.severity),
        "code": found.code,
        "message": found.message,
        "values": {name: plain(value) for name, value in found.values.items()},
        "at": span_data(found.span),
        "points_mm": [[_plain(x), _plain(y)] for x, y in found.points_mm],
        "hint": found.hint,
        "count": found.count * found.times,
    }


def certificate(
    verdict: Verdict,
    findings: Iterable[Diagnostic],
    *,
    input_name: str,
    output_name: str,
    format_name: str,
    units: str,
    input_bytes: bytes,
    output_bytes: bytes,
    profile_name: str = "",
    profile_sha256: str = "",
    join_um: float = 0.0,
    spline_um: float = 0.0,
    options: dict[str, Any] | None = None,
    version: str | None = None,
) -> dict[str, Any]:
    """Return the certificate of a program, ready for ``json.dumps``.

    Args:
        verdict: of the judge.
        findings: of the whole compilation, in their order.
        input_name: the source, as it was named.
        output_name: the program, as it was named.
        format_name: of the program.
        units: of the source: "mm", "um" or "inch".
        input_bytes: the source itself, for its fingerprint.
        output_bytes: the program itself.
        profile_name: of the machine.
        profile_sha256: fingerprint of its values.
        join_um: the largest shift of a joint that closed a gap of the drawing.
        spline_um: the largest distance between a spline or ellipse and its arcs; the program is
            judged against the arcs.
        options: that made the program, so that ``verify --against`` can take them from here.
        version: of the compiler; None for this one.

    Figures in um are rounded up to a nanometre. There are no dates.
    """
    if version is None:
        from importlib.metadata import version as installed

        version = installed("wedmcam")
    listed = list(findings)
    out: dict[str, Any] = {
        "input": input_name,
        "output": output_name,
        "format": format_name,
        "units": units,
        "origin_um": list(verdict.origin_um),
        "contours": verdict.contours,
        "blocks": verdict.blocks,
        "steps": verdict.steps,
        "closure_um": _um(verdict.closure_um),
        "max_deviation_um": _um(verdict.max_deviation_um),
        "gouge_um": _um(verdict.gouge_um),
        "offset_um": _plain(verdict.offset_um),
        "side": verdict.side,
        "diagnostics": [finding_data(f) for f in listed],
        "ok": verdict.ok,
        "lead_deviation_um": _um(verdict.lead_deviation_um),
        "uncut_um": _um(verdict.uncut_um),
        "join_um": _um(join_um),
        "spline_um": _um(spline_um),
        "moves": verdict.moves,
        "controls": verdict.controls,
        "path_mm": _plain(verdict.path_mm),
        "extents_um": [_plain(v) for v in verdict.extents_um],
        "count": verdict.count,
        "limits": {
            "path_um": verdict.path_limit_um,
            "gouge_um": verdict.gouge_limit_um,
        },
        "cuts": [
            {
                "number": c.number,
                "first_block": c.first_block,
                "last_block": c.last_block,
                "blocks": c.blocks,
                "steps": c.steps,
                "closed": c.closed,
                "closure_um": _um(c.closure_um),
                "max_deviation_um": _um(c.max_deviation_um),
                "lead_deviation_um": _um(c.lead_deviation_um),
                "length_mm": _plain(c.length_mm),
                "backwards": c.backwards,
            }
            for c in verdict.cuts
        ],
    }
    if verdict.count == "textbook":
        out["stepped_closure_um"] = _um(verdict.stepped_closure_um)
        out["stepped_max_deviation_um"] = _um(verdict.stepped_max_deviation_um)
        out["stepped_gouge_um"] = _um(verdict.stepped_gouge_um)
    out["options"] = dict(sorted((options or {}).items()))
    out["profile"] = profile_name
    out["sha256"] = {
        "input": fingerprint(input_bytes),
        "output": fingerprint(output_bytes),
        "profile": profile_sha256,
    }
    out["version"] = version
    return out
