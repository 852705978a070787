"""Shop defaults: what ``wedmcam.toml`` says, and what of it is in force.

A shop cuts everything with one wire and one gap; nobody should have to type them. Any option can
stand in a ``wedmcam.toml`` under its long name: beside the input, in a folder above it, or in the
user's configuration folder. What is nearer to the input wins, and what is typed wins over all. The
table of keys is the options themselves, so a new option can stand there at once.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from wedmcam.cli.lengths import Length, Point

if TYPE_CHECKING:
    from wedmcam.cli.batch import How
    from wedmcam.diag import Diagnostic, TextSpan
    from wedmcam.machines.machine import Machine

NAME = "wedmcam.toml"
#: Commands whose options can stand in the file.
COMMANDS = ("compile", "check", "batch", "verify", "inspect", "plot")
#: Under this name a context keeps what is in force.
META = "wedmcam.settings"
#: Keys that name profiles.
PROFILES = ("profile", "profile-in")
#: Options that each say how far the wire is from the outline: the nearest level decides.
OFFSETS = frozenset({"offset", "wire", "gap"})


@dataclass(frozen=True, slots=True)
class Setting:
    """One key of one file.

    Attributes:
        key: long name of the option, without dashes.
        value: as the option takes it (lengths in um).
        written: as it stands in the file.
        span: of the value.
        folder: of the file; names of files are relative to it.
    """

    key: str
    value: Any
    written: Any
    span: TextSpan
    folder: Path


@dataclass(frozen=True, slots=True)
class File:
    """A settings file that was read: its settings, what is wrong with it, and its text."""

    name: str
    settings: dict[str, Setting]
    found: tuple[Diagnostic, ...]
    text: str


@dataclass(slots=True)
class InForce:
    """What the files say for one input.

    Attributes:
        files: that were read, nearest first.
        settings: key -> the setting in force.
        aside: settings that do not count, and why.
        params: what the command gets: options, settings, defaults.
    """

    files: tuple[File, ...] = ()
    settings: dict[str, Setting] = field(default_factory=dict)
    aside: list[tuple[Setting, str]] = field(default_factory=list)
    params: dict[str, Any] = field(default_factory=dict)


class BadSettings(click.ClickException):
    """A settings file is wrong: exit status 2, all findings with their lines."""

    exit_code = 2

    def __init__(self, found: Iterable[tuple[Diagnostic, str]]) -> None:
        self.found = tuple(found)
        super().__init__(self.rendered(False))

    def rendered(self, colour: bool) -> str:
        """Return the findings as lines."""
        from wedmcam.diag.render import render

        return "\n".join(render(d, "", colour, text) for d, text in self.found)

    def show(self, file: Any = None) -> None:
        """Print the findings."""
        from wedmcam.cli.terminal import coloured

        click.echo(self.rendered(coloured()), err=True)


def key_of(option: click.Parameter) -> str | None:
    """Return the key of an option: its long name without dashes; None where it has none."""
    if not isinstance(option, click.Option):
        return None
    names = [n[2:] for n in option.opts if n.startswith("--")]
    return names[0] if names else None


def of_one_run(option: click.Option) -> bool:
    """Return whether an option names a file of one run: no default for others."""
    return option.required or (option.metavar or "").startswith(("FILE", "INPUT"))


def known_options(group: click.Group) -> dict[str, click.Option]:
    """Return key -> option of all commands that take settings, in their order."""
    known: dict[str, click.Option] = {}
    for name in COMMANDS:
        for option in group.commands[name].params:
            key = key_of(option)
            if key is not None and isinstance(option, click.Option) and option.expose_value:
                known.setdefault(key, option)
    return known


# --- reading a file ------------------------------------------------------------------------------


def _raw(option: click.Option, value: Any) -> Any:
    """Return a TOML value as click would get it from the command line.

    Raises:
        ValueError: of another type; says what is taken.
    """
    if option.is_flag:
        if not isinstance(value, bool):
            raise ValueError("takes true or false")
        return value
    if not option.multiple:
        return _word(option, value)
    if not isinstance(value, list) or _is_point(option, value):
        value = [value]
    return tuple(_word(option, v) for v in value)


def _is_point(option: click.Option, value: Any) -> bool:
    numbers = isinstance(value, list) and len(value) == 2
    return numbers and isinstance(option.type, Point) and not any(_not_number(v) for v in value)


def _not_number(value: Any) -> bool:
    return isinstance(value, bool) or not isinstance(value, int | float)


def _word(option: click.Option, value: Any) -> Any:
    if _is_point(option, value):
        return f"{value[0]},{value[1]}"
    if isinstance(option.type, Length) and not _not_number(value):
        return str(value)
    if isinstance(option.type, click.types.IntParamType):
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError("takes a whole number")
        return value
    if not isinstance(value, str):
        kind = {"length": 'a length: 0.1, "0.1mm" or "100um"', "x,y": 'a point: "4,10"'}
        raise ValueError(f"takes {kind.get(option.type.name, 'text')}")
    return value


def _placed(text: str, key: str) -> tuple[int, int, int, int, int]:
    """Return line, column and length of a key, and column and length of its value.

    The file is flat, so a search of lines finds it.
    """
    at = re.compile(rf"(\s*)([\"']?){re.escape(key)}\2\s*(?=[.=])=?\s*")
    for number, line in enumerate(text.splitlines(), 1):
        if m := at.match(line):
            start = len(m[1])
            name = re.match(r"[\"']?[^\s\"'=.]*[\"']?", line[start:])
            length = len(name[0]) if name else 1
            rest = re.match(r"\"(?:[^\"\\]|\\.)*\"|'[^']*'|[^#]*", line[m.end() :])
            value = rest[0].rstrip() if rest else ""
            return number, start + 1, length, m.end() + 1, max(1, len(value))
        if (m := re.match(r"\s*\[+\s*([\w-]+)", line)) and m[1] == key:
            return number, 1, len(line.rstrip()), 1, len(line.rstrip())
    return 1, 1, 1, 1, 1


def read(text: str, name: str, folder: Path, known: Mapping[str, click.Option]) -> File:
    """Return the settings of one file; everything that is wrong with it at once."""
    from wedmcam.diag import TextSpan, error
    from wedmcam.diag.toml import read_toml

    data, wrong = read_toml(text, name, "settings-syntax")
    if wrong is not None:
        return File(name, {}, (wrong,), text)
    settings: dict[str, Setting] = {}
    found: list[Diagnostic] = []
    flat, bad = _of_layers(data, text, name, known)
    found += bad
    for key, value in data.items():
        line, column, length, value_column, value_length = _placed(text, key)
        span = TextSpan(name, line, value_column, value_length)
        option = known.get(key)
        if option is None or of_one_run(option):
            found.append(_unknown(key, value, option, TextSpan(name, line, column, length), known))
            continue
        try:
            if isinstance(value, dict):
                raise ValueError("takes a value, not a table")
            converted = option.type_cast_value(click.Context(_NOWHERE), _raw(option, value))
            settings[key] = Setting(key, _checked(key, converted, folder), value, span, folder)
        except (ValueError, click.BadParameter) as why:
            said = why.message if isinstance(why, click.BadParameter) else f"{why}, not {value!r}"
            found.append(
                error("settings-value", f"'{key}': {said}", span, hint=_near_choice(option, value))
            )
    for key, values in flat.items():
        before = settings[key].value if key in settings else ()
        span = TextSpan(name, _placed(text, "layers")[0], 1)
        settings[key] = Setting(key, (*before, *values), data.get(key, values), span, folder)
    return File(name, settings, tuple(found), text)


#: Keys of a table of one layer -> the option that says the same of a layer that it names.
LAYER_KEYS = {"side": "layer-side", "offset": "layer-offset"}


def _of_layers(
    data: dict[str, Any], text: str, name: str, known: Mapping[str, click.Option]
) -> tuple[dict[str, list[tuple[str, Any]]], list[Diagnostic]]:
    """Take the tables ``[layers.NAME]`` out of a file; return their values by option.

    >>> # [layers.DIE]
    >>> # side = "die"      stands for --layer-side DIE=die
    """
    from wedmcam.diag import TextSpan, error

    tables = data.pop("layers", {})
    flat: dict[str, list[tuple[str, Any]]] = {}
    found: list[Diagnostic] = []
    span = TextSpan(name, _placed(text, "layers")[0], 1)
    hint = '[layers.DIE] with side = "die" and offset = "0.12mm"'
    if not isinstance(tables, dict):
        return {}, [error("settings-value", "'layers': takes tables, one a layer", span, hint=hint)]
    for layer, said in tables.items():
        if not isinstance(said, dict):
            what = f"'layers.{layer}': takes a table, not {said!r}"
            found.append(error("settings-value", what, span, hint=hint))
            continue
        for key, value in said.items():
            line = _line_of_layer(text, layer, key) or span.line
            at = TextSpan(name, line, 1)
            option = known.get(LAYER_KEYS.get(key, ""))
            if option is None:
                what = f"'layers.{layer}': there is no key '{key}'"
                hints = f"a layer takes {' and '.join(LAYER_KEYS)}"
                found.append(error("settings-key", what, at, hint=hints))
                continue
            try:
                if isinstance(value, bool) or not isinstance(value, str | int | float):
                    raise ValueError(f"takes text or a length, not {value!r}")
                pair = option.type.convert(f"{layer}={value}", option, click.Context(_NOWHERE))
                flat.setdefault(LAYER_KEYS[key], []).append(pair)
            except (ValueError, click.BadParameter) as why:
                told = why.message if isinstance(why, click.BadParameter) else str(why)
                found.append(error("settings-value", f"'layers.{layer}.{key}': {told}", at))
    return flat, found


def _line_of_layer(text: str, layer: str, key: str) -> int | None:
    """Return the line of a key of the table of a layer, or that of the table."""
    within: int | None = None
    for number, line in enumerate(text.splitlines(), 1):
        if m := re.match(r"\s*\[+\s*layers\s*\.\s*[\"']?(.*?)[\"']?\s*\]+", line):
            within = number if m[1] == layer else None
        elif within and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*=", line):
            return number
    return within


_NOWHERE = click.Command("settings")


def _unknown(
    key: str,
    value: Any,
    option: click.Option | None,
    span: TextSpan,
    known: Mapping[str, click.Option],
) -> Diagnostic:
    import difflib

    from wedmcam.diag import error

    if option is not None:
        return error(
            "settings-key",
            f"'{key}' names a file of one run: it is no default for others",
            span,
            hint=f"give --{key} on the command line",
        )
    can = [k for k, o in known.items() if not of_one_run(o)]
    near = difflib.get_close_matches(key.replace("_", "-"), can, 1, 0.6)
    hint = f"did you mean '{near[0]}'?" if near else "wedmcam config lists what can stand here"
    if isinstance(value, dict | list) and not near:
        hint = "settings stand in one list, without sections; " + hint
    return error("settings-key", f"there is no option --{key}", span, hint=hint)


def _near_choice(option: click.Option, value: Any) -> str | None:
    if not isinstance(option.type, click.Choice) or not isinstance(value, str):
        return None
    import difflib

    near = difflib.get_close_matches(value, [str(c) for c in option.type.choices], 1, 0.5)
    return f"did you mean '{near[0]}'?" if near else None


def _checked(key: str, value: Any, folder: Path) -> Any:
    """Return the value of an option that click takes as any text, checked.

    Raises:
        ValueError: no such format or profile.
    """
    if key in PROFILES:
        return _profile(value, folder)
    if key in ("to", "from"):
        from wedmcam.options import PROGRAM_FORMATS, SOURCE_FORMATS

        formats = PROGRAM_FORMATS if key == "to" else SOURCE_FORMATS
        if value not in formats:
            raise ValueError(f"takes {', '.join(formats)}")
    return value


def _profile(value: str, folder: Path) -> str:
    from wedmcam import machines

    if value in machines.names():
        return value
    if value.lower().endswith(".toml"):
        place = folder / value
        if not place.is_file():
            raise ValueError(f"there is no file {place}")
        return str(place)
    _, found = machines.find(value)
    raise ValueError(f"{found[0].message} ({found[0].hint})")


# --- finding files -------------------------------------------------------------------------------


def user_folder() -> Path:
    """Return the user's configuration folder of this program."""
    home = os.environ.get("XDG_CONFIG_HOME")
    return Path(home) / "wedmcam" if home else Path(click.get_app_dir("wedmcam"))


