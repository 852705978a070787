"""Bytes become an ezdxf document, with what ezdxf would lose put right before, and nothing guessed.

Known traps, each measured on real drawings:

- Without ``$ACADVER`` ezdxf takes a file for R12 and drops layer and closed flag of the entities
  that R12 did not have. A version is added in memory, and said.
- LWPOLYLINE and SPLINE without subclass markers stop ezdxf although their data is there. The
  markers are added in memory, and said.
- Without a HEADER section ezdxf reports its own defaults, metres for one: the raw header is read
  here.
- ``audit`` and ``recover`` of ezdxf delete good geometry and read ``2,5`` as 2. Neither is called.
  A damaged file is refused with the line, unless `salvage` gets its geometry out unchanged.
- Whatever way a file is read, as many entities must come out of it as it states.
- ezdxf stops at the end mark of a text file without a word, and reads over that of a binary one,
  where a second drawing then replaces the first. Both end here at their mark.
"""

from __future__ import annotations

import codecs
import contextlib
import gc
import io
import logging
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from wedmcam.diag import Diagnostic, FileSpan, Span, TextSpan, error, note, warning
from wedmcam.frontends.dxf.salvage import salvage
from wedmcam.frontends.dxf.tags import BINARY, PADDING, Tags, tags_of_binary, tags_of_text

if TYPE_CHECKING:
    from ezdxf.document import Drawing

#: How other files begin that people rename to .dxf or confuse with it.
OTHERS = (
    (b"AC10", "a DWG file", "save it as DXF in a CAD program"),
    (b"\x89PNG", "a PNG picture", "a picture has no contours to cut"),
    (b"\xff\xd8\xff", "a JPEG picture", "a picture has no contours to cut"),
    (b"GIF8", "a GIF picture", "a picture has no contours to cut"),
    (b"%PDF", "a PDF document", "export the drawing as DXF"),
    (b"PK\x03\x04", "a ZIP archive", "unpack it first"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"ISO-10303", "a STEP file", "export a drawing of it as DXF"),
    (b"<svg", "an SVG drawing", "export it as DXF"),
    (b"<?xml", "an XML file", "export the drawing as DXF"),
)
#: Entity types that came with R13 and later; ezdxf reads them wholly only from such a version.
LATER = ("LWPOLYLINE", "SPLINE", "ELLIPSE", "MTEXT", "HATCH")
#: Of those, the ones ezdxf refuses without their subclass marker.
MARKERS = {"LWPOLYLINE": "AcDbPolyline", "SPLINE": "AcDbSpline", "MTEXT": "AcDbMText"}
#: Group codes of AcDbEntity: what all entities have in common.
COMMON = frozenset({5, 6, 8, 48, 60, 62, 67, 102, 284, 330, 347, 370, 390, 410, 420, 430, 440})
#: Group codes whose values are floats, by the DXF reference.
FLOATS = ((10, 59), (110, 149), (210, 239), (460, 469), (1010, 1059))
#: Entity types that hold geometry: as many must come out of the reader as the file has.
GEOMETRY = ("LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE", "INSERT")

_VARIABLE = r"\$%s[ \t]*\r?\n[ \t]*%d[ \t]*\r?\n[ \t]*([^\s]+)"
_ESCAPE = re.compile(r"\\U\+((?!00[01])(?!D[89A-F])[0-9A-F]{4})", re.IGNORECASE)
_CONFLICT = re.compile(r"^(?:<{7}(?: .*)?|={7}|>{7}(?: .*)?)$", re.MULTILINE)
_CODE = re.compile(r"^\s*-?\d+\s*$")


#: Larger files are no part for a wire: a line takes about 300 bytes of memory where it is read, and
#: an outline of 100,000 segments has a third of these lines.
MOST_LINES, MOST_BYTES, MOST_BINARY = 3_000_000, 100_000_000, 30_000_000


@dataclass(frozen=True, slots=True)
class Header:
    """What the file itself says; None where it says nothing."""

    version: str | None = None
    codepage: str | None = None
    insunits: int | None = None
    measurement: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """A document and what its file says about itself. ``binary``: of the binary kind."""

    doc: Drawing
    header: Header
    binary: bool
    tags: Tags


