"""Start of the program: ``wedmcam`` and ``python -m wedmcam``."""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import sys
from typing import Any

INTERNAL, INTERRUPTED = 70, 130


def main() -> None:
    """Run the command line; a closed pipe and Ctrl-C leave no traceback."""
    # Ended from outside, half-written files are removed like after Ctrl-C.
    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), _ended)
    if sys.argv[1:2] in (["compile"], ["check"], ["verify"]):
        # One drawing, then the process ends: looking through a large one for cycles is a quarter
        # of the time and frees nothing that is needed.
        gc.disable()
    try:
        from wedmcam.cli.main import cli

        status = cli.main(prog_name="wedmcam", standalone_mode=False)
        sys.stdout.flush()
        status = status if isinstance(status, int) else 0
    except BrokenPipeError:
        # Nobody reads any more: that is their right. Python must not flush into it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 141
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        status = INTERRUPTED
    except SystemExit as why:
        status = why.code if isinstance(why.code, int) else 1
    except Exception as why:
        status = _said(why)
    _leave(status)


def _leave(status: int) -> None:
    """End; without waiting for the workers of a batch that was interrupted."""
    batch = sys.modules.get("wedmcam.cli.batch")
    if batch is not None and batch.ABANDONED:
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError):
                stream.flush()
        os._exit(status)
    sys.exit(status)


def _ended(number: int, _: Any) -> None:
    sys.exit(128 + number)


def _said(why: Exception) -> int:
    """Say what stopped the program, and return its exit status."""
    import click

    from wedmcam.options import WrongUse

    if isinstance(why, click.exceptions.Exit):
        return why.exit_code
    if isinstance(why, click.Abort):
        sys.stderr.write("interrupted\n")
        return INTERRUPTED
    if isinstance(why, click.exceptions.NoArgsIsHelpError):
        why.show()
        return why.exit_code
    if isinstance(why, click.UsageError):
        from wedmcam.cli.say import say_error

        path = why.ctx.command_path if why.ctx else "wedmcam"
        message = why.format_message().rstrip(".")
        say_error(message[:1].lower() + message[1:], f"{path} --help")
        return why.exit_code
    if isinstance(why, click.ClickException):
        why.show()
        return why.exit_code
    if isinstance(why, WrongUse):
        from wedmcam.cli.say import say_error

        say_error(str(why))
        return 2
    if isinstance(why, OSError):
        sys.stderr.write(f"error: {why.filename or 'output'}: {why.strerror or why}\n")
        return 1
    if os.environ.get("WEDMCAM_DEBUG"):
        raise why
    sys.stderr.write(
        f"internal error: {type(why).__name__}: {why}\n"
        "this is a bug of wedmcam: please report it with the input "
        "(WEDMCAM_DEBUG=1 shows where it happened)\n"
    )
    return INTERNAL


if __name__ == "__main__":
    main()