def places(folder: Path) -> list[Path]:
    """Return where a settings file may be for inputs of ``folder``, nearest first."""
    return [*(f / NAME for f in (folder, *folder.parents)), user_folder() / NAME]


def folder_of(name: str | None) -> Path:
    """Return the folder of an input; the current one for standard input and for none.

    What is a folder itself (of ``batch``, ``config``) is its own.
    """
    if name is None or name == "-":
        return Path.cwd()
    path = Path(os.path.abspath(name))
    return path if path.is_dir() else path.parent


def _shown(path: Path) -> str:
    """Return a path as people know it: from here, where it is below here."""
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


def _load(path: Path, group: click.Group) -> File | None:
    if not path.is_file():
        return None
    from wedmcam.diag import TextSpan, error

    name = _shown(path)
    try:
        text = path.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as why:
        what = f"cannot be read: {why.strerror}" if isinstance(why, OSError) else "not UTF-8"
        wrong = error("settings-syntax", what, TextSpan(name, 1, 1))
        return File(name, {}, (wrong,), "")
    return read(text, name, path.parent, known_options(group))


def files_for(folder: Path, ctx: click.Context) -> tuple[File, ...]:
    """Return the settings files for inputs of a folder, nearest first; each is read once a run.

    Raises:
        BadSettings: with all errors of all of them.
    """
    group = ctx.find_root().command
    assert isinstance(group, click.Group)
    known: dict[Path, File | None] = ctx.meta.setdefault(f"{META}.files", {})
    for place in places(folder):
        if place not in known:
            known[place] = _load(place, group)
    files = tuple(f for p in places(folder) if (f := known[p]) is not None)
    bad = [(d, f.text) for f in files for d in f.found]
    if bad:
        raise BadSettings(bad)
    return files


