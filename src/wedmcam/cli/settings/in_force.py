"""Which setting wins: what is typed, then the nearest file, then the default."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wedmcam.cli.settings.find import files_for
from wedmcam.cli.settings.keys import OFFSETS, PROFILES
from wedmcam.cli.settings.profiles import format_of_name, unfit_profile
from wedmcam.cli.settings.state import InForce, state_of

if TYPE_CHECKING:
    from wedmcam.cli.settings.read import BadSettings, Setting


def in_force(
    options: Mapping[str, click.Option],
    ctx: click.Context,
    folder: Path,
    typed: set[str],
    *,
    files: bool = True,
) -> InForce:
    """Return what a command gets: typed options, then settings, nearest first, then defaults.

    Args:
        options: key -> option of the command, for those that can be settings.
        ctx: of the run.
        folder: of the input.
        typed: names of the parameters that are given on the command line.
        files: whether settings files are asked for.

    Raises:
        BadSettings: a settings file is wrong.
    """
    state = state_of(ctx)
    if state.given is None:
        state.given = dict(ctx.params)
    result = InForce(files=files_for(folder, ctx) if files else (), params=dict(state.given))
    given = {
        key: state.given[str(option.name)]
        for key, option in options.items()
        if str(option.name) in typed
    }
    taken: dict[str, Any] = dict(given)
    for file in result.files:
        nearer = dict(taken)
        for key, setting in file.settings.items():
            if key not in options:
                continue
            why = _aside(setting, nearer, result.params, given)
            if why:
                result.aside.append((setting, why))
                continue
            taken[key] = setting.value
            result.settings[key] = setting
            result.params[str(options[key].name)] = setting.value
    if "units" in result.settings:
        # A default is weaker than what a drawing says of itself; what is typed is not.
        result.params["fill_in_units"] = True
    if "join" in options:  # a command that reads drawings: what has no effect there is reported
        result.params["wishes"] = frozenset(str(options[key].name) for key in given)
    return result


def _aside(
    setting: Setting, nearer: Mapping[str, Any], params: Mapping[str, Any], given: Mapping[str, Any]
) -> str:
    """Return why a setting does not count; empty if it does."""
    key = setting.key
    if key in nearer:
        return f"--{key} is given" if key in given else "a nearer file says it"
    rivals = {"offset": {"wire", "gap"}, "wire": {"offset"}, "gap": {"offset"}}.get(key, set())
    for rival in sorted(rivals & set(nearer)):
        return f"--{rival} is given" if rival in given else f"a nearer file says '{rival}'"
    if key in OFFSETS and nearer.get("side") == "on":
        return "side 'on' takes no offset"
    if key == "side" and setting.value == "on" and OFFSETS & set(nearer):
        return "an offset is given"
    if key == "to" and (named := format_of_name(params)):
        return f"the output's name says {named}"
    if key in PROFILES:
        return unfit_profile(setting, nearer, params)
    return ""


def locate(why: Exception, force: InForce) -> BadSettings | None:
    """Return wrong use as a finding in the settings file that it came from, if it did."""
    for key in re.findall(r"--([a-z][a-z-]*)", str(why)):
        setting = force.settings.get(key)
        if setting is not None:
            from wedmcam.cli.settings.read import BadSettings
            from wedmcam.diag import error

            text = next(f.text for f in force.files if f.name == setting.span.file)
            finding = error("settings-value", "{reason}", setting.span, reason=str(why))
            return BadSettings([(finding, text)])
    return None
