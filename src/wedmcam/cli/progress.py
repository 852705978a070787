"""A bar on a terminal for anything over a second; nothing into a pipe.

The library that draws it is fetched when the second is over: most runs never need it. What is
printed meanwhile must not mix with the bar: `Bar.clear` takes it away, and it comes back by itself.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

#: Nothing is shown for this long, seconds.
PATIENCE = 1.0


class Bar:
    """How much of something is done; ``total`` None where it is unknown.

    It is the owner's to call `clear` before anything is printed and at the end.
    """

    def __init__(self, what: str, total: int | None = None) -> None:
        self._what, self._total, self._done = what, total, 0
        self._due = time.monotonic() + PATIENCE
        self._live: Any = None
        self._task: Any = None
        self._start = time.monotonic()

    def step(self) -> None:
        """Count one more, and show it if it is time."""
        self._done += 1
        self.show()

    def show(self) -> None:
        """Show how far it is, on a terminal, when the second is over."""
        if time.monotonic() < self._due or not sys.stderr.isatty():
            return
        if self._live is None:
            self._live = self._draw_bar()
            self._live.start()
        self._live.update(self._task, completed=self._done)

    def clear(self) -> None:
        """Take the bar away."""
        if self._live is not None:
            self._live.stop()
            self._live = None

    def _draw_bar(self) -> Any:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
        )

        from wedmcam.diag import visible

        columns: list[Any] = [TextColumn("{task.description}", markup=False), BarColumn()]
        if self._total is not None:
            columns.append(MofNCompleteColumn())
        live = Progress(
            *columns,
            TimeElapsedColumn(),
            console=Console(stderr=True),
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._task = live.add_task(visible(self._what), total=self._total)
        # The time since the work began, not since it was shown.
        live.tasks[0].start_time = live.get_time() - (time.monotonic() - self._start)
        return live


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Show a spinner; do not print while it runs."""
    if not sys.stderr.isatty():
        yield
        return
    bar = Bar(what)
    over = threading.Event()

    def watch() -> None:
        if not over.wait(PATIENCE):
            bar.show()

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        over.set()
        try:
            watcher.join()
        finally:
            bar.clear()
