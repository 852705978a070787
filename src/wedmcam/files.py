"""Where a source comes from: bytes, or a path that is read here and nowhere deeper."""

from __future__ import annotations

from pathlib import Path

Source = str | Path | bytes


def bytes_of(source: Source, name: str | None) -> tuple[bytes, str]:
    """Return a source and its name: the path by default."""
    if isinstance(source, bytes):
        return source, name or "input"
    return Path(source).read_bytes(), name or str(source)