def load(data: bytes, file: str) -> tuple[Loaded | None, tuple[Diagnostic, ...]]:
    """Return the document in ``data``; None, with an error, where there is none. Never raises."""
    where = FileSpan(file)
    if not data.strip():
        return None, (error("not-dxf", "the file is empty", where),)
    if large := _too_large(data):
        return None, (error("too-large", large, where, hint="export the outlines alone"),)
    if data.startswith(BINARY):
        tags = tags_of_binary(data, file)
        return _parsed(None, tags, Header(), _behind(tags), None)
    for magic, what, cure in OTHERS:
        if data[:64].lstrip().startswith(magic):
            return None, (error("not-dxf", f"not a DXF drawing but {what}", where, hint=cure),)
    header, text = _decoded(data)
    if text is None:
        return None, (error("not-dxf", "not a DXF drawing: the file is not text", where),)
    if not _begins(text):
        why = "the first line is no group code" if not _CODE.match(text.split("\n", 1)[0]) else ""
        why = why or "it does not begin with a section"
        return None, (error("not-dxf", f"not a DXF drawing: {why}", where),)
    conflict = _CONFLICT.search(text)
    if conflict:
        line = text.count("\n", 0, conflict.start()) + 1
        span = TextSpan(file, line, 1, conflict.end() - conflict.start())
        shown = conflict.group()[:20]
        return None, (error("merge-conflict", f"a version control conflict: {shown}", span),)
    tags = tags_of_text(text, file)
    found = _behind(tags)
    if found:
        text = tags.text()
    original = text
    for repair in REPAIRS:
        text, said = repair(text, header)
        if said:
            found.append(note("repaired-drawing", said, where))
    return _parsed(text, tags, header, found, original)


def _too_large(data: bytes) -> str:
    """Return how a file is larger than any part, empty if it is not; before anything is read."""
    if data.startswith(BINARY) and len(data) > MOST_BINARY:
        return f"the drawing has {len(data):,} bytes; no more than {MOST_BINARY:,} are read"
    if len(data) > MOST_BYTES:
        return f"the drawing has {len(data):,} bytes; no more than {MOST_BYTES:,} are read"
    if len(data) > MOST_LINES and (lines := data.count(b"\n")) > MOST_LINES:
        return f"the drawing has {lines:,} lines; no more than {MOST_LINES:,} are read"
    return ""


def _behind(tags: Tags) -> list[Diagnostic]:
    """Return a warning where data are behind the end mark."""
    if tags.behind is None:
        return []
    span, many, second = tags.behind
    if second is None:
        text, hint = f"{many} behind the end mark (EOF), not read", None
    else:
        text = f"a second drawing behind the end mark (EOF), not read: {many}"
        hint = "save it as a file of its own, if it is meant"
    return [warning("behind-end", text, second or span, hint=hint)]


