"""From the cuts that are asked for to the plan: the stages of this package in their order."""

from __future__ import annotations

from collections.abc import Sequence, Set

from wedmcam.arithmetic import Arithmetic
from wedmcam.diag import Diagnostic, error, has_errors
from wedmcam.ir.plan import Cut, Plan, Scene, outline_numbers
from wedmcam.transforms.plan.beside import beside
from wedmcam.transforms.plan.cuts import cuts_of
from wedmcam.transforms.plan.idle import Used, of_path
from wedmcam.transforms.plan.leads import Threaded, across
from wedmcam.transforms.plan.material import thin_material
from wedmcam.transforms.plan.options import Cutting, Leading
from wedmcam.transforms.plan.paths import planned_paths
from wedmcam.transforms.plan.pieces import Piece, pair_of, pieces_of
from wedmcam.transforms.plan.scenes import PieceScene, scenes_of
from wedmcam.transforms.plan.shaped import ShapedCut
from wedmcam.transforms.plan.wording import Wording


def plan_cuts(
    shaped_cuts: Sequence[ShapedCut],
    cutting: Cutting,
    leading: Leading,
    ar: Arithmetic,
    words: Wording,
    wished: Set[str] = frozenset(),
) -> tuple[Plan | None, list[Diagnostic]]:
    """Return where the wire goes, cut by cut in the order in which they are asked for.

    Args:
        shaped_cuts: what is cut and how; a drawing is one cut.
        cutting: says what a cut does not.
        leading: likewise.
        ar: the arithmetic of the formulas.
        words: of the source.
        wished: names of the fields that were asked for.
    """
    used = Used(wished)
    scenes, findings = scenes_to_cut(shaped_cuts, cutting, leading.reverse, ar, used)
    if scenes is None:
        return None, findings
    cuts: list[tuple[int, Cut]] = []
    planned: list[Scene] = []
    first = 0
    for number, scene in enumerate(scenes):
        planned.append(scene.as_planned(shaped_cuts, first))
        first += len(scene.pieces)
        paths, problems = planned_paths(scene, shaped_cuts, cutting, ar, words)
        findings += problems
        if paths is None:
            continue
        some, problems = cuts_of(
            scene, planned[-1], number, paths, shaped_cuts, leading, used, words
        )
        cuts += some
        findings += problems
    if len(scenes) > 1 and not has_errors(findings):
        every = [cut for _, cut in cuts]
        threaded = [Threaded(cut.path, cut.thread) for cut in every]
        plates = [planned[cut.scene].plate for cut in every]
        findings += across(threaded, outline_numbers(every), plates, words.thread_point)
        findings += beside(planned, every)
    if has_errors(findings):
        return None, findings
    if not cuts:
        offset = max((o for scene in planned for o in scene.offsets), default=0.0)
        nothing = error(
            "nothing-to-cut",
            "no contour is left to cut"
            if words.of_part
            else "with an offset of {offset_mm:.3f} mm no contour is left to cut",
            hint=None if words.of_part else "a smaller offset",
            offset_mm=offset / 1000,
        )
        return None, [*findings, nothing]
    findings += of_path(used, cutting, leading, words)
    if not shaped_cuts[0].of_drawing:  # a drawing states no order, its scenes are in theirs
        cuts.sort(key=lambda numbered: numbered[0])
    return Plan(tuple(cut for _, cut in cuts), tuple(planned)), findings


def scenes_to_cut(
    shaped_cuts: Sequence[ShapedCut], cutting: Cutting, reverse: bool, ar: Arithmetic, used: Used
) -> tuple[list[PieceScene] | None, list[Diagnostic]]:
    """Return what makes one part each; None where contours cross or leave no wall."""
    findings: list[Diagnostic] = []
    pieces: list[Piece] = []
    pair = pair_of(shaped_cuts, cutting)
    for number, cut in enumerate(shaped_cuts):
        own, problems = pieces_of(number, cut, cutting, reverse, ar, used, pair)
        pieces += own
        findings += problems
    if has_errors(findings):
        return None, findings
    scenes, problems = scenes_of(shaped_cuts, pieces)
    findings += problems
    if has_errors(findings):
        return None, findings
    for plate in sorted({scene.plate for scene in scenes}):
        on_plate = [scene for scene in scenes if scene.plate == plate]
        findings += thin_material(on_plate, cutting.thin_wall_um)
    if has_errors(findings):
        return None, findings
    return scenes, findings
