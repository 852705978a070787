"""In which order contours are cut.

A contour is cut before the one around it: once the outer contour is through, the piece with the
hole in it is loose. Within that rule: as they lie, as they were drawn, or the nearest next.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wedmcam.ir.plan import Order


def order(
    parents: Sequence[int],
    threads: Sequence[tuple[int, int]],
    drawn: Sequence[int],
    how: Order,
) -> list[int]:
    """Return the numbers of the contours in cutting order.

    Args:
        parents: for each contour the one directly around it, -1 for none.
        threads: thread points, whole um.
        drawn: the place of each contour in the drawing.
        how: see `Order`. NEAREST starts at the contour nearest to the origin.

    >>> order([-1, 0, 0], [(0, 0), (50, 0), (5, 0)], [0, 1, 2], Order.INNER_FIRST)
    [1, 2, 0]
    >>> order([-1, 0, 0], [(0, 0), (50, 0), (5, 0)], [0, 1, 2], Order.NEAREST)
    [2, 1, 0]
    """
    count = len(parents)
    if how is Order.GIVEN:
        return sorted(range(count), key=lambda k: (drawn[k], k))
    waiting = [0] * count
    for parent in parents:
        if parent >= 0:
            waiting[parent] += 1
    if how is Order.INNER_FIRST:
        return _inner_first(parents)
    points = np.array(threads, float).reshape(count, 2)
    done = np.zeros(count, bool)
    ready = np.array([w == 0 for w in waiting])
    here = np.zeros(2)
    result: list[int] = []
    while len(result) < count:
        distance = np.hypot(*(points - here).T)
        distance[done | ~ready] = np.inf
        k = int(np.argmin(distance))
        done[k] = True
        result.append(k)
        here = points[k]
        parent = parents[k]
        if parent >= 0:
            waiting[parent] -= 1
            ready[parent] = waiting[parent] == 0
    return result


def _inner_first(parents: Sequence[int]) -> list[int]:
    """Return each tree of contours from its leaves up, siblings as numbered."""
    children: dict[int, list[int]] = {}
    for k, parent in enumerate(parents):
        children.setdefault(parent, []).append(k)
    result: list[int] = []
    stack = [(k, False) for k in reversed(children.get(-1, []))]
    while stack:
        k, opened = stack.pop()
        if opened or k not in children:
            result.append(k)
        else:
            stack.append((k, True))
            stack += [(c, False) for c in reversed(children[k])]
    return result


def parents_of(contour: Sequence[int], parents: Sequence[int]) -> list[int]:
    """Return for each path the first path of the contour around its own, -1 for none."""
    first: dict[int, int] = {}
    for k, c in enumerate(contour):
        first.setdefault(c, k)
    result = []
    for c in contour:
        parent = parents[c]
        while parent >= 0 and parent not in first:
            parent = parents[parent]
        result.append(first.get(parent, -1))
    return result
