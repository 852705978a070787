"""Forged files: one nibble of a program changed, or one block, and whether `verify` says so.

A forgery may pass without a word only where the path stays within 1 um of what was proven.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from wedmcam import api
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.targets import target_of

EDITS = (
    *("delete", "duplicate", "swap", "reverse", "other sense", "other sign of x"),
    *("other sign of y", "other quadrant", "other count direction", "J changed", "x changed"),
    *("y changed", "as a move", "pause inserted", "end inserted", "moved on"),
)


@dataclass(frozen=True, eq=False)
class Forged:
    """A forged file, and what was done to it."""

    what: str
    data: bytes


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of a forgery.

    Attributes:
        status: the exit status of ``verify``.
        said: findings that the honest program has not.
        same_path: the path is within 1 um of the honest one (``diff``).
    """

    forged: Forged
    status: int
    said: tuple[str, ...]
    same_path: bool

    @property
    def slipped(self) -> bool:
        """Whether another path passed without a word."""
        return self.status == 0 and not self.said and not self.same_path


def nibbles(data: bytes, seed: int) -> Iterator[Forged]:
    """Yield a file with one nibble changed, without end."""
    rng = np.random.default_rng(seed)
    while True:
        at, high = int(rng.integers(len(data))), bool(rng.integers(2))
        by = int(rng.integers(1, 16)) << (4 if high else 0)
        forged = bytearray(data)
        forged[at] ^= by
        yield Forged(f"byte {at}: {data[at]:#04x} to {forged[at]:#04x}", bytes(forged))


def digits(data: bytes, seed: int) -> Iterator[Forged]:
    """Yield a text with one digit changed, without end."""
    rng = np.random.default_rng(seed)
    places = [k for k, c in enumerate(data) if 48 <= c < 58]
    while True:
        at = places[int(rng.integers(len(places)))]
        forged = bytearray(data)
        forged[at] = 48 + (data[at] - 48 + int(rng.integers(1, 10))) % 10
        yield Forged(f"byte {at}: {chr(data[at])} to {chr(forged[at])}", bytes(forged))


def edits(made: Any, seed: int) -> Iterator[Forged]:
    """Yield the program of a compile with one block edited, without end."""
    rng = np.random.default_rng(seed)
    target, program = target_of(made.machine), made.program
    while True:
        what = EDITS[int(rng.integers(len(EDITS)))]
        row = int(rng.integers(len(program.blocks)))
        blocks = edited(program.blocks, row, what, rng)
        if blocks is None or (
            len(blocks) == len(program.blocks) and (blocks == program.blocks).all()
        ):
            continue
        other = Program(blocks, program.origin, step_um=program.step_um)
        data, _ = target.write(other, made.plan, made.entries)
        if data and data != made.data:
            yield Forged(f"block {row + 1}: {what}", data)


def edited(blocks: np.ndarray, row: int, what: str, rng: np.random.Generator) -> Any:
    """Return blocks with one edited; None where that cannot be done to it."""
    b = blocks.copy()
    one = b[row : row + 1]
    motion = int(one["kind"][0]) <= Kind.MOVE
    arc = int(one["kind"][0]) == Kind.ARC
    if what == "delete":
        return np.delete(b, row)
    if what == "duplicate":
        return np.insert(b, row, one)
    if what == "swap":
        if row + 1 == len(b):
            return None
        b[[row, row + 1]] = b[[row + 1, row]]
        return b
    if what == "moved on":
        return np.insert(np.delete(b, row), (row + 3) % len(b), one)
    if what in ("pause inserted", "end inserted"):
        new = np.zeros(1, b.dtype)
        new["kind"], new["source"] = (Kind.PAUSE if what[0] == "p" else Kind.STOP), -1
        return np.insert(b, row, new)
    if not motion:
        return None
    by = int(rng.choice([-1000, -100, -10, -2, -1, 1, 2, 10, 100, 1000]))
    if what == "reverse":
        one["x"], one["y"], one["turn"] = -one["x"], -one["y"], -one["turn"]
    elif what == "other sense" and arc:
        one["turn"] = -one["turn"]
    elif what == "other sign of x":
        one["x"] = -one["x"]
    elif what == "other sign of y":
        one["y"] = -one["y"]
    elif what == "other quadrant":
        one["x"], one["y"] = -one["y"], one["x"].copy()
    elif what == "other count direction" and int(one["axis"][0]) <= Axis.Y:
        one["axis"] = 1 - one["axis"]
    elif what == "J changed":
        one["count"] += by
    elif what == "x changed":
        one["x"] += by
    elif what == "y changed":
        one["y"] += by
    elif what == "as a move" and not arc:
        one["kind"] = Kind.MOVE if one["kind"] == Kind.LINE else Kind.LINE
    else:
        return None
    return b if one["count"][0] > 0 and (one["x"][0] or one["y"][0]) else None


class Trial:
    """One compiled program, and how `verify` is asked about forgeries of it.

    Args:
        source: the drawing or part program.
        certified: with its certificate, else only against the drawing.
        **options: of the compile.
    """

    def __init__(self, source: Any, certified: bool, **options: Any) -> None:
        self.source = source
        self.made = api.compile(source, output_name="a", **options)
        assert self.made.ok, self.made.findings
        self.certificate = self.made.summary if certified else None
        self.honest = {(d.code, d.message) for d in self._verified(self.made.data).findings}

    def _verified(self, data: bytes) -> api.Proof:
        return api.verify(
            data,
            against=self.source,
            against_name=self.made.summary["input"],
            profile=self.made.machine,
            name="a",
            certificate=self.certificate,
            options=self.made.options,
        )

    def outcome(self, forged: Forged) -> Outcome:
        """Return what becomes of a forgery."""
        proof = self._verified(forged.data)
        if proof.status:
            return Outcome(forged, proof.status, (), False)
        said = tuple(
            f"{d.severity}[{d.code}] {d.message}"
            for d in proof.findings
            if (d.code, d.message) not in self.honest
        )
        apart, _ = api.diff(
            self.made.data, forged.data, profiles=(self.made.machine, self.made.machine)
        )
        return Outcome(forged, 0, said, apart is not None and apart.equal)
