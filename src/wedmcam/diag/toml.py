"""TOML text as data, or the finding that says where it is none.

Profiles, and settings of a shop, are files of anybody: also one that nests ten thousand lists, or
has a number of as many digits, is answered with its place.
"""

from __future__ import annotations

import re
import tomllib
from typing import Any

from wedmcam.diag.finding import Diagnostic, error
from wedmcam.diag.span import TextSpan

#: More characters than this are no settings.
MOST_TEXT = 1_000_000


def read_toml(text: str, name: str, code: str) -> tuple[dict[str, Any], Diagnostic | None]:
    """Return the data of a TOML text, or nothing and a finding with ``code`` and its place."""
    if len(text) > MOST_TEXT:
        span = TextSpan(name, 1, 1)
        return {}, error(
            code, "more than {most:,} characters are no settings", span, most=MOST_TEXT
        )
    try:
        return tomllib.loads(text), None
    except RecursionError:
        return {}, error(code, "lists or tables are nested too deep", TextSpan(name, 1, 1))
    except ValueError as wrong:
        at = re.search(r"at line (\d+), column (\d+)", str(wrong))
        last = text.count("\n") + 1
        span = TextSpan(name, int(at[1]), int(at[2])) if at else TextSpan(name, last, 1)
        reason = re.sub(r"\s*\(at .*\)$", "", str(wrong))
        return {}, error(code, "not TOML: {reason}", span, reason=reason)
