"""What of a drawing its user takes and leaves out: by layer, type of entity, line type and colour.

A name is taken literally before it is a wildcard: CUT[1] is a layer, where there is one of that
name. What is asked for and matches nothing is said: a misspelt name would cut what was to be left
out. Line types and colours are those that are seen: BYLAYER is the layer's, BYBLOCK the INSERT's.
"""

from __future__ import annotations

import difflib
from collections.abc import Set
from dataclasses import dataclass
from typing import Any

from wedmcam.diag import Diagnostic, FileSpan, warning
from wedmcam.diag.lists import first_of
from wedmcam.frontends.dxf.kinds import UNREADABLE
from wedmcam.frontends.options import DrawingReading
from wedmcam.ir.colours import colour_of, of_rgb, shown
from wedmcam.ir.names import Names
from wedmcam.option_table import option_of

#: Line types that say nothing of their own.
PLAIN = ("", "bylayer", "byblock", "continuous")
#: The layer of thread points: a filter that takes only something does not take them away.
START = "start"
#: How many names a finding tells.
NAMED = 8


@dataclass(frozen=True, slots=True)
class Look:
    """How an entity is drawn: line type ("" for a plain one), and colour as in `ir.colours`.

    As stated: "BYBLOCK" and "0" are those of the INSERT, None those of the layer.
    """

    linetype: str | None = None
    colour: str | None = None


#: Of an INSERT in the layout itself.
TOP = Look("", "7")


def look_of(entity: Any, value_of_group: Any) -> Look | None:
    """Return how an entity says that it is drawn; None where it leaves all to its layer.

    ``value_of_group``: what finds a group of an entity of an unknown type.
    """
    dxf = entity.dxf
    if hasattr(entity, "xtags"):
        linetype, index, rgb = (value_of_group(entity, code, None) for code in (6, 62, 420))
    else:
        there = dxf.hasattr
        linetype = dxf.linetype if there("linetype") else None
        index = dxf.color if there("color") else None
        rgb = dxf.true_color if there("true_color") else None
    if linetype is None and index is None and rgb is None:
        return None
    colour = None
    if rgb is not None:
        colour = of_rgb(int(rgb))
    elif index is not None and int(index) != 256:
        colour = str(abs(int(index)))
    line = None if linetype is None or str(linetype).lower() == "bylayer" else str(linetype)
    return Look(line, colour)


class LayerLooks:
    """How layers are drawn, for what leaves it to them."""

    def __init__(self, table: Any) -> None:
        self._looks: dict[str, Look] = {}
        for layer in table:
            dxf = layer.dxf
            rgb = dxf.get("true_color")
            colour = str(abs(dxf.get("color", 7))) if rgb is None else of_rgb(int(rgb))
            linetype = str(dxf.get("linetype", ""))
            self._looks[str(dxf.get("name", "")).casefold()] = Look(_plain(linetype), colour)

    def seen(self, look: Look | None, layer: str, insert: Look) -> Look:
        """Return what is seen of an entity on a layer, in a block that an INSERT shows."""
        own = self._looks.get(layer.casefold(), TOP)
        if look is None:
            return own
        linetype, colour = look.linetype, look.colour
        if linetype is None:
            linetype = own.linetype
        elif linetype.lower() == "byblock":
            linetype = insert.linetype
        if colour is None:
            colour = own.colour
        elif colour == "0":
            colour = insert.colour
        return Look(_plain(linetype or ""), colour)


def _plain(linetype: str) -> str:
    return "" if linetype.lower() in PLAIN else linetype


@dataclass(frozen=True, slots=True)
class Both:
    """What is taken (nothing named: all), and what is left out, which wins."""

    take: Names
    ignore: Names

    def __bool__(self) -> bool:
        return bool(self.take) or bool(self.ignore)

    def leaves_out(self, name: str, start: bool) -> bool:
        """Return whether what is of that name is left out; ``start``: it is on layer START."""
        if name in self.ignore:
            return True
        return bool(self.take) and not start and name not in self.take