def _decoded(data: bytes) -> tuple[Header, str | None]:
    """Return the raw header and the text, with newlines as line ends; None where it is no text."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = data.decode("utf-16", "replace")
        return _header(text.encode("ascii", "replace")), _newlines(text)
    if b"\0" in data[:4096].rstrip(PADDING[:-1].encode()):
        return Header(), None
    header = _header(data)
    encoding = "utf-8-sig" if data.startswith(b"\xef\xbb\xbf") else _encoding(header, data)
    return header, _unescaped(_newlines(data.decode(encoding, "replace")))


def _unescaped(text: str) -> str:
    """Return text with escapes for characters outside of its code page resolved.

    >>> _unescaped("Fr" + chr(92) + "U+00E4sen")
    'Fräsen'
    """
    if "\\U+" not in text:
        return text
    return _ESCAPE.sub(lambda match: chr(int(match.group(1), 16)), text)


def _encoding(header: Header, data: bytes) -> str:
    """Return the encoding: UTF-8 from R2007 on, before that the code page, if it has one.

    Files that state neither are mostly UTF-8, and new ones that are none mostly keep their code
    page.
    """
    stated = None if header.codepage is None else _codepage(header.codepage)
    new = header.version is not None and header.version >= "AC1021"
    if stated is not None and not new:
        return stated
    for encoding in ("utf-8", stated or "cp1252"):
        try:
            data.decode(encoding)
        except UnicodeDecodeError:
            continue
        return encoding
    return "utf-8" if new else "cp1252"


def _codepage(name: str) -> str:
    """Return the encoding of a code page: ANSI_936, dos850, GB2312, BIG5, SHIFT_JIS, ...

    >>> [_codepage(name) for name in ("ANSI_936", "dos850", "Shift_JIS", "BIG5", "nonsense")]
    ['cp936', 'cp850', 'shift_jis', 'big5', 'cp1252']
    """
    plain = name.strip().lower()
    number = re.fullmatch(r"(?:ansi|dos|cp|windows)[_-]?(\d{3,5})", plain)
    for encoding in (f"cp{number.group(1)}" if number else plain, "cp1252"):
        with contextlib.suppress(LookupError):
            codecs.lookup(encoding)
            return encoding
    return "cp1252"


def _newlines(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def _header(data: bytes) -> Header:
    """Return what the HEADER section says, from the bytes: ezdxf fills in defaults."""
    begin = re.search(rb"[\r\n][ \t]*2[ \t]*[\r\n]+[ \t]*HEADER[ \t]*[\r\n]", data)
    if begin is None:
        return Header()
    end = data.find(b"ENDSEC", begin.end())
    part = data[begin.end() : end if end > 0 else len(data)]
    text = _newlines(part.decode("latin-1"))

    def value(name: str, code: int) -> str | None:
        match = re.search(_VARIABLE % (name, code), text)
        return match.group(1) if match else None

    return Header(
        value("ACADVER", 1),
        value("DWGCODEPAGE", 3),
        _whole(value("INSUNITS", 70)),
        _whole(value("MEASUREMENT", 70)),
    )


def _whole(text: str | None) -> int | None:
    try:
        return None if text is None else int(float(text))
    except (ValueError, OverflowError):
        return None


def _begins(text: str) -> bool:
    """Return whether the first group that is no comment opens a section."""
    lines = io.StringIO(text)
    for code in lines:
        value = lines.readline()
        if code.strip() == "999":
            continue
        return code.strip() == "0" and value.strip() == "SECTION"
    return False


# --- repairs in memory ----------------------------------------------------------------------


def _with_version(text: str, header: Header) -> tuple[str, str]:
    """State a version where the file has none, or one too old for the entities it holds."""
    if header.version is not None and header.version >= "AC1012":
        return text, ""
    if not any(f"\n{name}" in text for name in LATER):
        return text, ""
    variable = "  9\n$ACADVER\n  1\nAC1015\n"
    if header.version is not None:
        old = re.compile(r"(\$ACADVER[ \t]*\n[ \t]*1[ \t]*\n)[^\n]*")
        text = old.sub(r"\g<1>AC1015", text, count=1)
        return text, f"version {header.version} holds later entities: read as AC1015"
    begin = re.search(r"^[ \t]*2[ \t]*\n[ \t]*HEADER[ \t]*\n", text, re.MULTILINE)
    if begin:
        text = text[: begin.end()] + variable + text[begin.end() :]
    else:
        text = f"  0\nSECTION\n  2\nHEADER\n{variable}  0\nENDSEC\n{text}"
    return text, "the file states no version ($ACADVER): read as AC1015"


def _with_markers(text: str, header: Header) -> tuple[str, str]:
    """Add the subclass markers of entities that have none."""
    lacking = [
        name for name, marker in MARKERS.items() if text.count(f"\n{name}\n") > text.count(marker)
    ]
    if not lacking:
        return text, ""
    lines = text.split("\n")
    pairs = list(zip(lines[0::2], lines[1::2], strict=False))
    out: list[tuple[str, str]] = []
    mended = 0
    start = 0
    for at in range(1, len(pairs) + 1):
        if at < len(pairs) and pairs[at][0].strip() != "0":
            continue
        group = pairs[start:at]
        start = at
        marker = MARKERS.get(group[0][1].strip()) if group[0][0].strip() == "0" else None
        if marker and not any(c.strip() == "100" and v.strip() == marker for c, v in group):
            mended += 1
            body = [p for p in group[1:] if p[0].strip() != "100"]
            mine = [p for p in body if _whole(p[0]) in COMMON]
            rest = [p for p in body if _whole(p[0]) not in COMMON]
            group = [group[0], ("100", "AcDbEntity"), *mine, ("100", marker), *rest]
        out += group
    if not mended:
        return text, ""
    joined = "\n".join(line for pair in out for line in pair) + "\n"
    return joined, f"{mended} entities without subclass marker ({', '.join(lacking)}) completed"


#: In order; each returns the text, and what it did or nothing.
REPAIRS: tuple[Callable[[str, Header], tuple[str, str]], ...] = (_with_version, _with_markers)


# --- ezdxf ----------------------------------------------------------------------------------


def _parsed(
    text: str | None,
    tags: Tags,
    header: Header,
    found: list[Diagnostic],
    original: str | None,
) -> tuple[Loaded | None, tuple[Diagnostic, ...]]:
    """Return the document that ezdxf reads from the text, or from the tags where that is None."""
    import ezdxf
    from ezdxf.document import Drawing
    from ezdxf.lldxf.tagger import binary_tags_loader

    _silence()
    collecting = gc.isenabled()
    gc.disable()  # nothing of a document is garbage while it is read; this saves 40 % of the time
    try:
        if text is not None:
            doc = ezdxf.read(io.StringIO(text))  # type: ignore[attr-defined]
        else:
            data = tags.data()
            doc = Drawing.load(binary_tags_loader(data, errors="replace"))
            header = _binary_header(doc) if b"HEADER" in data[:256] else Header()
        doc.modelspace()  # a broken layout dictionary shows only now
        lost = _lost(tags, doc)
    except Exception as why:  # ezdxf raises whatever a broken file makes it stumble over
        span, reason, plain = _fault(text, original, why, tags.file)
        saved = None if plain or text is None else _saved(text, tags, header)
        if saved is not None:
            doc, done = saved
            found.append(
                warning(
                    "repaired-drawing",
                    f"the drawing is damaged ({reason}); its blocks and entities were read without "
                    f"the rest: {done or 'nothing of them had to be changed'}",
                    span,
                    hint="check the picture; exporting the drawing again is cleaner",
                )
            )
            return Loaded(doc, header, False, tags), tuple(found)
        found.append(
            error(
                "damaged-drawing",
                f"the drawing is damaged: {reason}",
                span,
                hint="open it in a CAD program, let it repair it, and export it again",
            )
        )
        return None, tuple(found)
    finally:
        if collecting:
            gc.enable()
    if lost:
        found.append(error("damaged-drawing", f"entities were lost in reading: {lost}"))
    return Loaded(doc, header, text is None, tags), tuple(found)


def _saved(text: str, tags: Tags, header: Header) -> tuple[Drawing, str] | None:
    """Return what `salvage` gets out of a damaged file, if every entity comes out of it."""
    import ezdxf

    version = header.version or "AC1009"
    if version < "AC1012":
        version = "AC1015" if any(f"\n{name}" in text for name in LATER) else "AC1009"
    got = salvage(text, version)
    if got is None:
        return None
    try:
        doc = ezdxf.read(io.StringIO(got.text))  # type: ignore[attr-defined]
        doc.modelspace()
        lost = _lost(tags, doc)
    except Exception:  # as before: whatever it stumbles over
        return None
    return None if lost else (doc, "; ".join(got.done))


def _silence() -> None:
    """Keep the messages of ezdxf off standard error; a handler of the user still gets them."""
    log = logging.getLogger("ezdxf")
    if not any(isinstance(h, logging.NullHandler) for h in log.handlers):
        log.addHandler(logging.NullHandler())


def _binary_header(doc: Drawing) -> Header:
    """Return what a binary file's header says: ezdxf adds no defaults where there is one."""

    def value(name: str) -> object:
        got: object = doc.header.get(name)
        return got

    version, codepage = value("$ACADVER"), value("$DWGCODEPAGE")
    return Header(
        str(version) if version else None,
        str(codepage) if codepage else None,
        _whole(_text(value("$INSUNITS"))),
        _whole(_text(value("$MEASUREMENT"))),
    )


