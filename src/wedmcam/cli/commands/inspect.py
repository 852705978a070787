"""``wedmcam inspect``: what is in a drawing."""

from __future__ import annotations

from typing import Any

import click

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli.files import read_input, shown_name
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import Configured
from wedmcam.cli.tables import print_inspection
from wedmcam.cli.terminal import print_findings, print_json


@click.command("inspect", cls=Configured)
@click.argument("input_", metavar="INPUT")
@ask.drawing_options
@ask.side_option
@ask.layer_side_option
@ask.said_options
def inspect_command(input_: str, **params: Any) -> int:
    """What the reader saw: units, size, entities, contours, gaps, the largest offset that fits."""
    ask.check_source(input_, params["from_"])
    options = ask.options_to_inspect(params, params["side"], params["layer_sides"])
    data, name = read_input(input_), shown_name(input_)
    with waiting(f"inspecting {name}"):
        inspection = api.inspect(data, name=name, options=options)
    texts: dict[str, str | bytes] = {name: data, **options.texts}
    print_findings(inspection.findings, name, params["quiet"], texts)
    if params["json_"]:
        print_json(inspection.facts)
    elif inspection.drawn is not None:
        print_inspection(inspection.facts, params["verbose"])
    return inspection.status
