"""What a drawing states twice, or counts otherwise than it is: ezdxf passes over it in silence.

Of two radii of one circle it takes the last, of two blocks of one name it puts both contents where
either is inserted, and counts it does not read. Which one is meant is not known, so it is an
error, with the line, wherever it is about something that is read, and a warning elsewhere.

Array operations find the few entities that may be concerned; only those are walked through.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, error, note, warning
from wedmcam.diag.lists import Listing, all_of, first_of
from wedmcam.frontends.dxf.repairs import MARKERS
from wedmcam.frontends.dxf.tags import CODES, Tags

Ints = NDArray[np.int64]

#: Group codes that may stand once in an entity, of those that say where something is: the layer,
#: whether it is seen, in paper space, which way its plane looks; and what each type adds. DXF
#: reference, ENTITIES section.
ALL = (8, 60, 67, 210, 220, 230)
SINGLE = {
    "LINE": (10, 20, 30, 11, 21, 31),
    "CIRCLE": (10, 20, 30, 40),
    "ARC": (10, 20, 30, 40, 50, 51),
    "ELLIPSE": (10, 20, 30, 11, 21, 31, 40, 41, 42),
    "POINT": (10, 20, 30),
    "INSERT": (2, 10, 20, 30, 41, 42, 43, 44, 45, 50, 70, 71),
    "POLYLINE": (70,),
    "VERTEX": (10, 20, 30, 42, 70),
    "LWPOLYLINE": (90, 70, 43, 38),
    "SPLINE": (70, 71, 72, 73, 74),
    "BLOCK": (2, 10, 20, 30),
}
#: What an entity cannot be without: a reader would take a default, and cut a circle of radius 1.
NEEDED = {
    "LINE": (10, 20, 11, 21),
    "CIRCLE": (10, 20, 40),
    "ARC": (10, 20, 40, 50, 51),
    "ELLIPSE": (10, 20, 11, 21, 40),
    "POINT": (10, 20),
    "INSERT": (2,),
}
#: What stands there together or not at all: an ellipse without both is a whole one.
TOGETHER = {"ELLIPSE": (41, 42)}
#: Likewise, what may stand once behind each point (a code of `POINTS`) of a list of points.
AT_POINT = {"LWPOLYLINE": (20, 40, 41, 42, 91), "SPLINE": (20, 30, 21, 31, 22, 32, 23, 33)}
POINTS = (10, 11, 12, 13)
#: Counts: the code that states one, and the code that is counted.
COUNTS = {
    "LWPOLYLINE": ((90, 10, "vertices"),),
    "SPLINE": ((72, 40, "knots"), (73, 10, "control points"), (74, 11, "fit points")),
}
#: Variables of the header that are read; the first decides the size of the part.
UNITS = "$INSUNITS"
VARIABLES = (UNITS, "$MEASUREMENT", "$ACADVER", "$DWGCODEPAGE")
COMMENT = 999
#: Sections that a reader takes once.
SECTIONS = ("TABLES", "BLOCKS", "ENTITIES")
#: Codes whose values are names, in which case makes no difference.
NAMES = (2, 8)
#: How many places a finding about many entities names.
NAMED = 5
#: How to mend an entity that contradicts itself.
CURE = "export the drawing again, or correct the line named"


@dataclass(frozen=True, slots=True)
class Reading:
    """What of a drawing is read.

    Attributes:
        blocks: names of the blocks, in lower case, whose contents are cut somewhere.
        layer: whether what lies on a layer is cut, or is a thread point.
        leaves_out_type: whether entities of a type, on a layer, are left out.
        units: whether the size follows from the drawing's own units.
        leaves_out_look: whether entities are left out by layer, line type, colour index, true
            colour, and whether no block holds them; None where no look decides.
    """

    blocks: Collection[str]
    layer: Callable[[str], bool]
    leaves_out_type: Callable[[str, str], bool]
    units: bool
    leaves_out_look: Callable[..., bool] | None = None


@dataclass(frozen=True, slots=True)
class _Fact:
    """One contradiction of one entity: the finding, where, and what others may share.

    Attributes:
        finding: about this entity alone, a template of ``{count} {entity} ...``.
        place: its line and handle.
        differs: names of the values in which entities of one finding may differ.
    """

    finding: Diagnostic
    place: str
    differs: tuple[str, ...] = ()

    @property
    def kind(self) -> tuple[object, ...]:
        """What entities have in common that share a finding."""
        d = self.finding
        shared = [str(value) for name, value in d.values.items() if name not in self.differs]
        return d.severity, d.code, d.template, *shared

    @property
    def figures(self) -> tuple[str, ...]:
        """The values in which they may differ."""
        return tuple(str(self.finding.values[name]) for name in self.differs)


def contradictions(tags: Tags, reading: Reading) -> list[Diagnostic]:
    """Return the findings about what a file says twice, leaves out, or counts otherwise."""
    look = _Look(tags, reading)
    findings = [*_sections(tags), *_variables(tags, reading), *_layers(tags), *_blocks(look)]
    groups: dict[tuple[object, ...], list[_Fact]] = {}
    for fact in (*_repeats(look), *_joined(look), *_missing(look), *_counts(look), *_early(look)):
        groups.setdefault(fact.kind, []).append(fact)
    for facts in groups.values():
        finding = replace(facts[0].finding, count=len(facts))
        if len({fact.figures for fact in facts}) > 1:
            finding = finding.extended(" in the first")
        places = first_of([fact.place for fact in facts], NAMED)
        findings.append(finding.extended(" ({places})", places=places))
    return findings


class _Look:
    """The entities of a file: of what type, in which section and block."""

    def __init__(self, tags: Tags, reading: Reading) -> None:
        self.tags, self.reading = tags, reading
        self.where = np.zeros(len(tags.marks), np.int8)  # 1: in BLOCKS, 2: in ENTITIES
        for name, first, end in tags.sections:
            if name in ("BLOCKS", "ENTITIES"):
                self.where[first:end] = 1 if name == "BLOCKS" else 2
        opens = tags.names.get("BLOCK", -1)
        self.blocks = np.flatnonzero((tags.kinds == opens) & (self.where == 1))
        self.polylines = np.flatnonzero(tags.kinds == tags.names.get("POLYLINE", -1))
        self.kind_of = {number: name for name, number in tags.names.items()}

    def entities(self, kind: str) -> Ints:
        """Return the marks of the entities of a type."""
        number = self.tags.names.get(kind, -1)
        return np.flatnonzero((self.tags.kinds == number) & (self.where > 0))

    def block_of(self, mark: int) -> int | None:
        """Return the BLOCK that an entity stands in; itself for a BLOCK."""
        if self.where[mark] != 1:
            return None
        at = int(np.searchsorted(self.blocks, mark, side="right")) - 1
        return int(self.blocks[at]) if at >= 0 else None

    def block_is_read(self, mark: int) -> bool:
        """Return whether something of a block is cut."""
        name = (self.tags.first(mark, 2) or "").lower()
        return name in self.reading.blocks or name.lstrip("*$") == "model_space"

    def is_read(self, mark: int) -> bool:
        """Return whether an entity is cut; True where that is not clear."""
        tags = self.tags
        block = self.block_of(mark)
        if block is not None and not self.block_is_read(block):
            return False
        if block == mark:
            return True
        if tags.kinds[mark] == tags.names.get("VERTEX", -1):  # its polyline decides
            before = int(np.searchsorted(self.polylines, mark)) - 1
            mark = int(self.polylines[before]) if before >= 0 else mark
        layer = tags.first(mark, 8) or "0"
        if self.reading.leaves_out_type(self.kind_of[int(tags.kinds[mark])], layer):
            return False
        if any((tags.first(mark, code) or "0") not in ("", "0") for code in (60, 67)):
            return False  # invisible, or in paper space
        if tags.kinds[mark] == tags.names.get("INSERT", -1):  # its block lies on layers of its own
            return (tags.first(mark, 2) or "").lower() in self.reading.blocks
        if block is not None and layer == "0":  # the layer of the INSERT
            return True
        if self.reading.leaves_out_look is not None:
            look = (tags.first(mark, code) for code in (6, 62, 420))
            if self.reading.leaves_out_look(layer, *look, block is None):
                return False
        return self.reading.layer(layer)

    def on_layers_alike(self, mark: int) -> bool:
        """Return whether all layers that an entity names are read, or none."""
        names = [self.tags.value(at).strip() for at, code in self.tags.own(mark) if code == 8]
        return len({self.reading.layer(name) for name in names}) == 1

    def severity(self, mark: int, at: int, same: bool = False) -> Callable[..., Diagnostic]:
        """Return how bad something at ``at`` is: an error if it is read, a note if it is the same.

        Otherwise it is a warning.
        """
        if same:
            return note
        if not self.is_read(mark):
            return warning
        by_layer = int(self.tags.codes[at]) == 8 and self.on_layers_alike(mark)
        return warning if by_layer else error

    def place(self, mark: int, at: int) -> str:
        """Return the place of a tag and the handle of its entity."""
        handle = self.tags.first(mark, 5)
        return self.tags.place(at) + (f", #{handle}" if handle else "")

    def entity(self, mark: int) -> str:
        """Return the type of an entity."""
        return self.kind_of[int(self.tags.kinds[mark])]


# --- stated twice -----------------------------------------------------------------------------


def _sections(tags: Tags) -> Iterator[Diagnostic]:
    """Find sections that are there twice: a reader takes one of them."""
    for name in SECTIONS:
        heads = [int(tags.marks[mark - 1]) + 1 for other, mark, _ in tags.sections if other == name]
        if len(heads) > 1:
            yield error(
                "stated-twice",
                "section {section} is there twice ({places}): two drawings in one file, it seems"
                if len(heads) == 2
                else "section {section} is there {often} times ({places}): two drawings in one "
                "file, it seems",
                tags.span(heads[1]),
                hint="leave one of them",
                section=name,
                often=len(heads),
                places=_places(tags, heads),
            )


def _variables(tags: Tags, reading: Reading) -> Iterator[Diagnostic]:
    """Find variables of the header that have two values."""
    heads = [mark - 1 for name, mark, _ in tags.sections if name == "HEADER"]
    stated: dict[str, list[int]] = {}
    for head in heads:
        first, last = int(tags.marks[head]), tags.last(head)
        for at in (first + np.flatnonzero(tags.codes[first:last] == 9)).tolist():
            name = tags.value(at).strip().upper()
            if name not in VARIABLES:
                continue
            for following in range(at + 1, last):
                if tags.code(following) == 9:
                    break
                if tags.code(following) != COMMENT:
                    stated.setdefault(name, []).append(following)
    for name, places in stated.items():
        values = [tags.value(at).strip() for at in places]
        if len(places) < 2:
            continue
        same = all(_same(values[0], value, 0) for value in values[1:])
        bad = name == UNITS and reading.units and not same
        say = error if bad else note if same else warning
        yield say(
            "stated-twice",
            "the header states {variable} twice: {stated} ({places})"
            if len(places) == 2
            else "the header states {variable} {often} times: {stated} ({places})",
            tags.span(places[1]),
            hint="--units settles what one drawing unit is" if bad else None,
            variable=name,
            often=len(places),
            stated=_stated(values),
            places=_places(tags, places),
        )


def _layers(tags: Tags) -> Iterator[Diagnostic]:
    """Find layers that are shown by one of two entries and not by the other."""
    states: dict[str, dict[tuple[bool, bool], int]] = {}
    for name, first, end in tags.sections:
        marks = np.flatnonzero(tags.kinds[first:end] == tags.names.get("LAYER", -1)) + first
        for mark in marks.tolist() if name == "TABLES" else ():
            layer = tags.first(mark, 2)
            colour, flags = (_whole(tags.first(mark, code) or "0") or 0 for code in (62, 70))
            if layer:
                states.setdefault(layer.lower(), {})[colour < 0, bool(flags & 1)] = mark
    for layer, marks_of in states.items():
        if len(marks_of) > 1:
            places = [int(tags.marks[mark]) for mark in marks_of.values()]
            yield error(
                "stated-twice",
                "layer {layer} is there twice, shown by one entry and hidden by another ({places})",
                tags.span(places[1]),
                hint="leave one of them",
                layer=_shown(layer),
                places=_places(tags, places),
            )


def _blocks(look: _Look) -> Iterator[Diagnostic]:
    """Find blocks that are defined twice; case makes no difference in names."""
    tags = look.tags
    named: dict[str, list[tuple[str, int]]] = {}
    for mark in look.blocks.tolist():
        name = tags.first(mark, 2)
        if name:
            named.setdefault(name.lower(), []).append((name, mark))
    for blocks in named.values():
        if len(blocks) < 2:
            continue
        names = list(dict.fromkeys(name for name, _ in blocks))
        marks = [mark for _, mark in blocks]
        places = [int(tags.marks[mark]) for mark in marks]
        read = look.block_is_read(marks[0])
        finding = (error if read else warning)(
            "block-twice",
            "block {block} is defined twice"
            if len(blocks) == 2
            else "block {block} is defined {often} times",
            tags.span(places[1]),
            hint="rename or remove one of them in the CAD program" if read else None,
            block=_shown(names[0]),
            often=len(blocks),
        )
        if names[1:]:
            others = _shown(", ".join(names[1:]))
            finding = finding.extended(
                ", also as {others}: case makes no difference", others=others
            )
        yield finding.extended(
            " ({places}); which one an INSERT means is not known"
            if read
            else " ({places}); nothing of it is cut",
            places=_places(tags, places),
        )


def _repeats(look: _Look) -> Iterator[_Fact]:
    """Find entities with two values where one belongs."""
    tags = look.tags
    for mark in _suspects(look).tolist():
        kind = look.kind_of[int(tags.kinds[mark])]
        single, at_point = {*ALL, *SINGLE[kind]}, AT_POINT.get(kind, ())
        seen: dict[int, int] = {}
        repeated: dict[int, list[int]] = {}
        for at, code in tags.own(mark):
            if at_point and code in POINTS:
                seen = {c: a for c, a in seen.items() if c not in at_point}
            if code not in single and code not in at_point:
                continue
            if code in seen:
                repeated.setdefault(seen[code], [seen[code]]).append(at)
            else:
                seen[code] = at
        alike: list[bool] = []
        repeats: list[tuple[str, str]] = []
        for places in repeated.values():
            code = int(tags.codes[places[0]])
            values = [tags.value(at).strip() for at in places]
            alike.append(all(_same(values[0], value, code) for value in values[1:]))
            stated = "the same" if alike[-1] else str(_stated(values))
            repeats.append((f"group {code} {_times(len(places))}", stated))
        if alike:
            same = all(alike)
            worst = [r for r, a in zip(repeats, alike, strict=True) if same or not a]
            at = list(repeated.values())[alike.index(same)][-1]
            yield _Fact(
                look.severity(mark, at, same)(
                    "stated-twice",
                    "{count} {entity} with {repeats}: {stated}",
                    tags.span(at),
                    hint=CURE,
                    entity=kind,
                    repeats=Listing([repeat for repeat, _ in worst], "; "),
                    stated=Listing([values for _, values in worst], "; "),
                ),
                look.place(mark, at),
                ("stated",),
            )


def _joined(look: _Look) -> Iterator[_Fact]:
    """Find entities with two handles or two markers of AcDbEntity: two in one, one of them lost.

    The line between them is gone that names the type of the second.
    """
    tags = look.tags
    for code in (5, 100):
        places = np.flatnonzero(tags.codes == code)
        owner = np.searchsorted(tags.marks, places, side="right") - 1
        inside = (owner >= 0) & (look.where[owner] > 0)
        many = np.bincount(owner[inside], minlength=len(tags.marks))
        for mark in np.flatnonzero(many > (1 if code == 5 else 2)).tolist():
            own = [at for at, other in tags.own(mark) if other == code]
            if code == 100:
                own = [at for at in own if tags.value(at).strip() == "AcDbEntity"]
            if len(own) < 2 or (code == 100 and len(_own(tags, mark, 5)) > 1):
                continue
            values: dict[str, Any] = {
                "entity": look.entity(mark),
                "group": code,
                "often": len(own),
                "hint": CURE,
            }
            place, span = look.place(mark, own[1]), tags.span(own[1])
            if any(tags.value(at).strip() != tags.value(own[0]).strip() for at in own):
                yield _Fact(
                    error(
                        "stated-twice",
                        "{count} {entity} with group {group} twice: two entities in one, the line "
                        "that names the type of one is missing"
                        if len(own) == 2
                        else "{count} {entity} with group {group} {often} times: two entities in "
                        "one, the line that names the type of one is missing",
                        span,
                        **values,
                    ),
                    place,
                )
            elif code == 100 and look.entity(mark) not in MARKERS:
                yield _Fact(
                    warning(
                        "stated-twice",
                        "{count} {entity} with group {group} twice: as if two entities were one"
                        if len(own) == 2
                        else "{count} {entity} with group {group} {often} times: as if two "
                        "entities were one",
                        span,
                        **values,
                    ),
                    place,
                )


def _own(tags: Tags, mark: int, code: int) -> list[int]:
    return [at for at, other in tags.own(mark) if other == code]


def _suspects(look: _Look) -> Ints:
    """Return the marks of entities in which a code that belongs there once may be twice.

    Each code that may stand once is a bit: where the sum of the bits is not their union, one is
    there twice.
    """
    tags = look.tags
    numbers = [tags.names[kind] for kind in SINGLE if kind in tags.names]
    if not numbers:
        return np.zeros(0, np.int64)
    kinds = np.where(look.where > 0, tags.kinds, -1)
    table = np.zeros((max(numbers) + 2, CODES + 1), np.int64)  # the last row: no entity of ours
    at_point = np.zeros_like(table)
    for kind in SINGLE:
        if kind in tags.names:
            row = tags.names[kind]
            codes = (*ALL, *SINGLE[kind])
            table[row, list(codes)] = 1 << np.arange(len(codes))
            codes = AT_POINT.get(kind, ())
            at_point[row, list(codes)] = 1 << np.arange(len(codes))
    kinds = np.where(kinds <= max(numbers), kinds, -1)
    first = int(tags.marks[0])
    sizes = np.diff(np.r_[tags.marks, len(tags.codes)])
    key = np.repeat(kinds, sizes) * (CODES + 1) + tags.codes[first:]
    key[key < 0] += table.size
    starts = tags.marks - first
    found = _doubled(table.ravel()[key], starts)
    bits = at_point.ravel()[key]
    if bits.any():
        new = np.isin(tags.codes[first:], POINTS)
        new[starts] = True
        points = np.flatnonzero(new)
        twice = points[_doubled(bits, points)]
        found = np.union1d(found, np.searchsorted(starts, twice, side="right") - 1)
    out: Ints = found
    return out


def _doubled(bits: Ints, starts: Ints) -> Ints:
    """Return the runs, between starts, in which some bit is twice."""
    out: Ints = np.flatnonzero(
        np.add.reduceat(bits, starts) != np.bitwise_or.reduceat(bits, starts)
    )
    return out


# --- not stated -------------------------------------------------------------------------------


def _missing(look: _Look) -> Iterator[_Fact]:
    """Find entities without a value that they cannot be without."""
    tags = look.tags
    for kind, needed in NEEDED.items():
        marks = look.entities(kind)
        if not len(marks):
            continue
        first = tags.marks[marks] + 1
        last = np.append(tags.marks, len(tags.codes))[marks + 1]
        pair = TOGETHER.get(kind, ())
        there = {}
        for code in (*needed, *pair):
            places = np.flatnonzero(tags.codes == code)
            there[code] = np.searchsorted(places, last) > np.searchsorted(places, first)
        lacks = ~np.logical_and.reduce([there[code] for code in needed])
        if pair:
            lacks |= there[pair[0]] != there[pair[1]]
        for k in np.flatnonzero(lacks).tolist():
            mark = int(marks[k])
            missing = [code for code in needed if not there[code][k]]
            missing = missing or [code for code in pair if not there[code][k]]
            at = int(tags.marks[mark])
            yield _Fact(
                look.severity(mark, at)(
                    "not-stated",
                    "{count} {entity} without group {groups}: no value to cut by",
                    tags.span(at),
                    hint=CURE,
                    entity=kind,
                    groups=Listing(missing, " and "),
                ),
                look.place(mark, at),
            )


# --- counted otherwise ------------------------------------------------------------------------


def _counts(look: _Look) -> Iterator[_Fact]:
    """Find entities that state another number of points than they have."""
    tags = look.tags
    for kind, counts in COUNTS.items():
        marks = look.entities(kind)
        if not len(marks):
            continue
        first = tags.marks[marks]
        last = np.append(tags.marks, len(tags.codes))[marks + 1]
        for code, of, words in counts:
            there = np.r_[0, np.cumsum(tags.codes == of)]
            many = there[last] - there[first]
            places = np.flatnonzero(tags.codes == code)
            owner = np.searchsorted(first, places, side="right") - 1
            inside = (owner >= 0) & (places < last[owner])
            for at, k in zip(places[inside].tolist(), owner[inside].tolist(), strict=True):
                stated = _whole(tags.value(at))
                if stated is None or stated == many[k]:
                    continue
                mark = int(marks[k])
                own = [c for a, c in tags.own(mark) if c == of or a == at]
                if code in own and stated != own.count(of):
                    yield _Fact(
                        look.severity(mark, at)(
                            "stated-count",
                            "{count} {entity} with another number of {counted} than stated: "
                            "{stated} stated, {there} there",
                            tags.span(at),
                            hint=CURE,
                            entity=kind,
                            counted=words,
                            stated=stated,
                            there=own.count(of),
                        ),
                        look.place(mark, at),
                        ("stated", "there"),
                    )


# --- before what it belongs to ----------------------------------------------------------------


def _early(look: _Look) -> Iterator[_Fact]:
    """Find bulges of an LWPOLYLINE before its first vertex: they belong to none."""
    tags = look.tags
    marks = look.entities("LWPOLYLINE")
    if not len(marks):
        return
    first = tags.marks[marks]
    last = np.append(tags.marks, len(tags.codes))[marks + 1]
    there = {}
    for code in (10, 42):
        places = np.append(np.flatnonzero(tags.codes == code), len(tags.codes))
        there[code] = np.minimum(places[np.searchsorted(places, first)], last)
    for k in np.flatnonzero(there[42] < there[10]).tolist():
        at = int(there[42][k])
        try:
            bulge = float(tags.value(at))
        except ValueError:
            continue
        if bulge:
            yield _Fact(
                warning(
                    "misplaced-group",
                    "{count} {entity} with a bulge (group 42) before the first vertex: "
                    "{bulge:g} belongs to no vertex and is not used",
                    tags.span(at),
                    hint=CURE,
                    entity="LWPOLYLINE",
                    bulge=bulge,
                ),
                look.place(int(marks[k]), at),
                ("bulge",),
            )


# --- in words ---------------------------------------------------------------------------------


def _same(one: str, other: str, code: int) -> bool:
    """Return whether two values are one: as numbers, or as names.

    >>> _same("5", " 5.000", 40), _same("Cut", "CUT", 8), _same("5", "7", 40)
    (True, True, False)
    """
    if code in NAMES:
        return one.strip().lower() == other.strip().lower()
    try:
        return float(one) == float(other)
    except ValueError:
        return one.strip() == other.strip()


def _whole(text: str) -> int | None:
    try:
        return int(float(text))
    except (ValueError, OverflowError):
        return None


def _times(many: int) -> str:
    return "twice" if many == 2 else f"{many} times"


def _shown(text: str) -> str:
    """Return text of a file for a message: not too long, and nothing that moves a cursor."""
    return "".join(c if c.isprintable() else "?" for c in text[:40])


def _stated(values: list[str]) -> Listing:
    """Return different values, as many as are named.

    >>> print(_stated(["5", "7"]), "|", _stated(["1", "2", "3"]))
    5 and 7 | 1, 2 and 3
    """
    return all_of(_shown(value) for value in values[:NAMED])


def _places(tags: Tags, places: list[int]) -> Listing:
    return Listing([tags.place(at) for at in places[:NAMED]], " and ")
