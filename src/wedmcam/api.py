"""The library: the names that a user imports, whatever room they come from.

These functions take bytes or a path, and return values; they print nothing and write nothing. A
path is read in `files` and nowhere deeper. Lengths are mm where a keyword says none. A name is
fetched when it is first used: who dumps a program loads no reader of drawings.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wedmcam.batch.compile import compile_all
    from wedmcam.compiler.results import Compilation, Inspection, Proof
    from wedmcam.files import Source, bytes_of
    from wedmcam.operations.compile import (
        arithmetic_difference,
        compile,
        compile_plan,
        planned_for,
        source_map,
    )
    from wedmcam.operations.diff import diff, difference_data
    from wedmcam.operations.inspect import inspect
    from wedmcam.operations.memory import clear as clear_memory
    from wedmcam.operations.memory import find_block
    from wedmcam.operations.memory import move as move_memory
    from wedmcam.operations.memory import read_image as read_memory
    from wedmcam.operations.memory import recognise as recognise_memory
    from wedmcam.operations.memory import show as show_memory
    from wedmcam.operations.profiles import machine_for, machine_issued, starts_of
    from wedmcam.operations.read import figures, read_program
    from wedmcam.operations.simulate import Simulation, simulate_program
    from wedmcam.operations.verify import verify, with_images
    from wedmcam.options import options_in_mm
    from wedmcam.programs.places import block_ends as positions
    from wedmcam.programs.places import minutes
    from wedmcam.reports.picture.simulation import plot_run, plot_run_html
    from wedmcam.reports.picture.tape import tape_picture as plot_tape
    from wedmcam.reports.plot import path_drawing, plot, plot_html
    from wedmcam.reports.pulses import pulse_lines

__all__ = [
    "Compilation",
    "Inspection",
    "Proof",
    "Simulation",
    "Source",
    "arithmetic_difference",
    "bytes_of",
    "clear_memory",
    "compile",
    "compile_all",
    "compile_plan",
    "diff",
    "difference_data",
    "figures",
    "find_block",
    "inspect",
    "machine_for",
    "machine_issued",
    "minutes",
    "move_memory",
    "options_in_mm",
    "path_drawing",
    "planned_for",
    "plot",
    "plot_html",
    "plot_run",
    "plot_run_html",
    "plot_tape",
    "positions",
    "pulse_lines",
    "read_memory",
    "read_program",
    "recognise_memory",
    "show_memory",
    "simulate_program",
    "source_map",
    "starts_of",
    "verify",
    "with_images",
]

#: Room -> the names that come from it.
_ROOMS: dict[str, tuple[str, ...]] = {
    "wedmcam.batch.compile": ("compile_all",),
    "wedmcam.compiler.results": ("Compilation", "Inspection", "Proof"),
    "wedmcam.files": ("Source", "bytes_of"),
    "wedmcam.operations.compile": (
        "arithmetic_difference",
        "compile",
        "compile_plan",
        "planned_for",
        "source_map",
    ),
    "wedmcam.operations.diff": ("diff", "difference_data"),
    "wedmcam.operations.inspect": ("inspect",),
    "wedmcam.operations.memory": ("find_block",),
    "wedmcam.operations.profiles": ("machine_for", "machine_issued", "starts_of"),
    "wedmcam.operations.read": ("figures", "read_program"),
    "wedmcam.operations.simulate": ("Simulation", "simulate_program"),
    "wedmcam.operations.verify": ("verify", "with_images"),
    "wedmcam.options": ("options_in_mm",),
    "wedmcam.programs.places": ("minutes",),
    "wedmcam.reports.picture.simulation": ("plot_run", "plot_run_html"),
    "wedmcam.reports.pulses": ("pulse_lines",),
    "wedmcam.reports.plot": ("path_drawing", "plot", "plot_html"),
}
#: Names of the library that are others where they come from, which says the rest: room, name.
_RENAMED = {
    "clear_memory": ("wedmcam.operations.memory", "clear"),
    "move_memory": ("wedmcam.operations.memory", "move"),
    "positions": ("wedmcam.programs.places", "block_ends"),
    "read_memory": ("wedmcam.operations.memory", "read_image"),
    "recognise_memory": ("wedmcam.operations.memory", "recognise"),
    "plot_tape": ("wedmcam.reports.picture.tape", "tape_picture"),
    "show_memory": ("wedmcam.operations.memory", "show"),
}
_ROOM_OF = {name: room for room, names in _ROOMS.items() for name in names}


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        room, own = _RENAMED[name]
        return getattr(import_module(room), own)
    if name not in _ROOM_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_ROOM_OF[name]), name)
