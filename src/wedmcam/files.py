"""Opening and writing: the only room of the library that touches files.

A source is read whole, here and nowhere deeper. Outputs appear whole or not at all: written beside
their place, then renamed; all outputs of a run are renamed only when all were written.
"""

from __future__ import annotations

import os
import secrets
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

Source = str | Path | bytes

#: No drawing and no program is larger; a device may have no end.
MOST_BYTES = 256 * 10**6

#: Files that are being written beside their places. Of the process, and no value that is passed:
#: a signal ends a worker of a batch between any two instructions, and its handler must know them.
UNFINISHED: set[str] = set()


class FileError(Exception):
    """A file cannot be read or written; the message names it and says why."""


def bytes_of(source: Source, name: str | None) -> tuple[bytes, str]:
    """Return a source and its name: the path by default."""
    if isinstance(source, bytes):
        return source, name or "input"
    return Path(source).read_bytes(), name or str(source)


def read_file(name: str) -> bytes:
    """Return the bytes of a file, or of standard input for ``-``.

    Raises:
        FileError: it cannot be read, or does not end.
    """
    try:
        if name == "-":
            data = sys.stdin.buffer.read(MOST_BYTES + 1)
        else:
            with open(name, "rb") as file:
                data = file.read(MOST_BYTES + 1)
    except OSError as why:
        raise FileError(f"{name}: cannot be read: {why.strerror or why}") from why
    if len(data) > MOST_BYTES:
        most = f"{MOST_BYTES // 10**6} MB"
        raise FileError(f"{name}: is larger than {most}, or a device without an end")
    return data


def remove_unfinished() -> None:
    """Remove what was being written: a run was interrupted, or a file could not be replaced."""
    while UNFINISHED:
        with suppress(OSError):
            os.unlink(UNFINISHED.pop())


def write_files(outputs: Sequence[tuple[str, bytes | Iterable[bytes]]]) -> None:
    """Write all files beside their places, then rename them; ``-`` is standard output.

    An output may come in pieces: there may be more of it than memory.

    Raises:
        FileError: nothing was replaced.
    """
    beside: list[tuple[str, str, str]] = []
    name = ""
    try:
        for name, data in outputs:
            if name == "-" or _is_device(name):
                continue
            place = Path(os.path.realpath(name))
            draft = str(place.parent / f".{place.name[:50]}.{secrets.token_hex(4)}")
            beside.append((draft, str(place), name))
            UNFINISHED.add(draft)
            with open(draft, "xb") as file:
                file.writelines(_pieces(data))
            os.chmod(draft, _mode(place))
        for draft, place_name, name in beside:  # noqa: B007 - named where it fails
            os.replace(draft, place_name)
    except OSError as why:
        raise FileError(f"{name}: cannot be written: {why.strerror}") from why
    finally:
        remove_unfinished()
    for name, data in outputs:
        try:
            if name == "-":
                sys.stdout.buffer.writelines(_pieces(data))
                sys.stdout.buffer.flush()
            elif _is_device(name):
                with open(name, "wb") as device:
                    device.writelines(_pieces(data))
        except BrokenPipeError:
            raise
        except OSError as why:
            raise FileError(f"{name}: cannot be written: {why.strerror}") from why


def _pieces(data: bytes | Iterable[bytes]) -> Iterable[bytes]:
    return [data] if isinstance(data, bytes) else data


def _is_device(name: str) -> bool:
    """Return whether an output is there and no regular file: it is written to, never replaced."""
    return Path(name).exists() and not Path(name).is_file()


def _mode(place: Path) -> int:
    """Return the permissions of the file that is replaced, or what a new file would get."""
    with suppress(OSError):
        return place.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
