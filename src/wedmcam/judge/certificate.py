"""The certificate: the verdict as plain data, the same for the same input, without dates.

The field names that the command line's summary shares are fixed; keys come in one order.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from wedmcam.diag import ByteSpan, Diagnostic, EntityRef, TextSpan, as_data
from wedmcam.judge.verdict import CutVerdict, Verdict


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


def finding_data(finding: Diagnostic) -> dict[str, Any]:
    """Return a finding as plain data."""
    return {
        "severity": str(finding.severity),
        "code": finding.code,
        "message": finding.message,
        "values": {name: as_data(value) for name, value in finding.values.items()},
        "at": span_data(finding.span),
        "points_mm": [[_plain(x), _plain(y)] for x, y in finding.points_mm],
        "hint": finding.hint,
        "count": finding.count * finding.times,
    }


@dataclass(frozen=True, slots=True)
class CertifiedSource:
    """What a certificate says of the source.

    Attributes:
        name: as it was named.
        data: the source itself, for its fingerprint.
        units: "mm", "um" or "inch".
        join_um: the largest shift of a joint that closed a gap of the drawing.
        spline_um: the largest distance between a spline or ellipse and its arcs; the program is
            judged against the arcs.
    """

    name: str
    data: bytes
    units: str
    join_um: float = 0.0
    spline_um: float = 0.0


@dataclass(frozen=True, slots=True)
class CertifiedProgram:
    """What a certificate says of the program.

    Attributes:
        name: as it was named.
        data: the program itself, for its fingerprint.
        format: of the program.
        profile: name of the machine's profile.
        profile_sha256: fingerprint of the values of the profile.
    """

    name: str
    data: bytes
    format: str
    profile: str = ""
    profile_sha256: str = ""


def certificate(
    verdict: Verdict,
    findings: Iterable[Diagnostic],
    source: CertifiedSource,
    program: CertifiedProgram,
    *,
    options: dict[str, Any] | None = None,
    version: str | None = None,
) -> dict[str, Any]:
    """Return the certificate of a program, ready for ``json.dumps``.

    Args:
        verdict: of the judge.
        findings: of the whole compilation, in their order.
        source: what the program was made of.
        program: what was judged.
        options: that made the program, so that ``verify --against`` can take them from here.
        version: of the compiler; None for this one.

    Figures in um are rounded up to a nanometre. There are no dates.
    """
    if version is None:
        from importlib.metadata import version as installed

        version = installed("wedmcam")
    out: dict[str, Any] = {
        "input": source.name,
        "output": program.name,
        "format": program.format,
        "units": source.units,
        "origin_um": list(verdict.origin_um),
        "contours": verdict.contours,
        "blocks": verdict.blocks,
        "steps": verdict.steps,
        "closure_um": _um(verdict.closure_um),
        "max_deviation_um": _um(verdict.max_deviation_um),
        "gouge_um": _um(verdict.gouge_um),
        "offset_um": _plain(verdict.offset_um),
        "side": verdict.side,
        "diagnostics": [finding_data(d) for d in findings],
        "ok": verdict.ok,
        "lead_deviation_um": _um(verdict.lead_deviation_um),
        "uncut_um": _um(verdict.uncut_um),
        "join_um": _um(source.join_um),
        "spline_um": _um(source.spline_um),
        "moves": verdict.moves,
        "controls": verdict.controls,
        "path_mm": _plain(verdict.path_mm),
        "extents_um": [_plain(v) for v in verdict.extents_um],
        "count": verdict.count,
        "limits": {
            "path_um": verdict.path_limit_um,
            "gouge_um": verdict.gouge_limit_um,
        },
        "cuts": [_cut_data(c) for c in verdict.cuts],
    }
    if verdict.count == "textbook":
        out["stepped_closure_um"] = _um(verdict.stepped_closure_um)
        out["stepped_max_deviation_um"] = _um(verdict.stepped_max_deviation_um)
        out["stepped_gouge_um"] = _um(verdict.stepped_gouge_um)
    out["options"] = dict(sorted((options or {}).items()))
    out["profile"] = program.profile
    out["sha256"] = {
        "input": fingerprint(source.data),
        "output": fingerprint(program.data),
        "profile": program.profile_sha256,
    }
    out["version"] = version
    return out


def _cut_data(cut: CutVerdict) -> dict[str, Any]:
    """Return the figures of one cut as plain data."""
    return {
        "number": cut.number,
        "first_block": cut.first_block,
        "last_block": cut.last_block,
        "blocks": cut.blocks,
        "steps": cut.steps,
        "closed": cut.closed,
        "closure_um": _um(cut.closure_um),
        "max_deviation_um": _um(cut.max_deviation_um),
        "lead_deviation_um": _um(cut.lead_deviation_um),
        "length_mm": _plain(cut.length_mm),
        "backwards": cut.backwards,
    }
