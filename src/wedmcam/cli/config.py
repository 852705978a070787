"""``wedmcam config``: every option with its value, and who says so.

It takes the options of all commands, so that what is typed can be seen to win.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from wedmcam.cli import settings
from wedmcam.cli.settings import COMMANDS, META, Configured, InForce
from wedmcam.cli.terminal import print_text


def config_command(group: click.Group) -> Configured:
    """Return the command, with the options of ``group``'s commands that can be settings."""
    known = settings.known_options(group)
    params: list[click.Parameter] = [click.Argument(["input_"], metavar="[INPUT]", required=False)]
    params += [option for option in known.values() if not settings.of_one_run(option)]
    return Configured(
        "config",
        callback=_config,
        params=params,
        short_help="The settings in force, and where each comes from.",
        help=f"""The settings in force for INPUT (or this folder), and where each comes from.

        Any option of {", ".join(COMMANDS)} that names no file of one run can stand in a
        {settings.NAME} under its long name: beside the input or in a folder above it, or in the
        user's configuration folder. What is nearer wins, and what is typed wins over all. Lengths
        are text with a unit ("0.1mm") or mm; what can be repeated takes a list; a flag takes true
        or false. Commands that only read programs (convert, diff, dump, explain) take "profile",
        "profile-in", "d" and what is said of programs ("units-in", "whole-in", ...) of it.
        """,
    )


def _config(**_: Any) -> int:
    from wedmcam.cli import terminal

    ctx = click.get_current_context()
    made: InForce = ctx.meta[META]
    rows = list(_rows(ctx, made))
    if made.params["json_"]:
        terminal.print_json(_data(rows, made))
        return 0
    for file in made.files:
        print_text(f"# {file.name}")
    if not made.files:
        folders = settings.places(settings.folder_of(ctx.params.get("input_")))
        print_text(
            f"# no {settings.NAME} in {folders[0].parent} or above, or in {folders[-1].parent}"
        )
    width = max(len(_text(row["value"])) for row in rows)
    for row in rows:
        print_text(f"{row['key']:16} {_text(row['value']):{width}}  {_origin(row)}")
    for setting, why in made.aside:
        place = f"{setting.span.file}:{setting.span.line}"
        print_text(f"# not in force: {setting.key} of {place}: {why}")
    return 0


def _places(ctx: click.Context) -> list[Path]:
    return settings.places(settings.folder_of(ctx.params.get("input_")))


def _rows(ctx: click.Context, made: InForce) -> Iterator[dict[str, Any]]:
    for option in ctx.command.params:
        key = settings.key_of(option)
        if key is None or not isinstance(option, click.Option) or not option.expose_value:
            continue
        setting = made.settings.get(key)
        row: dict[str, Any] = {"key": key}
        if setting is not None:
            row["value"] = setting.value if key in settings.PROFILES else setting.written
            row |= {"from": "file", "file": setting.span.file, "line": setting.span.line}
        elif settings.is_typed(ctx, option):
            row |= {"value": _typed(option, made.params[str(option.name)]), "from": "option"}
        else:
            row |= {"value": _default(option), "from": "default"}
        yield row


def _default(option: click.Option) -> Any:
    """Return a default as people write it; None where there is none."""
    if option.is_flag:
        return option.default is True
    # click marks a missing default by an object of its own, which is no value.
    return option.default if isinstance(option.default, str | int | float) else None


def _typed(option: click.Option, value: Any) -> Any:
    """Return a typed value as people write it: lengths were turned into um."""
    from wedmcam.cli.lengths import Length, Point

    if isinstance(option.type, Length):
        return _mm(value)
    if isinstance(option.type, Point):
        return [f"{_mm(x)},{_mm(y)}" for x, y in (value if option.multiple else (value,))]
    return list(value) if isinstance(value, tuple) else value


def _mm(um: float) -> str:
    return f"{um / 1000:.6f}".rstrip("0").rstrip(".") + "mm"


def _text(value: Any) -> str:
    if isinstance(value, tuple):  # a layer, and what is said of it
        name, said = value
        return f"{name}={_mm(said) if isinstance(said, float) else said}"
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "-"
    if isinstance(value, list):
        return ", ".join(_text(v) for v in value)
    return str(value)


def _origin(row: dict[str, Any]) -> str:
    if row["from"] == "file":
        return f"{row['file']}:{row['line']}"
    return f"option --{row['key']}" if row["from"] == "option" else "default"


def _data(rows: list[dict[str, Any]], made: InForce) -> dict[str, Any]:
    return {
        "files": [file.name for file in made.files],
        "settings": {row["key"]: {k: v for k, v in row.items() if k != "key"} for row in rows},
        "aside": [
            {"key": s.key, "file": s.span.file, "line": s.span.line, "why": why}
            for s, why in made.aside
        ],
    }
