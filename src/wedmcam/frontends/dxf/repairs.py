"""What is put right in the tags of a drawing before ezdxf reads it, without a guess.

Subclass markers (group 100) only say which class of AutoCAD a group belongs to. ezdxf needs them in
their order where an entity is a list: it takes the third part of an LWPOLYLINE for its vertices,
whatever is in it, and passes over vertices in the second. No group code of these types means two
things, so the markers can be put where they belong. A handle is a name and no more: one that is no
number stops ezdxf, and one that is there twice is only a name of two.

Array operations find what is concerned; only that is walked through.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, note
from wedmcam.diag.lists import Listing, first_of
from wedmcam.frontends.dxf.tags import CODES, FOREIGN, Tags

Tag = tuple[int, str]
#: Entity -> its tags anew.
Edits = dict[int, list[Tag]]

#: Types that ezdxf reads by the place of their markers, and the marker of their own.
MARKERS = {
    "LWPOLYLINE": "AcDbPolyline",
    "SPLINE": "AcDbSpline",
    "MTEXT": "AcDbMText",
    "HATCH": "AcDbHatch",
    "MPOLYGON": "AcDbMPolygon",
    "MLINE": "AcDbMline",
    "MESH": "AcDbSubDMesh",
    "WIPEOUT": "AcDbWipeout",
}
ENTITY = "AcDbEntity"
#: Group codes of AcDbEntity: what all entities have in common.
COMMON = frozenset(
    {5, 6, 8, 48, 60, 62, 67, 102, 284, 330, 347, 348, 360, 370, 380, 390, 410, 420, 430, 440}
)
#: Of those, the ones that types have for themselves, too: a HATCH names what it was drawn from.
OWN_TOO = frozenset({102, 330, 360})
#: A picture that stands for an entity in programs that do not know it: its size, and its bytes.
PICTURE_SIZE, PICTURE = (92, 160), 310
COMMENT = 999
#: How many places a finding names.
NAMED = 5


def find_repairs(tags: Tags) -> tuple[Edits, list[Diagnostic]]:
    """Return the entities that are to be read otherwise than they stand there, and notes."""
    edits: Edits = {}
    findings = [*_markers(tags, edits), *_handles(tags, edits)]
    return edits, findings


def text_with(tags: Tags, edits: Edits) -> str:
    """Return a drawing as text, with the entities of ``edits`` anew."""
    out: list[str] = []
    first = int(tags.marks[0]) if len(tags.marks) else len(tags.codes)
    out += _lines(tags, range(first))
    for mark in range(len(tags.marks)):
        if mark in edits:
            out += [f"{code}\n{value}" for code, value in edits[mark]]
        else:
            out += _lines(tags, range(int(tags.marks[mark]), tags.last(mark)))
    return "\n".join(out) + "\n"


def _lines(tags: Tags, places: range) -> Iterator[str]:
    for at in places:
        yield f"{tags.code(at)}\n{one_line(tags.value(at))}"


def one_line(value: str) -> str:
    """Return a value that fits a line: those of binary files may hold line ends."""
    return value if value.isprintable() else value.replace("\n", " ").replace("\r", " ")


def tags_of(tags: Tags, mark: int) -> list[Tag]:
    """Return what a mark opens, itself first."""
    return [
        (tags.code(at), one_line(tags.value(at)))
        for at in range(int(tags.marks[mark]), tags.last(mark))
    ]


def marks_of_entities(tags: Tags) -> NDArray[np.bool_]:
    """Return which marks are in the sections that hold entities."""
    inside = np.zeros(len(tags.marks), np.bool_)
    for name, first, end in tags.sections:
        inside[first:end] |= name in ("BLOCKS", "ENTITIES")
    return inside


# --- subclass markers -------------------------------------------------------------------------


def _markers(tags: Tags, edits: Edits) -> Iterator[Diagnostic]:
    """Put the markers of entities where they belong that have them otherwise."""
    marks = _unlike(tags).tolist()
    kinds: Counter[str] = Counter()
    for mark in marks:
        kind = tags.value(int(tags.marks[mark])).strip()
        edits[mark] = _marked(tags_of(tags, mark), MARKERS[kind])
        kinds[kind] += 1
    if marks:
        places = [int(tags.marks[mark]) for mark in marks]
        yield note(
            "repaired-drawing",
            "{entities} whose subclass markers (group 100) are missing or in another order: put in "
            "their places ({places})",
            tags.span(places[0]),
            count=len(marks),
            entities=[f"{many} {kind}" for kind, many in sorted(kinds.items())],
            places=_places(tags, places),
        )


def _places(tags: Tags, places: list[int]) -> Listing:
    return first_of([tags.place(at) for at in places], NAMED)


def _unlike(tags: Tags) -> NDArray[np.int64]:
    """Return the marks of entities that have other markers than ezdxf reads them by, or elsewhere.

    Right is: AcDbEntity, what all entities have in common, the marker of the type, its own data.
    """
    own_of = {tags.names[kind]: own for kind, own in MARKERS.items() if kind in tags.names}
    if not own_of:
        return np.zeros(0, np.int64)
    marks = np.flatnonzero(marks_of_entities(tags) & np.isin(tags.kinds, list(own_of)))
    if not len(marks):
        return marks
    first, last = tags.marks[marks], np.append(tags.marks, len(tags.codes))[marks + 1]
    places = np.flatnonzero(tags.codes == 100)
    low, high = np.searchsorted(places, first), np.searchsorted(places, last)
    good = high - low == 2
    one = places[np.where(good, low, 0)] if len(places) else first
    two = places[np.where(good, low + 1, 0)] if len(places) else first
    common = np.zeros(CODES + 1, np.int64)
    common[[*COMMON, *PICTURE_SIZE, PICTURE, COMMENT, 0, 100]] = 1
    others = np.r_[0, np.cumsum(1 - common[tags.codes])]
    good &= others[first] == others[np.where(good, two, first)]
    there = np.flatnonzero(good)
    firsts, seconds = (tags.texts(at[there].tolist()) for at in (one, two))
    owns = [own_of[number] for number in tags.kinds[marks[there]].tolist()]
    if firsts.count(ENTITY) != len(there) or seconds != owns:
        right = zip(firsts, seconds, owns, strict=True)
        good[there] = [a.strip() == ENTITY and b.strip() == own for a, b, own in right]
    out = marks[~good]
    return np.array([mark for mark in out.tolist() if _is_unlike(tags, mark)], np.int64)


def _is_unlike(tags: Tags, mark: int) -> bool:
    """Return the same of one entity, past which markers in data of other programs do not count."""
    own = MARKERS[tags.value(int(tags.marks[mark])).strip()]
    seen = []
    for at, code in tags.own(mark):
        if code == 100:
            seen.append(tags.value(at).strip())
        elif len(seen) < 2 and code not in COMMON | {*PICTURE_SIZE, PICTURE, COMMENT}:
            return True
    return seen != [ENTITY, own]


def _marked(tags: list[Tag], own: str) -> list[Tag]:
    """Return an entity with its markers in their places."""
    base: list[Tag] = []
    common: list[Tag] = []
    data: list[Tag] = []
    inside = False
    for k, (code, value) in enumerate(tags[1:], 1):
        if code in FOREIGN:
            data += tags[k:]
            break
        if code == 100 or code == PICTURE:
            continue
        if code in PICTURE_SIZE and tags[k + 1 : k + 2] and tags[k + 1][0] == PICTURE:
            continue
        starts = code == 102 and value.strip().startswith("{")
        if inside or starts:
            (data if data else base).append((code, value))
            inside = starts or code != 102
        elif code in COMMON and not (code in OWN_TOO and data):
            (base if code in (5, 330) else common).append((code, value))
        elif code != COMMENT:
            data.append((code, value))
    return [tags[0], *base, (100, ENTITY), *common, (100, own), *data]


# --- handles ----------------------------------------------------------------------------------

#: What a handle is not, in a list of them, one a line.
_STRANGE, _NOTHING = re.compile(r"[^0-9A-F\n]"), re.compile(r"^0*$", re.MULTILINE)
#: What has no handle in group 5: variables of the header, and dimension styles (a block's name).
NO_HANDLE = ("SECTION", "DIMSTYLE", "CLASS")


def _handles(tags: Tags, edits: Edits) -> Iterator[Diagnostic]:
    """Leave handles out that are none, and say which are there twice."""
    places = np.flatnonzero(tags.codes == 5)
    owner = np.searchsorted(tags.marks, places, side="right") - 1
    first = np.r_[True, owner[1:] != owner[:-1]] & (owner >= 0) if len(owner) else owner > 0
    names = [tags.names[name] for name in NO_HANDLE if name in tags.names]
    first &= ~np.isin(tags.kinds[owner], names)
    places, owner = places[first], owner[first]
    if not len(places):
        return
    values = tags.texts(places.tolist())
    joined = "\n".join(values).upper()
    wrong = []
    if " " in joined or "\t" in joined:
        joined = "\n".join(value.strip() for value in values).upper()
    values = joined.split("\n")
    if _STRANGE.search(joined) or _NOTHING.search(joined):
        wrong = [k for k, value in enumerate(values) if not _is_handle(value)]
    for k in wrong:
        mark, at = int(owner[k]), int(places[k])
        kept = edits.get(mark) or tags_of(tags, mark)
        gone = (5, one_line(tags.value(at)))
        edits[mark] = [tag for n, tag in enumerate(kept) if n != kept.index(gone)]
    if wrong:
        shown = sorted({values[k] for k in wrong})
        yield note(
            "repaired-drawing",
            "{count} entity has a handle (group 5) that no entity can have ({handles}): read "
            "without; findings name others ({places})"
            if len(wrong) == 1
            else "{count} entities have handles (group 5) that no entity can have ({handles}): "
            "read without; findings name others ({places})",
            tags.span(int(places[wrong[0]])),
            count=len(wrong),
            handles=shown[:NAMED],
            places=_places(tags, [int(places[k]) for k in wrong]),
        )
    mine = np.flatnonzero(marks_of_entities(tags)[owner]).tolist()
    if len({values[k] for k in mine}) == len(mine):
        return
    counts = Counter(values[k] for k in mine)
    twice = [value for value, many in counts.items() if many > 1 and _is_handle(value)]
    if twice:
        there = [int(places[k]) for k in mine if values[k] == twice[0]]
        yield note(
            "repaired-drawing",
            "handle {handle} is there {often} times, and {further} more: all are read, and a "
            "finding that names it may mean each ({places})"
            if len(twice) > 1
            else "handle {handle} is there {often} times: all are read, and a finding that names "
            "it may mean each ({places})",
            tags.span(there[1]),
            count=len(twice),
            handle=twice[0],
            often=counts[twice[0]],
            further=len(twice) - 1,
            places=_places(tags, there),
        )


def _is_handle(text: str) -> bool:
    """Return whether text is a handle: hexadecimal, above 0.

    >>> [_is_handle(text) for text in ("2F", "0", "xyz", "", "-1", "0x2F")]
    [True, False, False, False, False, False]
    """
    if not text or not text.isalnum():
        return False
    try:
        return int(text, 16) > 0 and "X" not in text.upper()
    except ValueError:
        return False
