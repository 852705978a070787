"""Tables of layers in a settings file: ``[layers.DIE]`` stands for options that name the layer."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import click

from wedmcam.diag import Diagnostic, TextSpan, error

#: Keys of a table of one layer -> the option that says the same of a layer that it names.
LAYER_KEYS = {"side": "layer-side", "offset": "layer-offset"}

_HINT = '[layers.DIE] with side = "die" and offset = "0.12mm"'

Pairs = dict[str, list[tuple[str, Any]]]


def take_layers(
    data: dict[str, Any], text: str, name: str, line: int, known: Mapping[str, click.Option]
) -> tuple[Pairs, list[Diagnostic]]:
    """Take the tables ``[layers.NAME]`` out of a file; return their values by option.

    >>> # [layers.DIE]
    >>> # side = "die"      stands for --layer-side DIE=die

    Args:
        data: of the file; the tables are removed.
        text: of the file.
        name: of the file.
        line: of the first table.
        known: key -> option.
    """
    tables = data.pop("layers", {})
    span = TextSpan(name, line, 1)
    if not isinstance(tables, dict):
        wrong = error("settings-value", "'layers': takes tables, one a layer", span, hint=_HINT)
        return {}, [wrong]
    pairs: Pairs = {}
    findings: list[Diagnostic] = []
    for layer, table in tables.items():
        if not isinstance(table, dict):
            findings.append(
                error(
                    "settings-value",
                    "'layers.{layer}': takes a table, not {value}",
                    span,
                    hint=_HINT,
                    layer=layer,
                    value=repr(table),
                )
            )
            continue
        for key, value in table.items():
            at = TextSpan(name, _line_of_layer(text, layer, key) or line, 1)
            pair = _pair(layer, key, value, at, known)
            if isinstance(pair, Diagnostic):
                findings.append(pair)
            else:
                pairs.setdefault(LAYER_KEYS[key], []).append(pair)
    return pairs, findings


def _pair(
    layer: str, key: str, value: Any, span: TextSpan, known: Mapping[str, click.Option]
) -> tuple[str, Any] | Diagnostic:
    """Return the layer with the value of one key of its table, as the option takes it."""
    option = known.get(LAYER_KEYS.get(key, ""))
    if option is None:
        return error(
            "settings-key",
            "'layers.{layer}': there is no key '{key}'",
            span,
            hint="a layer takes {keys}",
            layer=layer,
            key=key,
            keys=" and ".join(LAYER_KEYS),
        )
    try:
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise ValueError(f"takes text or a length, not {value!r}")
        nowhere = click.Context(click.Command("settings"))
        pair: tuple[str, Any] = option.type.convert(f"{layer}={value}", option, nowhere)
    except (ValueError, click.BadParameter) as why:
        return error(
            "settings-value",
            "'layers.{layer}.{key}': {reason}",
            span,
            layer=layer,
            key=key,
            reason=why.message if isinstance(why, click.BadParameter) else str(why),
        )
    return pair


def _line_of_layer(text: str, layer: str, key: str) -> int | None:
    """Return the line of a key of the table of a layer, or that of the table."""
    within: int | None = None
    for number, line in enumerate(text.splitlines(), 1):
        if m := re.match(r"\s*\[+\s*layers\s*\.\s*[\"']?(.*?)[\"']?\s*\]+", line):
            within = number if m[1] == layer else None
        elif within and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line):
            return number
    return within
