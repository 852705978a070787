"""Compare two programs of any formats as step paths."""

from __future__ import annotations

from typing import Any

from wedmcam.diag import Diagnostic
from wedmcam.files import Source
from wedmcam.frontends.answers import ANSWERS, check_answers
from wedmcam.judge.difference import Difference, difference
from wedmcam.machines import Machine
from wedmcam.operations.read import read_program
from wedmcam.targets import Entries


def diff(
    a: Source,
    b: Source,
    *,
    within_mm: float = 0.001,
    names: tuple[str | None, str | None] = (None, None),
    profiles: tuple[Machine | str | None, Machine | str | None] = (None, None),
    d: tuple[tuple[int, float], ...] = (),
    **answers: str | None,
) -> tuple[Difference | None, tuple[Diagnostic, ...]]:
    """Compare two programs of any formats as step paths; see ``judge.difference``.

    Args:
        a: a path or bytes.
        b: likewise.
        within_mm: as far apart is equal.
        names: of both in findings.
        profiles: of both.
        d: numbers and offsets (um) of ISO programs with G41 or G42.
        **answers: of ISO programs, as for `read_program`; ``whole_in_b`` and others are of the
            second where it is read otherwise.

    Returns:
        The difference; None where one cannot be read. And the findings of both readers.
    """
    first: dict[str, Any] = {name: v for name, v in answers.items() if not name.endswith("_b")}
    other = {n: v for n in ANSWERS if (v := answers.get(f"{n}_b")) is not None}
    check_answers({name.removesuffix("_b"): v for name, v in answers.items()})
    read = [
        read_program(source, profile=profile, name=name, entered=Entries(d=d), **of)
        for source, name, profile, of in zip(
            (a, b), names, profiles, (first, {**first, **other}), strict=True
        )
    ]
    findings = tuple(d for _, _, some in read for d in some)
    (one, machine_a, _), (two, machine_b, _) = read
    if one is None or two is None:
        return None, findings
    steppings = machine_a.stepping, machine_b.stepping
    return difference(one, two, *steppings, 1000.0 * within_mm), findings


def difference_data(d: Difference, a: str = "a", b: str = "b") -> dict[str, Any]:
    """Return a difference as plain data."""
    apart = d.distance_um if d.distance_um < float("inf") else None
    return {
        "a": a,
        "b": b,
        "equal": d.equal,
        "largest_um": round(d.largest_um, 3) if d.largest_um < float("inf") else None,
        "block_a": d.block_a or None,
        "block_b": d.block_b or None,
        "at_um": None if d.equal else list(d.at),
        "distance_um": None if d.equal or apart is None else round(apart, 3),
        "what": d.what,
    }
