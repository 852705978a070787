"""The compiler on one screen: every stage in its order, and where it stops.

A stage takes values and returns a value and findings. After a stage that found an error nothing
more runs, and nothing is written: `Refused`. Nothing here opens a file or prints.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeVar

from wedmcam.arithmetic import FLOAT64, Arithmetic
from wedmcam.diag import Diagnostic, Severity, has_errors, note, option_texts
from wedmcam.ir.contour import Contour
from wedmcam.ir.plan import Cut, Plan, Side
from wedmcam.ir.program import Axis, LineTable, Program
from wedmcam.ir.sketch import Sketch, ThreadPoint
from wedmcam.machines import Machine
from wedmcam.options import Options, WrongUse

if TYPE_CHECKING:
    from wedmcam.judge.verdict import Verdict
    from wedmcam.transforms.chain import ChainReport
    from wedmcam.transforms.items import Worked
    from wedmcam.transforms.nest import Nesting

T = TypeVar("T")


class Refused(Exception):  # noqa: N818 - a kind of stop, not of error
    """The input cannot be compiled; ``Run.found`` says why. ``stage`` names where it stopped."""

    def __init__(self, stage: str) -> None:
        super().__init__(stage)
        self.stage = stage


@dataclass
class Run:
    """Collects what the stages find, and stops after the first one that found an error.

    Attributes:
        strict: warnings are errors.
        found: all findings, in the order in which they were made.
    """

    strict: bool = False
    found: list[Diagnostic] = field(default_factory=list)

    def __call__(self, stage: str, result: tuple[T | None, Iterable[Diagnostic]]) -> T:
        """Take a stage's findings over and return its value."""
        value, found = result
        self.add(stage, found)
        assert value is not None, f"{stage} returned nothing and said nothing"
        return value

    def add(self, stage: str, found: Iterable[Diagnostic]) -> None:
        """Take findings over; refuse if there is an error among them."""
        new = [self._judged(d) for d in found]
        self.found += new
        if has_errors(new):
            raise Refused(stage)

    def _judged(self, d: Diagnostic) -> Diagnostic:
        if self.strict and d.severity is Severity.WARNING:
            return replace(d, severity=Severity.ERROR)
        return d


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """What was drawn: loose segments, and the contours they make.

    ``items``: the cuts of a part program with their figures; None for a drawing.
    """

    sketch: Sketch
    contours: tuple[Contour, ...]
    report: ChainReport
    nesting: Nesting
    items: tuple[Worked, ...] | None = None


def read(data: bytes, file: str, options: Options, run: Run) -> Drawn:
    """Return the contours of a drawing, or of a part program."""
    if source_format(data, file, options) == "wed":
        return _read_part(data, file, options, run)
    if options.defines:
        raise WrongUse("-D sets a let of a .wed program; this is a drawing")
    from wedmcam.frontends.dxf import DxfOptions
    from wedmcam.frontends.dxf import read as read_dxf
    from wedmcam.transforms.chain import chain
    from wedmcam.transforms.nest import nest

    asked = DxfOptions(
        units=options.units,
        fill_in_units=options.fill_in_units,
        layers=options.layers,
        ignore_layers=options.ignore_layers,
        tolerance_um=options.tolerance_um,
    )
    sketch = run("read", read_dxf(data, file, asked))
    contours, report, found = chain(sketch, options.join_um)
    run.add("chain", found)
    if options.transforms:
        sketch, contours = _transformed(sketch, contours, options, run)
    return Drawn(sketch, contours, report, nest(contours))


def source_format(data: bytes, file: str, options: Options) -> str:
    """Return the format of a source: as asked for, else by its name, else by its content."""
    if options.source is not None:
        return options.source
    name = file.lower()
    if name.endswith((".wed", ".dxf")):
        return name[-3:]
    from wedmcam.frontends.identify import is_part

    return "wed" if is_part(data) else "dxf"


