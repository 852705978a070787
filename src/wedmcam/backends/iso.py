"""Write ISO G-code in the layout of a profile: where each block ends, and the centres of arcs.

The end of a block is where the controller's interpolator stops, so that a reader that steps to the
stated end makes the same steps. What ISO cannot state (more than a turn in one record, a bare word
that is no M word) is refused. Numbers are whole um until they are text: there is no -0.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, ends, over_memory, travel
from wedmcam.controllers import Motion
from wedmcam.diag import Diagnostic, Severity, warning
from wedmcam.formats import b3, iso
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.ir.programmed import Programmed
from wedmcam.machines import Iso, Machine, around

#: How F is said.
_FEED = "--feed, a length a minute; or feed_um in a profile of your own"


def encode(
    program: Program,
    machine: Machine,
    positions: NDArray[np.int64] | None = None,
    feed_um: float | None = None,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the ISO file of a program, and what was found.

    Args:
        program: blocks as lowering or a decoder made them. `Kind.THREAD` becomes a pause.
        machine: an ISO profile.
        positions: where the machine stands after each block, drawing um, shape (blocks, 2). Left
            out, the controller is run.
        feed_um: cutting speed, um a minute, for a profile that writes F; None for the profile's.

    Returns:
        The bytes, empty when there is an error. A stop is added where there is none.
    """
    checks = Checks(program)
    kinds = program.blocks["kind"].copy()
    motion = machine.own_stepping.run(program.blocks)
    _refuse_unstated(checks, machine, motion)
    kinds[_too_small(checks, machine, motion)] = Kind.LINE
    names = dict(program.words)
    _refuse_words(checks, names)
    kinds[kinds == Kind.THREAD] = Kind.PAUSE
    checks.tell(
        Severity.ERROR,
        "lone-line",
        b3.moves(kinds) & (kinds == Kind.LINE),
        "block {block}: a single line between two pauses would be read as a move",
        hint="write the line as two blocks",
    )
    if not checks.failed:
        checks.findings += travel(program, machine)
    checks.findings += over_memory(len(program.blocks), machine)
    if checks.failed:
        return b"", checks.findings
    if positions is None:
        positions = ends(program, machine)
    opening, opening_findings = _opening(machine, program.origin, feed_um)
    rows = [*opening, *_rows(program, kinds, motion, positions, machine.iso, names)]
    data, more = _text(rows, machine)
    return data, [*checks.findings, *opening_findings, *more]


def _refuse_unstated(checks: Checks, machine: Machine, motion: Motion) -> None:
    """Report blocks that ISO cannot state: without an end or a step, or over a full circle."""
    blocks = checks.program.blocks
    arc = blocks["kind"] == Kind.ARC
    x, y = blocks["x"], blocks["y"]
    end = machine.own_stepping.arc_end(
        x, y, np.where(arc, blocks["turn"], 1), x + motion.dx, y + motion.dy
    )
    moving = blocks["kind"] <= Kind.MOVE
    checks.tell(Severity.ERROR, "endless-block", motion.steps < 0, "block {block}: it never ends")
    checks.tell(
        Severity.ERROR,
        "zero-count",
        moving & (motion.steps == 0),
        "block {block}: it has no step",
    )
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        arc & (end.steps != motion.steps),
        "block {block}: more than a full circle; an ISO record states only where it ends",
        hint="write it as several blocks",
    )


def _too_small(checks: Checks, machine: Machine, motion: Motion) -> NDArray[np.bool_]:
    """Return the arcs that are lines to a controller with a least radius; report full circles."""
    blocks, least = checks.program.blocks, machine.iso.arc_least_um
    x, y = blocks["x"], blocks["y"]
    radius = np.minimum(np.hypot(x, y), np.hypot(x + motion.dx, y + motion.dy))
    small: NDArray[np.bool_] = (blocks["kind"] == Kind.ARC) & (radius < least)
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        small & (motion.dx == 0) & (motion.dy == 0),
        "block {block}: a full circle whose radius is below {least_um} um: {machine} takes none",
        lambda i: {"least_um": least, "machine": machine.name},
    )
    return small


