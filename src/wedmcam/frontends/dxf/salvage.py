"""A second try at a damaged file: its layers, blocks and entities alone, every tag kept or named.

Much of what stops a reader has nothing to do with geometry: a table without its head, a stray end
of section, a colour that is no number, coordinates in the order of another century. What holds the
geometry is taken out of such a file tag by tag and written as a plain drawing. Nothing in it is
guessed: a value that would have to be changed to be read is refused, and whoever calls compares the
counts of what comes out with what the file states.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

Tag = tuple[int, str]

#: Sections that hold what is cut; the others are left out.
KEPT = ("TABLES", "BLOCKS", "ENTITIES")
#: Group codes with whole numbers that are looks: colour, line weight, transparency.
LOOKS = frozenset({62, 370, 420, 440})
#: Ranges of group codes with whole numbers.
WHOLE = ((60, 79), (90, 99), (160, 179), (270, 289), (370, 389), (400, 409), (420, 429), (440, 449))
#: Entities with one place for each of their point codes, whose coordinates may be put in order.
SINGLE = frozenset(
    {"LINE", "ARC", "CIRCLE", "POINT", "INSERT", "VERTEX", "TEXT", "ATTRIB", "BLOCK"}
)


@dataclass(slots=True)
class Salvaged:
    """A plain drawing, and what was done: each a clause of a sentence."""

    text: str = ""
    done: list[str] = field(default_factory=list)


def salvage(text: str, version: str) -> Salvaged | None:
    """Return the geometry of a damaged file as a plain drawing; None where that would be guessing.

    Args:
        text: with newlines as line ends; group codes are whole numbers.
        version: to be stated, e.g. "AC1015".
    """
    lines = text.split("\n")
    sections: dict[str, list[Tag]] = {name: [] for name in KEPT}
    inside = ""
    out = Salvaged()
    stray = looks = 0
    others: Counter[str] = Counter()
    at = 0
    while at + 1 < len(lines):
        try:
            code = int(lines[at])
        except ValueError:
            return None
        value = lines[at + 1]
        word = value.strip()
        at += 2
        if code == 0 and word == "EOF":
            break
        if code == 0 and word == "SECTION":
            inside = lines[at + 1].strip() if at + 1 < len(lines) else ""
            at += 2
            if inside not in KEPT:
                others[inside] += 1
        elif code == 0 and word == "ENDSEC":
            inside = ""
        elif inside in KEPT:
            if any(a <= code <= b for a, b in WHOLE) and not _is_whole(value):
                if code not in LOOKS:
                    return None
                looks += 1
                continue
            sections[inside].append((code, value))
        elif not inside:
            stray += code != 999
    else:
        return None  # without its end mark it may be cut off
    if stray:
        out.done.append(f"{stray} groups outside of sections left out")
    if looks:
        out.done.append(f"{looks} colours or line weights that are no numbers left out")
    if others:
        out.done.append(f"sections {', '.join(sorted(others))} left out")
    turned = 0
    body = []
    for name in ("BLOCKS", "ENTITIES"):
        tags, moved = _in_order(sections[name])
        turned += moved
        if tags:
            body += [(0, "SECTION"), (2, name), *tags, (0, "ENDSEC")]
    if turned:
        out.done.append(f"coordinates of {turned} entities put in order")
    head: list[Tag] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, version), (0, "ENDSEC")]
    layers = _layers(sections["TABLES"])
    if layers:
        head += [(0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LAYER"), (70, str(len(layers)))]
        for layer in layers:
            head += layer
        head += [(0, "ENDTAB"), (0, "ENDSEC")]
    out.text = "".join(f"{code:3d}\n{value}\n" for code, value in [*head, *body, (0, "EOF")])
    return out


def _is_whole(text: str) -> bool:
    try:
        int(text)
    except ValueError:
        return False
    return True


def _entities(tags: list[Tag]) -> list[list[Tag]]:
    """Return the groups that begin with code 0."""
    out: list[list[Tag]] = []
    for tag in tags:
        if tag[0] == 0 or not out:
            out.append([])
        out[-1].append(tag)
    return out


def _in_order(tags: list[Tag]) -> tuple[list[Tag], int]:
    """Return tags with x, y and z of every place side by side, and in how many entities not so."""
    out: list[Tag] = []
    moved = 0
    for group in _entities(tags):
        codes = Counter(code for code, _ in group)
        places = [c for c in codes if 10 <= c <= 18]
        done = group
        if group[0][1].strip() in SINGLE and all(
            codes[c + k] <= 1 for c in places for k in (0, 10, 20)
        ):
            of = dict(group)
            done = []
            for code, value in group:
                if code in places:
                    done += [(c, of[c]) for c in (code, code + 10, code + 20) if c in of]
                elif not (20 <= code <= 38 and (code - 10 in places or code - 20 in places)):
                    done.append((code, value))
        moved += done != group
        out += done
    return out, moved


def _layers(tags: list[Tag]) -> list[list[Tag]]:
    """Return name, state, colour and line type of each layer."""
    return [
        [tag for tag in group if tag[0] in (0, 2, 70, 62, 6)]
        for group in _entities(tags)
        if group[0] == (0, group[0][1]) and group[0][1].strip() == "LAYER"
    ]