def _read_part(data: bytes, file: str, options: Options, run: Run) -> Drawn:
    """Return the figures that a part program cuts, each with what is asked of it."""
    from wedmcam.frontends.wed import read as read_wed
    from wedmcam.transforms import items
    from wedmcam.transforms.chain import ChainReport
    from wedmcam.transforms.nest import nest

    part = run(
        "read",
        read_wed(data, file, arithmetic=options.arithmetic, defines=options.defines),
    )
    run.add("read", items.idle_options(part, options))
    more = _transforms(options, run)
    worked = run("transform", items.worked(part, more, arithmetic(options)))
    sketch, contours = items.sketch_of(part, worked)
    closed = sum(c.closed for c in contours)
    report = ChainReport(closed, len(contours) - closed)
    return Drawn(sketch, contours, report, nest(contours), worked)


def _transforms(options: Options, run: Run) -> list[Any]:
    """Return what ``--transform`` says, parsed."""
    if not options.transforms:
        return []
    from wedmcam.frontends.wed import parse_transform

    texts = option_texts("--transform", options.transforms)
    parsed = [parse_transform(text, name) for name, text in texts.items()]
    run.add("transform", [d for _, found in parsed for d in found])
    return [t for t, _ in parsed if t is not None]


def _transformed(
    sketch: Sketch, contours: tuple[Contour, ...], options: Options, run: Run
) -> tuple[Sketch, tuple[Contour, ...]]:
    """Return contours and thread points after ``--transform``; --start points stay (ruling 5)."""
    from wedmcam.transforms import figures
    from wedmcam.transforms.meetings import contour_meetings

    whole = figures.Sequence(tuple(_transforms(options, run)))
    made = run(
        "transform", figures.transformed(contours, whole, arithmetic(options), sketch.thread_points)
    )
    run.add("transform", figures.idle_reverse(contours, whole))
    contours = figures.counter_clockwise(made[0])
    run.add("transform", contour_meetings(contours))
    return replace(sketch, thread_points=made[1]), contours


def arithmetic(options: Options) -> Arithmetic:
    """Return the arithmetic in which formulas run."""
    if options.arithmetic == FLOAT64.name:
        return FLOAT64
    from wedmcam.decimal8 import DECIMAL8

    return DECIMAL8


def plan(drawn: Drawn, options: Options, run: Run) -> Plan:
    """Return where the wire goes: sides, compensation, leads, order."""
    if drawn.items is not None:
        from wedmcam.transforms import items

        return run("plan", items.plan(drawn.items, options, arithmetic(options)))
    from wedmcam.transforms import planning, walls
    from wedmcam.transforms.merge import merge_arcs

    side = options.effective_side
    contours = [merge_arcs(c) for c in drawn.contours]
    run.add("open", planning.unfit(contours, options, side))
    run.add("walls", walls.thin(contours, walls.kept_sides(drawn.nesting.depths, side)))
    if options.corner_um:
        from wedmcam.transforms.corners import round_corners

        contours = run("corners", round_corners(contours, options.corner_um, arithmetic(options)))
    lanes = run(
        "compensate", planning.lanes(contours, drawn.nesting, options, side, arithmetic(options))
    )
    threads = list(drawn.sketch.thread_points)
    threads += [ThreadPoint(x, y) for x, y in options.starts_um]
    cuts = run("leads", planning.cuts(lanes, threads, drawn.nesting, options))
    return Plan(tuple(cuts), tuple(contours), drawn.nesting.depths, side, options.offset_um or 0.0)


def part_of(made: Plan, machine: Machine, options: Options, run: Run) -> Plan:
    """Return the part of a plan that was asked for: some cuts, the rest from a block on, or all.

    Raises:
        WrongUse: there is no such cut or block, or nothing is left to cut behind it.
    """
    from wedmcam import offsets
    from wedmcam.transforms.rest import some

    made = run("leads", offsets.started(made, machine))
    if options.cuts is not None:
        if options.cuts[1] > len(made.cuts):
            raise WrongUse(
                f"the program has {len(made.cuts)} contours, there is no --cuts "
                f"{options.cuts[0]}-{options.cuts[1]}"
            )
        made = some(made, *options.cuts)
    return _rest(made, machine, options, run) if options.from_block else made


