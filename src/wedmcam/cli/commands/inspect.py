"""``wedmcam inspect``: what is in a drawing."""

from __future__ import annotations

from typing import Any

import click

from wedmcam import api
from wedmcam.cli import asked as ask
from wedmcam.cli.files import read_input, shown_name
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import Configured
from wedmcam.cli.tables import print_inspection
from wedmcam.cli.terminal import print_findings, print_json
from wedmcam.ir.plan import Side
from wedmcam.options import FILTERS, Options


@click.command("inspect", cls=Configured)
@click.argument("input_", metavar="INPUT")
@ask.drawing_options
@click.option("--side", type=ask.SIDES, help="For the largest offset: part (default) or die.")
@ask.layer_side_option
@ask.said_options
def inspect_command(input_: str, **params: Any) -> int:
    """What the reader saw: units, size, entities, contours, gaps, the largest offset that fits."""
    ask.check_source(input_, params["from_"])
    options = _options(params)
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


def _options(params: dict[str, Any]) -> Options:
    """Return the options that a drawing is looked at with."""
    side = Side.DIE if params["side"] == "die" else None
    return Options(
        units=params["units"],
        fill_in_units=params.get("fill_in_units", False),
        **{name: params[name] for name in FILTERS},
        join_um=params["join_um"],
        tolerance_um=params["tolerance_um"],
        thin_wall_um=params["thin_wall_um"],
        transforms=params["transforms"],
        arithmetic=params["arithmetic"],
        side=side,
        layer_sides=(sides := ask.sides_of(params)),
        offset_um=1.0 if side or sides else None,  # a side needs one; it is not used
        strict=params["strict"],
        wishes=ask.wishes_of(params),
    )