# --- what is in force ----------------------------------------------------------------------------


def in_force(
    command: click.Command, ctx: click.Context, folder: Path, *, files: bool = True
) -> InForce:
    """Return what a command gets: typed options, then settings, nearest first, then defaults."""
    read_files = files_for(folder, ctx) if files else ()
    given = ctx.meta.setdefault(f"{META}.given", dict(ctx.params))
    made = InForce(files=read_files, params=dict(given))
    options = {
        key: option
        for option in command.params
        if (key := key_of(option)) and isinstance(option, click.Option) and option.expose_value
        if key in _of_programs() or not isinstance(command, ReadsPrograms)
    }
    typed = {key: given[str(o.name)] for key, o in options.items() if is_typed(ctx, o)}
    taken: dict[str, Any] = dict(typed)
    for file in read_files:
        nearer = dict(taken)
        for key, setting in file.settings.items():
            if key not in options:
                continue
            why = _aside(setting, nearer, made.params, typed)
            if why:
                made.aside.append((setting, why))
                continue
            taken[key] = setting.value
            made.settings[key] = setting
            made.params[str(options[key].name)] = setting.value
    if "units" in made.settings:
        # A default is weaker than what a drawing says of itself; what is typed is not.
        made.params["fill_in_units"] = True
    if "join" in options:  # a command that reads drawings: what has no effect there is said
        made.params["wishes"] = frozenset(str(options[key].name) for key in typed)
    return made