def _rest(made: Plan, machine: Machine, options: Options, run: Run) -> Plan:
    """Return what is left of a plan from a block of its program on."""
    import numpy as np

    from wedmcam import offsets
    from wedmcam.controller import run as stepped
    from wedmcam.ir.program import Kind, Role
    from wedmcam.source_map import block_ends, matched
    from wedmcam.transforms.rest import rest

    trial = Run()  # what is to be said of the whole program is not said of its rest
    try:
        lowered = lower(made, machine, options, trial)
        data = encode(lowered, machine, trial, made, options)
        entered = offsets.entered(made, machine, options)
        program, _ = decode(data, machine, "program", entered, made)
    except Refused:
        run.found += trial.found
        raise
    program = replace(program, origin=lowered.origin)
    n = options.from_block
    if n > len(program.blocks):
        raise WrongUse(f"the program has {len(program.blocks)} blocks, there is no block {n}")
    like = matched(lowered, program, machine)
    cutting = np.flatnonzero((program.blocks["kind"] < Kind.MOVE) & (like >= 0))
    cutting = cutting[cutting >= n - 1]
    roles, cuts = lowered.blocks["role"], lowered.blocks["cut"]
    left = cutting[(roles[like[cutting]] == Role.CONTOUR) | (roles[like[cutting]] == Role.LEAD_IN)]
    if not len(left):
        raise WrongUse(f"from block {n} on nothing is left to cut")
    block = int(left[0])
    cut = int(cuts[like[block]])
    starts, _ = block_ends(program, machine)
    at = (round(starts[block][0]), round(starts[block][1]))
    if roles[like[block]] == Role.LEAD_IN or cut != int(cuts[like[cutting[0]]]):
        # Nothing of this contour was cut.
        if options.backwards:
            raise WrongUse(f"block {n} begins a contour: leave --backwards out")
        return replace(made, cuts=made.cuts[cut - 1 :], partial=True)
    if machine.offsets:
        first = cut + (options.cuts[0] - 1 if options.cuts else 0)
        last = first - cut + len(made.cuts)
        raise WrongUse(
            f"block {n} lies within contour {first}: G41 and G42 are taken up on a lead, and there "
            f"is none in the kerf. --cuts {first}-{last} cuts that contour as a whole; its rest "
            "needs a profile without compensation (iso-um), where blocks have other numbers"
        )
    before = (lowered.blocks["cut"] == cut) & (roles == Role.CONTOUR)
    before[int(like[block]) :] = False
    motion = stepped(lowered.blocks, LineTable(machine.table))
    # Chords: good enough to tell two passes apart.
    share = np.hypot(motion.dx, motion.dy) * lowered.step_um
    arc = lowered.blocks["kind"] == Kind.ARC
    share[arc] = motion.steps[arc] * (np.pi / 4) * lowered.step_um  # a turn takes 8 R steps
    along = float(share[before].sum())
    found = rest(made, cut - 1, at, along, options.backwards, lowered.step_um)
    if found is None:
        raise WrongUse(f"block {n} of the program lies on no contour")
    return found


def lower(made: Plan, machine: Machine, options: Options, run: Run) -> Program:
    """Return the program in integers, format-neutral."""
    from wedmcam.transforms.lower import Target
    from wedmcam.transforms.lower import lower as lower_plan

    if machine.format != "3b" and count_of(machine, options) == "textbook":
        raise WrongUse(
            "--count textbook is for 3B: the ZD-065 counts on the inscribed square, by stepping"
        )
    target = Target(
        square=machine.binary,
        square_axis=square_axis(machine),
        table=LineTable(machine.table),
        count_um=machine.limits.count_um,
        line_um=machine.limits.line_um,
        arc_um=machine.limits.arc_um,
        textbook=count_of(machine, options) == "textbook",
        step_um=machine.axes.step_um,
    )
    return run("lower", lower_plan(made, target))


def square_axis(machine: Machine) -> Axis:
    """Return how the inscribed square of the ZD-065 counts at a tie, seen from the drawing."""
    return Axis.SQUARE_X if machine.axes.exchange else Axis.SQUARE


def encode(program: Program, machine: Machine, run: Run, made: Plan, options: Options) -> bytes:
    """Return the bytes of a program.

    A format that is no cutting program (rotation, compensation) is written so that the controller's
    own data processing makes this program of it.
    """
    from wedmcam.backends import encoder

    more = processing(machine, options, made)
    if machine.gapped:
        from wedmcam.transforms import zd065

        run.add("encode", zd065.corners(made, "3b" if machine.format == "4b" else "compact"))
        more["grown"] = zd065.grown(made, program)
    if machine.offsets:
        from wedmcam import offsets

        return run("encode", offsets.encode(made, program, machine, options))
    data: bytes = run("encode", encoder(machine.format)(program, machine, **more))
    return data


