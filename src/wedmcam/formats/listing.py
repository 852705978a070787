"""Many equal findings, told with measure: the first ones by place, the rest as a number."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Severity, Span

#: How many findings of one code are listed by place when they are errors; others are counted.
ERRORS = 20

#: What the fields of a template say of one thing, by its index.
Values = Callable[[int], Mapping[str, object]]


def listed(
    severity: Severity,
    code: str,
    where: NDArray[np.intp] | list[int],
    span: Callable[[int], Span | None],
    template: str,
    values: Values | None = None,
    hint: str | None = None,
) -> Iterator[tuple[int, Diagnostic]]:
    """Yield (index, finding) for the places ``where``.

    Errors are listed one by one up to `ERRORS`, notes and warnings only by their first place; the
    last finding counts those that are not listed.

    Args:
        severity, code: of the findings.
        where: indices of the things that they are about.
        span: where a thing stands.
        template, hint: as of `Diagnostic`, with a field for each value.
        values: of a thing, by its index; None where the templates have no field.
    """
    limit = ERRORS if severity is Severity.ERROR else 1
    total = len(where)
    for rank, index in enumerate(map(int, where[:limit]), 1):
        count = total - limit + 1 if rank == limit and total > limit else 1
        yield (
            index,
            Diagnostic(
                severity,
                code,
                template,
                span(index),
                hint_template=hint,
                count=count,
                values=values(index) if values is not None else {},
            ),
        )


def in_order(findings: Iterable[tuple[int, Diagnostic]]) -> list[Diagnostic]:
    """Return findings by their place in the file; equal places keep their order."""
    return [diagnostic for _, diagnostic in sorted(findings, key=lambda pair: pair[0])]
