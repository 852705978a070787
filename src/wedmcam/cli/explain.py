"""``wedmcam explain``: what a code means, with an example that was run."""

from __future__ import annotations

import json
import textwrap
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

WIDTH = 96


@cache
def examples() -> dict[str, dict[str, str]]:
    """Return code -> its example: ``run`` and ``said``, or ``cannot``; made by ``make docs``."""
    text = files("wedmcam.diag").joinpath("examples.json").read_text("utf-8")
    made: dict[str, dict[str, str]] = json.loads(text)
    return made


def explained(code: str) -> str | None:
    """Return what a code means; None where there is none of this name."""
    from wedmcam.diag import CODES

    if code not in CODES:
        return None
    entry = CODES[code]
    parts = [code, *(_part(n, getattr(entry, n)) for n in ("what", "why", "cure"))]
    example: dict[str, Any] = examples().get(code, {})
    if "run" in example:
        shown = textwrap.indent(f"$ {example['run']}\n{example['said']}", "    ")
        parts.append(f"  for example\n{shown}")
    return "\n".join(parts)


def _part(name: str, text: str) -> str:
    head = f"  {name:6} "
    return textwrap.fill(text, WIDTH, initial_indent=head, subsequent_indent=" " * len(head))


def listed() -> str:
    """Return all codes with what they mean in a line each."""
    from wedmcam.diag import CODES

    width = max(map(len, CODES))
    return "\n".join(f"{code:{width}}  {CODES[code].what}" for code in sorted(CODES))


def unknown(name: str) -> str:
    """Return what to say of a name that is no code."""
    import difflib

    from wedmcam.diag import CODES

    if Path(name).is_file():
        return f"{name} is a file: to explain a block of a program give --block N"
    near = difflib.get_close_matches(name.lower(), CODES, 3, 0.6)
    hint = f"did you mean {', '.join(near)}?" if near else "wedmcam explain --list tells all"
    return f"there is no diagnostic '{name}'; {hint}"