def _of_programs() -> set[str]:
    """Return the keys that say how programs are read, whatever their format, and F of one made."""
    from wedmcam.options import READING

    return {"d", "feed", *(name.replace("_", "-") for name in READING)}


def is_typed(ctx: click.Context, option: click.Parameter) -> bool:
    """Return whether an option was given on the command line."""
    return ctx.get_parameter_source(str(option.name)) not in (ParameterSource.DEFAULT, None)


def typed(ctx: click.Context) -> set[str]:
    """Return the names of the parameters that were given on the command line."""
    return {str(o.name) for o in ctx.command.params if is_typed(ctx, o)}


def also_read(ctx: click.Context) -> list[str]:
    """Return the files beside its inputs that a command reads: no output may overwrite them."""
    made: InForce = ctx.meta[META]
    named = [made.params.get(key.replace("-", "_")) for key in PROFILES]
    profiles = [name for name in named if name and Path(name).suffix.lower() == ".toml"]
    return [file.name for file in made.files] + profiles


def _aside(
    setting: Setting, nearer: Mapping[str, Any], params: Mapping[str, Any], typed: Mapping[str, Any]
) -> str:
    """Return why a setting does not count; empty if it does."""
    key = setting.key
    if key in nearer:
        return f"--{key} is given" if key in typed else "a nearer file says it"
    rivals = {"offset": {"wire", "gap"}, "wire": {"offset"}, "gap": {"offset"}}.get(key, set())
    for rival in sorted(rivals & set(nearer)):
        return f"--{rival} is given" if rival in typed else f"a nearer file says '{rival}'"
    if key in OFFSETS and nearer.get("side") == "on":
        return "side 'on' takes no offset"
    if key == "side" and setting.value == "on" and OFFSETS & set(nearer):
        return "an offset is given"
    if key == "to" and (named := _format_of_name(params)):
        return f"the output's name says {named}"
    if key in PROFILES:
        return _unfit_profile(setting, nearer, params)
    return ""