def _refuse_words(checks: Checks, names: dict[int, str]) -> None:
    """Report control words that a reader of ISO would not take for one."""
    mask = checks.program.blocks["kind"] == Kind.WORD
    for i in np.flatnonzero(mask).tolist():
        mask[i] = not iso.is_word(names[i])
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        mask,
        "block {block}: '{word}' is no M word: it would not be read as a control word",
        lambda i: {"word": names[i]},
    )


def _opening(
    machine: Machine, origin: tuple[float, float], feed_um: float | None
) -> tuple[list[str], list[Diagnostic]]:
    """Return the first lines of a program: modes, F, and where it starts; and what F was assumed.

    Args:
        machine: an ISO profile. Where a pulse is no um, F counts pulses as places do.
        origin: where the program starts, as `Program` has it.
        feed_um: as for `encode`.

    >>> from wedmcam.machines import builtin
    >>> _opening(builtin("linuxcnc"), (5000, 0), 2000.0)[0]
    ['G21 G17 G40 G80 G61 G91.1 G94', 'G90', 'F2.0', 'G00 X5.000 Y0.000']
    """
    how = machine.iso
    per = _per_um(how)
    words = [
        k + _number(how, int(np.floor(v * per + 0.5))) for k, v in zip("XY", origin, strict=True)
    ]
    rows = ["G91" if how.coordinates == "incremental" else "G90"]
    findings = []
    if how.feed_um:
        mm = (feed_um or how.feed_um) / 1000
        rows.append("F" + re.sub(r"(\.\d+?)0+$", r"\1", f"{mm / machine.axes.step_um:.8f}"))
        if feed_um is None:
            findings.append(
                warning(
                    "feed-assumed",
                    "{word} is written, {feed_mm:g} mm a minute: the profile's, no --feed was "
                    "given",
                    hint=_FEED,
                    word=rows[-1],
                    feed_mm=mm,
                )
            )
        least = how.feed_least_um * machine.axes.step_um
        if mm * 1000 < least:
            findings.append(
                warning(
                    "feed-raised",
                    "{word}: {machine} cuts no slower than {least_mm:g} mm a minute, and does so",
                    hint="--feed {least_mm:g}mm or more",
                    word=rows[-1],
                    machine=machine.name,
                    least_mm=least / 1000,
                )
            )
    modes = [how.between.join(how.modes.split())] if how.modes else []
    if how.start == "move":
        start = how.between.join([f"G{0:0{how.code_digits}d}", *words])
        return [*modes, *rows, start], findings
    return [*modes, how.between.join(["G92", *words]), *rows], findings


def _text(rows: list[str], machine: Machine) -> tuple[bytes, list[Diagnostic]]:
    """Return the file of some lines, and a warning where one is too long."""
    layout, how = machine.layout, machine.iso
    if layout.number_width:
        sep = how.between
        rows = [f"N{n:0{layout.number_width}d}{sep}{row}" for n, row in enumerate(rows, 1)]
    text = "".join(row + layout.eol for row in rows)
    frame = ["".join(line + layout.eol for line in part) for part in (layout.header, layout.footer)]
    data = frame[0].encode(layout.encoding) + text.encode("ascii")
    findings = _long_lines([*layout.header, *rows, *layout.footer], machine)
    header = [*layout.header, how.modes]
    for code, effect in around.modes(header, bool(how.feed_um), how.semicolon):
        findings.append(
            warning(
                "header-mode",
                "{word} in the header: {effect}",
                hint="G61 and G94 behind it, or without it",
                word=code,
                effect=effect,
            )
        )
    if idle := around.behind_end(layout.footer, how.semicolon):
        findings.append(
            warning(
                "after-end",
                "{words} of the footer: behind the end (M02), not run",
                hint="leave it out of 'footer', or put it into 'header'",
                count=len(idle),
                words=", ".join(dict.fromkeys(idle)),
            )
        )
    return data + frame[1].encode(layout.encoding), findings


