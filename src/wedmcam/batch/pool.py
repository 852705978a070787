"""The processes of a batch: outcomes come in the order of the items, whatever their number.

A process can die (the memory of the machine is over, somebody ends it), and then Python ends its
neighbours too. What they were at is done again, each item in a process alone: the one that dies
again is an internal error of its item, and no other item is lost. An interrupted batch waits for
nothing that is under way.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from typing import Any

from wedmcam.batch.items import Item
from wedmcam.batch.work import INTERNAL, Outcome, compile_item, failed
from wedmcam.files import remove_unfinished

Work = Callable[[Item], Outcome]
Numbered = tuple[int, Outcome]

#: So many items a process are handed out before the first of them is done.
AHEAD = 4


def compile_items(
    items: Sequence[Item], jobs: int = 0, work: Work = compile_item
) -> Generator[Outcome, None, None]:
    """Yield the outcomes in the order of the items.

    Args:
        items: what is to be done.
        jobs: processes; 0 for one a core, 1 for this one alone.
        work: what does one item; it and its outcomes can be pickled.
    """
    jobs = min(jobs or os.cpu_count() or 1, len(items))
    if jobs < 2:
        yield from map(work, items)
        return
    with closing(_as_completed(items, jobs, work)) as completed:
        yield from _in_order(completed)


def _in_order(completed: Iterable[Numbered]) -> Generator[Outcome, None, None]:
    waiting: dict[int, Outcome] = {}
    following = 0
    for number, outcome in completed:
        waiting[number] = outcome
        while following in waiting:
            yield waiting.pop(following)
            following += 1


def _as_completed(items: Sequence[Item], jobs: int, work: Work) -> Generator[Numbered, None, None]:
    """Yield outcomes with the numbers of their items, as they come."""
    upcoming = deque(range(len(items)))
    while upcoming:
        with _processes(jobs) as pool:
            lost = yield from _until_one_dies(pool, items, upcoming, jobs * AHEAD, work)
        for number in lost:
            yield number, _alone(items[number], work)


def _until_one_dies(
    pool: ProcessPoolExecutor, items: Sequence[Item], upcoming: deque[int], most: int, work: Work
) -> Generator[Numbered, None, list[int]]:
    """Yield outcomes until all are there, or a process died; return the items that were lost.

    Args:
        pool: the processes.
        items: all of the batch.
        upcoming: numbers of those that are to be done; what is handed out is taken away.
        most: so many are handed out at once.
        work: what does one item.
    """
    under_way: dict[Future[Outcome], int] = {}
    lost: list[int] = []
    while under_way or (upcoming and not lost):
        try:
            while upcoming and len(under_way) < most and not lost:
                under_way[pool.submit(work, items[upcoming[0]])] = upcoming[0]
                upcoming.popleft()
        except BrokenProcessPool:
            lost += [upcoming.popleft()]
        for future in wait(under_way, return_when=FIRST_COMPLETED).done:
            number = under_way.pop(future)
            try:
                yield number, future.result()
            except BrokenProcessPool:
                lost.append(number)
            except Exception as why:  # an outcome that cannot be pickled: a bug of ours
                yield number, _ended_outcome(items[number], why)
    return sorted(lost)


def _alone(item: Item, work: Work) -> Outcome:
    """Do an item in a process of its own."""
    with _processes(1) as pool:
        try:
            return pool.submit(work, item).result()
        except Exception as why:
            return _ended_outcome(item, why)


def _ended_outcome(item: Item, why: Exception) -> Outcome:
    return failed(item, INTERNAL, f"{item.source}: internal error: the process ended: {why}")


@contextmanager
def _processes(count: int) -> Generator[ProcessPoolExecutor, None, None]:
    """Give processes that are ended when the batch is interrupted."""
    pool = ProcessPoolExecutor(count, initializer=_begin)
    try:
        yield pool
    except BaseException:
        _abandon(pool)
        raise
    pool.shutdown()


def _abandon(pool: ProcessPoolExecutor) -> None:
    """End the processes of an interrupted batch, without waiting for what is under way."""
    workers = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for worker in workers:
        worker.terminate()
    for worker in workers:
        worker.join(10)
        worker.kill()


def _begin() -> None:
    """Leave Ctrl-C to the process that started this one; end when it says so, or is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    threading.Thread(target=_watch, daemon=True).start()


def _watch() -> None:
    """End with the process that started this one: killed, it has said nothing."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        _end(signal.SIGHUP, None)


def _end(number: int, _: Any) -> None:
    # No exception: the pool would take it for the outcome of an item, and go on.
    remove_unfinished()
    os._exit(128 + number)
