"""What starts fast: help and settings ask for the options of commands, and load nothing else."""

import json
import os
import subprocess
import sys

import pytest

from wedmcam.cli.main import COMMANDS

#: Rooms that read, compile, write or judge, and the library of their arrays.
HEAVY = {"numpy", "wedmcam.compiler", "wedmcam.machines", "wedmcam.operations", "wedmcam.judge"}
LOADED = """
import json, sys
from wedmcam.cli.main import cli
{use}
print(json.dumps(sorted(sys.modules)))
"""


def modules_after(use):
    """Return the modules that a fresh interpreter has loaded."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED.format(use=use)],
        capture_output=True,
        check=True,
        env=os.environ,
        text=True,
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


#: What has a help page: each command, and those of the group that has some.
PAGES = [*COMMANDS, *(f"profile {name}" for name in ("list", "show", "check", "probe"))]


@pytest.mark.parametrize("page", PAGES)
def test_help_of_a_command_loads_its_options_alone(page):
    use = f"cli.main({[*page.split(), '--help']}, standalone_mode=False)"
    assert not modules_after(use) & HEAVY


def test_keys_of_settings_load_options_alone():
    use = "from wedmcam.cli.settings import known_options\nassert known_options(cli)"
    assert not modules_after(use) & HEAVY


def test_help_of_the_program_loads_no_command():
    loaded = modules_after("cli.main(['--help'], standalone_mode=False)")
    assert not {f"wedmcam.cli.commands.{name}" for name in COMMANDS} & loaded
    assert not loaded & HEAVY