def _long_lines(lines: list[str], machine: Machine) -> list[Diagnostic]:
    """Return a warning of the lines that are longer than the controller takes."""
    most = machine.limits.line_chars
    if not most:
        return []
    over = {
        n: size
        for n, line in enumerate(lines, 1)
        if len(line) > most and (size := len(around.code_of(line, machine.iso.semicolon))) > most
    }
    if not over:
        return []
    first = min(over)
    return [
        warning(
            "over-line",
            "line {line} has {characters} characters, {machine} takes {most} ({count} lines)"
            if len(over) > 1
            else "line {line} has {characters} characters, {machine} takes {most}",
            hint="'header' and 'footer' of the profile may be several lines",
            count=len(over),
            line=first,
            characters=over[first],
            machine=machine.name,
            most=most,
        )
    ]


def encode_outlines(
    written: Programmed,
    ends: NDArray[np.float64],
    machine: Machine,
    feed_um: float | None = None,
) -> tuple[bytes, list[Diagnostic]]:
    """Return the ISO file of outlines that the controller offsets.

    Args:
        written: in the controller's frame; what is not in compensation is a plain block.
        ends: where each block ends as it is programmed, um, shape (blocks, 2).
        machine: an ISO profile.
        feed_um: as for `encode`.

    Returns:
        The bytes. G41 or G42 with its D stands with the lead-in, G40 with the lead-out; behind an
        open outline G40 stands alone.
    """
    how, motions = machine.iso, written.motions
    sep, digits = how.between, how.code_digits
    codes = {n: f"G{n:0{digits}d}" for n in (0, 1, 2, 3)}
    incremental = how.coordinates == "incremental"
    per = _per_um(how)
    at = np.floor(ends * per + 0.5).astype(np.int64)
    here = np.floor(np.array(written.program.origin) * per + 0.5).astype(np.int64)
    opening, findings = _opening(machine, written.program.origin, feed_um)
    rows: list[str] = []
    blocks = written.program.blocks
    runs = np.append(motions["run"], -1)
    # Behind an outline without a way out G40 stands alone.
    open_end = (runs[:-1] != runs[1:]) & (motions["role"] != Role.LEAD_OUT)
    for i, mark in enumerate(written.mark.tolist()):
        kind, turn = int(blocks["kind"][i]), int(blocks["turn"][i])
        if kind > Kind.MOVE:
            rows.append(f"M{0 if kind == Kind.PAUSE else 2:0{digits}d}")
            continue
        if mark >= 0:
            turn = int(motions["turn"][mark])
            centre = np.array([motions["cx"][mark], motions["cy"][mark]])
            centre = np.floor(centre * per + 0.5).astype(np.int64) - here
        else:
            centre = -np.array([blocks["x"][i], blocks["y"][i]]) * round(per)
        to = at[i]
        words = [codes[2 + (turn > 0) if turn else 0 if kind == Kind.MOVE and how.rapid else 1]]
        if mark >= 0 and motions["role"][mark] == Role.LEAD_IN:
            side = 41 if motions["shift"][mark] > 0 else 42
            number = f"{how.offset_letter}{int(motions['d'][mark])}"
            words = [f"G{side}", number, *words]
        elif mark >= 0 and motions["role"][mark] == Role.LEAD_OUT:
            words = ["G40", *words]
        ends_at = (to - here if incremental else to).tolist()
        words += [f"{k}{_number(how, v)}" for k, v in zip("XY", ends_at, strict=True)]
        if turn:
            from_here = _centre(how, here.tolist(), centre.tolist())
            words += [f"{k}{_number(how, v)}" for k, v in zip("IJ", from_here, strict=True)]
        rows.append(sep.join(words))
        if mark >= 0 and open_end[mark]:
            rows.append("G40")
        here = to
    most = machine.limits.blocks
    if most and len(rows) > most:
        findings.append(
            warning(
                "over-memory",
                "{records} records; {machine} holds {most}",
                hint="compile --split cuts it at thread points, a longer contour in the kerf",
                records=len(rows),
                machine=machine.name,
                most=most,
            )
        )
    data, more = _text([*opening, *rows], machine)
    return data, [*findings, *more]


def _per_um(how: Iso) -> float:
    """Return how many units of the last digit a um has."""
    return 1.0 if how.unit == "um" else 10.0 ** (how.decimals - 3)


