"""A second try at a damaged file: its layers, blocks and entities alone, every tag kept or named.

Much of what stops a reader has nothing to do with geometry: a table without its head, a stray end
of section, a dictionary that is cut off, a text whose height is no number. What holds the geometry
is taken out of such a file and written as a plain drawing. ezdxf decides, as always, what can be
read: an entity that stops it is found by halving, and leaves a mark in its place that says its type
and layer. So what is never cut stops nothing, and what would be cut is refused by name and line.
Nothing is guessed: no value is changed, and as many entities must come out as the file states.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from wedmcam.diag import Span
from wedmcam.frontends.dxf.kinds import GEOMETRY, UNREADABLE, WITH_BOUNDS
from wedmcam.frontends.dxf.repairs import find_repairs, text_with
from wedmcam.frontends.dxf.tags import PADDING, tags_of_text

#: A group code, a value, and the line of the value, from 0.
Tag = tuple[int, str, int]
Group = list[Tag]

#: Sections that hold what is cut; the others are left out.
KEPT = ("TABLES", "BLOCKS", "ENTITIES")
#: Group codes with whole numbers that are looks: colour, line weight, transparency.
LOOKS = frozenset({62, 370, 420, 440})
#: Ranges of group codes with whole numbers.
WHOLE = ((60, 79), (90, 99), (160, 179), (270, 289), (370, 389), (400, 409), (420, 429), (440, 449))
#: Group codes whose values are floats, by the DXF reference.
FLOATS = ((10, 59), (110, 149), (210, 239), (460, 469), (1010, 1059))
#: Entities with one place for each of their point codes, whose coordinates may be put in order.
SINGLE = frozenset(
    {"LINE", "ARC", "CIRCLE", "POINT", "INSERT", "VERTEX", "TEXT", "ATTRIB", "BLOCK"}
)
#: What belongs to the entity before it, up to SEQEND.
FOLLOWERS = {"VERTEX": "POLYLINE", "ATTRIB": "INSERT"}
#: What a mark in the place of an unreadable entity tells of it: line type, colour, where it shows.
TOLD = (6, 60, 62, 67, 420)
#: More attempts at reading than this, to find what is unreadable, are no repair.
MOST_READS = 400


class Hopeless(Exception):  # noqa: N818 - an answer, not a fault of ours
    """Nothing can be got out without a guess; where, and why."""

    def __init__(self, line: int, why: str) -> None:
        super().__init__(why)
        self.line, self.why = line, why


@dataclass(frozen=True, slots=True)
class Unreadable:
    """An entity that ezdxf cannot read: what it is, where it is wrong, and how."""

    kind: str
    handle: str
    span: Span
    place: str
    why: str

    def __str__(self) -> str:
        name = f"{self.kind} #{self.handle}" if self.handle else self.kind
        return f"{name}, {self.place}: {self.why}"


@dataclass(slots=True)
class Salvaged:
    """A plain drawing, what was done (each a clause of a sentence), and what is not in it.

    ``unreadable``: in the order of the marks that stand for them.
    ``counts``: type -> how many entities must be in it.
    ``broken``: the section that stopped the reader, and where it starts; None where none did alone.
    """

    text: str = ""
    done: list[str] = field(default_factory=list)
    unreadable: list[Unreadable] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    broken: tuple[str, int] | None = None


@dataclass(slots=True)
class _Source:
    """The lines of a file, and what finds their places and reads them.

    ``fault``: why ezdxf does not read a text; None where it does.
    """

    lines: list[str]
    version: str
    span: Callable[[int], Span]
    place: Callable[[int], str]
    fault: Callable[[str], str | None]
    reads: int = 0


def salvage(
    lines: list[str],
    version: str,
    span: Callable[[int], Span],
    place: Callable[[int], str],
    fault: Callable[[str], str | None],
) -> Salvaged:
    """Return the geometry of a damaged file as a plain drawing.

    Args:
        lines: of the file; its end mark is the last.
        version: to be stated, e.g. "AC1015".
        span: of a line, counted from 0.
        place: likewise in words.
        fault: why ezdxf does not read a text; None where it does.

    Raises:
        Hopeless: that would be guessing.
    """
    source = _Source(lines, version, span, place, fault)
    out = Salvaged()
    sections: dict[str, list[Group]] = {name: [] for name in KEPT}
    others: list[tuple[str, int, int]] = []
    for name, first, end in _sections(source, out):
        if name == "TABLES":
            sections[name] += _layers(source, first, end)
            others.append((name, first, end))
        elif name in KEPT:
            sections[name] += _groups(_tags(source, first, end))
        else:
            others.append((name, first, end))
    out.broken = _broken(source, others)
    if gone := sorted({name for name, _, _ in others if name != "TABLES"}):
        out.done.append(f"sections {', '.join(gone)} left out")
    body = ""
    moved = looks = 0
    for name in ("BLOCKS", "ENTITIES"):
        groups: list[Group] = []
        for group in sections[name]:
            plain = [t for t in group if t[0] not in LOOKS or _is_whole(t[1])]
            looks += len(group) - len(plain)
            ordered = _in_order(plain)
            moved += ordered != plain
            groups.append(ordered)
        if groups:
            units = _readable(source, _units(groups), out)
            text = "".join(_text(group) for unit in units for group in unit)
            body += f"  0\nSECTION\n  2\n{name}\n{text}  0\nENDSEC\n"
    if looks:
        out.done.append(f"{looks} colours or line weights that are no numbers left out")
    if moved:
        out.done.append(f"coordinates of {moved} entities put in order")
    layers = ""
    if sections["TABLES"]:
        named = "".join(_text(group) for group in sections["TABLES"])
        many = len(sections["TABLES"])
        layers = f"  0\nTABLE\n  2\nLAYER\n 70\n{many}\n{named}  0\nENDTAB\n"
        layers = f"  0\nSECTION\n  2\nTABLES\n{layers}  0\nENDSEC\n"
    out.text = _mended(_headed(source, layers + body))
    return out


def _headed(source: _Source, body: str) -> str:
    head = f"  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\n{source.version}\n  0\nENDSEC\n"
    return f"{head}{body}  0\nEOF\n"


def _mended(text: str) -> str:
    """Return a plain drawing with its markers and handles put right."""
    tags = tags_of_text(text, "")
    edits, _ = find_repairs(tags)
    return text_with(tags, edits) if edits else text


def _text(group: Group) -> str:
    return "".join(f"{code:3d}\n{value}\n" for code, value, _ in group)


# --- from lines to groups ---------------------------------------------------------------------


def _sections(source: _Source, out: Salvaged) -> list[tuple[str, int, int]]:
    """Return name, first line and line behind the last of each section.

    A section begins where its head stands, whatever a damaged one before has done to the pairs.
    """
    lines = source.lines
    words = [line.strip(PADDING) for line in lines]
    marks = [k for k in _places(words, "EOF", 1, len(words)) if words[k - 1] == "0"]
    last = marks[0] + 1 if marks else _behind_the_last(words)
    if not last or words[last - 1] != "EOF":
        raise Hopeless(len(lines), "the end of file mark is missing; it may be cut off")
    del words[last:]
    heads = [
        k
        for k in _places(words, "SECTION", 1, last - 2)
        if words[k - 1] == "0" and words[k + 1] == "2"
    ]
    found = []
    stray = _stray(words, 0, heads[0] - 1 if heads else last, source)
    for k, head in enumerate(heads):
        name = words[head + 2]
        stop = heads[k + 1] - 1 if k + 1 < len(heads) else last - 1
        first = head + 3
        ends = [e - 1 for e in _places(words, "ENDSEC", first, stop) if words[e - 1] == "0"]
        end = ends[0] if ends else stop - (words[stop - 1 : stop] == ["0"])
        if ends:
            stray += _stray(words, end + 2, stop, source)
        if name not in KEPT:
            _stray(words, first, end, source)
        found.append((name, first, end))
    if stray:
        out.done.append(f"{stray} groups outside of sections left out")
    return found


def _behind_the_last(words: list[str]) -> int:
    """Return how many lines there are up to the last that is not empty."""
    return next((k for k in range(len(words), 0, -1) if words[k - 1]), 0)


def _places(words: list[str], word: str, first: int, last: int) -> list[int]:
    """Return where a word is among the lines."""
    places = []
    at = first
    try:
        while True:
            at = words.index(word, at, last)
            places.append(at)
            at += 1
    except ValueError:
        return places


def _stray(words: list[str], first: int, last: int, source: _Source) -> int:
    """Return how many groups there are in lines that no section of entities holds.

    Raises:
        Hopeless: an entity is among them.
    """
    kinds = GEOMETRY | WITH_BOUNDS
    for k in range(first, last - 1):
        if words[k + 1] in kinds and words[k] == "0":
            raise Hopeless(k + 1, f"{words[k + 1]} stands outside of the sections of entities")
    return sum(w not in ("999", "EOF") for w in words[first : max(first, last) : 2] if w)


def _tags(source: _Source, first: int, end: int) -> Group:
    """Return the tags in lines.

    Raises:
        Hopeless: a group code is none.
    """
    out: Group = []
    for at in range(first, end - 1, 2):
        line = source.lines[at]
        try:
            code = int(line)
        except ValueError:
            shown = line.strip()[:40]
            raise Hopeless(at, f'"{shown}" stands where a group code must be') from None
        out.append((code, source.lines[at + 1], at + 1))
    if (end - first) % 2:
        raise Hopeless(end, "a group code or a value is missing before the end of the section")
    return out


def _groups(tags: Group) -> list[Group]:
    """Return the groups that begin with code 0; comments are left out."""
    out: list[Group] = []
    for tag in tags:
        if tag[0] == 999:
            continue
        if tag[0] == 0 or not out:
            out.append([])
        out[-1].append(tag)
    return out


def _layers(source: _Source, first: int, end: int) -> list[Group]:
    """Return name, state, colour and line type of each layer.

    Raises:
        Hopeless: the table of layers is damaged: what is hidden would be cut.
    """
    words = [line.strip() for line in source.lines[first:end]]
    tables = [k for k in _places(words, "TABLE", 1, len(words)) if words[k - 1] == "0"]
    out = []
    for k, head in enumerate(tables):
        if words[head + 1 : head + 3] != ["2", "LAYER"]:
            continue
        stop = tables[k + 1] - 1 if k + 1 < len(tables) else len(words)
        ends = [e for e in _places(words, "ENDTAB", head, stop) if words[e - 1] == "0"]
        tags = _tags(source, first + head - 1, first + (ends[0] - 1 if ends else stop))
        for group in _groups(tags)[1:]:
            if group[0][1].strip() == "LAYER":
                for tag in group:
                    if why := _number_fault(tag, (70, 62)):
                        raise Hopeless(tag[2], f"a layer's state: {why}")
                if not any(code == 2 for code, _, _ in group):
                    if _is_shown(group):
                        continue
                    raise Hopeless(group[0][2], "a hidden layer without a name (group 2)")
                out.append([tag for tag in group if tag[0] in (0, 2, 70, 62, 6, 420)])
    return out


def _is_shown(layer: Group) -> bool:
    state = {code: float(value) for code, value, _ in layer if code in (62, 70)}
    return state.get(62, 7.0) >= 0 and not int(state.get(70, 0.0)) & 1


def _units(groups: list[Group]) -> list[list[Group]]:
    """Return entities with what follows them: the vertices of a POLYLINE, attributes, SEQEND."""
    out: list[list[Group]] = []
    opened = ""
    for group in groups:
        kind = group[0][1].strip()
        if opened and (FOLLOWERS.get(kind) == opened or kind == "SEQEND"):
            out[-1].append(group)
            opened = "" if kind == "SEQEND" else opened
            continue
        if opened:  # what follows says as well that it has ended
            out[-1].append([(0, "SEQEND", group[0][2])])
        out.append([group])
        follow = next((v.strip() for c, v, _ in group if c == 66), "0") != "0"
        opened = kind if kind == "POLYLINE" or (kind == "INSERT" and follow) else ""
    return out


def _is_whole(text: str) -> bool:
    try:
        int(text)
    except ValueError:
        return False
    return True


def _number_fault(tag: Tag, codes: tuple[int, ...] | None = None) -> str:
    """Return what is wrong with the number that a tag holds, if."""
    code, value, _ = tag
    if codes is not None and code not in codes:
        return ""
    whole = any(low <= code <= high for low, high in WHOLE)
    if not whole and not any(low <= code <= high for low, high in FLOATS):
        return ""
    try:
        number = float(value)
        if whole:
            int(number)
        return ""
    except (ValueError, OverflowError):
        shown = value.strip()[:40]
        comma = "; decimals take a point, no comma" if "," in shown else ""
        return f'"{shown}" is no {"whole " if whole else ""}number (group {code}){comma}'


def _in_order(group: Group) -> Group:
    """Return an entity with x, y and z of every place side by side."""
    codes = Counter(code for code, _, _ in group)
    places = [c for c in codes if 10 <= c <= 18]
    if group[0][1].strip() not in SINGLE or any(
        codes[c + k] > 1 for c in places for k in (0, 10, 20)
    ):
        return group
    of = {tag[0]: tag for tag in group}
    out: Group = []
    for tag in group:
        code = tag[0]
        if code in places:
            out += [of[c] for c in (code, code + 10, code + 20) if c in of]
        elif not (20 <= code <= 38 and (code - 10 in places or code - 20 in places)):
            out.append(tag)
    return out


# --- what can be read -------------------------------------------------------------------------


def _broken(source: _Source, others: list[tuple[str, int, int]]) -> tuple[str, int] | None:
    """Return the section beside the entities that ezdxf cannot read by itself."""
    for name, first, end in others:
        inside = "".join(line + "\n" for line in source.lines[first:end])
        head = f"  0\nSECTION\n  2\n{name}\n{inside}  0\nENDSEC\n"
        whole = f"{head}  0\nEOF\n" if name == "HEADER" else _headed(source, head)
        if source.fault(whole) is not None:
            return name, first - 1
    return None


def _readable(source: _Source, units: list[list[Group]], out: Salvaged) -> list[list[Group]]:
    """Return entities with marks in place of those that ezdxf cannot read.

    Raises:
        Hopeless: too many of them, or a block that cannot be read.
    """
    reasons: dict[int, str] = {}
    inside = [k for k, unit in enumerate(units) if _kind(unit) not in ("BLOCK", "ENDBLK")]

    def halve(some: list[int]) -> None:
        source.reads += 1
        if source.reads > MOST_READS:
            at = units[some[0]][0][0][2]
            raise Hopeless(at, f"{len(reasons)} entities cannot be read, and there are more")
        body = "".join(_text(group) for k in some for group in units[k])
        section = f"  0\nSECTION\n  2\nENTITIES\n{body}  0\nENDSEC\n"
        why = source.fault(_mended(_headed(source, section)))
        if why is None:
            return
        if len(some) == 1:
            reasons[some[0]] = why
            return
        middle = len(some) // 2
        halve(some[:middle])
        halve(some[middle:])

    if inside:
        halve(inside)
    readable = []
    lost = False
    for k, unit in enumerate(units):
        kind = _kind(unit)
        if kind == "BLOCK":
            unit, lost = _block_head(source, unit[0], out)
        if lost and kind not in ("BLOCK", "ENDBLK"):
            continue
        if k in reasons:
            readable.append([_mark(source, unit, reasons[k], out)])
            continue
        readable.append(unit)
        if k in inside:
            out.counts[_kind(unit)] += 1
    return readable


#: What the head of a block must have: a name, and where its origin is.
HEAD = (0, 2, 3, 5, 8, 70)
NO_BASE = ("*model_space", "*paper_space", "$model_space", "$paper_space")


def _block_head(source: _Source, head: Group, out: Salvaged) -> tuple[list[Group], bool]:
    """Return the head of a block; with a mark for its content, and True, where it is unreadable.

    Raises:
        Hopeless: a block without a name.
    """
    end: Group = [(0, "ENDBLK", head[0][2]), (8, "0", head[0][2])]
    source.reads += 1
    section = f"  0\nSECTION\n  2\nBLOCKS\n{_text(head)}{_text(end)}  0\nENDSEC\n"
    why = source.fault(_headed(source, section))
    name = next((value.strip() for code, value, _ in head if code == 2), "")
    if why is None and name:
        return [head], False
    if not name:
        raise Hopeless(head[0][2], "a BLOCK without a name (group 2)")
    plain = [tag for tag in head if tag[0] in HEAD and not _number_fault(tag)]
    base = [(code, "0", head[0][2]) for code in (10, 20, 30)]
    if name.lower().startswith(NO_BASE):  # nothing is inserted there
        return [[*plain, *base]], False
    mark = _mark(source, [head], f"block {name}: {why}", out)
    layer = [(code, "0" if code == 8 else value, at) for code, value, at in mark if code != 5]
    return [[*plain, *base], layer], True


def _kind(unit: list[Group]) -> str:
    return unit[0][0][1].strip()


def _mark(source: _Source, unit: list[Group], why: str, out: Salvaged) -> Group:
    """Return what stands for an unreadable entity, and note it."""
    head = unit[0]
    kind, at = _kind(unit), head[0][2]
    first: dict[int, str] = {}
    for code, value, _ in head:
        first.setdefault(code, value)
    for tag in (tag for group in unit for tag in group):
        if fault := _number_fault(tag):
            why, at = fault, tag[2]
            break
    handle = first.get(5, "").strip()
    out.unreadable.append(Unreadable(kind, handle, source.span(at), source.place(at), why))
    number = len(out.unreadable) - 1
    told = [(code, first[code], at) for code in TOLD if code in first and _is_told(code, first)]
    base: Group = [(0, UNREADABLE, at)]
    base += [(5, handle, at)] if handle else []
    base += [(100, "AcDbEntity", at), (8, first.get(8, "0"), at), *told]
    return [*base, (100, "Unreadable", at), (90, str(number), at), (1, kind, at)]


def _is_told(code: int, first: dict[int, str]) -> bool:
    return code == 6 or _is_whole(first[code])
