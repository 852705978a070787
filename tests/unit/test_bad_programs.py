"""Programs that are wrong in one way each: the first lines of a file say what is to be found.

``tests/bad/*.3b``: ``; line:column severity[code]``. ``tests/bad/*.zd.txt``: bytes in hex, after
``# address severity[code]``. No place: the finding is about the whole file.
"""

import re
from pathlib import Path

import pytest

from wedmcam.diag import ByteSpan, FileSpan, TextSpan
from wedmcam.frontends import decoder
from wedmcam.machines import builtin, default

BAD = Path(__file__).parents[1] / "bad"
EXPECTED = re.compile(r"^[;#] (?:(\S+) )?(note|warning|error)\[([a-z0-9-]+)\]$", re.M)


def place(span):
    match span:
        case TextSpan():
            return f"{span.line}:{span.column}"
        case ByteSpan():
            return f"{span.start:#06x}"
        case FileSpan():
            return ""


@pytest.mark.parametrize(
    "path",
    sorted([*BAD.glob("*.3b"), *BAD.glob("*.zd.txt"), *BAD.glob("*.nc")]),
    ids=lambda p: p.name,
)
def test_bad_program(path):
    text = path.read_text("ascii")
    want = {(where, severity, code) for where, severity, code in EXPECTED.findall(text)}
    assert want
    if path.suffix in (".3b", ".nc"):
        format_, data = {".3b": "3b", ".nc": "iso"}[path.suffix], text.encode()
    else:
        format_, data = "compact", bytes.fromhex(re.sub("#.*", "", text))
    machine = builtin("iso-um") if format_ == "iso" else default(format_)
    _, found = decoder(format_)(data, machine, path.name)
    got = {(place(d.span), str(d.severity), d.code) for d in found}
    # The lines that state what is expected are comments, and reported as such.
    assert want <= got
    assert {code for _, _, code in got} <= {code for _, _, code in want} | {"text-skipped"}
    assert all(d.message for d in found)


def test_there_are_cases():
    assert len(list(BAD.glob("*.3b"))) > 15
    assert len(list(BAD.glob("*.zd.txt"))) > 10
