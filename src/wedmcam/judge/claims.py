"""What a certificate claims, held against what is found now.

A certificate is a file like any other: it may be cut short, edited or made up. Here its shape is
looked at before anything is taken from it, and each of its figures is compared with the one that
was derived again. Not compared are names of files, the version, and the words of findings.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from wedmcam.diag import Diagnostic, error, note

#: Figures that are listed one by one; of the others their number.
LISTED = 10

#: Figures are rounded up to a nanometre: so far two of the same may lie apart, um.
ROUNDING = 0.002

#: No figure of a program is larger, um or steps; beyond it sums would lose their digits.
LARGEST = 1e12

#: Names, which may be others tomorrow, and what the rest follows from. ``starts_of`` and the text
#: of the profile say how to plan and to read; the fingerprint of the profile is compared.
NOT_FIGURES = {
    *("input", "output", "version", "diagnostics", "ok", "metamorphic", "leads"),
    *("starts_of", "starts_of_toml", "profile_toml"),
}

#: Codes that tell how this very certificate or the place was found, and not what the program is;
#: and those of options without effect, or not given, which are told only to whoever typed them.
OF_THE_PROOF = {
    *("certificate-differs", "origin-fitted"),
    *("filter-unmatched", "idle-option", "wed-option", "default-profile"),
}

#: What a proof is asked for with; whoever types other options than a certificate has means them.
_OPTIONS = ("options.", "number of options.")

Fits = Callable[[Any], bool]

#: Template of a finding and its values: what a certificate says is text of a user, no template.
_Difference = tuple[str, dict[str, Any]]

_ANOTHER = "the certificate says {figure} {stated}, the program has {now}"
_TOO_MANY = "the certificate says {figure} {stated}, there is none"
_MISSING = "the certificate does not say {figure}, the program has {now}"
_OPTION = "the certificate says {figure} {stated}, asked for is {now}"
_OF_FINDINGS = "the certificate says {stated} {finding}, found: {now}"
_CHANGED = "the certificate was changed: compile again"


def _whole(value: Any) -> bool:
    return type(value) is int and abs(value) <= LARGEST


def _natural(value: Any) -> bool:
    return _whole(value) and value >= 0


def _number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= LARGEST  # NaN is not


def _figure(value: Any) -> bool:
    return value is None or _number(value)


def _text(value: Any) -> bool:
    return isinstance(value, str)


def _name(value: Any) -> bool:
    return value is None or isinstance(value, str)


def _truth(value: Any) -> bool:
    return isinstance(value, bool)


def _numbers(count: int) -> Fits:
    return lambda v: isinstance(v, list) and len(v) == count and all(map(_number, v))


def _holds(keys: Mapping[str, Fits]) -> Fits:
    return lambda v: isinstance(v, dict) and all(k in v and fits(v[k]) for k, fits in keys.items())


def _rows(keys: Mapping[str, Fits]) -> Fits:
    one = _holds(keys)
    return lambda v: isinstance(v, list) and all(map(one, v))


_FINDING: dict[str, Fits] = {
    "severity": lambda v: v in ("note", "warning", "error"),
    "code": _text,
    "message": _text,
    "count": _natural,
}
_CUT: dict[str, Fits] = {
    **dict.fromkeys(("number", "first_block", "last_block", "blocks", "steps"), _natural),
    **dict.fromkeys(("closure_um", "max_deviation_um", "lead_deviation_um"), _figure),
    "closed": _truth,
    "length_mm": _number,
    "backwards": _truth,
}
#: What every certificate of a program says.
_KEYS: dict[str, Fits] = {
    **dict.fromkeys(("input", "output"), _name),
    **dict.fromkeys(("format", "units", "side", "profile", "version", "arithmetic"), _text),
    **dict.fromkeys(("contours", "blocks", "steps", "moves", "controls"), _natural),
    **dict.fromkeys(("closure_um", "max_deviation_um", "gouge_um"), _figure),
    **dict.fromkeys(("lead_deviation_um", "uncut_um", "join_um", "spline_um"), _figure),
    **dict.fromkeys(("offset_um", "path_mm"), _number),
    "origin_um": _numbers(2),
    "extents_um": _numbers(4),
    "step_um": lambda v: _number(v) and v > 0,
    "ok": _truth,
    "count": lambda v: v in ("exact", "textbook"),
    "limits": _holds({"path_um": _number, "gouge_um": _number}),
    "diagnostics": _rows(_FINDING),
    "cuts": _rows(_CUT),
    "options": lambda v: isinstance(v, dict),
    "sha256": _holds(dict.fromkeys(("input", "output", "profile"), _text)),
}


#: What some say.
def _entered(entry: tuple[str, Any]) -> bool:
    """Return whether this is an entry for a figure in rotation format."""
    name, value = entry
    if name in ("lead_in_um", "lead_out_um"):
        pair = isinstance(value, list) and len(value) == 2 and all(map(_number, value))
        return value is None or pair
    return name in ("copies", "angle_deg") and _number(value)


_MORE: dict[str, Fits] = {
    **dict.fromkeys(("profile_toml", "starts_of", "starts_of_toml", "leads"), _text),
    **dict.fromkeys(
        ("stepped_closure_um", "stepped_max_deviation_um", "stepped_gouge_um"), _figure
    ),
    "entered": lambda v: isinstance(v, dict) and all(map(_entered, v.items())),
    "d_is": lambda v: v == "diameter",
    "d_um": lambda v: isinstance(v, dict) and all(map(_number, v.values())),
}


def parsed(text: str | bytes) -> dict[str, Any]:
    """Return a certificate from its JSON text.

    Raises:
        ValueError: it is none; the text says why.
    """

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        twice = [key for key, n in Counter(key for key, _ in pairs).items() if n > 1]
        if twice:
            raise ValueError(f"it says '{twice[0]}' twice")
        return dict(pairs)

    def no_number(word: str) -> float:
        raise ValueError(f"{word} is no number")

    try:
        data = json.loads(text, object_pairs_hook=once, parse_constant=no_number)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    if why := fault(data):
        raise ValueError(why)
    assert isinstance(data, dict)
    return data


def fault(data: Any) -> str:
    """Return what is wrong with the shape of a certificate; empty where nothing is.

    >>> fault({"input": "a.dxf"})
    "it does not say 'output'"
    """
    if not isinstance(data, dict):
        return "it is no table of figures"
    for key, fits in _KEYS.items():
        if key not in data:
            return f"it does not say '{key}'"
        if not fits(data[key]):
            return f"'{key}' is not what a certificate says there"
    for key, fits in _MORE.items():
        if key in data and not fits(data[key]):
            return f"'{key}' is not what a certificate says there"
    return ""


def differences(
    stated: Mapping[str, Any], now: Mapping[str, Any], findings: Iterable[Diagnostic]
) -> list[Diagnostic]:
    """Return a finding for each figure of a certificate that is not the one derived again.

    Args:
        stated: the certificate, without a `fault`.
        now: the certificate that would be written now.
        findings: findings of its program as they would stand in it.

    A figure that is another is an error. So is, from the same version, one that is
    missing or too many, and another code or count of findings; from another version these are
    notes. So is another fingerprint of the profile: what follows from its values is compared.
    Options are what was asked for: of others that is a note.
    """
    same_version = stated["version"] == now["version"]
    claims = dict(_leaves({k: v for k, v in stated.items() if k not in NOT_FIGURES}))
    figures = dict(_leaves({k: v for k, v in now.items() if k not in NOT_FIGURES}))
    # What makes warnings errors is a wish of whoever asks. Both files are known to be the same.
    for name in ("options.strict", "sha256.input", "sha256.output"):
        claims.pop(name, None)
        figures.pop(name, None)
    for name in [name for name in figures if name.startswith("number of ")]:
        if name in claims and claims[name] != figures[name]:  # then rows are not compared
            rows = name.removeprefix("number of ") + "["
            claims = {k: v for k, v in claims.items() if not k.startswith(rows)}
            figures = {k: v for k, v in figures.items() if not k.startswith(rows)}
    wrong: list[_Difference] = []
    other: list[_Difference] = []
    options: list[_Difference] = []
    loose = wrong if same_version else other
    for name in [*figures, *(name for name in claims if name not in figures)]:
        if name.startswith(_OPTIONS):
            if not (name in claims and name in figures and _same(claims[name], figures[name])):
                said, asked = (
                    _shown(of[name]) if name in of else "nothing" for of in (claims, figures)
                )
                options.append((_OPTION, {"figure": name, "stated": said, "now": asked}))
        elif name not in figures:
            loose.append((_TOO_MANY, {"figure": name, "stated": _shown(claims[name])}))
        elif name not in claims:
            loose.append((_MISSING, {"figure": name, "now": _shown(figures[name])}))
        elif not _same(claims[name], figures[name]):
            # Versions print the same profile otherwise; and all that follows from it is compared.
            which = other if name == "sha256.profile" else wrong
            which.append(_another(name, claims[name], figures[name]))
    if not stated["ok"]:
        wrong.append(("the certificate says ok false: it is of a program that failed", {}))
    loose.extend(_findings(stated["diagnostics"], findings))
    return [
        *_capped(wrong, error, _CHANGED),
        *_capped(options, note, "what is asked for is proven"),
        *_capped(
            other,
            note,
            "the certificate is of version {issued}",
            issued=_shown(stated["version"]),
        ),
    ]


def of_the_program(stated: Mapping[str, Any], now: Mapping[str, Any]) -> list[Diagnostic]:
    """Return an error for each figure that a program has by itself, and its certificate otherwise.

    Args:
        stated: the certificate, without a `fault`.
        now: of ``judge.figures``.
    """
    names = ("blocks", "steps", "moves", "controls", "path_mm")
    wrong = [
        _another(name, stated[name], now[name])
        for name in names
        if not _same(stated[name], now[name])
    ]
    return list(_capped(wrong, error, _CHANGED))


def _another(name: str, stated: Any, now: Any) -> _Difference:
    return _ANOTHER, {"figure": name, "stated": _shown(stated), "now": _shown(now)}


def _capped(
    differences: list[_Difference], say: Callable[..., Diagnostic], hint: str, **more: str
) -> Iterator[Diagnostic]:
    """Yield a finding for each of the first differences; ``more`` are values of the hint."""
    for template, values in differences[:LISTED]:
        yield say("certificate-differs", template, hint=hint, **values, **more)
    if (rest := len(differences) - LISTED) > 0:
        yield say("certificate-differs", "and {count} more are other than found", count=rest)


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the figures of nested data with their names: ``cuts[2].steps``."""
    if isinstance(value, dict):
        for key, one in value.items():
            yield from _leaves(one, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list | tuple):
        yield f"number of {name}", len(value)
        for k, one in enumerate(value, 1):
            yield from _leaves(one, f"{name}[{k}]")
    else:
        yield name, value


def _same(stated: Any, now: Any) -> bool:
    if isinstance(stated, bool) or isinstance(now, bool):
        return stated is now
    if isinstance(stated, int) and isinstance(now, int):
        return stated == now
    if isinstance(stated, int | float) and isinstance(now, int | float):
        return _number(stated) and math.isfinite(now) and abs(stated - now) <= ROUNDING
    return bool(stated == now)


def _shown(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=True, default=str)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _findings(stated: list[dict[str, Any]], findings: Iterable[Diagnostic]) -> list[_Difference]:
    """Return in which codes the findings of a certificate are others, or more or fewer."""
    claimed: Counter[tuple[str, str]] = Counter()
    for d in stated:
        claimed[d["severity"], d["code"]] += d["count"]
    now: Counter[tuple[str, str]] = Counter()
    for one in findings:
        now[str(one.severity), one.code] += one.count
    return [
        (
            _OF_FINDINGS,
            {
                "stated": claimed[key],
                "finding": f"{key[0]}[{_shown(key[1])[1:-1]}]",
                "now": now[key],
            },
        )
        for key in sorted({*claimed, *now})
        if key[1] not in OF_THE_PROOF and claimed[key] != now[key]
    ]
