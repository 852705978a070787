"""The judge: it decodes what was written, runs it, and compares it with the plan and the part.

It shares no geometry with what made the program. Names are fetched when they are first used, so
that importing this costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wedmcam.verify.certificate import certificate
    from wedmcam.verify.fit import fit
    from wedmcam.verify.judge import Limits, judge
    from wedmcam.verify.textbook import recomputed_ends
    from wedmcam.verify.verdict import BlockTable, CutVerdict, Verdict
    from wedmcam.verify.walk import same_steps
    from wedmcam.verify.witness import swept_gouge

_HOME = {
    "BlockTable": "verdict",
    "CutVerdict": "verdict",
    "Limits": "judge",
    "Verdict": "verdict",
    "certificate": "certificate",
    "fit": "fit",
    "judge": "judge",
    "recomputed_ends": "textbook",
    "same_steps": "walk",
    "swept_gouge": "witness",
}

__all__ = [
    "BlockTable",
    "CutVerdict",
    "Limits",
    "Verdict",
    "certificate",
    "fit",
    "judge",
    "recomputed_ends",
    "same_steps",
    "swept_gouge",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    value = getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
