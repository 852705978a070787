"""A decoded program as source text of the part language: what an old program cuts, to go on from.

Each stretch between two moves becomes a contour of the lines and arcs that the controller steps
(one that was there already, elsewhere, is moved there),
and a ``cut ... on`` with its thread point, the point where the lead arrives, stop and overcut. So
the text says what the wire does, not what the part was: the offset is in it. Every point is a
whole micron where the controller really stood, so that compiling the text can find the same blocks
again; whether it did is proven by who asked for it (``conversion``).
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Motion, Stepping
from wedmcam.diag import Diagnostic, Span, error, has_errors, visible, warning
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.programs.stretches import Stretch, beside, stretches, words_left_out

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
#: What to do with a program that the part language has no words for.
ANY_PATH = "convert to .dxf, which takes any path"
#: Arcs of more than this are written in parts: near a full turn their ends cannot be told apart.
MOST_SWEEP = np.radians(350.0)


def source(
    program: Program, machine: Machine, name: str, pieces: Ints | None = None
) -> tuple[bytes, list[Diagnostic]]:
    """Return a program in the part language, mm, from where the first block starts.

    Args:
        program: decoded.
        machine: the profile that it was read with: whose controller steps it.
        name: of the program, for the title.
        pieces: in how many parts the arc of each block is written at least; None for one.

    Returns:
        UTF-8 text, empty where there is an error; a warning for each pause and word that the part
        language has no place for.
    """
    blocks, stepping = program.blocks, machine.stepping
    motion = stepping.run(blocks)
    rows, findings = _rows(program, motion)
    if has_errors(findings) or not (blocks["kind"][rows] < Kind.MOVE).any():
        return b"", findings
    ends = np.column_stack([np.cumsum(motion.dx[rows]), np.cumsum(motion.dy[rows])])
    starts = ends - np.column_stack([motion.dx[rows], motion.dy[rows]])
    parts = np.ones(len(rows), np.int64) if pieces is None else pieces[rows]
    text = _Text(blocks[rows], starts, ends, motion.steps[rows], parts, stepping, program.step_um)
    title = visible(PurePath(name).name.replace('"', "'"))
    lines = [
        f"# What {title} cuts, as {machine.name} steps it; its first block starts at (0, 0).",
        "# The wire's centre runs on these contours: the offset is in them.",
        f'part "{title.split(".")[0] or title}"',
    ]
    cuts = []
    runs = stretches(text.blocks, starts, ends)
    for i in beside(text.blocks["kind"], runs):
        findings.append(
            warning(
                "not-carried",
                "a pause at {place} mm from the start has no place in the part language",
                _span(program, int(rows[i])),
                place=text.at(ends[i]),
            )
        )
    for k, one in enumerate(runs):
        contour, cut, lost = text.stretch(one, f"path{k + 1}")
        lines += contour if contour[0][:3] == lines[-1][:3] == "let" else ["", *contour]
        cuts.append(cut)
        for i in lost:
            findings.append(
                warning(
                    "not-carried",
                    "a pause at {place} mm from the start has no place in the part language: "
                    "'stop' is one pause on a closed contour",
                    _span(program, int(rows[i])),
                    place=text.at(ends[i]),
                )
            )
    last = _end_of_cutting(blocks)
    words = [i for i, _ in program.words if i < last]
    findings += words_left_out(program, words, "the part language")
    return ("\n".join([*lines, "", *cuts]) + "\n").encode("utf-8"), findings


def _end_of_cutting(blocks: NDArray[np.void]) -> int:
    """Return the row of the first stop or end; behind the last where there is none."""
    kinds = blocks["kind"]
    end = np.flatnonzero((kinds == Kind.STOP) | (kinds == Kind.END))
    return int(end[0]) if len(end) else len(blocks)


def _rows(program: Program, motion: Motion) -> tuple[Ints, list[Diagnostic]]:
    """Return the rows that are written: those with a step, and controls, up to the end of cutting.

    Findings are errors where a block never ends or none cuts, a warning where blocks follow.
    """
    kinds, last = program.blocks["kind"], _end_of_cutting(program.blocks)
    findings: list[Diagnostic] = []
    endless = np.flatnonzero(motion.steps < 0)[:1].tolist()
    for i in endless:
        findings.append(
            error(
                "endless-block",
                "block {block} never ends on its controller: there is no path to write down",
                _span(program, i),
                block=i + 1,
            )
        )
    late = np.flatnonzero((kinds <= Kind.MOVE) & (np.arange(len(kinds)) > last))
    if len(late):
        findings.append(
            warning(
                "not-carried",
                "{blocks} blocks behind the end of cutting are no part of the path; left out",
                _span(program, int(late[0])),
                blocks=len(late),
            )
        )
    taken = (np.arange(len(kinds)) < last) & ((kinds > Kind.MOVE) | (motion.steps > 0))
    rows = np.flatnonzero(taken)
    if not findings and not (kinds[rows] < Kind.MOVE).any():
        findings.append(error("no-blocks", "this program cuts nothing"))
    return rows, findings


def trim(program: Program) -> tuple[Program, list[Diagnostic]]:
    """Return a program from its first cut to its last, and what moves that leaves out."""
    kinds = program.blocks["kind"]
    cuts = np.flatnonzero(kinds < Kind.MOVE)
    moves = np.flatnonzero(kinds == Kind.MOVE)
    if not len(cuts):
        return program, []
    findings = []
    before, behind = moves[moves < cuts[0]], moves[moves > cuts[-1]]
    if len(before):
        findings.append(
            warning(
                "not-carried",
                "the program begins with a move; the part program starts where it ends: moves go "
                "from cut to cut in the part language",
                _span(program, int(before[0])),
            )
        )
    if len(behind):
        findings.append(
            warning(
                "not-carried",
                "the program ends with a move; the part program ends where it starts: moves go "
                "from cut to cut in the part language",
                _span(program, int(behind[0])),
            )
        )
    if not findings:
        return program, []
    first = int(cuts[0]) if len(before) else 0
    last = int(cuts[-1]) + 1 if len(behind) else len(kinds)
    keep = np.arange(len(kinds))
    keep = keep[(keep >= first) & ((keep < last) | (kinds >= Kind.STOP))]
    number = {int(old): new for new, old in enumerate(keep)}
    spans = [program.spans[i] for i in keep.tolist()] if len(program.spans) == len(kinds) else ()
    words = tuple((number[i], word) for i, word in program.words if i in number)
    return replace(program, blocks=program.blocks[keep], spans=spans, words=words), findings


def hindrance(program: Program, machine: Machine) -> Diagnostic | None:
    """Return an error on what of a program the part language has no words for; None for nothing."""
    blocks = program.blocks
    motion = machine.stepping.run(blocks)
    ends = np.column_stack([np.cumsum(motion.dx), np.cumsum(motion.dy)])
    starts = ends - np.column_stack([motion.dx, motion.dy])
    move = (blocks["kind"] == Kind.MOVE) & (motion.steps > 0)
    both = np.flatnonzero(move[:-1] & move[1:])
    way = ends - starts
    bend = way[both, 0] * way[both + 1, 1] - way[both, 1] * way[both + 1, 0]
    size = np.hypot(*way[both].T) + np.hypot(*way[both + 1].T)
    for i in both[np.abs(bend) > 2 * size].tolist():
        return error(
            "not-in-format",
            "blocks {first} and {second} move round a corner, and the part language moves "
            "straight from thread point to thread point",
            _span(program, i),
            hint=ANY_PATH,
            first=i + 1,
            second=i + 2,
        )
    for one in stretches(blocks, starts, ends):
        for path in (one.path, np.concatenate([one.lead_in, one.path, one.overcut, one.lead_out])):
            again = (ends[path[:-1]] == starts[path[0]]).all(axis=1)
            if again.any():
                i = int(path[int(np.argmax(again)) + 1])
                return error(
                    "not-in-format",
                    "block {block} goes on without a pause where its contour is closed already, "
                    "and a 'cut' runs round once",
                    _span(program, i),
                    hint=ANY_PATH,
                    block=i + 1,
                )
    return None


def _span(program: Program, i: int) -> Span | None:
    return program.spans[i] if i < len(program.spans) else None


def _mm(um: float) -> str:
    """Return a length in mm, no digits that say nothing.

    >>> _mm(-1500), _mm(0), _mm(1234.5678)
    ('-1.5', '0', '1.234568')
    """
    digits = f"{um / 1000:.6f}".rstrip("0").rstrip(".")
    return "0" if digits in ("-0", "") else digits


class _Text:
    """The blocks of a program, on their way to text."""

    def __init__(
        self,
        blocks: NDArray[np.void],
        starts: Ints,
        ends: Ints,
        steps: Ints,
        pieces: Ints,
        stepping: Stepping,
        step_um: float,
    ) -> None:
        self.blocks, self.starts, self.ends = blocks, starts, ends
        self.steps, self.pieces, self.stepping = steps, pieces, stepping
        self.step_um = step_um
        self.arc = blocks["kind"] == Kind.ARC
        offset = np.column_stack([blocks["x"], blocks["y"]]).astype(np.int64)
        self.centre = np.where(self.arc[:, None], starts - offset, 0)
        self.radius = np.hypot(blocks["x"], blocks["y"])
        self.sweep, self.length = self._sizes()
        #: What draws each contour from its own start -> its name and where it starts.
        self.seen: dict[tuple[str, ...], tuple[str, Ints]] = {}

    def _mm(self, steps: float) -> str:
        return _mm(steps * self.step_um)

    def at(self, p: Ints | tuple[int, int]) -> str:
        """Return a place, mm."""
        return f"({self._mm(int(p[0]))}, {self._mm(int(p[1]))})"

    def _sizes(self) -> tuple[Floats, Floats]:
        """Return the sweep of each arc, rad, and the length of each block, steps."""
        turn = self.blocks["turn"].astype(np.int64)
        a, b = self.starts - self.centre, self.ends - self.centre
        first, last = np.arctan2(a[:, 1], a[:, 0]), np.arctan2(b[:, 1], b[:, 0])
        sweep = np.mod((last - first) * turn, math.tau)
        # A turn takes 8 R steps: that tells an arc that just passes its start from a short one.
        whole = self.steps / np.maximum(8.0 * self.radius, 1.0) * math.tau
        sweep = np.where(self.arc, sweep + math.tau * np.round((whole - sweep) / math.tau), 0.0)
        straight = np.hypot(*(self.ends - self.starts).T)
        return sweep, np.where(self.arc, self.radius * sweep, straight)

    def stretch(self, one: Stretch, name: str) -> tuple[list[str], str, list[int]]:
        """Return a contour, the statement that cuts it, and the blocks whose pauses are lost."""
        path, over = one.path, one.overcut
        led = len(one.lead_in) > 0 and one.closed
        if not led:  # no lead that can be told from the path: all of it is path
            path = np.concatenate([one.lead_in, path, over, one.lead_out])
            over = path[:0]
        closed = bool((self.ends[path[-1]] == self.starts[path[0]]).all())
        home = self.starts[path[0]]
        thread = self.starts[one.lead_in[0]] if led else home
        same = tuple(self._commands(path, closed, home))
        if same in self.seen:
            other, there = self.seen[same]
            lines = [f"let {name} = {other} | translate {self.at(home - there)}"]
        else:
            self.seen[same] = name, home
            lines = [f"contour {name} {{", *self._commands(path, closed, 0 * home), "}"]
        cut = f"cut {name} on start {self.at(thread)}"
        if led or (closed and len(path) == 1):
            cut += f" enter {self.at(home)}"
        stop, lost = self._stop(one, path, closed)
        # What a shop has as defaults is not what this program does: all of it is said.
        cut += stop or (" stop 0" if closed else "")
        if closed and not len(over):
            cut += " overcut 0"
        cut += " corner 0"
        if len(over):
            cut += f" overcut {self._mm(float(self.length[over[: len(over) // 2]].sum()))}"
        return lines, cut, lost

    def _commands(self, path: Ints, closed: bool, origin: Ints) -> list[str]:
        """Return what draws a path, from ``origin``."""
        if closed and len(path) == 1:
            i = path[0]
            sense = "" if self.blocks["turn"][i] > 0 else "cw "
            at, radius = self.at(self.centre[i] - origin), self._mm(float(self.radius[i]))
            return [f"  circle {sense}center {at} radius {radius}"]
        lines = [f"  from {self.at(self.starts[path[0]] - origin)}"]
        for i in path.tolist():
            lines += self._block(i, origin)
        if closed:
            # 'close' is a line back, and nothing after an arc that ends there.
            lines = lines if self.arc[path[-1]] else lines[:-1]
            lines.append("  close")
        return lines

    def _stop(self, one: Stretch, path: Ints, closed: bool) -> tuple[str, list[int]]:
        """Return the clause of the last pause on the path; the others are lost."""
        lost = []
        clause = ""
        for i in one.pauses[::-1]:
            if not clause and closed and i in path[:-1]:
                rest = path[np.flatnonzero(path == i)[0] + 1 :]
                clause = f" stop {self._mm(float(self.length[rest].sum()))}"
            else:
                lost.append(i)
        return clause, lost[::-1]

    def _block(self, i: int, origin: Ints) -> list[str]:
        """Return the commands of a block, from ``origin``."""
        if not self.arc[i]:
            return [f"  line to {self.at(self.ends[i] - origin)}"]
        turn, sweep = int(self.blocks["turn"][i]), float(self.sweep[i])
        word, centre = ("ccw" if turn > 0 else "cw"), self.centre[i]
        least = 1 if sweep <= MOST_SWEEP else int(np.ceil(sweep / np.pi))
        pieces = max(least, int(self.pieces[i]))
        # Where the machine stands on its way: whole microns, as near to the circle as it gets.
        part = np.repeat(self.blocks[i : i + 1], pieces - 1)
        dx, dy = self.stepping.position(part, self.steps[i] * np.arange(1, pieces) // pieces)
        stops = [*(self.starts[i] + np.column_stack([dx, dy])), self.ends[i]]
        middle = self.at(centre - origin)
        return [f"  arc {word} to {self.at(p - origin)} center {middle}" for p in stops]
