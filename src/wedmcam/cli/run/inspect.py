"""``wedmcam inspect``: what is in a drawing."""

from __future__ import annotations

from typing import Any

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli.files import read_input, shown_name
from wedmcam.cli.inspection import print_inspection
from wedmcam.cli.progress import waiting
from wedmcam.cli.terminal import print_findings, print_json


def run_inspect(input_: str, **params: Any) -> int:
    """Run ``wedmcam inspect``; return the exit status."""
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
