"""A source as commands read it, and its compile to one program: what compile and check share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli.files import read_input, shown_name
from wedmcam.cli.observer import Observer
from wedmcam.cli.progress import waiting
from wedmcam.cli.terminal import print_findings
from wedmcam.compiler.results import Compilation
from wedmcam.machines import Machine
from wedmcam.options import Options


@dataclass(frozen=True, slots=True)
class Source:
    """A drawing or a part program, with the options that it is read and cut by.

    ``name``: as it stands in messages.
    """

    name: str
    data: bytes
    options: Options

    @property
    def texts(self) -> dict[str, str | bytes]:
        """Name -> text of what findings point to."""
        return {self.name: self.data, **self.options.texts}


def read_source(input_: str, params: dict[str, Any]) -> Source:
    """Return a source that is read.

    Raises:
        Failed: it cannot be read.
        WrongUse: its format is not read, or options do not fit together.
    """
    ask.check_source(input_, params["from_"])
    options = ask.options_of(params)
    return Source(shown_name(input_), read_input(input_), options)


def compile_source(
    source: Source,
    machine: Machine,
    output: str,
    params: dict[str, Any],
    stages: tuple[str, ...],
) -> Compilation:
    """Compile a source to one program; print its findings, and what is asked for of its stages.

    Args:
        source: to compile.
        machine: to compile for.
        output: name of the program.
        params: of the command.
        stages: that ``--dump-after`` names.
    """
    observer = Observer(stages)
    with waiting(f"compiling {source.name}"):
        compilation = api.compile(
            source.data,
            to=machine.format,
            profile=machine if params["profile"] else None,
            name=source.name,
            output_name=output,
            options=source.options,
            observe=observer,
        )
    observer.print_stages(machine)
    print_findings(compilation.findings, source.name, params["quiet"], source.texts)
    if params["verbose"]:
        observer.print_times()
    return compilation


def measure_arithmetics(
    compilation: Compilation, source: Source, params: dict[str, Any]
) -> dict[str, Any]:
    """Return what ``--json`` says of the other arithmetic; empty where it is not measured."""
    if not (params["json_"] or source.options.arithmetic == "float64"):
        return {}
    return {"arithmetic_difference_um": api.arithmetic_difference(compilation, source.data)}
