"""What a G-code program leaves open to its machine, who says it, and what is asked where none does.

X10 is 10 mm to one controller and 10 um to another; a line before the first G90 or G91 is a place
to one and a way to the next. A file that does not say it itself is read as the user says, or as the
profile that the user names says. Where neither says it, a guess would be another part: what writes
or proves is refused with the question, what only shows goes on and says first what it assumed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, error, warning
from wedmcam.diag.lists import Listing
from wedmcam.frontends.iso.offsets import Entry
from wedmcam.frontends.iso.words import Words
from wedmcam.frontends.text import Plain, TextSpans, plain
from wedmcam.machines import Iso, Layout, builtin, names

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Of a line before the first G90 or G91; of one before the first G20, G21, G70 or G71.
UNSAID = -1

#: The last digit of a whole number in inches, where it has to be assumed: 0.0001 in, as most have.
INCH_DIGIT_NM = 2540
#: Codes of what a file leaves open: an answer is asked, or assumed.
QUESTIONS = frozenset(
    {"iso-coordinates", "iso-units", "iso-centres", "iso-semicolon", "subprogram"}
)
#: What answers a question beside its options.
_BY_PROFILE = "; or --profile-in NAME|FILE of the machine it was written for"


@dataclass(frozen=True, slots=True)
class Dialect:
    """What is said of a program beside its text; None where nothing says it.

    Attributes:
        coordinates: "absolute" or "incremental": before the first G90 or G91.
        units_nm: what 1 is in a number with a point before the first G20 or G21, nm.
        whole_nm: what 1 is in a number without a point, nm.
        centres: "start": I and J lead from the start of an arc to its centre; "absolute": under
            G90 they are the place of the centre; "to-start": from the centre to the start.
        semicolon: "comment" or "block": what stands behind ``;``.
        subprograms: "N-label", "O-number" or "none": which lines M98 runs.
        named: the profile is one that was named. It says what it has keys for.
        shown: the program is only shown: what is assumed is a warning, and no error.
        asks: what the profile leaves open is asked. Else the program is one of ours, and means what
            is written with that profile.
        leaves: keys of the named profile that are ``open``, see `completed`.
    """

    coordinates: str | None = None
    units_nm: int | None = None
    whole_nm: int | None = None
    centres: str | None = None
    semicolon: str | None = None
    subprograms: str | None = None
    named: bool = True
    shown: bool = False
    asks: bool = False
    leaves: frozenset[str] = frozenset()

    def is_open(self, said: str | int | None, key: str) -> bool:
        """Return whether neither an option nor a profile, by its key, says something."""
        return said is None and (not self.named or key in self.leaves)


#: Keys of a profile that may be open, and what is written then, or assumed of what is only shown.
_CLOSED = {"coordinates": "absolute", "integers": "um", "points": "mm", "ij": "start"}


def completed(said: Dialect, profile: Iso) -> tuple[Dialect, Iso]:
    """Return a dialect with what its profile says, if it was named; and the profile closed."""
    opened: dict[str, Any] = {k: v for k, v in _CLOSED.items() if getattr(profile, k) == "open"}
    closed = replace(profile, **opened) if opened else profile
    if not said.named:
        return said, closed
    leaves = frozenset(opened) if said.asks else frozenset()
    centres = said.centres or (None if "ij" in leaves else closed.ij)
    style = profile.subprograms if profile.subprograms != "none" else None
    return replace(
        said,
        centres=centres,
        semicolon=said.semicolon or profile.semicolon or None,
        subprograms=said.subprograms or style,
        leaves=leaves,
    ), closed


# --- questions ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Question:
    """Something that a file leaves open.

    Attributes:
        code: of the finding.
        at, length: where in the text it first matters.
        template: what the file says there, and what it may mean; ``{text}`` is what stands there.
        text: an excerpt.
        assumed: as what it is read where it is only shown.
        hint: the answers.
        count: in how many places it matters.
        by_profile: a profile that is named answers it too.
        values: of template and hint.
    """

    code: str
    at: int
    length: int
    template: str
    text: str
    assumed: str
    hint: str
    count: int = 1
    by_profile: bool = True
    values: Mapping[str, object] = field(default_factory=dict)

    def finding(self, spans: TextSpans, shown: bool) -> Diagnostic:
        """Return the question as an error, or as a warning that says what was assumed."""
        span = spans.at(self.at, self.length)
        if shown:
            start = warning(
                self.code,
                "assumed: {assumed}. ",
                span,
                count=self.count,
                assumed=self.assumed,
            )
        else:
            start = error(self.code, "", span, count=self.count)
        finding = start.extended(self.template, hint=self.hint, text=self.text, **self.values)
        return finding.extended(hint=_BY_PROFILE) if self.by_profile else finding


def of_coordinates(lines: Ints, w: Words, text: Plain, incremental: bool) -> list[Question]:
    """Return the question of lines with coordinates that stand before G90 and G91."""
    if not len(lines):
        return []
    first = int(lines[0])
    at, end = int(w.line_start[first]), int(w.line_end[first])
    return [
        Question(
            "iso-coordinates",
            at,
            max(end - at, 1),
            "{text}: no G90 or G91 stands before it: a place (absolute, G90) or a way "
            "(incremental, G91)?",
            text.excerpt(at, end),
            "incremental (G91)" if incremental else "absolute (G90)",
            "--coordinates-in absolute, or --coordinates-in incremental",
            len(np.unique(w.line_start[lines])),
        )
    ]


def of_units(words: Ints, w: Words, text: Plain) -> list[Question]:
    """Return the question of numbers with a point that stand before G20 and G21."""
    return _of_words(
        "iso-units",
        words,
        w,
        text,
        "{text}: a number with a point, and no G20 or G21 stands before it: mm or inch?",
        "mm",
        "--units-in mm, or --units-in inch",
    )


def of_whole(words: Ints, w: Words, text: Plain, inch: Bools, assumed: str) -> list[Question]:
    """Return the question of numbers without a point; ``inch``: whether G20 is in force."""
    if not len(words):
        return []
    first = abs(int(w.whole[words[0]]))
    return _of_words(
        "iso-units",
        words,
        w,
        text,
        "{text}: a number without a point: {least:.4f} in or {most} in?"
        if inch[0]
        else "{text}: a number without a point: {least:.3f} mm or {most} mm?",
        assumed="its last digit is 0.0001 in" if inch[0] else f"whole numbers are {assumed}",
        hint="--whole-in 0.0001in, or --whole-in inch; or --profile-in NAME|FILE of the machine it "
        "was written for (of wedmcam: iso-um, iso-mm), or in verify its --certificate"
        if inch[0]
        else "--whole-in um, or --whole-in mm; or --profile-in NAME|FILE of the machine it was "
        "written for (of wedmcam: iso-um, iso-mm), or in verify its --certificate",
        by_profile=False,
        least=first / (10_000 if inch[0] else 1000),
        most=first,
    )


def _of_words(
    code: str,
    words: Ints,
    w: Words,
    text: Plain,
    template: str,
    assumed: str,
    hint: str,
    by_profile: bool = True,
    **values: object,
) -> list[Question]:
    if not len(words):
        return []
    at, end = int(w.start[words[0]]), int(w.end[words[0]])
    places, word = len(np.unique(w.start[words])), text.excerpt(at, end)
    return [
        Question(
            code, at, max(end - at, 1), template, word, assumed, hint, places, by_profile, values
        )
    ]


def of_table(entries: list[Entry], said: Dialect, text: Plain, stated: bool) -> list[Question]:
    """Return the questions of units of a table of offsets; ``stated``: the file says mm or inch."""
    questions = []
    pointed, whole = [e for e in entries if e.pointed], [e for e in entries if e.whole]
    if pointed and said.is_open(said.units_nm, "points") and not stated:
        at, end = pointed[0].at, pointed[0].end
        questions.append(
            Question(
                "iso-units",
                at,
                end - at,
                "{text}: an offset with a point, and no G20 or G21 in the file: mm or inch?",
                text.excerpt(at, end),
                "mm",
                "--units-in mm, or --units-in inch",
                len(pointed),
            )
        )
    if whole and said.is_open(said.whole_nm, "integers"):
        at, end = whole[0].at, whole[0].end
        questions.append(
            Question(
                "iso-units",
                at,
                end - at,
                "{text}: an offset without a point: what is its last digit?",
                text.excerpt(at, end),
                "as the whole numbers of the default profile",
                "--whole-in um, or --whole-in mm",
                len(whole),
            )
        )
    return questions


def of_centres(line: int, count: int, w: Words, text: Plain) -> list[Question]:
    """Return the question of a file in which no arc tells from where I and J count."""
    at, end = int(w.line_start[line]), int(w.line_end[line])
    return [
        Question(
            "iso-centres",
            at,
            max(end - at, 1),
            "{text}: I and J may lead from the start to the centre, or be the place of the "
            "centre: no arc of this file proves either (full circles do not)",
            text.excerpt(at, end),
            "I and J lead from the start to the centre",
            "--centres-in start, absolute or to-start",
            count,
        )
    ]


#: Words without a blank: a letter and a number, any number of times.
_WORDS = re.compile(rb"/?(?:[A-Z][-+]?(?:\d+\.?\d*|\.\d+))+")
_BRACKETS = re.compile(rb"\([^)]*\)?")
_GAP = re.compile(rb"(?<=[A-Z]) +(?=[-+.\d])")
#: What stands in no word.
_OTHER = re.compile(rb"[^A-Z0-9.+/-]+")
#: Letters of which a word changes the path.
_PATH = re.compile(rb"[GXYIJR]")
_NAME = re.compile(rb"[A-Z]{2}")


def reads_as_words(comment: bytes) -> bool:
    """Return whether text behind a semicolon could be blocks of a program.

    It could where all of it is words, or where a word that changes a path stands there by itself.

    >>> [reads_as_words(t) for t in (b"; G01 X5.0", b";M02", b"; BY HAND", b"; BACK TO X 5", b";")]
    [True, True, False, True, False]
    """
    for part in _BRACKETS.sub(b" ", comment).split(b";"):
        chunks = _OTHER.sub(b" ", _GAP.sub(b"", part)).split()
        words = [(m[0], c[m.end() :]) for c in chunks if (m := _WORDS.match(c))]
        if chunks and len(words) == len(chunks) and not any(rest for _, rest in words):
            return True
        if any(_PATH.search(word) and not _NAME.match(rest) for word, rest in words):
            return True
    return False


def of_semicolons(w: Words, text: Plain, layout: Layout | None) -> list[Question]:
    """Return the question of text behind semicolons that reads as words.

    ``layout``: of the profile that was named; its header and footer are comments.
    """
    own: set[bytes] = set()
    if layout is not None:
        own = {plain(t.encode(layout.encoding)).codes for t in (*layout.header, *layout.footer)}
    blocks = [
        (a, b)
        for a, b in w.comments
        if text.codes[a] == ord(";")
        and text.codes[a:b].strip() not in own
        and reads_as_words(text.codes[a:b])
    ]
    if not blocks:
        return []
    a, b = blocks[0]
    return [
        Question(
            "iso-semicolon",
            a,
            b - a,
            "{text}: text behind a semicolon that reads as words: blocks of their own (the "
            "semicolon ends a block), or a comment?",
            text.excerpt(a, b),
            "a comment",
            "--semicolon-in block, or --semicolon-in comment",
            len(blocks),
            by_profile=False,
        )
    ]


#: What runs subprograms, and how.
_STYLES = {
    "N-label": "M98 P0001 runs from the line N0001 to M99",
    "O-number": "M98 P0001 runs O0001 to M99",
}


def _profiles_of(style: str) -> Listing:
    """Return the built-in profiles of a style."""
    return Listing(
        [name for name in names() if builtin(name).iso.subprograms == style], between=" or "
    )


def of_subprograms(
    words: Ints, w: Words, text: Plain, fits: list[str], refused: bool
) -> list[Question]:
    """Return the question of the words M98: which lines do they run?

    Args:
        words: the M98. w, text: of the file.
        fits: styles in which every call of the file finds its subprogram.
        refused: the user says that none is run.
    """
    if refused:
        return _of_words(
            "subprogram",
            words,
            w,
            text,
            "{text}: calls a subprogram, and --subprograms-in none runs none",
            "",
            "write the blocks of the subprogram in the place of its call, as the machine does",
            by_profile=False,
        )
    fit = fits[0] if len(fits) == 1 else None
    return _of_words(
        "subprogram",
        words,
        w,
        text,
        "{text}: calls a subprogram: is P the number of a line (N), or of a program (O)?"
        if fit is None
        else "{text}: calls a subprogram: is P the number of a line (N), or of a program (O)? In "
        "this file every call finds its {style}",
        assumed="" if fit is None else f"{fit}, {_STYLES[fit]}",
        hint="--subprograms-in N-label (M98 P0001 runs from the line N0001 to M99; --profile-in "
        "{of_lines}), or --subprograms-in O-number (M98 P0001 runs O0001 to M99; --profile-in "
        "{of_programs})",
        style=fit,
        of_lines=_profiles_of("N-label"),
        of_programs=_profiles_of("O-number"),
    )


def of_returns(words: Ints, w: Words, text: Plain) -> list[Question]:
    """Return the question of M99 in a program that calls nothing."""
    return _of_words(
        "subprogram",
        words,
        w,
        text,
        "{text}: in a program that calls nothing: a subprogram alone, or a program without end",
        "the lines are run once",
        "M02 at the end of the program; or this file and the one that calls it as one file",
        by_profile=False,
    )


def of_repeats(words: Ints, w: Words, text: Plain) -> list[Question]:
    """Return the finding of other words that call, repeat or end a subprogram."""
    return _of_words(
        "subprogram",
        words,
        w,
        text,
        "{text}: may call, repeat or end a subprogram (M97 to M99, L, P), and is not run",
        "the lines are run as they stand, once",
        "write the blocks of the subprogram in the place of its call, as the machine runs them",
        by_profile=False,
    )
