"""Findings and the places they point to.

Every stage of the compiler returns ``(result, findings)``. A finding is a value: a code, a
severity, a sentence with numbers, and a span. Exceptions are for bugs of our own. A repair is
reported like a fault, so that nothing happens to a drawing in silence.
"""

from __future__ import annotations

from wedmcam.diag.capped import LISTED, capped
from wedmcam.diag.codes import CODES, Code
from wedmcam.diag.data import as_data
from wedmcam.diag.finding import (
    Diagnostic,
    Place,
    Severity,
    error,
    has_errors,
    note,
    warning,
)
from wedmcam.diag.shown import counted, json_text, shortened, visible
from wedmcam.diag.span import ByteSpan, EntityRef, FileSpan, Span, TextSpan, option_texts

__all__ = [
    "CODES",
    "LISTED",
    "ByteSpan",
    "Code",
    "Diagnostic",
    "EntityRef",
    "FileSpan",
    "Place",
    "Severity",
    "Span",
    "TextSpan",
    "as_data",
    "capped",
    "counted",
    "error",
    "has_errors",
    "json_text",
    "note",
    "option_texts",
    "shortened",
    "visible",
    "warning",
]
