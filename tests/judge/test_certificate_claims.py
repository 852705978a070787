"""Certificates that lie, that are none, and honest ones of other versions."""

from __future__ import annotations

import copy
import json
from dataclasses import replace

import lead_forgeries as lf
import pytest

import wedmcam
from wedmcam import api
from wedmcam.api import options_in_mm
from wedmcam.diag import Severity
from wedmcam.judge import claims
from wedmcam.options import WrongUse

DRAWING = lf.plate()  # another call would write another date


@pytest.fixture(scope="module")
def made():
    return api.compile(DRAWING, offset=0.05, lead=0.15, output_name="a.3b", name="a.dxf")


@pytest.fixture(scope="module")
def honest(made):
    return json.loads(json.dumps(made.summary))


def proof(made, certificate, **more):
    return api.verify(
        made.data,
        against=DRAWING,
        against_name="a.dxf",
        name="a.3b",
        certificate=certificate,
        **more,
    )


def said(found, severity=Severity.ERROR):
    return [d.message for d in found if d.code == "certificate-differs" and d.severity == severity]


def test_an_honest_certificate_holds_without_a_word(made, honest):
    done = proof(made, honest)
    assert done.status == 0
    assert not [d for d in done.findings if d.code == "certificate-differs"]


def test_options_without_effect_are_told_to_whoever_typed_them():
    """An honest certificate holds, whether they were typed for the compile or for the proof."""
    for compiled, proven in ((None, frozenset()), (frozenset(), None)):
        asked = options_in_mm(offset=0.05, lead=0.15, ignore_layers=["C*"])
        typed = replace(asked, wishes=compiled)
        made = api.compile(DRAWING, options=typed, output_name="a.3b", name="a.dxf")
        issued = json.loads(json.dumps(made.summary))
        done = proof(made, issued, options=replace(asked, wishes=proven))
        assert done.status == 0, [d.message for d in done.findings]
        told = ["filter-unmatched" in {d.code for d in of.findings} for of in (made, done)]
        assert told == [compiled is None, proven is None]


LIES = {
    "offset_um": 200.0,
    "side": "die",
    "units": "inch",
    "format": "iso",
    "origin_um": [0, 1],
    "path_mm": 1.0,
    "extents_um": [0, 0, 1, 1],
    "cuts": [],
    "contours": 2,
    "blocks": 1,
    "steps": 1,
    "moves": 0,
    "controls": 99,
    "closure_um": 3.0,
    "max_deviation_um": 0.5,
    "lead_deviation_um": 0.5,
    "gouge_um": None,
    "uncut_um": 7.0,
    "join_um": 1.0,
    "spline_um": 1.0,
    "count": "textbook",
    "limits": {"path_um": 20.0, "gouge_um": 1.6},
    "step_um": 5,
    "arithmetic": "float64",
    "profile": "b3-columns",
    "diagnostics": [{"severity": "note", "code": "joined", "message": "", "count": 1}],
    "d_um": {"1": 100.0},
    "ok": False,
}


@pytest.mark.parametrize("key", LIES)
def test_field_cert_lies(made, honest, key):
    assert honest.get(key) != LIES[key]
    done = proof(made, honest | {key: LIES[key]}, profile=made.machine)
    assert done.status == 3
    assert any(key.rstrip("s") in text or key == "diagnostics" for text in said(done.findings))


def test_every_lie_within_a_row_is_named(made, honest):
    for key, value in honest["cuts"][1].items():
        lie = copy.deepcopy(honest)
        lie["cuts"][1][key] = not value if isinstance(value, bool) else (value or 0) + 1
        done = proof(made, lie)
        assert done.status == 3
        (text,) = said(done.findings)
        assert text.startswith(f"the certificate says cuts[2].{key} ")


def test_many_lies_are_capped(made, honest):
    lie = copy.deepcopy(honest)
    for cut in lie["cuts"]:
        for key in ("steps", "blocks", "first_block", "last_block", "length_mm"):
            cut[key] += 1
    texts = said(proof(made, lie).findings)
    assert len(texts) == claims.LISTED + 1
    assert texts[-1] == "and 5 more are other than found"


