"""``wedmcam verify``: prove a program against its drawing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from wedmcam import api
from wedmcam.cli import options as ask
from wedmcam.cli import report
from wedmcam.cli.files import Failed, read_input, read_program, shown_name, write_outputs
from wedmcam.cli.outputs import (
    certificate_bytes,
    check_names,
    check_picture,
    picture,
    write_refused,
)
from wedmcam.cli.progress import waiting
from wedmcam.cli.settings import typed
from wedmcam.cli.terminal import print_findings, print_json
from wedmcam.compiler.results import Proof
from wedmcam.judge.claims import parsed
from wedmcam.operations.profiles import reader_machine
from wedmcam.programs.places import with_time
from wedmcam.targets.entries import GAPPED


def run_verify(
    program: str,
    against: str | None,
    format_: str | None,
    origin: tuple[float, float] | None,
    fit_origin: bool,
    certificate: str | None,
    plot_: str | None,
    metamorphic: bool,
    **params: Any,
) -> int:
    """Run ``wedmcam verify``; return the exit status."""
    given = typed(click.get_current_context())
    issued = _read_certificate(certificate)
    if issued is not None:
        against = against if against is not None else _drawing_of(issued, str(certificate))
        params = ask.as_issued(params, issued, given)
    entered = ask.entered_in(params)
    named = ask.profile_in(params, given)
    machine = ask.machine_of(named, format_) if named else None
    data = read_program(program)
    if params["gap_um"] is not None and params["wire_um"] is None:
        read_as = reader_machine(data, shown_name(program), format_, machine)
        params = _gap_entered(params, given, read_as.format)
    options = ask.options_of(params)
    new_certificate = None if issued else certificate
    outputs = [name for name in (plot_, new_certificate) if name is not None]
    check_names([program, *([against] if against else [])], outputs)
    check_picture(plot_)
    if against is None:
        _warn_without_drawing()
    drawing = None if against is None else read_input(against)
    with waiting(f"verifying {shown_name(program)}"):
        proof = api.verify(
            data,
            against=drawing,
            profile=machine,
            format=format_,
            name=shown_name(program),
            against_name=against,
            origin_mm=None if origin is None else (origin[0] / 1000, origin[1] / 1000),
            fit_origin=fit_origin,
            entered=entered if entered.stated else None,
            certificate=issued,
            options=options,
        )
    texts: dict[str, str | bytes] = {}
    if against is not None and drawing is not None:
        texts = {against: drawing, **options.texts}
    if metamorphic:
        if against is None or drawing is None:
            raise click.UsageError("--metamorphic compiles the drawing: give --against INPUT")
        with waiting("compiling images"):
            proof = api.with_images(proof, drawing, against, options)
    print_findings(proof.findings, shown_name(program), params["quiet"], texts)
    _write(proof, program, new_certificate, plot_)
    return _report(proof, params)


def _warn_without_drawing() -> None:
    """Warn of options of a drawing where there is none."""
    names = {*ask.DRAWING_NAMES, *ask.PATH_NAMES} - {"offset_um", "wire_um", "gap_um", "side"}
    ask.warn_of_idle(names, "there is no --against DRAWING")


def _write(proof: Proof, program: str, certificate: str | None, plot: str | None) -> None:
    """Write the certificate of a good program, and the picture of what was decoded or refused."""
    files = []
    title = Path(program).name
    if certificate is not None and proof.ok:
        files.append((certificate, certificate_bytes(proof.summary)))
    if plot is not None and proof.program is not None:
        files.append((plot, picture(proof, title, plot)))
    write_outputs(files)
    if plot is not None and proof.program is None:
        write_refused(proof, title, plot, shown_name(program))


def _report(proof: Proof, params: dict[str, Any]) -> int:
    """Print the proof for people or for programs; return the exit status."""
    feed = ask.feed_of(params)
    if params["json_"]:
        print_json(with_time(proof.summary, feed))
    elif not params["quiet"]:
        report.print_proof(proof, params["verbose"])
        report.print_time(proof.summary, feed)
    return proof.status


def _gap_entered(params: dict[str, Any], given: set[str], format_: str) -> dict[str, Any]:
    """Return what was typed, with ``--gap`` as the operator enters it beside an outline.

    It is the whole offset there, and the ZD-065 puts arcs on the corners of what it offsets.
    """
    if format_ not in GAPPED or params["offset_um"] is not None:
        return params
    entered = {**params, "offset_um": params["gap_um"], "gap_um": None}
    if format_ == "compensation" and "corners" not in given:
        entered["corners"] = "paper"
    return entered


def _read_certificate(certificate: str | None) -> dict[str, Any] | None:
    """Return the certificate of a file; None where there is no file yet.

    Raises:
        UsageError: the file is no certificate.
    """
    if certificate is None or not Path(certificate).exists():
        return None
    try:
        return parsed(read_input(certificate))
    except ValueError as why:
        raise click.UsageError(f"{certificate} is no certificate: {why}") from why


def _drawing_of(issued: dict[str, Any], certificate: str) -> str:
    """Return the drawing that a certificate names: from here, or from a folder above it.

    Raises:
        Failed: it is not there.
    """
    name = str(issued.get("input") or "")
    folder = Path(certificate).resolve().parent
    places = [Path(name), *(above / name for above in (folder, *folder.parents))]
    for place in (*places, folder / Path(name).name):
        if name and place.is_file():
            return str(place)
    raise Failed(
        f"{certificate}: the drawing {name or '(none)'} of the certificate is not there, so "
        "nothing can be proven; give --against DRAWING"
    )
