"""What commands write: the files of a program, and pictures of good and of refused work."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from wedmcam import api
from wedmcam.cli.files import check_outputs, write_outputs
from wedmcam.cli.settings import also_read
from wedmcam.cli.terminal import print_text
from wedmcam.compiler.results import Compilation, Inspection, Proof
from wedmcam.diag import json_text
from wedmcam.diag.run import WrongUse
from wedmcam.machines import Machine
from wedmcam.targets import target_of

PICTURES = (".svg", ".png", ".html")


@dataclass(frozen=True, slots=True)
class Outputs:
    """Names of the files that are written with a program; None for those that are not asked for."""

    program: str
    certificate: str | None = None
    plot: str | None = None
    map: str | None = None
    sheet: str | None = None

    @property
    def names(self) -> list[str]:
        """Names of all files."""
        every = (self.program, self.certificate, self.plot, self.map, self.sheet)
        return [name for name in every if name is not None]

    def renamed(self, rename: Callable[[str], str]) -> Outputs:
        """Return the outputs under other names."""
        program, *others = (
            None if name is None else rename(name)
            for name in (self.program, self.certificate, self.plot, self.map, self.sheet)
        )
        return Outputs(str(program), *others)


def check_names(inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """Refuse outputs that are inputs, settings that are read, or each other.

    Raises:
        UsageError: exit status 2.
    """
    check_outputs([*inputs, *also_read(click.get_current_context())], outputs)


def check_picture(name: str | None) -> None:
    """Refuse a name that no picture has.

    Raises:
        UsageError: with the endings that there are.
    """
    if name not in (None, "-") and Path(str(name)).suffix.lower() not in PICTURES:
        raise click.UsageError(f"{name}: a picture ends in {', '.join(PICTURES)}")


def check_terminal(output: str, machine: Machine) -> None:
    """Refuse to write a program that is no text on a terminal.

    Raises:
        UsageError: exit status 2.
    """
    if output == "-" and not target_of(machine).is_text and sys.stdout.isatty():
        raise click.UsageError("a binary program is not for a terminal: give -o FILE")


def program_files(
    compilation: Compilation, outputs: Outputs, data: bytes
) -> list[tuple[str, bytes]]:
    """Return names and bytes of what is written with a good program, but for the setup sheet.

    ``data``: the program.
    """
    files = [(outputs.program, data)]
    if outputs.certificate is not None:
        files.append((outputs.certificate, certificate_bytes(compilation.summary)))
    if outputs.plot is not None:
        title = Path(outputs.program).name
        files.append((outputs.plot, picture(compilation, title, outputs.plot)))
    if outputs.map is not None:
        files.append((outputs.map, map_bytes(api.source_map(compilation))))
    return files


def certificate_bytes(data: dict[str, Any]) -> bytes:
    """Return a certificate as it is written to a file."""
    return (json_text(data, 2) + "\n").encode("utf-8")


def map_bytes(data: dict[str, Any]) -> bytes:
    """Return a map as it is written to a file: a line a block, for large programs are long."""
    head = {k: v for k, v in data.items() if k != "blocks"}
    top = json_text(head, 2)[:-2]
    rows = ",\n".join("    " + json_text(row) for row in data["blocks"])
    return f'{top},\n  "blocks": [\n{rows}\n  ]\n}}\n'.encode()


def picture(of: Compilation | Inspection | Proof, title: str, name: str) -> bytes:
    """Return the picture as the bytes of the format that its name tells."""
    return picture_bytes(name, lambda: api.plot(of, title), lambda: api.plot_html(of, title))


def picture_bytes(
    name: str, as_svg: Callable[[], str], as_html: Callable[[], str] | None = None
) -> bytes:
    """Return a picture as the bytes of the format that its name tells; a PNG is made of the SVG."""
    suffix = Path(name).suffix.lower()
    if suffix == ".html" and as_html is not None:
        return as_html().encode("utf-8")
    svg = as_svg()
    if suffix != ".png":
        return svg.encode("utf-8")
    import resvg_py  # a large library, for PNG alone

    return bytes(resvg_py.svg_to_bytes(svg_string=svg, zoom=2))


def write_refused(of: Compilation | Inspection | Proof, title: str, name: str, source: str) -> bool:
    """Write the picture of what is refused, and say what it shows; or say why there is none.

    Args:
        of: the compilation, inspection or proof that has errors.
        title: of the picture.
        name: of its file.
        source: what was read.

    Returns:
        Whether it was written.
    """
    try:
        data = picture(of, title, name)
    except WrongUse as why:
        print_text(f"no picture was written: {source}: {why}", err=True)
        return False
    write_outputs([(name, data)])
    if name != "-":
        print_text(f"{name} shows what was read, with the places marked", err=True)
    return True


def print_nothing_written(output: str, what: str = "nothing") -> None:
    """Say that no program was written, and that one that is there is as it was.

    ``what``: other files may have been.
    """
    there = output != "-" and Path(output).exists()
    print_text(f"{what} was written" + (f"; {output} is as it was" if there else ""), err=True)
