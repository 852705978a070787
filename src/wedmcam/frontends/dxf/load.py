"""Bytes become an ezdxf document, with what ezdxf would lose put right before, and nothing guessed.

Known traps, each measured on real drawings:

- Without ``$ACADVER`` ezdxf takes a file for R12 and drops layer and closed flag of the entities
  that R12 did not have. A version is added in memory, and said.
- Entities whose subclass markers are missing or in another order stop ezdxf although their data
  are there, and so do handles that are none: put right in memory, and said (`repairs`).
- Without a HEADER section ezdxf reports its own defaults, metres for one: the raw header is read
  here.
- ``audit`` and ``recover`` of ezdxf delete good geometry and read ``2,5`` as 2. Neither is called.
  What stops ezdxf is left out, if it is never cut, and refused by name and line, if it is
  (`salvage`).
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
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from wedmcam.diag import (
    Diagnostic,
    FileSpan,
    Severity,
    Span,
    TextSpan,
    error,
    note,
    warning,
)
from wedmcam.diag.lists import Listing
from wedmcam.frontends.dxf.kinds import GEOMETRY, WITH_BOUNDS
from wedmcam.frontends.dxf.repairs import COMMENT, find_repairs, marks_of_entities, text_with
from wedmcam.frontends.dxf.salvage import Hopeless, Unreadable, salvage
from wedmcam.frontends.dxf.tags import (
    BINARY,
    NO_CODE,
    Tags,
    encoding_of_binary,
    tags_of_binary,
    tags_of_text,
)

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
AGAIN = "the head or the end of something is missing: export the drawing again"
#: A text has at most this share of NUL characters: in one of two bytes a letter, all have.
MOST_NUL = 0.02

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
    """A document and what its file says about itself.

    ``binary``: of the binary kind; ``unreadable``: entities with a mark in their place.
    """

    doc: Drawing
    header: Header
    binary: bool
    tags: Tags
    unreadable: tuple[Unreadable, ...] = ()


def load(data: bytes, file: str) -> tuple[Loaded | None, tuple[Diagnostic, ...]]:
    """Return the document in ``data``; None, with an error, where there is none. Never raises."""
    where = FileSpan(file)
    if not data.strip():
        return None, (error("not-dxf", "the file is empty", where),)
    if large := _too_large(data, where):
        return None, (large,)
    if data.startswith(BINARY):
        tags = tags_of_binary(data, file, encoding_of_binary(data))
        edits, findings = find_repairs(tags)
        findings = [*_behind(tags), *_misplaced(tags), *findings]
        if not edits:
            return _parse(None, tags, Header(), findings)
        text = text_with(tags, edits)
        return _parse(text, tags, _header(text.encode("latin-1", "replace")), findings)
    for magic, what, cure in OTHERS:
        if data[:64].lstrip().startswith(magic):
            return None, (
                error(
                    "not-dxf",
                    "not a DXF drawing but {kind}",
                    where,
                    hint="{cure}",
                    kind=what,
                    cure=cure,
                ),
            )
    header, decoded = _decoded(data)
    if decoded is None:
        return None, (error("not-dxf", "not a DXF drawing: the file is not text", where),)
    text = decoded
    if not _begins(text):
        return None, (
            error(
                "not-dxf",
                "not a DXF drawing: it does not begin with a section"
                if _CODE.match(text.split("\n", 1)[0])
                else "not a DXF drawing: the first line is no group code",
                where,
            ),
        )
    conflict = _CONFLICT.search(text)
    if conflict:
        line = text.count("\n", 0, conflict.start()) + 1
        span = TextSpan(file, line, 1, conflict.end() - conflict.start())
        mark = conflict.group()[:20]
        return None, (
            error("merge-conflict", "a version control conflict: {mark}", span, mark=mark),
        )
    tags = tags_of_text(text, file)
    findings = [*_behind(tags), *_misplaced(tags)]
    edits, notes = find_repairs(tags)
    findings += notes
    if edits:
        text = text_with(tags, edits)
    elif tags.behind is not None:
        text = tags.text()
    text, version_notes = _with_version(text, header, where)
    return _parse(text, tags, header, [*findings, *version_notes])


def _too_large(data: bytes, where: FileSpan) -> Diagnostic | None:
    """Return the error about a file that is larger than any part; before anything is read."""
    most = MOST_BINARY if data.startswith(BINARY) else MOST_BYTES
    if len(data) > most:
        return error(
            "too-large",
            "the drawing has {size:,} bytes; no more than {most:,} are read",
            where,
            hint="export the outlines alone",
            size=len(data),
            most=most,
        )
    if len(data) > MOST_LINES and (lines := data.count(b"\n")) > MOST_LINES:
        return error(
            "too-large",
            "the drawing has {lines:,} lines; no more than {most:,} are read",
            where,
            hint="export the outlines alone",
            lines=lines,
            most=MOST_LINES,
        )
    return None


def _behind(tags: Tags) -> list[Diagnostic]:
    """Return a note where data are behind the end mark, and a warning where they are a drawing."""
    if tags.behind is None:
        return []
    size = tags.behind.size
    if tags.behind.second is None:
        return [
            note(
                "behind-end",
                "{size} bytes behind the end mark (EOF), not read"
                if tags.is_binary
                else "{size} line behind the end mark (EOF), not read"
                if size == 1
                else "{size} lines behind the end mark (EOF), not read",
                tags.behind.span,
                size=size,
            )
        ]
    return [
        warning(
            "behind-end",
            "a second drawing behind the end mark (EOF), not read: {size} bytes"
            if tags.is_binary
            else "a second drawing behind the end mark (EOF), not read: {size} line"
            if size == 1
            else "a second drawing behind the end mark (EOF), not read: {size} lines",
            tags.behind.second,
            hint="save it as a file of its own, if it is meant",
            size=size,
        )
    ]


def _misplaced(tags: Tags) -> list[Diagnostic]:
    """Return errors about what ezdxf passes over, because its head or an end is missing."""
    if tags.end is None or (tags.codes == NO_CODE).any():  # its pairs are not what they seem
        return []
    inside = marks_of_entities(tags)
    numbers = [tags.names[kind] for kind in GEOMETRY | WITH_BOUNDS if kind in tags.names]
    lost = np.flatnonzero(np.isin(tags.kinds, numbers) & ~inside).tolist()
    findings: list[Diagnostic] = []
    if lost:
        findings.append(
            error(
                "damaged-drawing",
                "{entities} outside of the sections BLOCKS and ENTITIES, from {place} on: they "
                "would be lost",
                hint=AGAIN,
                **_misplaced_in(tags, lost),
            )
        )
    opens, ends = (tags.names.get(name, -1) for name in ("BLOCK", "ENDBLK"))
    for name, first, last in tags.sections:
        if name == "BLOCKS":
            kinds = tags.kinds[first:last]
            depth = np.cumsum((kinds == opens).astype(np.int64) - (kinds == ends))
            wrong = (depth < 0) | (depth > 1)
            wrong |= (depth == 0) & (kinds != ends)
            lost = (first + np.flatnonzero(wrong)).tolist()
            if not lost and len(depth) and depth[-1]:
                lost = [first + int(np.flatnonzero(kinds == opens)[-1])]
            if lost:
                findings.append(
                    error(
                        "damaged-drawing",
                        "{entities} outside of BLOCK and ENDBLK, from {place} on: they would be "
                        "lost",
                        hint=AGAIN,
                        **_misplaced_in(tags, lost),
                    )
                )
            heads = (first + np.flatnonzero(kinds == opens)).tolist()
            lost = [mark for mark in heads if not tags.first(mark, 2)]
            if lost:
                findings.append(
                    error(
                        "damaged-drawing",
                        "{entities} without a name (group 2), from {place} on: they would be lost",
                        hint=AGAIN,
                        **_misplaced_in(tags, lost),
                    )
                )
        if name in ("BLOCKS", "ENTITIES"):
            head = int(tags.marks[first - 1])
            codes = [code for _, code in tags.own(first - 1) if code != COMMENT]
            if len(codes) > 1:
                findings.append(
                    error(
                        "damaged-drawing",
                        "{groups} groups between the head of section {section} and its first "
                        "entity ({place}): the line that names a type is missing",
                        tags.span(head),
                        hint=AGAIN,
                        groups=len(codes) - 1,
                        section=name,
                        place=tags.place(head),
                    )
                )
    return findings


def _misplaced_in(tags: Tags, lost: list[int]) -> dict[str, Any]:
    """Return where marks are that would be lost, and the values of the error about them."""
    at = int(tags.marks[lost[0]])
    kinds = Counter(tags.value(int(tags.marks[mark])).strip() for mark in lost)
    return {
        "span": tags.span(at),
        "count": len(lost),
        "entities": [f"{n} {kind}" for kind, n in sorted(kinds.items())[:5]],
        "place": tags.place(at),
    }


def _decoded(data: bytes) -> tuple[Header, str | None]:
    """Return the raw header and the text, with newlines as line ends; None where it is no text."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = data.decode("utf-16", "replace")
        return _header(text.encode("ascii", "replace")), _newlines(text)
    first = data[:4096].split(b"EOF")[0]
    if first.count(b"\0") > MOST_NUL * len(first):
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