def _number(how: Iso, value: int) -> str:
    """Return a length as the profile writes it, from units of its last digit.

    >>> _number(Iso(unit="mm", sign="always"), -1500), _number(Iso(width=6), 12)
    ('-1.500', '000012')
    """
    sign = "-" if value < 0 else "+" if how.sign == "always" else ""
    size = abs(value)
    if how.unit == "um":
        return f"{sign}{size:0{max(how.width, 1)}d}"
    n = how.decimals
    return f"{sign}{f'{size // 10**n}.{size % 10**n:0{n}d}':0>{max(how.width, 1)}}"


def _centre(how: Iso, start: list[int], centre: list[int]) -> list[int]:
    """Return I and J as a profile has them, of a centre relative to the start of its arc.

    >>> _centre(Iso(ij="absolute", coordinates="absolute"), [5, 0], [-5, 1])
    [0, 1]
    """
    if how.ij == "to-start":
        return [-c for c in centre]
    if how.ij == "absolute" and how.coordinates == "absolute":
        return [s + c for s, c in zip(start, centre, strict=True)]
    return centre


def _arc(
    how: Iso, start: list[int], end: list[int], centre: list[int], halves: bool
) -> list[list[str]]:
    """Return the coordinates of an arc, or of both halves of a full circle.

    Args:
        how: the dialect.
        start: in absolute coordinates.
        end: as it is written, of the whole arc.
        centre: relative to the start.
        halves: it is a full circle that is written in two.

    >>> _arc(Iso(), [0, 0], [0, 0], [-9, 4], True)
    [['X-18', 'Y8', 'I-9', 'J4'], ['X18', 'Y-8', 'I9', 'J-4']]
    """
    if not halves:
        arcs = [(end, _centre(how, start, centre))]
    else:
        there = [2 * c for c in centre]
        back = [-v for v in there] if how.coordinates == "incremental" else end
        if how.coordinates == "absolute":
            there = [e + v for e, v in zip(end, there, strict=True)]
        arcs = [
            (there, _centre(how, start, centre)),
            (back, _centre(how, there, [-c for c in centre])),
        ]
    return [
        [f"{k}{_number(how, v)}" for k, v in zip("XYIJ", [*to, *c], strict=True)] for to, c in arcs
    ]


def _rows(
    program: Program,
    kinds: NDArray[np.uint8],
    motion: Motion,
    positions: NDArray[np.int64],
    how: Iso,
    names: dict[int, str],
) -> list[str]:
    """Return the lines of a program behind its opening, without numbers and line ends."""
    blocks = program.blocks
    sep = how.between
    digits = how.code_digits
    codes = {n: f"G{n:0{digits}d}" for n in (0, 1, 2, 3)}
    pause, stop = f"M{0:0{digits}d}", f"M{2:0{digits}d}"
    incremental = how.coordinates == "incremental"
    per = round(_per_um(how))
    px, py = (motion.dx, motion.dy) if incremental else (positions[:, 0], positions[:, 1])
    px, py = px * per, py * per
    rows: list[str] = []
    columns = zip(
        kinds.tolist(),
        blocks["turn"].tolist(),
        px.tolist(),
        py.tolist(),
        (-blocks["x"] * per).tolist(),
        (-blocks["y"] * per).tolist(),
        strict=True,
    )
    whole = (motion.dx == 0) & (motion.dy == 0) & (how.full_circle == "halves")
    ended = False
    here = [int(np.floor(v * per + 0.5)) for v in program.origin]
    for i, (kind, turn, x, y, cx, cy) in enumerate(columns):
        if kind == Kind.ARC:
            code = codes[3 if turn > 0 else 2]
            rows += [sep.join([code, *w]) for w in _arc(how, here, [x, y], [cx, cy], whole[i])]
        elif kind <= Kind.MOVE:
            code = codes[0 if kind == Kind.MOVE and how.rapid else 1]
            rows.append(sep.join([code, f"X{_number(how, x)}", f"Y{_number(how, y)}"]))
        if kind <= Kind.MOVE:
            here = [x, y]
        elif kind == Kind.PAUSE:
            rows.append(pause)
        elif kind == Kind.WORD:
            rows.append(names[i])
        elif not ended:
            rows.append(stop)
            ended = True
    if not ended:
        rows.append(stop)
    return rows
