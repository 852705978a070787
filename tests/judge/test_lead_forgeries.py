"""Leads in the proof: none of hundreds of forged ones passes; `benchmarks/bench_forgeries.py`."""

from __future__ import annotations

import lead_forgeries as lf
import numpy as np
import pytest

from wedmcam import api
from wedmcam.diag import Severity

#: Of the forgeries of a case every so many are tried here; the benchmark tries them all.
EVERY = {"3b": 2, "from a block": 1}


@pytest.mark.parametrize("name", lf.CASES)
def test_no_forged_lead_passes(name):
    made = lf.compiled(name)
    assert lf.passes(made, made.program, ours=True)
    assert lf.passes(made, made.program, ours=False)
    tried = forged(name)
    assert len(tried) > 3
    for f in tried:
        assert not lf.strict(made, f.program), f.name
        assert not lf.passes(made, f.program, ours=True), f.name
        if f.refused:
            assert not lf.passes(made, f.program, ours=False), f.name


def forged(name):
    """Return the forgeries of a case that are tried here."""
    return list(lf.forged(lf.compiled(name)))[:: EVERY.get(name, 7)]


def test_there_are_hundreds_of_them():
    assert sum(len(forged(name)) for name in lf.CASES) >= 300


def verified(made, text, *, ours):
    """Return what `verify --against` says of a program in text."""
    return api.verify(
        text.encode(),
        against=lf.plate(),
        name="a.3b",
        certificate=made.summary if ours else None,
        options=made.options,
    )


def says(proof, code):
    return [(d.severity, d.message) for d in proof.findings if d.code == code]


def test_field_no_leadout():
    """The last way out is missing: with a certificate and without one it is refused."""
    made = lf.compiled("3b")
    *body, last, end = made.data.decode().split()
    assert end == "DD"
    text = "\n".join([*body, end])
    for ours in (False, True):
        proof = verified(made, text, ours=ours)
        assert proof.status == 3
        said = " ".join(d.message for d in proof.findings)
        assert "the program does not end where the plan ends" in said
    assert verified(made, "\n".join([*body, last, end]), ours=False).status == 0


def test_field_circle_twice():
    made = lf.compiled("3b")
    lines = made.data.decode().split()
    circle = next(k for k, line in enumerate(lines) if "GYNR1" in line)
    text = "\n".join([*lines[: circle + 1], *lines[circle:]])
    proof = verified(made, text, ours=False)
    assert proof.status == 0
    (severity, said), *more = says(proof, "cut-twice")
    assert (severity, more) == (Severity.WARNING, [])
    assert said == f"cut 1 is run twice: block {circle + 2} runs it again"
    assert proof.verdict.contours == 3
    proof = verified(made, text, ours=True)
    assert proof.status == 3
    assert says(proof, "cut-twice") == [(Severity.ERROR, said)]


def test_a_way_in_or_out_in_more_blocks_is_the_same_way():
    made = lf.compiled("wed, one circle")
    lead_in, circle, lead_out, end = made.data.decode().split()
    assert (lead_in, lead_out) == ("B550B0B550GXL1", "B550B0B550GXL3")
    there, back = (["B300B0B300GX" + z, "B250B0B250GX" + z] for z in ("L1", "L3"))
    for lines in ([*there, circle, lead_out], [lead_in, circle, *back], [*there, circle, *back]):
        proof = api.verify(
            "\n".join([*lines, end]).encode(),
            against=lf.CASES["wed, one circle"][0].encode(),
            against_name="a.wed",
            name="a.3b",
            options=made.options,
        )
        assert proof.ok
        assert not {"path-deviation", "other-leads"} & {d.code for d in proof.findings}


@pytest.mark.parametrize("times", [2, 3])
def test_a_second_pass_is_proven_like_the_first(times):
    """A contour of its own once more, threaded anew; and one that is not where the first was."""
    made = lf.compiled("wed, one circle")
    *cut, end = made.data.decode().split()
    for passes, status in ((cut, 0), (["B545B0B545GXL1", "B545B0B2180GYNR1", "B545B0B545GXL3"], 3)):
        text = "\n".join([*cut, *(times - 1) * ["D", *passes], end])
        proof = api.verify(
            text.encode(),
            against=lf.CASES["wed, one circle"][0].encode(),
            against_name="a.wed",
            name="a.3b",
            options=made.options,
        )
        assert proof.status == status
        assert len(says(proof, "cut-twice")) == times - 1


def test_field_wrong_first_lead_in_is_refused_where_the_origin_is_fitted():
    made = lf.compiled("wed, one circle")
    lead_in, *rest = made.data.decode().split()
    assert lead_in == "B550B0B550GXL1"
    for um in (540, 549, 551, 560, 50):
        text = "\n".join([f"B{um}B0B{um}GXL1", *rest])
        proof = api.verify(
            text.encode(),
            against=lf.CASES["wed, one circle"][0].encode(),
            against_name="a.wed",
            name="a.3b",
            options=made.options,
        )
        assert proof.status == 3
        assert says(proof, "thread-point")


def test_other_leads_of_a_program_from_elsewhere_are_notes():
    """Threaded elsewhere, in by a bend, out straight: the part is what is proven."""
    made = lf.compiled("wed, one circle")
    _, circle, _, end = made.data.decode().split()
    text = "\n".join(["B150B200B200GYL1", "B300B200B300GXL4", circle, "B450B0B450GXL3", end])
    for origin in (None, (1.1, 1.0)):
        proof = api.verify(
            text.encode(),
            against=lf.CASES["wed, one circle"][0].encode(),
            against_name="a.wed",
            name="a.3b",
            origin_mm=origin,
            options=made.options,
        )
        assert proof.status == 0, [d.message for d in proof.findings]
        assert says(proof, "other-order")
        assert np.allclose(proof.program.origin, (1100, 1000))