def _format_of_name(params: Mapping[str, Any]) -> str | None:
    from wedmcam.options import FORMAT_OF_SUFFIX

    output = params.get("output")
    return FORMAT_OF_SUFFIX.get(Path(output).suffix.lower()) if output else None


def _unfit_profile(setting: Setting, nearer: Mapping[str, Any], params: Mapping[str, Any]) -> str:
    """Return why a profile is not for this run: a shop has machines of several formats."""
    from wedmcam.cli import asked as ask

    named = setting.written
    wanted = nearer.get("to") or nearer.get("format") or _format_of_name(params)
    if setting.key == "profile-in":
        wanted = nearer.get("format")
    if wanted is None:
        wanted = _format_of_program(params)
    if wanted is None:
        return ""
    format_ = ask.machine_of(setting.value, None).format
    if format_ in (w.strip() for w in wanted.split(",")):  # --to 3b,iso: for the one it is for
        return ""
    return f"'{named}' is for {format_}, not for {wanted}"


def _format_of_program(params: Mapping[str, Any]) -> str | None:
    """Return the format of a program that is read (verify, plot); None where none is."""
    from wedmcam.options import FORMAT_OF_SUFFIX

    name = params.get("program") or ("output" in params and params.get("input_"))
    if not name:
        return None
    suffix = Path(name).suffix.lower()
    if suffix in FORMAT_OF_SUFFIX:
        return FORMAT_OF_SUFFIX[suffix]
    if suffix in (".dxf", ".wed") or not Path(name).is_file():
        return None if "program" not in params else "a program from standard input"
    from wedmcam.cli.files import read_input
    from wedmcam.frontends.identify import identify

    seen = identify(read_input(name)).format
    return seen if seen in FORMAT_OF_SUFFIX.values() else None


def format_of_program(program: str) -> str | None:
    """Return the format of a program by its name or content; None where neither tells."""
    return _format_of_program({"program": program})


def where(made: InForce, key: str) -> str:
    """Return where the value of a key comes from; empty for typed ones and defaults."""
    setting = made.settings.get(key)
    return f"{setting.span.file}:{setting.span.line}" if setting else ""


