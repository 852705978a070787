"""From threaded paths to the cuts of a scene: in their order, each with its stop and overcut."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from wedmcam.diag import Diagnostic, Place, error, warning
from wedmcam.geom import measure
from wedmcam.ir.figure import Reverse
from wedmcam.ir.plan import Cut, Scene
from wedmcam.transforms.plan.idle import Used
from wedmcam.transforms.plan.leads import Threaded, lead
from wedmcam.transforms.plan.options import Leading
from wedmcam.transforms.plan.order import order, parents_of
from wedmcam.transforms.plan.paths import PlannedPath
from wedmcam.transforms.plan.scenes import PieceScene
from wedmcam.transforms.plan.shaped import ShapedCut
from wedmcam.transforms.plan.wording import Wording


def cuts_of(
    scene: PieceScene,
    planned: Scene,
    number: int,
    paths: Sequence[PlannedPath],
    shaped_cuts: Sequence[ShapedCut],
    leading: Leading,
    used: Used,
    words: Wording,
) -> tuple[list[tuple[int, Cut]], list[Diagnostic]]:
    """Return the cuts of a scene with the numbers of what asks for them, inner contours first.

    Args:
        scene: its contours.
        planned: the same as the plan has it, ``number`` in its scenes.
        number: see there.
        paths: of the wire.
        shaped_cuts: all cuts of the source.
        leading: says what a cut does not.
        used: takes up what had an effect.
        words: of the source.
    """
    if not paths:
        return [], []
    cut_of = [scene.pieces[p.contour].cut for p in paths]
    own: dict[int, set[int]] = {p.cut: set() for p in scene.pieces}
    for k, n in enumerate(cut_of):
        own[n].add(k)
    threads = [start for n in own for start in shaped_cuts[n].starts]
    only: list[Collection[int]] = [mine for n, mine in own.items() for _ in shaped_cuts[n].starts]
    if scene.starts is not None:
        threads, only = list(scene.starts), [range(len(paths))] * len(scene.starts)
    threaded, findings = lead(paths, threads, leading.lead_um, only, words.thread_point)
    if threaded is None:
        return [], findings
    parents = parents_of([p.contour for p in paths], scene.nesting.parents)
    drawn = [int(p.outline.vertices["source"].min(initial=1 << 30)) for p in paths]
    # A part program cuts every scene inner contours first: one cut of it speaks for all.
    how = shaped_cuts[cut_of[0]].order
    cuts = []
    for k in order(parents, [t.thread for t in threaded], drawn, how):
        path, one, item = paths[k], threaded[k], shaped_cuts[cut_of[k]].item
        closed, piece = one.path.closed, scene.pieces[path.contour]
        stop = item.stop if item.stop is not None else leading.stop_um
        over = item.overcut if item.overcut is not None else leading.overcut_um
        used.add("stop_um", closed and item.stop is None)
        used.add("overcut_um", closed and item.overcut is None)
        used.add("lead_um", one.measured and item.lead is None)
        cut = Cut(
            path.outline,
            one.path,
            one.thread,
            scene.nesting.depths[path.contour],
            None if path.scrap_left is None else not path.scrap_left,
            stop if closed else 0.0,
            over if closed else 0.0,
            planned.first + path.contour + 1,
            planned.sides[path.contour],
            path.offset_um,
            number,
            one.stated,
            piece.clearance,
            piece.cornered_as_run,
            piece.corner,
        )
        cuts.append((cut_of[k], cut))
        if item.lead is not None and not one.measured:
            findings.append(_idle_lead(shaped_cuts[cut_of[k]]))
    findings += _too_long(cuts, shaped_cuts, words)
    for n, mine in own.items():
        turned = [paths[k] for k in sorted(mine) if _turned(paths[k], threaded[k])]
        findings += _overruled(
            turned, shaped_cuts[n], leading.reverse and used.wished("reverse"), words
        )
    return cuts, findings


def _idle_lead(cut: ShapedCut) -> Diagnostic:
    """Return a warning on the 'lead' of a cut that is entered from elsewhere."""
    return warning(
        "wed-option",
        "'lead' has no effect: the cut is entered from its start"
        if cut.starts
        else "'lead' has no effect: the cut is entered from the centre of the circle",
        cut.item.span,
    )


def _overruled(
    turned: Sequence[PlannedPath], cut: ShapedCut, reverse: bool, words: Wording
) -> list[Diagnostic]:
    """Return a warning where open paths of a cut are run the other way than was asked for."""
    options = ["--reverse"] if reverse else []
    options += (
        ["'reverse'"] if any(isinstance(t, Reverse) for t, _ in cut.item.shape.stages) else []
    )
    if not options or not turned:
        return []
    return [
        warning(
            words.idle,
            "{option} has no effect: an open contour is run from the end that is nearer to its "
            "thread point",
            cut.item.span or turned[0].path.source_of(0),
            count=len(turned),
            option=options[0],
        )
    ]


def _turned(planned: PlannedPath, one: Threaded) -> bool:
    """Return whether a thread point lets an open path be run the other way than it was to be."""
    if one.path.closed:
        return False
    a, b = planned.path.vertices, one.path.vertices
    return bool(a["x"][0] != b["x"][0] or a["y"][0] != b["y"][0])


def _too_long(
    cuts: Sequence[tuple[int, Cut]], shaped_cuts: Sequence[ShapedCut], words: Wording
) -> list[Diagnostic]:
    """Return errors where a stop or an overcut is longer than the path."""
    findings = []
    for name in ("stop", "overcut"):
        for number, cut in cuts:
            length = cut.stop_um if name == "stop" else cut.overcut_um
            if not length:
                continue
            whole = measure.length(cut.path.vertices, cut.path.closed)
            if length < whole - 1.0:
                continue
            findings.append(
                error(
                    f"{name}-too-long",
                    "'{option}' of {length_mm:.3f} mm is longer than the path of {path_mm:.3f} mm"
                    if words.of_part
                    else "--{option} {length_mm:.3f} mm is longer than the path of {path_mm:.3f} "
                    "mm that starts at {start}",
                    shaped_cuts[number].item.span or cut.path.source_of(0),
                    hint="a shorter {option}" if words.of_part else "a shorter --{option}",
                    option=name,
                    length_mm=length / 1000,
                    path_mm=whole / 1000,
                    start=Place.of_um(*cut.thread),
                )
            )
    return findings