def test_what_a_certificate_says_is_text_and_no_template(honest):
    """Braces of a layer, a key, a code or a version stay as they are, and JSON has the values."""
    stated = copy.deepcopy(honest) | {"layers": ["{A}"], "{count}": "{0}", "version": "{figure}"}
    stated["options"] = honest["options"] | {"side": "{now}"}
    stated["diagnostics"] = [{"severity": "note", "code": "{}", "message": "", "count": 1}]
    found = claims.differences(stated, honest | {"layers": ["{B}"]}, ())
    texts = [d.message for d in found]
    assert 'the certificate says layers[1] "{A}", the program has "{B}"' in texts
    assert 'the certificate says {count} "{0}", there is none' in texts
    assert "the certificate says 1 note[{}], found: 0" in texts
    assert any('options.side "{now}", asked for is' in text for text in texts)
    assert 'the certificate is of version "{figure}"' in {d.hint for d in found}
    (layer,) = [d for d in found if "layers" in d.message]
    assert {
        "figure": "layers[1]",
        "stated": '"{A}"',
        "now": '"{B}"',
    }.items() <= layer.values.items()
    (error,) = claims.of_the_program(honest | {"blocks": "{x}"}, honest)
    assert error.message.startswith('the certificate says blocks "{x}", the program has ')


def test_names_words_and_versions_are_not_compared(made, honest):
    other = copy.deepcopy(honest) | {"input": "b.dxf", "output": "b.3b", "version": "99"}
    other["sha256"]["profile"] = "0" * 64
    for d in other["diagnostics"]:
        d["message"], d["hint"] = "x", "y"
    done = proof(made, other)
    assert done.status == 0
    (text,) = said(done.findings, Severity.NOTE)
    assert "sha256.profile" in text


def test_a_changed_count_of_findings_is_seen(honest):
    made = api.compile(DRAWING, output_name="a")  # no offset: a warning
    stated = json.loads(json.dumps(made.summary))
    assert [d["code"] for d in stated["diagnostics"]] == ["no-offset"]

    def status(diagnostics):
        cert = stated | {"diagnostics": diagnostics}
        return api.verify(made.data, against=DRAWING, certificate=cert).status

    (one,) = stated["diagnostics"]
    assert status([one]) == 0
    assert status([]) == 3
    assert status([one, one]) == 3
    assert status([one | {"count": 2}]) == 3
    assert status([one | {"severity": "note"}]) == 3


@pytest.mark.parametrize("key", claims._KEYS)
def test_field_cert_no_origin(made, honest, key):
    """A certificate without any one of its keys, or with another type there, is none."""
    without = {k: v for k, v in honest.items() if k != key}
    with pytest.raises(WrongUse, match=f"no certificate: it does not say '{key}'"):
        proof(made, without)
    for value in WRONG:
        if claims._KEYS[key](value):
            continue
        with pytest.raises(WrongUse, match=r"no certificate"):
            proof(made, honest | {key: value})


WRONG = [
    *(None, True, -1, 1.5, "x", [], {}, [[]], [None, None], [1], [1, 2, 3], {"x": 1}),
    *(float("nan"), float("inf"), 10**400, [1e300, 0], [[1], [2]], [{}], [{"number": 1}]),
]


def test_every_value_of_another_type_is_refused_or_compared(made, honest):
    """Nothing in a certificate breaks the program: each leaf, and each table, replaced by all."""

    def spots(value, path=()):
        yield path
        if isinstance(value, dict):
            for k, v in value.items():
                yield from spots(v, (*path, k))
        elif isinstance(value, list):
            for k, v in enumerate(value[:1]):
                yield from spots(v, (*path, k))

    tried = 0
    for path in list(spots(honest)):
        for value in WRONG:
            other = copy.deepcopy(honest)
            if not path:
                other = value
            else:
                at = other
                for step in path[:-1]:
                    at = at[step]
                at[path[-1]] = value
            if claims.fault(other):
                tried += 1
                continue
            if path[0] == "options" or tried % 40:  # a proof takes a while
                tried += 1
                continue
            tried += 1
            try:
                assert proof(made, other).status in (0, 1, 3)
            except WrongUse:
                continue
    assert tried > 500


