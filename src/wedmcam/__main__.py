"""Start of the program: ``wedmcam`` and ``python -m wedmcam``."""

from __future__ import annotations

import gc
import io
import os
import signal
import sys
from typing import Any

INTERNAL, INTERRUPTED = 70, 130


def main() -> None:
    """Run the command line; a closed pipe and Ctrl-C leave no traceback."""
    _give_streams()
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
        status, stopped = status if isinstance(status, int) else 0, False
    except BaseException as why:
        status, stopped = _status(why), True
    _leave(status, stopped)


def _give_streams() -> None:
    """Put something in the place of standard streams that are closed.

    Else the next file that is opened would be one of them. Reading and writing there fails as it
    should, except messages: who closed standard error wants none.
    """
    for number, (name, mode, way) in enumerate(
        (
            ("stdin", "r", os.O_WRONLY),
            ("stdout", "w", os.O_RDONLY),
            ("stderr", "w", os.O_WRONLY),
        )
    ):
        if getattr(sys, name) is None:
            os.open(os.devnull, way)  # takes the lowest number that is free
            setattr(sys, name, open(number, mode, encoding="utf-8"))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _status(why: BaseException) -> int:
    """Return the exit status of what ended the run, and print what it was."""
    if isinstance(why, BrokenPipeError):
        # The reader closed its end of the pipe: that is its right.
        return 141
    if isinstance(why, SystemExit):
        return why.code if isinstance(why.code, int) else 1
    try:
        if isinstance(why, KeyboardInterrupt):
            sys.stderr.write("interrupted\n")
            return INTERRUPTED
        return report_stop(why)
    except BrokenPipeError:
        return 141
    except OSError:  # there is no place for messages
        return 1


def _leave(status: int, stopped: bool) -> None:
    """End; what was stopped waits for no process of a batch that may be under way."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            # What it still holds has no place: Python must not try again when it ends.
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
            status = status or 1
    if stopped:
        os._exit(status)
    sys.exit(status)


def _ended(number: int, _: Any) -> None:
    sys.exit(128 + number)


def report_stop(why: BaseException) -> int:
    """Print what stopped the program, and return its exit status."""
    import click  # here, so that nothing of the start can fail outside of `main`

    from wedmcam.cli.terminal import print_error
    from wedmcam.diag.run import WrongUse

    if isinstance(why, click.exceptions.Exit):
        return why.exit_code
    if isinstance(why, click.Abort):
        sys.stderr.write("interrupted\n")
        return INTERRUPTED
    if isinstance(why, click.exceptions.NoArgsIsHelpError):
        why.show()
        return why.exit_code
    if isinstance(why, click.UsageError):
        path = why.ctx.command_path if why.ctx else "wedmcam"
        message = why.format_message().rstrip(".")
        print_error(message[:1].lower() + message[1:], f"{path} --help")
        return why.exit_code
    if isinstance(why, click.ClickException):
        why.show()
        return why.exit_code
    if isinstance(why, WrongUse):
        print_error(str(why))
        return 2
    if isinstance(why, OSError):
        print_error(f"{why.filename or 'standard output'}: {why.strerror or why}")
        return 1
    if isinstance(why, MemoryError):
        print_error("the memory of this machine does not hold what this input needs")
        return 1
    if os.environ.get("WEDMCAM_DEBUG"):
        raise why
    print_error(
        f"internal error: {type(why).__name__}: {why}\nthis is a bug of wedmcam: please report it "
        "with the input (WEDMCAM_DEBUG=1 shows where it happened)"
    )
    return INTERNAL


if __name__ == "__main__":
    main()
