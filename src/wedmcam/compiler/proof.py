"""A program that exists is proven: where it starts in the drawing, and what its certificate claims.

`pipeline.judge_program` measures, here as in a compile, so that an honest certificate holds. What a
certificate claims beyond that (the findings of a compile, and which program it was) is derived by
emitting its plan again.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from wedmcam.compiler import pipeline
from wedmcam.compiler.sources import Drawn
from wedmcam.diag import Diagnostic, Place, Severity, error, has_errors, note, warning
from wedmcam.diag.run import Refused, Run
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Program
from wedmcam.options import Options
from wedmcam.targets import Target

if TYPE_CHECKING:
    from wedmcam.judge.verdict import Verdict

#: A thread point of the plan is one that was given if it is no farther from it, um: it was rounded.
SAME_POINT = 1.0

#: So many places are tried in full; a drawing may give thousands of thread points.
TRIED = 8

Steps = tuple[int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Placing:
    """What is known of where a program starts in the drawing.

    Attributes:
        origin_um: as an option or a certificate states it; None where neither does.
        given: thread points of the drawing and of the options, um.
        fit: a translation may be fitted although thread points are given.
        ours: the program is said to be of this plan, so that order and leads are the plan's too.
    """

    origin_um: tuple[float, float] | None
    given: tuple[tuple[float, float], ...]
    fit: bool
    ours: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Judged:
    """A program at a place, and what the judge says of it there."""

    program: Program
    verdict: Verdict
    findings: list[Diagnostic]


def given_points(drawn: Drawn, options: Options) -> tuple[tuple[float, float], ...]:
    """Return the thread points of the source and of the options, um."""
    threads = [(p.x, p.y) for p in drawn.sketch.thread_points]
    return (*threads, *options.leading.starts_um)


def place_program(
    decoded: Program, plan: Plan, target: Target, options: Options, how: Placing, run: Run
) -> tuple[Program, Verdict]:
    """Judge a program where it starts: at the stated origin, on a thread point, or where it fits.

    The plan's first thread point comes first, then the others that were given. Where it proves on
    none of them a translation is fitted: if no thread point is given, or if that is asked for.
    """
    from wedmcam.judge.in_steps import in_steps

    def at(place: Steps, fitted: bool = False, strict: bool = how.ours) -> _Judged:
        program = replace(decoded, origin=place)
        judged = pipeline.judge_program(
            program, plan, target, options, strict_order=strict, fitted=fitted
        )
        return _Judged(program, *judged)

    notes: list[Diagnostic] = []
    threads = [cut.thread for cut in in_steps(plan, decoded.step_um).cuts]
    if plan.others is not None:
        threads = [plan.others.start]  # in the kerf, where the load before it stands
    if how.origin_um is not None:
        x, y = (v / decoded.step_um for v in how.origin_um)
        best = at((round(x), round(y)))
    else:
        best = at(threads[0])
        if not best.verdict.ok and (not how.ours or how.fit):
            best, notes = _elsewhere(best, decoded, plan, target, how, threads, at)
    if not how.ours:
        notes += _other_start(best.program, threads)
    lost = len(best.verdict.cuts) < len(plan.cuts)
    if not how.ours and lost and has_errors(best.findings):
        # A contour that was not found tells us little. Followed in the plan's order, the first
        # block that leaves it tells more, if the program is one of this plan at all.
        strict = at(best.program.origin, strict=True)
        if len(strict.verdict.cuts) == len(plan.cuts):
            best = strict
    run.add("verify", [*notes, *best.findings])
    return best.program, best.verdict


def _elsewhere(
    first: _Judged,
    decoded: Program,
    plan: Plan,
    target: Target,
    how: Placing,
    threads: Sequence[Steps],
    at: Callable[..., _Judged],
) -> tuple[_Judged, list[Diagnostic]]:
    """Return the proof at another place, and the findings that say why there."""
    from wedmcam.judge.origin import fit, may_start

    stepping = target.machine.stepping
    places = _given_places(how.given, threads, decoded.step_um)
    for place in may_start(decoded, plan, places, stepping=stepping)[:TRIED]:
        if place != threads[0] and (judged := at(place)).verdict.ok:
            return judged, []
    fitted, notes = fit(decoded, plan, stepping=stepping)
    if fitted is None:
        return first, notes
    best = at(fitted.origin, fitted=fitted.origin != threads[0])
    if not how.given:
        more_cuts = len(best.verdict.cuts) > len(first.verdict.cuts)
        nearer = best.verdict.max_deviation_um < first.verdict.max_deviation_um
        return (best, notes) if best.verdict.ok or more_cuts or nearer else (first, [])
    if not best.verdict.ok and fitted.origin in (threads[0], *places):
        return best, []  # it starts where it may, and is wrong
    if how.fit:
        return best, [replace(d, severity=Severity.WARNING) for d in notes]
    start = _place(fitted.origin, decoded.step_um)
    where = error(
        "origin-unknown",
        "the program does not prove with its start on the one thread point that is given"
        if len(how.given) == 1
        else "the program does not prove with its start on any of the {given} thread points that "
        "is given",
        hint="--origin X,Y says where it starts; --fit-origin takes the place that fits",
        points_mm=(start,),
        given=len(how.given),
        start=start,
    )
    where = where.extended(
        "; it would prove if it started at {start}"
        if best.verdict.ok
        else "; it fits best if it starts at {start}, and does not prove there"
    )
    return (replace(first, findings=[]) if best.verdict.ok else first), [where]


def _place(at: Steps, step_um: float) -> Place:
    return Place.of_um(at[0] * step_um, at[1] * step_um)


def _given_places(
    given: Iterable[tuple[float, float]], threads: Sequence[Steps], step_um: float
) -> list[Steps]:
    """Return given thread points in steps, in the order in which the plan threads there."""
    points = np.array(list(given), float).reshape(-1, 2) / step_um
    if not len(points):
        return []
    places: dict[Steps, None] = {}
    left = np.ones(len(points), bool)
    for place in threads:
        near = np.hypot(points[:, 0] - place[0], points[:, 1] - place[1]) <= SAME_POINT
        if near.any():
            places[place] = None
            left &= ~near
    for x, y in points[left]:
        places[(round(float(x)), round(float(y)))] = None
    return list(places)


def _other_start(program: Program, threads: Sequence[Steps]) -> list[Diagnostic]:
    """Return a note where a program starts elsewhere than the plan does."""
    if program.origin == threads[0]:
        return []
    start = _place(program.origin, program.step_um)
    return [
        note(
            "other-order",
            "the program starts at {start}, where the plan threads cut {cut}, the plan at {planned}"
            if program.origin in threads
            else "the program starts at {start}, the plan at {planned}",
            points_mm=(start,),
            start=start,
            cut=threads.index(program.origin) + 1 if program.origin in threads else None,
            planned=_place(threads[0], program.step_um),
        )
    ]


# --- certificates --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Proven:
    """A program that was proven, and what it was proven with.

    Attributes:
        program: at its place.
        data: its bytes.
        drawing: the bytes of what was drawn.
        plan: as asked for of the target.
        target: of the program.
        options: as asked for.
    """

    program: Program
    data: bytes
    drawing: bytes
    plan: Plan
    target: Target
    options: Options


def is_of(certificate: Mapping[str, Any], key: str, data: bytes) -> bool:
    """Return whether a certificate is of these bytes, its "input" or its "output"."""
    from wedmcam.judge.certificate import fingerprint

    return bool(certificate["sha256"][key] == fingerprint(data))


def is_ours(certificate: Mapping[str, Any]) -> bool:
    """Return whether a certificate is of a compile, and not of a program from elsewhere."""
    return "leads" not in certificate


def issued_for_others(
    certificate: Mapping[str, Any], data: bytes, drawing: bytes
) -> list[Diagnostic]:
    """Return a warning for each of program and drawing that a certificate is not of."""
    return [
        warning(
            "certificate-differs",
            "the certificate was issued for another {file}: its fingerprint differs",
            hint="what is proven now is the file that is there",
            file=what,
        )
        for key, what, seen in (("output", "program", data), ("input", "drawing", drawing))
        if seen and not is_of(certificate, key, seen)
    ]


def check_certificate(
    certificate: Mapping[str, Any],
    now: Mapping[str, Any],
    proven: Proven,
    planned: Sequence[Diagnostic],
    read: Sequence[Diagnostic],
    judged: Sequence[Diagnostic],
    every: Sequence[Diagnostic],
) -> list[Diagnostic]:
    """Return the findings on what a certificate claims of a program.

    Args:
        certificate: without a fault.
        now: the one that would be written now.
        proven: the program.
        planned: findings until the plan.
        read: findings of the reader on the program.
        judged: findings of the judge on it.
        every: all findings so far.

    Of another drawing, only what the program is by itself is compared. Of another program, where
    it leaves the one that is compiled is reported.
    """
    from wedmcam.judge.claims import differences, of_the_program

    same = is_of(certificate, "output", proven.data)
    if not is_of(certificate, "input", proven.drawing):
        return of_the_program(certificate, now) if same else []
    if not is_ours(certificate):
        return differences(certificate, now, every) if same else []
    trial = Run(findings=list(planned))
    wrote = b""
    with contextlib.suppress(Refused):  # its findings are not the certificate's: that is said
        _, _, wrote = pipeline.write_program(proven.plan, proven.target, proven.options, trial)
    findings: list[Diagnostic] = []
    if same:
        derived = [*trial.findings, *pipeline.new_in_reading(trial.findings, read), *judged]
        findings += differences(certificate, now, derived)
    if wrote and wrote != proven.data:
        findings += _left(certificate, now, proven, wrote)
    return findings


def _left(
    certificate: Mapping[str, Any], now: Mapping[str, Any], proven: Proven, wrote: bytes
) -> list[Diagnostic]:
    """Return the finding that names where a program is not the one that its plan compiles to.

    Only this version can tell what it compiles: that another one wrote other blocks is a note.
    """
    from wedmcam.judge.difference import difference

    target, program = proven.target, proven.program
    compiled, _ = target.read(wrote, "program", target.entries(proven.plan))
    stepping = target.machine.stepping
    apart = difference(compiled, program, stepping, stepping, 0.0)
    other_version = certificate["version"] != now["version"]
    make = note if other_version else warning
    left = make(
        "certificate-differs",
        "the program is not the one that this drawing and these options compile to: ",
        hint="the certificate is of another version"
        if other_version
        else "the program was changed: compile again",
    )
    if apart.equal:
        return [left.extended("other bytes and the same path")]
    left = left.extended(
        "another path, first in block {block}"
        if apart.block_b
        else "another path, first in its end",
        block=apart.block_b,
    )
    if apart.distance_um < np.inf:
        left = left.extended(" by {apart_mm:.4f} mm", apart_mm=apart.distance_um / 1000.0)
    if apart.what != "apart":
        left = left.extended(": {difference}", difference=apart.what)
    return [left]


def check_certificate_alone(
    certificate: Mapping[str, Any], figures: Mapping[str, Any], data: bytes
) -> list[Diagnostic]:
    """Return the findings on what a certificate claims of a program without its drawing."""
    from wedmcam.judge.claims import of_the_program

    if not is_of(certificate, "output", data):
        return issued_for_others(certificate, data, b"")
    return of_the_program(certificate, figures)
