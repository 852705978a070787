"""``wedmcam zd065``: the memory of the ZD-065 as a file."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])


class Address(click.ParamType):  # type: ignore[type-arg]
    """An address of the machine: 0x01FF, $01FF, or decimal 511."""

    name = "address"

    def convert(self, value: Any, param: Any, ctx: Any) -> int:
        """Return the address; a wrong one is wrong use."""
        if isinstance(value, int):
            return value
        text = str(value).strip()
        match = re.fullmatch(r"(?:0[xX]|\$)([0-9a-fA-F]{1,4})|(0+|[1-9][0-9]{0,4})", text)
        address = -1
        if match:
            address = int(match[1], 16) if match[1] else int(match[2])
        if not 0 <= address <= 0xFFFF:  # a decimal number with a 0 before it may be meant as hex
            how = "write it hexadecimal (0x01FF, $01FF) or decimal (511), 0 to 0xFFFF"
            self.fail(f"'{value}' is no address: {how}", param, ctx)
        return address


class Seconds(click.ParamType):  # type: ignore[type-arg]
    """A time: 2, 2s, 500ms."""

    name = "time"

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        """Return seconds; a wrong one is wrong use."""
        if isinstance(value, float):
            return value
        match = re.fullmatch(r"\s*([0-9]{1,6}(?:\.[0-9]{0,6})?|\.[0-9]{1,6})\s*(s|ms)?\s*", value)
        seconds = float(match[1]) * (0.001 if match[2] == "ms" else 1.0) if match else math.nan
        if not 0 < seconds <= 9999:
            self.fail(f"'{value}' is no time: write 2s or 500ms, up to 9999 s", param, ctx)
        return seconds


ADDRESS = Address()
SECONDS = Seconds()

_BASE = click.option(
    "--base", type=ADDRESS, default="0x0000", show_default=True, help="Of the first byte of IMAGE."
)
_AT = click.option(
    "--at", type=ADDRESS, help="Where the data begin; by default the first byte that is not 0."
)
_FORMAT = click.option(
    "--format",
    "format_",
    type=click.Choice(["compact", "rotation", "compensation"]),
    help="Of the data, where it is known: lines alone do in two formats.",
)
_JSON = click.option("--json", "json_", is_flag=True, help="As JSON on standard output.")
_OUTPUT = click.option(
    "-o", "--output", metavar="FILE", help="Where the memory goes; - for stdout."
)


def _options(*options: Callable[[Any], Any]) -> Callable[[F], F]:
    def apply(command: F) -> F:
        for option in reversed((click.argument("image"), *options)):
            command = option(command)
        return command

    return apply


@click.group("zd065")
def zd065_group() -> None:
    """The memory of the ZD-065: IMAGE holds its 4,096 bytes for data.

    A shorter file, such as a program in .zd, is a memory whose other bytes are 0. Addresses are
    hexadecimal (0x01FF, $01FF) or decimal.
    """


@zd065_group.command("show", short_help="Bytes of a range, three at a time.")
@_options(
    click.argument("first", metavar="[FROM]", type=ADDRESS, required=False),
    click.argument("last", metavar="[TO]", type=ADDRESS, required=False),
    click.option(
        "--time", "time_s", type=SECONDS, default="1s", show_default=True,
        help="How long each group is shown.",
    ),
    _BASE,
    _JSON,
)  # fmt: skip
def show_command(**params: Any) -> int:
    """Bytes of a range, three at a time, as the six digits of the machine show them.

    FROM and TO are both shown; all of the memory by default. When each group is shown is printed
    beside it; nothing waits.
    """
    from wedmcam.cli.run.zd065 import run_show

    return run_show(**params)


@zd065_group.command("find", short_help="The address of block N.")
@_options(click.argument("number", metavar="N", type=click.IntRange(1)), _BASE, _AT, _FORMAT, _JSON)
def find_command(**params: Any) -> int:
    """The address of block N of the data, counted from 1, thread points and pauses included."""
    from wedmcam.cli.run.zd065 import run_find

    return run_find(**params)


@zd065_group.command("move", short_help="Data to another address; where they were is cleared.")
@_options(
    click.argument("first", metavar="FROM", type=ADDRESS),
    click.argument("last", metavar="TO", type=ADDRESS),
    click.argument("to", metavar="DEST", type=ADDRESS),
    _OUTPUT,
    click.option("--in-place", is_flag=True, help="Write IMAGE itself."),
    _BASE,
    _FORMAT,
    _JSON,
    click.option("--strict", is_flag=True, help="Warnings are errors: nothing may get lost."),
)
def move_command(**params: Any) -> int:
    """The bytes FROM to TO, both included, to the address DEST; where they were is cleared to 0.

    Where both ranges overlap, only what is not overwritten is cleared. Data that are overwritten
    are a warning.
    """
    from wedmcam.cli.run.zd065 import run_move

    return run_move(**params)


@zd065_group.command("identify", short_help="What the memory holds.")
@_options(
    _BASE,
    _AT,
    _FORMAT,
    click.option("--clear", is_flag=True, help="Where it is random: write a cleared memory to -o."),
    _OUTPUT,
    _JSON,
)
def identify_command(**params: Any) -> int:
    """What the memory holds: the format, the number of blocks, the last address.

    Random data are recognised as such, and a damaged place is told. The machine clears random
    memory by itself; here only --clear does.
    """
    from wedmcam.cli.run.zd065 import run_identify

    return run_identify(**params)
