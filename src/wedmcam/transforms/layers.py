"""Layers that are cut on a side of their own: punch and die in one drawing.

What is cut on one side and at one offset joins to contours by itself: the outline of a punch may be
drawn once more as that of its die, and neither a copy nor a crossing of it is one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence, Set
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from wedmcam.diag import Diagnostic, EntityRef, Span, error, warning
from wedmcam.ir.contour import Contour
from wedmcam.ir.names import Names
from wedmcam.ir.plan import Side
from wedmcam.ir.sketch import Sketch
from wedmcam.option_table import option_of
from wedmcam.transforms.plan.options import Cutting

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Rule:
    """How the contours of a layer are cut.

    Attributes:
        side: on which the wire runs.
        stated: the side was asked for; else it follows from whether there is an offset.
        offset_um: wire / 2 + gap where the layer has its own; None for that of all.
        clearance_um: by how much less the wire keeps from their outlines.
    """

    side: Side
    stated: bool
    offset_um: float | None
    clearance_um: float


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Contours that are cut by one rule."""

    rule: Rule
    contours: tuple[Contour, ...]


def rule_of(layer: str, cutting: Cutting, names: Collection[str] = ()) -> Rule:
    """Return how the contours of a layer are cut; a name counts before a wildcard.

    ``names``: of all layers, case folded: what names one of them is no wildcard for others.
    """
    side = _choose(layer, cutting.layer_sides, names)
    offset = _choose(layer, cutting.layer_offsets, names)
    stated = side or cutting.side
    if stated is None:
        stated_side = Side.PART if (offset or cutting.offset_um) else Side.ON
    else:
        stated_side = stated
    return Rule(stated_side, stated is not None, offset, cutting.taken_um(stated_side))


def _choose(layer: str, choices: Sequence[tuple[str, T]], names: Collection[str]) -> T | None:
    """Return the choice for a layer: under its name, else under the first wildcard for it."""
    fits = [(word, value) for word, value in choices if layer in Names([word], names)]
    literal = [value for word, value in fits if word.casefold() == layer.casefold()]
    return next(iter([*literal, *(value for _, value in fits)]), None)


def split(
    sketch: Sketch, cutting: Cutting, wished: Set[str]
) -> tuple[list[tuple[Rule, Sketch]], list[Diagnostic]]:
    """Return a sketch in parts of one rule each; errors for layers that are named and not there.

    And a warning where a clearance was asked for and no part takes it. ``wished``: names of the
    fields that were asked for.

    What a shop says of the layers of all its drawings may miss in one; what was asked for with this
    drawing in mind may not: its contours would be cut on the wrong side.
    """
    if not (cutting.layer_sides or cutting.layer_offsets):
        return [(rule_of("", cutting), sketch)], []
    layers = [_layer(s) for s in sketch.sources]
    names = {layer.casefold() for layer in layers}
    rules = {layer: rule_of(layer, cutting, names) for layer in dict.fromkeys(layers)}
    used = sketch.segments["source"]
    cut = {layers[k] for k in np.unique(used[used >= 0]).tolist()}
    groups: list[tuple[Rule, Sketch]] = []
    every = list(dict.fromkeys(rules.values()))
    which = np.array([every.index(rules[layer]) for layer in layers], np.int64)
    of = np.where(used >= 0, which[used] if len(which) else 0, 0)
    for number, rule in enumerate(every):
        mine = of == number
        if mine.any():
            groups.append((rule, replace(sketch, segments=sketch.segments[mine])))
    findings = _missing(cut, cutting, wished)
    if not findings and "clearance_um" in wished and cutting.clearance_um:
        findings = _untaken([rule for rule, _ in groups], cutting)
    return groups or [(rule_of("", cutting), sketch)], findings


def _untaken(rules: Sequence[Rule], cutting: Cutting) -> list[Diagnostic]:
    """Return a warning where no contour takes the clearance that was asked for."""
    if not rules or any(rule.clearance_um for rule in rules):
        return []
    who = cutting.clearance_on
    return [
        warning(
            "clearance-untaken",
            "--clearance is taken by the {taker}, and no contour of the drawing is cut as one",
            hint="--clearance-on {other}, or --layer-side for the layer that is the {taker}",
            taker=who,
            other="punch" if who == "die" else "die",
        )
    ]


def _missing(cut: set[str], cutting: Cutting, wished: Set[str]) -> list[Diagnostic]:
    """Return an error for each name for which there is no layer with something to cut."""
    return [
        error(
            "no-such-layer",
            "{option} {layer}: nothing to cut is on a layer of this name",
            hint="layers with something to cut: {layers}"
            if cut
            else "layers with something to cut: none",
            option=option_of(field),
            layer=name,
            layers=sorted(cut)[:12],
        )
        for field in ("layer_sides", "layer_offsets")
        if field in wished
        for name in Names((name for name, _ in getattr(cutting, field)), cut).unmatched
    ]


def _layer(source: Span) -> str:
    return source.layer if isinstance(source, EntityRef) else ""