@pytest.mark.parametrize(
    "options",
    [
        *(
            {name: value}
            for name in ("layers", "transforms", "defines")
            for value in (5, "ab", [1])
        ),
        *({name: value} for name in ("join_um", "offset_um") for value in ("x", [], float("nan"))),
        *({name: value} for name in ("cuts", "d", "starts_um") for value in (5, [1], [[]], "ab")),
        *({name: "yes"} for name in ("sharp", "trim", "reverse", "backwards")),
        *({name: 5} for name in ("units", "source", "count", "arithmetic", "side", "order")),
        *({name: value} for name in ("from_block",) for value in (1.5, None, 10**30)),
        {"nothing": 1},
        {"wishes": ["x"]},
    ],
)
def test_options_of_another_type_are_refused(made, honest, options):
    with pytest.raises(WrongUse):
        proof(made, honest | {"options": {**honest["options"], **options}})


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[" * 100_000, "nested too deeply"),
        ('{"a": 1, "a": 2}', "says 'a' twice"),
        ('{"a": NaN}', "NaN is no number"),
        ("[]", "no table"),
        ("", "Expecting value"),
        ("\udcff".encode("utf-8", "surrogateescape"), "codec"),
        ('{"a": 1' + "0" * 5000 + "}", "digits"),
    ],
)
def test_what_is_no_certificate_says_why(text, why):
    with pytest.raises(ValueError, match=why):
        claims.parsed(text)


def test_a_certificate_gives_the_options(made, honest):
    done = proof(made, honest)
    assert done.status == 0
    assert done.summary["options"] == honest["options"]


def test_a_program_that_was_changed_is_told_where(made, honest):
    """A certificate that fits the changed program all the same: what is compiled is another."""
    lines = made.data.decode().split("\n")
    row = next(k for k, line in enumerate(lines) if line.startswith("B1800B0B1800GX"))
    lines[row] = (
        lines[row].replace("B1800B0B1800", "B1000B0B1000") + "\nB800B0B800" + lines[row][12:]
    )
    data = "\n".join(lines).encode()
    other = api.verify(data, against=DRAWING, certificate=honest)
    assert other.status == 0
    texts = said(other.findings, Severity.WARNING)
    assert "issued for another program" in texts[0]
    assert "other bytes and the same path" in texts[1]


def test_a_certificate_of_a_program_from_elsewhere_holds_too(made):
    """Written by verify: order and leads are its own, the next time as well."""
    foreign = api.compile(DRAWING, offset=0.05, lead=0.3, reverse=True)
    first = api.verify(foreign.data, against=DRAWING, offset=0.05, name="old.3b")
    assert first.status == 0
    assert first.summary["leads"] == "own"
    again = json.loads(json.dumps(first.summary))
    second = api.verify(foreign.data, against=DRAWING, certificate=again, name="old.3b")
    assert second.status == 0, [d.message for d in second.findings]
    lie = again | {"steps": again["steps"] + 1}
    assert api.verify(foreign.data, against=DRAWING, certificate=lie).status == 3


def test_without_a_drawing_the_program_itself_is_held_to_it(made, honest):
    assert wedmcam.verify(made.data, certificate=honest).status == 0
    assert wedmcam.verify(made.data, certificate=honest | {"steps": 1}).status == 3


def test_of_another_drawing_what_the_program_is_by_itself_is_compared(made, honest):
    for lie, status in (({}, 0), ({"steps": 1}, 3), ({"path_mm": 1.0}, 3)):
        done = api.verify(made.data, against=lf.plate(), certificate=honest | lie)
        assert done.status == status
        (text,) = said(done.findings, Severity.WARNING)
        assert "another drawing" in text
