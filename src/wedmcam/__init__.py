"""wedmcam: from a drawing to a proven wire-EDM program.

The library is what the command line calls: `compile`, `compile_all`, `verify`, `inspect`, `plot`,
`simulate_program`. Names are fetched when they are first used: importing this costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wedmcam.api import (
        Compilation,
        Inspection,
        Proof,
        Simulation,
        arithmetic_difference,
        compile,
        compile_all,
        inspect,
        plot,
        read_program,
        simulate_program,
        verify,
    )
    from wedmcam.options import Options, WrongUse

__version__ = "0.1.0"

__all__ = [
    "Compilation",
    "Inspection",
    "Options",
    "Proof",
    "Simulation",
    "WrongUse",
    "arithmetic_difference",
    "compile",
    "compile_all",
    "inspect",
    "plot",
    "read_program",
    "simulate_program",
    "verify",
]

_API = {name for name in __all__ if name not in ("Options", "WrongUse")}


def __getattr__(name: str) -> Any:
    import importlib

    if name in _API:
        return getattr(importlib.import_module("wedmcam.api"), name)
    if name in ("Options", "WrongUse"):
        return getattr(importlib.import_module("wedmcam.options"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
