"""Shop defaults: what ``wedmcam.toml`` says, and what of it is in force.

A shop cuts everything with one wire and one gap, and should not type them each time. Any option can
stand in a ``wedmcam.toml`` under its long name: beside the input, in a folder above it, or in the
user's configuration folder. What is nearer to the input wins, and what is typed wins over all. The
table of keys is the options themselves, so a new option can stand there at once.

`keys` is that table, `read` turns a file into settings (`layers` its tables of layers), `find` says
where files are, `in_force` which setting wins (`profiles`: for which program a profile is), and
`configured` are the commands that run with them. `state` is all that a run keeps of it. Help asks
for `configured` and `keys` alone, so these load nothing that reads a file.
"""

from __future__ import annotations

from wedmcam.cli.settings.configured import Configured, ReadsPrograms, also_read, typed
from wedmcam.cli.settings.keys import NAME, key_of, known_options, of_one_run

__all__ = [
    "NAME",
    "Configured",
    "ReadsPrograms",
    "also_read",
    "key_of",
    "known_options",
    "of_one_run",
    "typed",
]
