"""Run commands of wedmcam in processes of their own without importing everything each time.

A test of the command line needs a process: standard streams, a working folder, an exit status. To
start one takes longer than most commands do, because of what they import. So one process imports it
all, and each command is a fork of it, which is set up as a new process would be.

Run as a program it is that process: a line of JSON for each command on standard input, its wait
status on standard output.
"""

import atexit
import json
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

#: What commands import when they need it.
IMPORTED = """
    click ezdxf lark mpmath numpy rich.console rich.progress shapely
    wedmcam.api wedmcam.backends.dxf wedmcam.cli.main wedmcam.cli.options wedmcam.compiler.pipeline
    wedmcam.compiler.proof wedmcam.frontends.dxf wedmcam.frontends.iso wedmcam.frontends.wed
    wedmcam.judge.verdict wedmcam.operations.compile wedmcam.operations.verify
    wedmcam.transforms.lower
""".split()
#: Where these are given a process is started anew: Python reads them when it starts.
AT_START = ("PYTHON", "LC_", "LANG")


def wedmcam(*arguments, cwd=None, stdin=None, env=None):
    """Run a command; return a `subprocess.CompletedProcess` with bytes."""
    line = [str(one) for one in arguments]
    if not hasattr(os, "fork") or any(name.startswith(AT_START) for name in env or {}):
        command = [sys.executable, "-m", "wedmcam", *line]
        every = {**os.environ, **(env or {})}
        return subprocess.run(
            command, cwd=cwd, input=stdin, capture_output=True, env=every, check=False
        )
    with tempfile.TemporaryDirectory() as folder:
        streams = [Path(folder) / name for name in ("in", "out", "err")]
        if stdin is not None:
            streams[0].write_bytes(stdin)
        order = {
            "line": line,
            "cwd": os.fspath(cwd or os.getcwd()),
            "env": {**os.environ, **(env or {})},
            # As it is for subprocess: what no one gives comes from where the tests have theirs.
            "streams": [
                str(streams[0]) if stdin is not None else os.devnull,
                *map(str, streams[1:]),
            ],
        }
        server = _server(os.getpid())
        server.stdin.write(json.dumps(order).encode() + b"\n")
        server.stdin.flush()
        status = os.waitstatus_to_exitcode(int(server.stdout.readline()))
        out, err = (stream.read_bytes() for stream in streams[1:])
    return subprocess.CompletedProcess(["wedmcam", *line], status, out, err)


@cache
def _server(_pid):
    """Return the process that forks; one for each process of the tests."""
    server = subprocess.Popen(
        [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    atexit.register(server.stdin.close)
    return server


def serve():
    """Fork for each line of standard input, and answer with the status of each."""
    from importlib import import_module

    for name in IMPORTED:
        import_module(name)
    orders, answers = os.dup(0), os.dup(1)
    for line in os.fdopen(orders, "rb", 0):
        child = os.fork()
        if child == 0:
            _become(**json.loads(line))
        _, status = os.waitpid(child, 0)
        os.write(answers, b"%d\n" % status)


def _become(line, cwd, env, streams):
    """Be the process of a command, in a child; does not come back."""
    from wedmcam.__main__ import main

    status = 70
    try:
        for number, name in enumerate(streams):
            flags = os.O_RDONLY if number == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC
            os.dup2(os.open(name, flags), number)
        os.closerange(3, 64)
        os.chdir(cwd)
        os.environ.clear()
        os.environ.update(env)
        sys.stdin, sys.stdout, sys.stderr = (
            open(number, mode, encoding="utf-8", errors=errors, closefd=False)  # noqa: SIM115
            for number, mode, errors in (
                (0, "r", "surrogateescape"),
                (1, "w", "strict"),
                (2, "w", "backslashreplace"),
            )
        )
        sys.argv = ["wedmcam", *line]
        main()
        status = 0
    except SystemExit as why:
        status = why.code if isinstance(why.code, int) else 0 if why.code is None else 1
    finally:
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except (OSError, ValueError):
                status = status or 1
        os._exit(status)


if __name__ == "__main__":
    serve()
