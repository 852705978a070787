"""Pictures that commands write: by the name's ending, and of drawings that are refused, too."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam.cli.files import write_outputs
from wedmcam.cli.terminal import print_text

PICTURES = (".svg", ".png", ".html")


def check_picture(name: str) -> None:
    """Refuse a name that no picture has.

    Raises:
        UsageError: with the endings that there are.
    """
    if name != "-" and Path(name).suffix.lower() not in PICTURES:
        raise click.UsageError(f"{name}: a picture ends in {', '.join(PICTURES)}")


def picture(made: Any, title: str, name: str) -> bytes:
    """Return the picture as the bytes of the format that its name tells."""
    from wedmcam import api

    if Path(name).suffix.lower() == ".html":
        return api.plot_html(made, title).encode("utf-8")
    svg = api.plot(made, title)
    if Path(name).suffix.lower() != ".png":
        return svg.encode("utf-8")
    import resvg_py

    return bytes(resvg_py.svg_to_bytes(svg_string=svg, zoom=2))


def write_refused(made: Any, title: str, name: str, source: str) -> bool:
    """Write the picture of what is refused, and say what it shows; or say why there is none.

    Args:
        made: the compilation, inspection or proof that has errors.
        title: of the picture.
        name: of its file.
        source: what was read.

    Returns:
        Whether it was written.
    """
    from wedmcam.options import WrongUse

    try:
        data = picture(made, title, name)
    except WrongUse as why:
        print_text(f"no picture was written: {source}: {why}", err=True)
        return False
    write_outputs([(name, data)])
    if name != "-":
        print_text(f"{name} shows what was read, with the places marked", err=True)
    return True


def print_nothing_written(output: str, but: bool = False) -> None:
    """Say that no program was written, and that one that is there is as it was.

    ``but``: a picture was.
    """
    what = "no program" if but else "nothing"
    there = output != "-" and Path(output).exists()
    print_text(f"{what} was written" + (f"; {output} is as it was" if there else ""), err=True)