# --- versions -------------------------------------------------------------------------------


def _with_version(text: str, header: Header, where: FileSpan) -> tuple[str, list[Diagnostic]]:
    """State a version where the file has none, or one too old for the entities it holds."""
    if header.version is not None and header.version >= "AC1012":
        return text, []
    if not any(f"\n{name}" in text for name in LATER):
        return text, []
    variable = "  9\n$ACADVER\n  1\nAC1015\n"
    if header.version is not None:
        old = re.compile(r"(\$ACADVER[ \t]*\n[ \t]*1[ \t]*\n)[^\n]*")
        text = old.sub(r"\g<1>AC1015", text, count=1)
        return text, [
            note(
                "repaired-drawing",
                "version {version} holds later entities: read as AC1015",
                where,
                version=header.version,
            )
        ]
    begin = re.search(r"^[ \t]*2[ \t]*\n[ \t]*HEADER[ \t]*\n", text, re.MULTILINE)
    if begin:
        text = text[: begin.end()] + variable + text[begin.end() :]
    else:
        text = f"  0\nSECTION\n  2\nHEADER\n{variable}  0\nENDSEC\n{text}"
    return text, [
        note("repaired-drawing", "the file states no version ($ACADVER): read as AC1015", where)
    ]


# --- ezdxf ----------------------------------------------------------------------------------


