"""``wedmcam config``: every option with its value, and who says so.

It takes the options of all commands, so that what is typed can be seen to win.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import click

from wedmcam.cli.lengths import Length, Point
from wedmcam.cli.main import cli
from wedmcam.cli.settings import Configured
from wedmcam.cli.settings.configured import is_typed
from wedmcam.cli.settings.find import folder_of, places
from wedmcam.cli.settings.keys import COMMANDS, NAME, PROFILES, key_of, known_options, of_one_run
from wedmcam.cli.settings.state import InForce, state_of
from wedmcam.cli.terminal import print_json, print_text

HELP = f"""The settings in force for INPUT (or this folder), and where each comes from.

Any option of {", ".join(COMMANDS)} that names no file of one run can stand in a
{NAME} under its long name: beside the input or in a folder above it, or in the
user's configuration folder. What is nearer wins, and what is typed wins over all. Lengths
are text with a unit ("0.1mm") or mm; what can be repeated takes a list; a flag takes true
or false. Commands that only read programs (convert, diff, dump, explain) take "profile",
"profile-in", "d" and the answers about programs ("units-in", "whole-in", ...) of it.
"""


def _options() -> list[click.Parameter]:
    """Return the options of all commands that can be settings."""
    return [option for option in known_options(cli).values() if not of_one_run(option)]


def _print_config(**_: Any) -> int:
    """Print the settings in force, as a table or as JSON."""
    ctx = click.get_current_context()
    force = state_of(ctx).in_force
    rows = list(_rows(ctx, force))
    if force.params["json_"]:
        print_json(_as_data(rows, force))
        return 0
    for file in force.files:
        print_text(f"# {file.name}")
    if not force.files:
        files = places(folder_of(ctx.params.get("input_")))
        print_text(f"# no {NAME} in {files[0].parent} or above, or in {files[-1].parent}")
    width = max(len(_text(row["value"])) for row in rows)
    for row in rows:
        print_text(f"{row['key']:16} {_text(row['value']):{width}}  {_origin(row)}")
    for setting, why in force.aside:
        place = f"{setting.span.file}:{setting.span.line}"
        print_text(f"# not in force: {setting.key} of {place}: {why}")
    return 0


def _rows(ctx: click.Context, force: InForce) -> Iterator[dict[str, Any]]:
    for option in ctx.command.params:
        key = key_of(option)
        if key is None or not isinstance(option, click.Option) or not option.expose_value:
            continue
        setting = force.settings.get(key)
        row: dict[str, Any] = {"key": key}
        if setting is not None:
            row["value"] = setting.value if key in PROFILES else setting.written
            row |= {"from": "file", "file": setting.span.file, "line": setting.span.line}
        elif is_typed(ctx, option):
            row |= {"value": _typed(option, force.params[str(option.name)]), "from": "option"}
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
    if isinstance(option.type, Length):
        return _mm(value)
    if isinstance(option.type, Point):
        return [f"{_mm(x)},{_mm(y)}" for x, y in (value if option.multiple else (value,))]
    return list(value) if isinstance(value, tuple) else value


def _mm(um: float) -> str:
    return f"{um / 1000:.6f}".rstrip("0").rstrip(".") + "mm"


def _text(value: Any) -> str:
    if isinstance(value, tuple):  # a layer, and what holds for it
        name, of_layer = value
        return f"{name}={_mm(of_layer) if isinstance(of_layer, float) else of_layer}"
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


def _as_data(rows: list[dict[str, Any]], force: InForce) -> dict[str, Any]:
    return {
        "files": [file.name for file in force.files],
        "settings": {row["key"]: {k: v for k, v in row.items() if k != "key"} for row in rows},
        "aside": [
            {"key": s.key, "file": s.span.file, "line": s.span.line, "why": why}
            for s, why in force.aside
        ],
    }


config_command = Configured(
    "config",
    callback=_print_config,
    params=[click.Argument(["input_"], metavar="[INPUT]", required=False), *_options()],
    help=HELP,
)