@dataclass(frozen=True, slots=True)
class Filters:
    """All filters of a drawing."""

    layers: Both
    types: Both
    linetypes: Both
    colours: Both

    @property
    def by_look(self) -> bool:
        """Whether line types or colours decide anything."""
        return bool(self.linetypes) or bool(self.colours)

    def leaves_out_type(self, kind: str, layer: str) -> bool:
        """Return whether entities of a type are left out; an INSERT shows what its block holds."""
        start = layer.casefold() == START or kind == "INSERT"
        return bool(self.types) and self.types.leaves_out(kind, start)

    def leaves_out_look(self, look: Look, layer: str) -> bool:
        """Return whether what looks so is left out."""
        start = layer.casefold() == START
        return self.linetypes.leaves_out(look.linetype or "CONTINUOUS", start) or (
            self.colours.leaves_out(look.colour or "7", start)
        )


#: Filters: field of the options, and what it names.
_NAMED = {
    "layers": "layer",
    "types": "type of entity",
    "linetypes": "line type",
    "colours": "colour",
}
FILTERS = {prefix + name: what for name, what in _NAMED.items() for prefix in ("", "ignore_")}


def filters_of(
    doc: Any, options: DrawingReading, file: str, type_of: Any, wished: Set[str] | None = None
) -> tuple[Filters, list[Diagnostic]]:
    """Return the filters of a drawing, and warnings about names that match nothing in it.

    Args:
        doc: the document.
        options: of the reader.
        file: its name.
        type_of: what tells the type of an entity.
        wished: names of the filters that are of this drawing alone; None: all.
    """
    asked = {name: tuple(getattr(options, name)) for name in FILTERS}
    for name in ("colours", "ignore_colours"):
        asked[name] = tuple(colour_of(text) for text in asked[name])
    there = _there(doc, type_of) if any(asked.values()) else {}
    names = {name: Names(asked[name], there.get(what, ())) for name, what in FILTERS.items()}
    findings = []
    for name, what in FILTERS.items():
        if wished is not None and name not in wished:
            continue
        for word in names[name].unmatched:
            unmatched = warning(
                "filter-unmatched",
                "{option} {name}: nothing in the drawing has that {property}",
                FileSpan(file),
                option=option_of(name),
                name=shown(word) if what == "colour" else word,
                property=what,
            )
            findings.append(_with_nearest(unmatched, word, sorted(there[what]), what))
    both = [Both(names[k], names[f"ignore_{k}"]) for k in _NAMED]
    return Filters(*both), findings


def _with_nearest(unmatched: Diagnostic, word: str, there: list[str], what: str) -> Diagnostic:
    """Return the finding with the name that is nearest to a word, or the names that there are."""
    if what == "colour":
        there = [shown(colour) for colour in there]
    else:
        folded = {name.casefold(): name for name in there}
        near = difflib.get_close_matches(word.casefold(), folded, 1, 0.6)
        if near:
            return unmatched.extended(hint="did you mean {nearest}?", nearest=folded[near[0]])
    if not there:
        return unmatched.extended(hint="there is none")
    return unmatched.extended(hint="there is {there}", there=first_of(there, NAMED))


def _there(doc: Any, type_of: Any) -> dict[str, set[str]]:
    """Return the names of layers, types, line types and colours that a drawing has."""
    from wedmcam.frontends.dxf.shapes import layer_of, value_of_group

    looks = LayerLooks(doc.layers)
    layers = {str(layer.dxf.get("name", "")) for layer in doc.layers}
    kinds: set[str] = set()
    linetypes = {str(line.dxf.get("name", "")) for line in doc.linetypes}
    colours: set[str] = set()
    for block in doc.blocks:
        for entity in block:
            layer = layer_of(entity)
            layers.add(layer)
            kinds.add(type_of(entity))
            look = looks.seen(look_of(entity, value_of_group), layer, TOP)
            linetypes.add(look.linetype or "CONTINUOUS")
            colours.add(look.colour or "7")
    linetypes = {name for name in linetypes if name.lower() not in ("bylayer", "byblock", "")}
    kinds.discard(UNREADABLE)
    return {"layer": layers, "type of entity": kinds, "line type": linetypes, "colour": colours}