def processing(machine: Machine, options: Options, made: Plan | None = None) -> dict[str, Any]:
    """Return what the operator enters beside a file: the gap and its side for compensation.

    Args:
        machine: whose controller asks for it.
        options: say it, where there is no plan.
        made: of which the program is, or is to be.

    Raises:
        WrongUse: no whole um, or cuts of a part program with different offsets.
    """
    if not machine.gapped:
        return {}
    gap, side = options.offset_um or 0.0, options.effective_side
    if made is not None:
        from wedmcam.transforms import zd065

        gaps = zd065.gaps(made)
        if len(gaps) > 1:
            several = ", ".join(f"{um / 1000:.4g} mm at {place}" for um, place in gaps)
            raise WrongUse(
                f"{machine.format} has one gap for all cuts, and they have different offsets: "
                f"{several}"
            )
        gap, side = gaps[0][0] if gaps else 0.0, made.side
    if abs(gap - round(gap)) > 1e-6:
        raise WrongUse(f"the gap of {machine.format} is whole um, not {gap:g}")
    return {"gap_um": round(gap), "outwards": side is not Side.DIE}


def decode(
    data: bytes, machine: Machine, file: str, options: Options, made: Plan | None = None
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that a file means to its controller.

    ``made``: the plan that it is of, where there is one.
    """
    from wedmcam import offsets
    from wedmcam.frontends import decoder

    if machine.format == "iso":
        return offsets.decode(data, machine, file, offsets.table_of(options.d, options.offset_um))

    program: tuple[Program, list[Diagnostic]] = decoder(machine.format)(
        data, machine, file, **processing(machine, options, made)
    )
    return program


def prove(
    data: bytes,
    file: str,
    made: Plan,
    machine: Machine,
    options: Options,
    run: Run,
    *,
    origin: tuple[int, int],
    strict_order: bool = True,
) -> tuple[Program, Verdict]:
    """Decode the bytes that are to be written, run them, and compare with the plan and the part."""
    from dataclasses import replace as changed

    from wedmcam import offsets
    from wedmcam.judge.judge import judge

    decoded, found = decode(data, machine, file, offsets.entered(made, machine, options), made)
    # Notes of the reader say how it understood a foreign file; and what the writer warned of (the
    # file needs two loads, say) need not be said twice.
    said = {d.code for d in run.found}
    new = [
        d
        for d in found
        if d.severity is Severity.ERROR or (d.severity > Severity.NOTE and d.code not in said)
    ]
    run.add("decode", new)
    decoded = changed(decoded, origin=origin)
    verdict, found = judge(
        decoded,
        made,
        table=LineTable(machine.table),
        limits=machine.limits,
        count="textbook" if count_of(machine, options) == "textbook" else "exact",
        strict_order=strict_order,
        trimmed=options.trim,
    )
    if machine.offsets and has_errors(found):
        found = [
            *found,
            note(
                "not-reachable",
                "the outline and the path of the controller are both rounded to its grid: some "
                "places come out farther from the path than is allowed",
                hint="a profile with more digits (iso-g41-mm), or one that does not leave the "
                "offset to the controller",
            ),
        ]
    if machine.gapped and has_errors(found):
        found = [
            *found,
            note(
                "not-reachable",
                "the controller scales and rounds the arcs of this format: some gaps come out "
                "farther from the path than is allowed",
                hint="another gap by some um, or --to "
                + ("3b" if machine.format == "4b" else "compact"),
            ),
        ]
    run.add("verify", found)
    return decoded, verdict


def count_of(machine: Machine, options: Options) -> str:
    """Return the counting in force: asked for, or the profile's."""
    return options.count or machine.count


__all__ = [
    "Cut",
    "Drawn",
    "Refused",
    "Run",
    "Side",
    "count_of",
    "decode",
    "encode",
    "lower",
    "plan",
    "prove",
    "read",
]
