"""What `--dump-after` and `-v` show of the stages of a compile: what each gave, and how long."""

from __future__ import annotations

import time
from typing import Any

from wedmcam.cli.terminal import print_text
from wedmcam.machines import Machine
from wedmcam.reports.stages import STAGES, stage_text


class Observer:
    """Keeps what was asked for of each stage, and the time since the one before."""

    def __init__(self, stages: tuple[str, ...]) -> None:
        self._shown = [(name, STAGES[name]) for name in dict.fromkeys(stages)]
        self._values: dict[str, Any] = {}
        self._seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def __call__(self, stage: str, value: Any) -> None:
        """Take a stage over; of one that runs several times the last value, and all its time."""
        now = time.perf_counter()
        self._seconds[stage] = self._seconds.get(stage, 0.0) + now - self._last
        self._last = now
        if any(stage == source for _, source in self._shown):
            self._values[stage] = value

    def print_stages(self, machine: Machine) -> None:
        """Print the stages that were asked for, as far as the compile came."""
        for name, source in self._shown:
            if source in self._values:
                print_text(stage_text(name, self._values[source], machine.stepping), nl=False)
            else:
                print_text(f"{name}: the compile did not come so far", err=True)

    def print_times(self) -> None:
        """Print how long each stage took."""
        parts = ", ".join(f"{stage} {1000 * s:.0f}" for stage, s in self._seconds.items())
        print_text(f"stages     {parts} ms", err=True)