def _text(value: object) -> str | None:
    return None if value is None else str(value)


def _fault(
    text: str | None, original: str | None, why: Exception, file: str
) -> tuple[Span, str, bool]:
    """Return where a file that ezdxf refused is wrong, and whether its data are.

    Wrong data, or missing ones, cannot be had without a guess. Lines are those of the file, which
    is ``original``, and not of the repaired text.
    """
    where = FileSpan(file)
    from ezdxf.lldxf.const import DXFError

    reason = str(why).strip().removeprefix("DXFStructureError: ").rstrip(".")
    if not isinstance(why, DXFError):
        reason = f"the reader stumbles over it ({type(why).__name__}: {reason})"
    if text is None or original is None:
        return where, reason, True
    lines = original.split("\n")
    for at in range(0, len(lines) - 1, 2):
        code, value = _whole(lines[at]) if _CODE.match(lines[at]) else None, lines[at + 1]
        if code is None:
            shown = lines[at].strip()[:40]
            return TextSpan(file, at + 1, 1), f'"{shown}" stands where a group code must be', True
        if code == 0 and value.strip() == "EOF":
            break
        if any(low <= code <= high for low, high in FLOATS) and not _is_float(value):
            shown = value.strip()[:40]
            comma = "; decimals take a point, no comma" if "," in shown else ""
            return TextSpan(file, at + 2, 1), f'"{shown}" is no number (group {code}){comma}', True
    if "EOF" in reason:
        return (
            TextSpan(file, len(lines), 1),
            "the end of file mark is missing; it may be cut off",
            True,
        )
    if text is not original:
        return where, re.sub(r",? *(near|at|in)? *line:? \d+", "", reason), False
    near = re.search(r"line:? (\d+)", reason)
    return TextSpan(file, int(near.group(1)), 1) if near else where, reason, False


def _is_float(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _lost(tags: Tags, doc: Drawing) -> str:
    """Return which entities that the file states the document does not hold, or nothing."""
    inside = np.zeros(len(tags.marks), np.bool_)
    for name, first, end in tags.sections:
        inside[first:end] |= name in ("BLOCKS", "ENTITIES")
    many = np.bincount(tags.kinds[inside], minlength=len(tags.names))
    stated = {name: int(many[number]) for name, number in tags.names.items()}
    held = Counter(entity.dxftype() for block in doc.blocks for entity in block)
    names = [n for n in GEOMETRY if stated.get(n, 0) > held[n]]
    return ", ".join(f"{stated[n] - held[n]} {n}" for n in names)
