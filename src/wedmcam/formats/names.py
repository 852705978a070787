"""Names of formats, and the endings of their files."""

from __future__ import annotations

#: File name endings of programs, and the format each means; the first of a format is written.
FORMAT_OF_SUFFIX = {
    ".3b": "3b",
    ".zd": "compact",
    ".zdr": "rotation",
    ".zdc": "compensation",
    ".nc": "iso",
    ".4b": "4b",
    ".d15": "dem15",
    ".ngc": "iso",
    ".gcode": "iso",
    ".iso": "iso",
    ".eia": "iso",
    ".n15": "nby15",
}
SUFFIX_OF_FORMAT: dict[str, str] = {}
for _ending, _format in FORMAT_OF_SUFFIX.items():
    SUFFIX_OF_FORMAT.setdefault(_format, _ending)
PROGRAM_FORMATS = ("3b", "compact", "rotation", "compensation", "iso", "4b", "dem15", "nby15")
SOURCE_FORMATS = ("dxf", "wed")