def _parse(
    text: str | None, tags: Tags, header: Header, findings: list[Diagnostic]
) -> tuple[Loaded | None, tuple[Diagnostic, ...]]:
    """Return the document that ezdxf reads from the text, or from the tags where that is None."""
    from ezdxf.document import Drawing
    from ezdxf.lldxf.tagger import binary_tags_loader

    _silence()
    collecting = gc.isenabled()
    gc.disable()  # nothing of a document is garbage while it is read; this saves 40 % of the time
    unreadable: tuple[Unreadable, ...] = ()
    try:
        if text is not None:
            doc = _read(text)
        else:
            data = tags.data()
            doc = Drawing.load(binary_tags_loader(data, errors="replace"))
            header = _binary_header(doc) if b"HEADER" in data[:256] else Header()
            doc.modelspace()  # a broken layout dictionary shows only now
        lost = _lost(_stated(tags), doc)
    except Exception as why:  # ezdxf raises whatever a broken file makes it stumble over
        lines = tags.lines or text_with(tags, {}).split("\n")
        if text is None:
            header = _header("\n".join(lines).encode("latin-1", "replace"))
        try:
            doc, unreadable, repair = _salvaged(lines, tags, header, _reason(why))
        except Hopeless as hopeless:
            findings.append(_refused(lines, tags, hopeless))
            return None, tuple(findings)
        lost = []
        findings.append(repair)
    finally:
        if collecting:
            gc.enable()
    if lost and not any(d.severity is Severity.ERROR for d in findings):
        findings.append(
            error("damaged-drawing", "entities were lost in reading: {entities}", entities=lost)
        )
    return Loaded(doc, header, bool(tags.is_binary), tags, unreadable), tuple(findings)


def _read(text: str) -> Drawing:
    import ezdxf

    doc: Drawing = ezdxf.read(io.StringIO(text))  # type: ignore[attr-defined]
    doc.modelspace()  # a broken layout dictionary shows only now
    return doc


def _reason(why: Exception) -> str:
    """Return what an exception of ezdxf says to somebody who does not know its code."""
    from ezdxf.lldxf.const import DXFError

    if not isinstance(why, DXFError):
        return "values are missing in it, or do not stand where they belong"
    text = str(why).strip().removeprefix("DXFStructureError: ").rstrip(".")
    return re.sub(r",? *(near|at|in)? *line:? \d+", "", text)


