"""``wedmcam compile --to 3b,compact``: several programs of one source, all written or none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam.cli import asked as ask
from wedmcam.cli.files import check_outputs, read_input, write_outputs
from wedmcam.cli.pictures import picture, write_refused
from wedmcam.cli.progress import waiting
from wedmcam.cli.terminal import print_text


def compile_several(
    input_: str,
    output: str,
    to: str,
    certificate: str | None,
    map_: str | None,
    plot: str | None,
    **asked: Any,
) -> int:
    """Compile for each format of ``to``; names are ``output`` with the ending of each.

    Certificates and maps are one a program: ``FILE.json`` becomes ``FILE.3b.json``. The picture
    ``plot`` is of the first.
    """
    from wedmcam import api
    from wedmcam.cli import report, terminal
    from wedmcam.cli.settings import also_read
    from wedmcam.operations import together as several

    feed = ask.feed_of(asked)
    if output == "-":
        raise click.UsageError("several programs do not fit standard output: give -o NAME")
    formats = several.formats_of(to)
    machines = _machines(formats, asked["profile"])
    named = [ask.machine_of(asked["profile"], None).format] if asked["profile"] else []
    names = several.names_of(output, formats)
    beside = {
        "certificate": [_for(certificate, name) for name in names],
        "map": [_for(map_, name) for name in names],
    }
    check_outputs(
        [input_, *also_read(click.get_current_context())],
        [
            *names,
            *(n for some in beside.values() for n in some if n is not None),
            *([plot] if plot else []),
        ],
    )
    ask.check_source(input_, asked["from_"])
    name = "stdin" if input_ == "-" else input_
    options = ask.options_of(asked)
    data = read_input(input_)
    with waiting(f"compiling {name}"):
        made = several.compile_several(
            data, machines, name=name, output_names=names, options=options, named=named
        )
    terminal.print_findings(made.findings, name, asked["quiet"], {name: data, **options.texts})
    if not made.ok:
        if plot is not None:
            refused = next((one for one in made.made if not one.ok), made.made[0])
            write_refused(refused, Path(name).name, plot, name)
        print_text("no program was written", err=True)
        return made.status
    files: list[tuple[str, bytes]] = []
    for one, to_, issued, mapped in zip(
        made.made, names, beside["certificate"], beside["map"], strict=True
    ):
        assert one.data is not None
        files.append((to_, one.data))
        if issued is not None:
            files.append((issued, report.certificate_bytes(one.summary)))
        if mapped is not None:
            files.append((mapped, report.map_bytes(api.source_map(one))))
    if plot is not None:
        files.append((plot, picture(made.made[0], Path(names[0]).name, plot)))
    write_outputs(files)
    if not asked["quiet"]:
        for k, (one, to_) in enumerate(zip(made.made, names, strict=True)):
            report.print_report(one, to_, asked["verbose"], rows=k == 0)  # one plan serves all
        print_text(
            f"the same path in {len(names)} formats: at most {max(made.apart_um):.2f} um apart",
            err=True,
        )
        report.print_time(made.made[0].summary, feed)
    if asked["json_"]:
        terminal.print_json([report.with_time(one.summary, feed) for one in made.made])
    return 0


def _machines(formats: list[str], profile: str | None) -> list[Any]:
    """Return a machine a format; ``--profile`` is for the one of its format."""
    if profile is None:
        return [ask.machine_of(None, format_) for format_ in formats]
    named = ask.machine_of(profile, None)
    if not any(named.is_of(f) for f in formats):
        raise click.UsageError(
            f"the profile '{named.name}' is for {named.format}, not for {', '.join(formats)}"
        )
    return [named if named.is_of(f) else ask.machine_of(None, f) for f in formats]


def _for(name: str | None, program: str) -> str | None:
    """Return the name of what goes with one of several programs.

    >>> _for("plate.json", "out/plate.3b")
    'plate.3b.json'
    """
    if name is None:
        return None
    path = Path(name)
    return str(path.with_suffix(Path(program).suffix + path.suffix))
