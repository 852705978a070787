"""Images of a part must have images of its program: what no single compile can show about itself.

The part is rotated by 90, 180 and 270 degrees, mirrored, run the other way round, and threaded
elsewhere; each image is compiled to bytes and decoded again, and its program is judged against the
image of the first plan. So both programs lie within the deviation budget of one path; they are not
the same to the step, because the stair of a line changes under rotation and reversal. Faults of one
quadrant or sense, in the compiler or in a profile, show here.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from wedmcam.compiler import pipeline
from wedmcam.compiler.sources import Drawn
from wedmcam.diag import Diagnostic, Severity, error, note
from wedmcam.diag.run import Refused, Run
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan
from wedmcam.machines import Machine
from wedmcam.options import Options
from wedmcam.targets import Target, target_of


class Isometry(NamedTuple):
    """A map of the plane that keeps whole um: (x, y) -> (a x + b y, c x + d y), all 0 or +-1."""

    name: str
    a: int = 1
    b: int = 0
    c: int = 0
    d: int = 1

    def point(self, x: float, y: float) -> tuple[float, float]:
        """Return the image of a point."""
        return self.a * x + self.b * y + 0.0, self.c * x + self.d * y + 0.0

    def contour(self, contour: Contour) -> Contour:
        """Return the image of a contour, in its own order."""
        v = contour.vertices.copy()
        for x, y in (("x", "y"), ("cx", "cy")):
            old_x, old_y = contour.vertices[x], contour.vertices[y]
            v[x] = self.a * old_x + self.b * old_y + 0.0
            v[y] = self.c * old_x + self.d * old_y + 0.0
        v["turn"] *= np.sign(self.a * self.d - self.b * self.c)
        return Contour(v, contour.closed)


#: Images of the part.
ISOMETRIES = (
    Isometry("rotated by 90 degrees", 0, -1, 1, 0),
    Isometry("rotated by 180 degrees", -1, 0, 0, -1),
    Isometry("rotated by 270 degrees", 0, 1, -1, 0),
    Isometry("mirrored in the x axis", 1, 0, 0, -1),
    Isometry("mirrored in the 45 degree line", 0, 1, 1, 0),
)

#: How far from the path thread points elsewhere are set at first, um; halved where they do not fit.
ELSEWHERE = 500.0


class Image(NamedTuple):
    """One image.

    Attributes:
        name: what was done to the part.
        ok: its program lies on the image of the path.
        deviation_um: of its program from the image of the path; None where there is no program.
        blocks: of its program.
        why: the first finding where it is not ok, or why it was left out.
    """

    name: str
    ok: bool
    deviation_um: float | None
    blocks: int
    why: str = ""


def metamorphic(
    data: bytes, name: str, machine: Machine, options: Options
) -> tuple[tuple[Image, ...], list[Diagnostic]]:
    """Compile images of a drawing and compare their programs with the image of its path.

    Returns:
        What came of each image, and findings: errors for images that differ, a note for one that
        could not be tried. A drawing that is refused has its findings and no image.
    """
    run, target = Run(options.judging.strict), target_of(machine)
    options = replace(options, wishes=frozenset())  # a compile says which had no effect
    try:
        drawn, plan = pipeline.plan_source(data, name, options, [target], run)
    except Refused:
        return (), run.findings
    images = []
    for isometry in ISOMETRIES:
        moved, moved_options = _moved(drawn, options, isometry)
        images.append(
            _image(isometry.name, moved, moved_options, target, _plan_moved(plan, isometry))
        )
    other_way = options.with_values(reverse=not options.leading.reverse)
    images.append(_image("run the other way round", drawn, other_way, target, plan))
    images.append(_elsewhere(drawn, options, target, plan))
    findings = []
    for image in images:
        if not image.ok:
            findings.append(
                error(
                    "not-an-image",
                    "the part {image} has another program: {why}",
                    image=image.name,
                    why=image.why,
                )
            )
        elif image.why:
            findings.append(
                note("not-an-image", "the part {image}: {why}", image=image.name, why=image.why)
            )
    return tuple(images), findings


def _moved(drawn: Drawn, options: Options, by: Isometry) -> tuple[Drawn, Options]:
    """Return the image of what was drawn, and the options with the image of --start."""
    from wedmcam.transforms.figures import counter_clockwise
    from wedmcam.transforms.nest import nest

    points = []
    for p in drawn.sketch.thread_points:
        x, y = by.point(p.x, p.y)
        points.append(replace(p, x=x, y=y))
    groups = tuple(
        replace(g, contours=counter_clockwise(tuple(by.contour(c) for c in g.contours)))
        for g in drawn.groups
    )
    contours = tuple(c for g in groups for c in g.contours)
    sketch = replace(drawn.sketch, thread_points=tuple(points))
    moved = replace(drawn, sketch=sketch, contours=contours, nesting=nest(contours), groups=groups)
    starts = tuple(by.point(*s) for s in options.leading.starts_um)
    return moved, options.with_values(starts_um=starts)


def _plan_moved(plan: Plan, by: Isometry) -> Plan:
    """Return the image of a plan; the paths of a mirror image run the other way."""

    def cut(one: Cut) -> Cut:
        x, y = by.point(*one.thread)
        return replace(one, outline=None, path=by.contour(one.path), thread=(int(x), int(y)))

    return replace(
        plan,
        cuts=tuple(cut(one) for one in plan.cuts),
        scenes=tuple(
            replace(s, outlines=tuple(by.contour(c) for c in s.outlines)) for s in plan.scenes
        ),
    )


def _image(name: str, drawn: Drawn, options: Options, target: Target, wanted: Plan) -> Image:
    """Compile an image, and judge its program against the plan that is wanted."""
    run = Run()
    try:
        plan = pipeline.plan_of(drawn, options, [target], run)
        entries, lowered, data = pipeline.write_program(plan, target, options, run)
        decoded, findings = target.read(data, name, entries)
        run.add("decode", findings)
    except Refused as why:
        return Image(name, False, None, 0, f"{why.stage} refuses it: {_first(run.findings)}")
    program = replace(decoded, origin=lowered.origin)
    verdict, findings = pipeline.judge_program(program, wanted, target, options, strict_order=False)
    text = "" if verdict.ok else _first(findings)
    return Image(name, verdict.ok, verdict.max_deviation_um, verdict.blocks, text)


def _first(findings: list[Diagnostic]) -> str:
    return next((d.message for d in findings if d.severity is Severity.ERROR), "")


def _elsewhere(drawn: Drawn, options: Options, target: Target, plan: Plan) -> Image:
    """Thread every closed contour elsewhere: beside the middle of another segment of its path."""
    name = "threaded elsewhere"
    moved = replace(drawn, sketch=replace(drawn.sketch, thread_points=()))
    cuts = [c for c in plan.cuts if c.path.closed and c.keeps_left is not None]
    for away in (ELSEWHERE, ELSEWHERE / 4.0):
        for share in (1 / 2, 1 / 3, 2 / 3):
            points = tuple(_beside(c, share, away) for c in cuts)
            threaded = options.with_values(starts_um=points)
            try:
                pipeline.plan_of(moved, threaded, [target], Run())
            except Refused:
                continue
            if points:
                return _image(name, moved, threaded, target, plan)
    return Image(name, True, None, 0, "not tried: no other thread points fit")


def _beside(cut: Cut, share: float, away: float) -> tuple[float, float]:
    """Return a place on the scrap side, ``away`` from the segment after a share of all."""
    k = int(share * len(cut.path.starts))
    a, b = cut.path.starts[k], cut.path.ends[k]
    x, y = float(a["x"]), float(a["y"])
    side = -1.0 if cut.keeps_left else 1.0
    if a["turn"]:
        # Beside the start of the arc, along its radius: to its left is its centre.
        ux, uy = float(a["cx"]) - x, float(a["cy"]) - y
        side *= float(a["turn"])
    else:
        ux, uy = y - float(b["y"]), float(b["x"]) - x
        x, y = (x + float(b["x"])) / 2.0, (y + float(b["y"])) / 2.0
    scale = side * away / float(np.hypot(ux, uy))
    return float(round(x + scale * ux)), float(round(y + scale * uy))
