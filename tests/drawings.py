"""Made drawings for the tests: bytes of DXF files, and sketches without a file."""

from __future__ import annotations

import io
import struct
from collections.abc import Callable, Iterable
from typing import Any

import ezdxf
import numpy as np

from wedmcam.diag import Diagnostic, EntityRef
from wedmcam.frontends.dxf import read
from wedmcam.frontends.options import DrawingReading
from wedmcam.ir.sketch import SEGMENT, Sketch

VERSIONS = ("R12", "R2000", "R2004", "R2007", "R2010", "R2013", "R2018")


def drawing(
    draw: Callable[[Any, Any], object], version: str = "R2010", units: int = 4, binary: bool = False
) -> bytes:
    """Return a DXF file; ``draw`` gets the document and its model space."""
    doc = ezdxf.new(version, units=units)
    doc.header["$MEASUREMENT"] = 0 if units in (1, 2, 3, 8, 9, 10) else 1
    draw(doc, doc.modelspace())
    if binary:
        raw = io.BytesIO()
        doc.write(raw, fmt="bin")
        return raw.getvalue()
    out = io.StringIO()
    doc.write(out)
    return out.getvalue().encode("utf-8" if version >= "R2007" and version != "R12" else "cp1252")


def bare(*entities: str, header: str = "  9\n$INSUNITS\n 70\n     4\n") -> bytes:
    """Return an R12 file written by hand; group codes and values separated by blanks or lines."""
    top = f"  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n{header}  0\nENDSEC\n"
    body = "".join("\n".join(e.split()) + "\n" for e in entities)
    return f"{top}  0\nSECTION\n  2\nENTITIES\n{body}  0\nENDSEC\n  0\nEOF\n".encode()


def got(data: bytes, **options: Any) -> tuple[Sketch, tuple[Diagnostic, ...]]:
    wished = options.pop("wished", None)
    sketch, found = read(data, "part.dxf", DrawingReading(**options), wished)
    assert sketch is not None, found
    return sketch, found


def codes(found: Iterable[Diagnostic]) -> list[str]:
    return [d.code for d in found]


def rows(sketch: Sketch) -> list[tuple[float, ...]]:
    """Return (x0, y0, x1, y1, cx, cy, turn) of each segment, centre 0 for lines, in 1e-6 um."""
    out = []
    for s in sketch.segments:
        centre = (s["cx"], s["cy"]) if s["turn"] else (0.0, 0.0)
        numbers = (s["x0"], s["y0"], s["x1"], s["y1"], *centre)
        out.append((*(round(float(v), 6) + 0.0 for v in numbers), int(s["turn"])))
    return out


Row = tuple[float, ...]


def sketch(segments: Iterable[Row]) -> Sketch:
    """Return a sketch of (x0, y0, x1, y1) lines and (x0, y0, x1, y1, cx, cy, turn) arcs, um."""
    given = [(*s, 0.0, 0.0, 0) if len(s) == 4 else s for s in segments]
    array = np.zeros(len(given), SEGMENT)
    for k, name in enumerate(("x0", "y0", "x1", "y1", "cx", "cy", "turn")):
        array[name] = [g[k] for g in given]
    array["source"] = np.arange(len(given))
    refs = tuple(EntityRef("part.dxf", f"{k:X}", "LINE", "0") for k in range(len(given)))
    return Sketch(array, refs)


def polygon(*points: tuple[float, float], closed: bool = True) -> list[Row]:
    """Return the lines through points."""
    after = [*points[1:], points[0]] if closed else points[1:]
    return [(*a, *b) for a, b in zip(points, after, strict=False)]


SQUARE = polygon((0, 0), (10_000, 0), (10_000, 10_000), (0, 10_000))


def as_binary(data: bytes) -> bytes:
    """Return a text drawing as a binary one, tag by tag, whatever is wrong with it."""
    from ezdxf.lldxf.types import DOUBLE, INT16, INT32

    lines = data.decode().split("\n")
    old = "AC1009" in lines
    out = [b"AutoCAD Binary DXF\r\n\x1a\x00"]
    for code_line, value in zip(lines[0::2], lines[1::2], strict=False):
        code = int(code_line)
        out.append(struct.pack("<B" if old else "<H", code))
        if code in DOUBLE:
            out.append(struct.pack("<d", float(value)))
        elif code in INT16 or code in INT32:
            out.append(struct.pack("<h" if code in INT16 else "<i", int(value)))
        else:
            out.append(value.strip().encode() + b"\0")
    return b"".join(out)