class Configured(click.Command):
    """A command whose options have their defaults from settings files.

    The command itself sees no difference: its arguments are complete when it starts.
    """

    def __init__(self, *arguments: Any, **more: Any) -> None:
        super().__init__(*arguments, **more)
        self.params.append(
            click.Option(
                ["--no-config"],
                is_flag=True,
                expose_value=False,
                help=f"Take no settings from a {NAME} (see wedmcam config).",
                callback=lambda ctx, _, value: ctx.meta.__setitem__(f"{META}.off", value),
            )
        )

    def invoke(self, ctx: click.Context) -> Any:
        """Complete the arguments and run."""
        from wedmcam.options import WrongUse

        made = self.made(ctx, folder_of(_input(ctx.params)))
        ctx.meta[META] = made
        ctx.params = made.params
        try:
            return super().invoke(ctx)
        except WrongUse as why:
            raise located(why, made) or why from why

    def made(self, ctx: click.Context, folder: Path) -> InForce:
        """Return what is in force for inputs of a folder.

        Raises:
            BadSettings: a settings file is wrong.
        """
        certificate = ctx.params.get("certificate")
        repeats = "program" in ctx.params and certificate and Path(certificate).exists()
        # A certificate says how its program was made; what the shop does today is beside the point.
        return in_force(
            self, ctx, folder, files=not (repeats or ctx.meta.get(f"{META}.off", False))
        )


class ReadsPrograms(Configured):
    """A command that reads programs and compiles none.

    Of the settings it takes ``d`` and what is said of programs that are read; the profile is asked
    for each program (`profile_for`), as a shop has machines of several formats. A command that is
    given no program takes none.
    """

    def made(self, ctx: click.Context, folder: Path) -> InForce:
        """Return what is in force for programs of a folder."""
        if "block" in ctx.params and ctx.params["block"] is None:  # explain CODE
            return InForce(params=dict(ctx.params))
        return super().made(ctx, folder)


def profile_for(format_: str | None, keys: Iterable[str] = ("profile",)) -> Setting | None:
    """Return the nearest setting of a profile that is for a format; for any where it is None."""
    from wedmcam.cli import asked as ask

    made: InForce = click.get_current_context().meta[META]
    for setting in (file.settings.get(key) for file in made.files for key in keys):
        if setting and format_ in (None, ask.machine_of(setting.value, None).format):
            return setting
    return None


def machine_for(program: str, profile: str | None, format_: str | None = None) -> Machine | None:
    """Return the machine to read a program with: as typed, else as set for its format, else None.

    Raises:
        WrongUse: no such profile, or one of another format.
    """
    from wedmcam.cli import asked as ask

    if profile:
        return ask.machine_of(profile, format_)
    wanted = format_ or _format_of_program({"program": program}) or "none"
    setting = profile_for(wanted, reversed(PROFILES))
    return ask.machine_of(setting.value, None) if setting else None


def _input(params: Mapping[str, Any]) -> str | None:
    names = ("input_", "against", "program", "file", "a", "what")
    name = next((params[k] for k in names if params.get(k)), None)
    return name if isinstance(name, str) else None


def located(why: Exception, made: InForce) -> BadSettings | None:
    """Return wrong use as a finding in the settings file that it came from, if it did."""
    from wedmcam.diag import error

    for key in re.findall(r"--([a-z][a-z-]*)", str(why)):
        setting = made.settings.get(key)
        if setting is not None:
            text = next(f.text for f in made.files if f.name == setting.span.file)
            return BadSettings([(error("settings-value", str(why), setting.span), text)])
    return None


def by_folder(ctx: click.Context, how: Callable[[dict[str, Any]], How]) -> Callable[[str], How]:
    """Return ``how`` as a function of a drawing's name: with the settings of its own folder.

    What is wrong without any settings is wrong use at once; what a settings file makes wrong is
    the matter of its folder alone.
    """
    from wedmcam.cli.batch import How
    from wedmcam.options import WrongUse

    command = ctx.command
    assert isinstance(command, Configured)
    made: dict[Path, How] = {}

    def of(name: str) -> How:
        folder = folder_of(name)
        if folder not in made:
            made[folder] = _one(folder)
        return made[folder]

    def _one(folder: Path) -> How:
        force: InForce | None = None
        try:
            force = command.made(ctx, folder)
            return how(force.params)
        except BadSettings as why:
            return How(wrong=why.message)
        except WrongUse as why:
            wrong = located(why, force) if force else None
            if wrong is None:
                raise
            return How(wrong=wrong.message)

    return of