def _salvaged(
    lines: list[str], tags: Tags, header: Header, reason: str
) -> tuple[Drawing, tuple[Unreadable, ...], Diagnostic]:
    """Return what `salvage` gets out of a damaged file, what it could not, and what it did.

    Raises:
        Hopeless: not every entity comes out of it, or has a mark in its place.
    """

    def fault(text: str) -> str | None:
        try:
            _read(text)
        except Exception as why:  # as before: whatever it stumbles over
            return _reason(why)
        return None

    version = header.version or "AC1009"
    if not re.fullmatch(r"AC10(0[6-9]|[123]\d)", version):
        version = "AC1015"
    if version < "AC1012":
        words = {line.strip() for line in lines}
        version = "AC1015" if words & set(LATER) else "AC1009"
    got = salvage(lines, version, partial(_span, tags), partial(_place, tags), fault)
    try:
        doc = _read(got.text)
        lost = _lost(got.counts, doc)
    except Exception as why:
        raise Hopeless(0, f"{reason}; and without the rest: {_reason(why)}") from why
    if lost:
        raise Hopeless(0, f"{reason}; of its entities {', '.join(lost)} would be lost")
    where: Span = FileSpan(tags.file)
    if got.unreadable:
        where, reason = got.unreadable[0].span, str(got.unreadable[0])
        if len(got.unreadable) > 1:
            reason += f"; and {len(got.unreadable) - 1} more"
    elif got.broken is not None:
        name, at = got.broken
        where, reason = _span(tags, at), f"section {name}, {_place(tags, at)}: {reason}"
    repair = warning(
        "repaired-drawing",
        "the drawing is damaged ({reason}); its blocks and entities were read without the rest: "
        "{changes}"
        if got.done
        else "the drawing is damaged ({reason}); its blocks and entities were read without the "
        "rest: nothing of them had to be changed",
        where,
        hint="check the picture; exporting the drawing again is cleaner",
        reason=reason,
        changes=Listing(got.done, "; "),
    )
    return doc, tuple(got.unreadable), repair


def _span(tags: Tags, line: int) -> Span:
    """Return the place of a line, from 0, of a file or of its tags as text."""
    if not tags.is_binary:
        return TextSpan(tags.file, line + 1, 1)
    if not len(tags.codes):
        return FileSpan(tags.file)
    return tags.span(min(line // 2, len(tags.codes) - 1))


def _place(tags: Tags, line: int) -> str:
    if not tags.is_binary:
        return f"line {line + 1}"
    return tags.place(min(line // 2, len(tags.codes) - 1)) if len(tags.codes) else "byte 0"


def _refused(lines: list[str], tags: Tags, why: Hopeless) -> Diagnostic:
    """Return the error about a file that gives nothing: with the entity it stops in."""
    line = min(why.line, len(lines) - 1)
    inside = _entity_before(lines, line)
    return error(
        "damaged-drawing",
        "the drawing is damaged: {reason} ({entity})"
        if inside and line
        else "the drawing is damaged: {reason}",
        _span(tags, line) if line else FileSpan(tags.file),
        hint="open it in a CAD program, let it repair it, and export it again",
        reason=why.why,
        entity=inside,
    )


def _entity_before(lines: list[str], line: int) -> str:
    """Return the entity that a line stands in: "in LINE #2F, which begins in line 31"."""
    for k in range(min(line, len(lines) - 2), 0, -1):
        word = lines[k].strip()
        if lines[k - 1].strip() == "0" and word.isupper() and word.isascii():
            pairs = zip(lines[k + 1 : line + 1 : 2], lines[k + 2 : line + 2 : 2], strict=False)
            handle = next((f" #{v.strip()}" for code, v in pairs if code.strip() == "5"), "")
            return f"in {word[:40]}{handle[:20]}, which begins in line {k + 1}"
    return ""


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


def _stated(tags: Tags) -> Counter[str]:
    """Return how many entities of each type the file states."""
    many = np.bincount(tags.kinds[marks_of_entities(tags)], minlength=len(tags.names))
    return Counter({name: int(many[number]) for name, number in tags.names.items()})


def _lost(stated: Counter[str], doc: Drawing) -> list[str]:
    """Return the entities that a file states and the document does not hold."""
    held = Counter(entity.dxftype() for block in doc.blocks for entity in block)
    names = [n for n in sorted(GEOMETRY | WITH_BOUNDS) if stated[n] > held[n]]
    return [f"{stated[n] - held[n]} {n}" for n in names]
