"""All that a run of a command keeps of its settings, and where: beside the context of click.

click hands a command its arguments and nothing else, and callbacks of options nothing but the
context; so what else they need is kept in ``Context.meta``, which a run has one of.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from wedmcam.cli.settings.read import File, Setting

#: The key of `Context.meta`.
META = "wedmcam.settings"


@dataclass(slots=True)
class InForce:
    """What the files say for one input.

    Attributes:
        files: that were read, nearest first.
        settings: key -> the setting in force.
        aside: settings that do not count, and why.
        params: what the command gets: options, settings, defaults.
    """

    files: tuple[File, ...] = ()
    settings: dict[str, Setting] = field(default_factory=dict)
    aside: list[tuple[Setting, str]] = field(default_factory=list)
    params: dict[str, Any] = field(default_factory=dict)


@dataclass(slots=True)
class State:
    """What a run keeps of its settings.

    Attributes:
        off: ``--no-config`` is given.
        given: parameters as click collected them, before settings; None until a command starts.
        files: place -> the settings file that is there.
        in_force: what the command runs with.
    """

    off: bool = False
    given: dict[str, Any] | None = None
    files: dict[Path, File] = field(default_factory=dict)
    in_force: InForce = field(default_factory=InForce)


def state_of(ctx: click.Context) -> State:
    """Return the state of a run."""
    state: State = ctx.meta.setdefault(META, State())
    return state
