"""``wedmcam identify``: which format a file is in."""

from __future__ import annotations

from wedmcam import api
from wedmcam.cli.files import read_input, shown_name
from wedmcam.cli.tables import identification, memory_of
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import Diagnostic
from wedmcam.frontends.identify import identify
from wedmcam.frontends.iso.dialect import QUESTIONS
from wedmcam.judge.certificate import finding_data


def run_identify(file: str, json_: bool) -> int:
    """Run ``wedmcam identify``; return the exit status."""
    data = read_input(file)
    seen = identify(data)
    findings = _open_questions(data, file) if seen.format == "iso" else []
    print_findings(findings, file)
    if json_:
        diagnostics = [finding_data(d) for d in findings]
        print_json({"file": file, **identification(seen), "diagnostics": diagnostics})
    else:
        print_text(f"{file}: {seen.reason}{memory_of(seen)}")
    return 1 if seen.format in ("unknown", "empty") else 0


def _open_questions(data: bytes, file: str) -> list[Diagnostic]:
    """Return what an ISO program leaves open to its machine."""
    _, _, findings = api.read_program(data, format="iso", name=shown_name(file), shown=True)
    return [d for d in findings if d.code in QUESTIONS]
