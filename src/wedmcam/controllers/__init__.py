"""The semantics of the targets: what controllers do with the blocks that they are given.

``stepping`` says what an interpolator is; ``pointwise`` is the family that compares point by point
(逐点比较法); ``zd065`` is that machine's own data processing. Who has a machine takes
``machine.stepping`` and passes it on.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from wedmcam.controllers.stepping import ArcEnd, Motion, Step, Stepping

#: Format of programs -> "module:class" of the interpolator that runs them, made of the name of how
#: lines are stepped; named and not imported, so that starting costs nothing.
STEPPINGS: dict[str, str] = dict.fromkeys(
    ("3b", "4b", "iso", "compact", "rotation", "compensation", "nby15"),
    "wedmcam.controllers.pointwise:of_table",
) | {"dem15": "wedmcam.controllers.eindhoven.vectors:of_table"}


def stepping_of(format_: str, table: str) -> Stepping:
    """Return the interpolator of the controllers that read a format.

    Args:
        format_: of their programs.
        table: how they step lines: a value of `pointwise.LineTable`, or what its module knows.

    Raises:
        KeyError: no controller reads this format.
    """
    module, _, name = STEPPINGS[format_].partition(":")
    make: Callable[[str], Stepping] = getattr(import_module(module), name)
    return make(table)


__all__ = ["STEPPINGS", "ArcEnd", "Motion", "Step", "Stepping", "stepping_of"]
