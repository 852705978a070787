"""In which order the lines of an ISO program are run: `M98` runs those of a subprogram.

A controller runs the lines of a subprogram in the place of each call, and modes and places go on
through it. So the lines are put in the order in which they are run before anything else is read;
everything behind this module sees one long program. How long it gets, and how deep calls are
nested, is counted before a line is repeated.

Sources: "N-label" is what SodickDXFCoder writes for Sodick (github.com/Meconer/SodickDXFCoder:
``M98 P0001``, M02 or M199 at the end of the main program, then ``N0001`` to ``M99``), with L as the
number of repetitions (cncwirecut.blogspot.com, *Definition of Words*; Galil's M98 reads the same).
"O-number" is Fanuc's (B-64124EN 12.3: M99 and M98 may stand behind a motion, which comes first;
``P51002`` runs O1002 five times) and LinuxCNC's (*O Codes*, Fanuc-style programs: L, and M99 in the
main program runs without end). Eight levels: Mitsubishi's *Subprogram Call: M98, M99*.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity, note, warning
from wedmcam.diag.lists import Listing
from wedmcam.formats import iso
from wedmcam.formats.listing import Values
from wedmcam.frontends.iso import dialect as dialects
from wedmcam.frontends.iso.reading import Reading
from wedmcam.frontends.iso.words import Words

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: How deep calls may be nested: subprograms that are open at once.
DEEPEST = 8
#: Lines that may be run in all.
MOST_LINES = 1_000_000
#: So many labels are named in a finding; others are counted.
NAMED = 8
#: Styles that run subprograms, and the letter of their labels.
STYLES = {"N-label": "N", "O-number": "O"}
#: Letters that may stand beside M98, beyond P and L: modes, and what changes no path.
_BESIDE = b"NGMCFSTE"
#: What goes somewhere, and may stand beside M98 and M99 of "O-number" only: the motion comes first.
_MOTION = b"XYIJR"
_BEHIND = "subprograms stand behind the end (M02) of the main program, each ends with M99"


@dataclass(frozen=True, slots=True, eq=False)
class _Refused:
    """What is wrong with lines: a template, with values by index into them, and what to do."""

    lines: Ints
    template: str
    values: Values | None
    hint: str


@dataclass(slots=True, eq=False)
class CallTree:
    """How a text is run in one style, or why it cannot be.

    Attributes:
        style: key of `STYLES`.
        end: the line that ends the main program.
        wrong: lines, what is wrong there (a template, with values by index into them), and what
            to do.
        spent: words that are read no more: those that call, return, and name programs.
        line, row, back: of each label its line, its word, and the line of the next M99; one past
            the last line where there is none.
        call: lines with M98, in the order of the text. target: the label that each runs, -1 for
            none. times: how often.
        live: calls that are reached from the main program. used: labels likewise.
        low, high: of each label, the first call in its subprogram and the first behind it.
        runs: how often each label is run.
    """

    style: str
    end: int
    spent: Bools
    line: Ints
    row: Ints
    back: Ints
    call: Ints
    target: Ints
    times: Ints
    live: Bools
    used: Bools
    low: Ints
    high: Ints
    runs: Ints
    wrong: list[_Refused] = field(default_factory=list)

    def refuse(
        self, lines: Ints, template: str, values: Values | None = None, *, hint: str
    ) -> None:
        """Keep what is wrong with some lines."""
        if len(lines):
            self.wrong.append(_Refused(lines, template, values, hint))

    def within(self, of_call: Ints) -> Ints:
        """Return the sum of a figure of each call over the calls of each subprogram."""
        summed = np.append(0, np.cumsum(of_call))
        found: Ints = summed[self.high] - summed[self.low]
        return found


def ends_of(style: str | None) -> tuple[int, ...]:
    """Return the M codes that end a program: M199 too where Sodick's labels are run."""
    return (*iso.ENDS, iso.END_OF_LABELS) if style == "N-label" else iso.ENDS


def calls_of(r: Reading) -> bool:
    """Return whether the main program calls a subprogram."""
    w = r.words
    rows = np.flatnonzero(w.letter == ord("M"))
    if not np.isin(w.whole[rows], 98).any():
        return False
    code = _codes(w)
    return bool((w.line[code == 98] <= _last_of_main(w, code, r.subprograms, r.lines)).any())


def order_of(r: Reading) -> Ints | None:
    """Return the lines of the text in the order in which they are run, and report what cannot be.

    None for a text that calls nothing, and one that cannot be run. Where nothing says the style, it
    is asked; what only shows takes the one that fits, and where none does, it is refused there too:
    the lines of a subprogram, run where they stand, are another path. Lines that are run nowhere
    are left out of the text.
    """
    w = r.words
    rows = np.flatnonzero(w.letter == ord("M"))
    if not np.isin(w.whole[rows], (98, 99)).any():
        return None
    code = _codes(w)
    said = r.subprograms
    last = _last_of_main(w, code, said, r.lines)
    calls = np.flatnonzero((code == 98) & (w.line <= last))
    if not len(calls):
        back = np.flatnonzero((code == 99) & (w.line <= last))
        r.questions += dialects.of_returns(back, w, r.plain)
        r.words = w.without_words(code == 99)
        return None
    if said in STYLES:
        tree = _tree_of(r, code, str(said))
    else:
        trees = [_tree_of(r, code, style) for style in STYLES]
        # M199 may end the main program before the first call: then the style runs none.
        fits = [p for p in trees if p.live.any() and not p.wrong]
        names = [p.style for p in fits]
        questions = dialects.of_subprograms(calls, w, r.plain, names, said == "none")
        runs = len(fits) == 1 and said != "none"
        if r.dialect.shown and not runs:
            r.findings += [(q.at, q.finding(r.spans, shown=False)) for q in questions]
        else:
            r.questions += questions
        if not r.dialect.shown or not runs:
            _leave(r, code, iso.END_OF_LABELS)
            return None
        tree = fits[0]
    if tree.wrong:
        for one in tree.wrong:
            r.tell_lines(
                Severity.ERROR, "subprogram", one.lines, one.template, one.values, one.hint
            )
        _leave(r, code)
        return None
    r.subprograms = tree.style
    return _run(r, tree)


def _codes(w: Words) -> Ints:
    """Return the number of each M word, -1 for other words."""
    m = (w.letter == ord("M")) & w.good & ~w.pointed
    return np.where(m, w.whole, -1)


def _last_of_main(w: Words, code: Ints, style: str | None, lines: int) -> int:
    """Return the line that ends the main program: the last of the text where no word does."""
    ends = w.line[np.isin(code, ends_of(style))]
    return int(ends[0]) if len(ends) else lines - 1


def _leave(r: Reading, code: Ints, *others: int) -> None:
    """Take the words of calls out of a text that cannot be run, for they are reported.

    ``others``: M codes that the answer to what is asked tells the meaning of.
    """
    w = r.words
    here = np.zeros(r.lines, bool)
    here[w.line[code == 98]] = True
    words = np.isin(code, (98, 99, *others))
    words |= here[w.line] & np.isin(w.letter, np.frombuffer(b"PL", np.uint8))
    r.words = w.without_words(words)
    r.unrun = True


# --- what is run ----------------------------------------------------------------------------------


def _tree_of(r: Reading, code: Ints, style: str) -> CallTree:
    """Return how the text is run in a style."""
    w = r.words
    end = _last_of_main(w, code, style, r.lines)
    opens = np.ones(len(w.line), bool)
    opens[1:] = w.line[1:] != w.line[:-1]
    whole = w.good & ~w.pointed & (w.whole >= 0)
    labels = np.flatnonzero(opens & whole & (w.letter == ord(STYLES[style])))
    backs = np.unique(w.line[code == 99])
    line = w.line[labels]
    back = np.append(backs, r.lines)[np.searchsorted(backs, line)]
    call = np.unique(w.line[code == 98])
    tree = CallTree(
        style,
        end,
        np.isin(code, (98, 99)),
        line,
        labels,
        back,
        call,
        target=np.full(len(call), -1),
        times=np.ones(len(call), np.int64),
        live=call <= end,
        used=np.zeros(len(labels), bool),
        low=np.searchsorted(call, line),
        high=np.searchsorted(call, back, "right"),
        runs=np.zeros(len(labels), np.int64),
    )
    tree.low = np.minimum(tree.low, tree.high)
    faults = _target(r, tree, whole)
    _reach(tree)
    for fault in faults:
        at = np.flatnonzero(fault.which & tree.live)
        tree.refuse(call[at], fault.template, _at(fault.values, at), hint=fault.hint)
    _check_lines(r, tree, code, backs)
    _check_bodies(r, tree, code)
    if tree.live.any() and not tree.wrong:
        _count(r, tree)
    return tree


def _at(values: Values | None, rows: Ints) -> Values | None:
    """Return the values of some rows, by index into these."""
    return None if values is None else lambda i: values(int(rows[i]))


@dataclass(frozen=True, slots=True, eq=False)
class _Fault:
    """Which calls cannot be followed, why (a template, with values by call), and what to do."""

    which: Bools
    template: str
    values: Values | None = None
    hint: str = "a call is M98 P0001, or M98 P0001 L3 to run it three times"


def _target(r: Reading, tree: CallTree, whole: Bools) -> list[_Fault]:
    """Find what each call runs and how often; return which calls cannot be followed."""
    w, call = r.words, tree.call
    of = np.full(r.lines, -1)
    of[call] = np.arange(len(call))
    mine = of[w.line]

    def numbers(letter: str, absent: int) -> tuple[Ints, Ints, Bools]:
        rows = np.flatnonzero((mine >= 0) & (w.letter == ord(letter)))
        value, wrong = np.full(len(call), absent), np.zeros(len(call), bool)
        value[mine[rows]] = w.whole[rows]
        wrong[mine[rows[~whole[rows]]]] = True
        return value, np.bincount(mine[rows], minlength=len(call)), wrong

    p, of_p, wrong_p = numbers("P", -1)
    times, of_l, wrong_l = numbers("L", 1)
    tree.spent |= (mine >= 0) & np.isin(w.letter, np.frombuffer(b"PL", np.uint8))
    number = w.whole[tree.row]
    known = np.unique(number)
    packed = np.zeros(len(call), bool)
    both = packed
    if tree.style == "O-number":
        tree.spent[tree.row] = True
        # P51002: O1002 five times [B-64124EN 12.3].
        may_pack = (p >= 10_000) & r.machine.iso.packed_calls
        packed = may_pack & ~np.isin(p, known)
        both = may_pack & np.isin(p, known) & np.isin(p % 10_000, known)
        times = np.where(packed, p // 10_000, times)
        p = np.where(packed, p % 10_000, p)
    tree.times = times
    order = np.argsort(number, kind="stable")
    first = np.searchsorted(number[order], p)
    many = np.searchsorted(number[order], p, "right") - first
    found = many > 0
    tree.target[found] = order[first[found]]
    letter = STYLES[tree.style]

    def twice(i: int) -> dict[str, object]:
        rows = tree.row[order[first[i] : first[i] + 2]]
        a, b = (int(w.line[k]) for k in rows)
        return {"label": _word(r, int(rows[0])), "line": a + 1, "again": b + 1}

    labels = _labels(r, tree)
    no_p, ok = of_p == 0, (of_p == 1) & ~wrong_p
    return [
        _Fault(no_p, "M98 without P: the file does not say which subprogram"),
        _Fault(~no_p & ~ok, "P is the number of one subprogram, whole"),
        _Fault(
            (of_l > 1) | wrong_l | (times < 1),
            "L is how often the subprogram is run, whole, from 1 on",
        ),
        _Fault(
            packed & (of_l > 0),
            "P of five digits or more holds the number of times already, and L gives one",
        ),
        _Fault(
            both,
            "both {letter}{number} and {letter}{last:04d} are in the file: is P the whole number, "
            "or the number of times and the last four digits?",
            lambda i: {"letter": letter, "number": int(p[i]), "last": int(p[i] % 10_000)},
            hint="give one of the two subprograms another number",
        ),
        _Fault(
            ok & ~found,
            "no line opens with {letter}{number:04d}; the file has {labels}"
            if labels
            else "no line opens with {letter}{number:04d}; the file has no {letter} behind the end "
            "of the main program",
            lambda i: {"letter": letter, "number": int(p[i]), "labels": labels},
            hint=_BEHIND,
        ),
        _Fault(
            ok & (many > 1),
            "{label} stands twice, in lines {line} and {again}",
            twice,
            hint="give one of the two another number",
        ),
    ]


def _word(r: Reading, row: int) -> str:
    return r.plain.excerpt(int(r.words.start[row]), int(r.words.end[row]))


def _labels(r: Reading, tree: CallTree) -> Listing:
    """Return the labels that a file has behind its main program, the first of many."""
    rows = tree.row[tree.line > tree.end].tolist()
    return Listing([_word(r, row) for row in rows[:NAMED]], unnamed=max(0, len(rows) - NAMED))


def _reach(tree: CallTree) -> None:
    """Find which calls and labels the main program reaches; what is deeper than allowed, once."""
    for _ in range(DEEPEST + 1):
        new = np.unique(tree.target[tree.live & (tree.target >= 0)])
        new = new[~tree.used[new]]
        if not len(new):
            return
        tree.used[new] = True
        edge = np.zeros(len(tree.call) + 1, np.int64)
        np.add.at(edge, tree.low[new], 1)
        np.add.at(edge, tree.high[new], -1)
        tree.live |= np.cumsum(edge[:-1]) > 0


def _check_lines(r: Reading, tree: CallTree, code: Ints, backs: Ints) -> None:
    """Refuse words beside M98 and M99 where no source states their order, or their meaning."""
    w = r.words
    tree.refuse(
        backs[backs <= tree.end],
        "M99 in the main program: the machine runs it from its start again, without end",
        hint=_BEHIND,
    )
    motion = np.isin(w.letter, np.frombuffer(_MOTION, np.uint8))
    motion |= (w.letter == ord("G")) & np.isin(w.whole, (4, 64, 92))
    called, returned = np.zeros(r.lines, bool), np.zeros(r.lines, bool)
    called[tree.call[tree.live]] = True
    returned[tree.back[tree.used & (tree.back < r.lines)]] = True
    here = called | returned
    many = np.bincount(w.line[w.letter == ord("M")], minlength=r.lines)
    tree.refuse(
        np.flatnonzero(here & (many > 1)),
        "another M word in a line with M98 or M99: no source states which comes first",
        hint="write each into a line of its own",
    )
    beside = np.isin(w.letter, np.frombuffer(_BESIDE, np.uint8)) & ~motion
    plain_call = beside | np.isin(w.letter, np.frombuffer(b"PL", np.uint8))
    plain_back = beside | np.isin(w.letter, np.frombuffer(b"DH", np.uint8))
    if tree.style == "O-number":
        moves = motion & (w.letter != ord("G"))
        opens = w.letter == ord("O")
        plain_call, plain_back = plain_call | moves | opens, plain_back | moves | opens
    other = (called[w.line] & ~plain_call) | (returned[w.line] & ~plain_back)
    rows = np.flatnonzero(other)
    rows = rows[np.unique(w.line[rows], return_index=True)[1]]
    aside = returned[w.line[rows]] & (w.letter[rows] == ord("P"))

    def refuse(rows: Ints, template: str) -> None:
        tree.refuse(
            w.line[rows],
            template,
            lambda i: {
                "word": _word(r, int(rows[i])),
                "code": "M98" if called[w.line[rows[i]]] else "M99",
            },
            hint="write M98 and M99 into lines of their own",
        )

    refuse(rows[aside], "{word} beside M99 goes on in another line: it is not followed")
    refuse(
        rows[~aside & motion[rows]],
        "{word}: a motion in a line with {code}; no source states what it does there",
    )
    refuse(
        rows[~aside & ~motion[rows]],
        "{word}: a word in a line with {code}; no source states what it does there",
    )


def _check_bodies(r: Reading, tree: CallTree, code: Ints) -> None:
    """Refuse subprograms that do not end, or whose lines belong to the main program."""
    w = r.words
    called = np.flatnonzero(tree.live & (tree.target >= 0))
    _, first = np.unique(tree.target[called], return_index=True)
    called = called[np.sort(first)]
    of = tree.target[called]
    ends = np.unique(w.line[np.isin(code, ends_of(tree.style))])
    inside = tree.line[of] <= tree.end

    def refuse(mask: Bools, template: str) -> None:
        rows = tree.row[of[mask]]
        tree.refuse(
            tree.call[called[mask]],
            template,
            lambda i: {"label": _word(r, int(rows[i]))},
            hint=_BEHIND,
        )

    refuse(inside, "{label} is a line of the main program, and no subprogram")
    ended = np.searchsorted(ends, tree.line[of])
    stop = np.append(ends, r.lines)[ended]
    last = np.where(tree.style == "O-number", np.append(tree.line, r.lines)[of + 1], r.lines)
    endless = ~inside & (tree.back[of] >= np.minimum(last, r.lines))
    refuse(
        endless & (stop >= last),
        "{label} has no M99: the file does not say where the subprogram ends",
    )
    refuse(
        ~inside & (stop < np.minimum(last, tree.back[of])),
        "{label} ends the whole program (M02, M30) before its M99",
    )
    if tree.style == "O-number":
        opens = w.line[0] if len(w.line) else 0
        other = tree.line[(tree.line <= tree.end) & (tree.line > opens)]
        tree.refuse(
            other[:1],
            "another program begins here, and the one before it has no end",
            hint=_BEHIND,
        )


#: A program that gets too long: counted out, only in its sum, and in neither.
_LONG = "{total:,} lines would be run, and at most {most:,} are: here {label} of {lines:,}, {often}"
_LONGER = (
    "more than {total:,} lines would be run, and at most {most:,} are: here {label} of {lines:,}, "
    "{often}"
)
_LONGEST = (
    "more than {total:,} lines would be run, and at most {most:,} are: here {label} of {lines:,} "
    "or more, {often}"
)


def _count(r: Reading, tree: CallTree) -> None:
    """Refuse calls that are nested too deep, and programs that get too long."""
    own = tree.back - tree.line + 1
    live, target = tree.live, np.maximum(tree.target, 0)
    # Subprograms that open so many levels: themselves, and a chain of calls below.
    deep = [np.ones(len(own), bool)]
    for _ in range(DEEPEST):
        deep.append(tree.within((live & deep[-1][target]).astype(np.int64)) > 0)
    main = live & (tree.call <= tree.end)
    if (main & deep[-1][target]).any():
        _refuse_depth(r, tree, deep)
        return
    # Cut to what cannot overflow: a million calls of this size, this often.
    most = 2 * MOST_LINES
    times = np.minimum(tree.times, most)
    size = np.minimum(own, most)
    for _ in range(DEEPEST):
        size = np.minimum(own + tree.within(np.where(live, times * size[target], 0)), most)
    total = tree.end + 1 + int((times * size[target])[main].sum())
    if total > MOST_LINES:
        worst = int(np.flatnonzero(main)[np.argmax((times * size[target])[main])])
        lines, often = int(size[target[worst]]), int(tree.times[worst])
        if total < most:
            template = _LONG
        else:
            template = _LONGER if lines < most else _LONGEST
        tree.refuse(
            tree.call[worst : worst + 1],
            template,
            lambda i: {
                "total": min(total, most),
                "most": MOST_LINES,
                "label": _word(r, int(tree.row[target[worst]])),
                "lines": lines,
                "often": _often(often),
            },
            hint="fewer repeats (L), or one program for each part",
        )
        return
    added = np.zeros(len(own), np.int64)
    np.add.at(added, target[main], tree.times[main])
    while added.any():
        tree.runs += added
        edge = np.zeros(len(tree.call) + 1, np.int64)
        np.add.at(edge, tree.low, added)
        np.add.at(edge, tree.high, -added)
        opened = np.where(live, np.cumsum(edge[:-1]), 0)
        added = np.zeros(len(own), np.int64)
        np.add.at(added, target[live], (opened * tree.times)[live])


def _refuse_depth(r: Reading, tree: CallTree, deep: list[Bools]) -> None:
    """Refuse a chain of calls that is too deep, or goes round, by the names in it."""
    chain: list[int] = []
    calls = np.flatnonzero(tree.live & (tree.call <= tree.end))
    for below in reversed(deep):
        call = int(calls[below[tree.target[calls]]][0])
        label = int(tree.target[call])
        again = label in chain
        chain.append(label)
        if again:
            break
        calls = np.arange(tree.low[label], tree.high[label])
    labels = Listing([_word(r, int(tree.row[label])) for label in chain], between=" > ")
    tree.refuse(
        tree.call[call : call + 1],
        "{labels}: a subprogram that runs itself never ends"
        if again
        else "{labels}: subprograms are nested at most {deepest} deep",
        lambda i: {"labels": labels, "deepest": DEEPEST},
        hint="leave the call out"
        if again
        else "write the lines of the last ones in the place of their calls",
    )


# --- running it -----------------------------------------------------------------------------------


def _order_of(r: Reading, tree: CallTree) -> Ints:
    """Return the lines in the order in which they are run."""
    own = tree.back - tree.line + 1
    of = np.full(r.lines, -1)
    of[tree.call] = np.arange(len(tree.call))
    order = np.arange(tree.end + 1)
    calls = of[order]
    while (calls >= 0).any():
        open_ = calls >= 0
        target = tree.target[calls]
        sizes = 1 + np.where(open_, tree.times[calls] * own[target], 0)
        source = np.repeat(np.arange(len(order)), sizes)
        nth = np.arange(len(source)) - (np.cumsum(sizes) - sizes)[source]
        body = tree.line[target[source]] + (nth - 1) % own[target[source]]
        order = np.where(nth == 0, order[source], body)
        calls = np.where(nth == 0, -1, of[order])
    return order


def _run(r: Reading, tree: CallTree) -> Ints:
    """Return the order, leave out the lines that are run nowhere, and say both."""
    w = r.words
    order = _order_of(r, tree)
    done = np.zeros(r.lines, bool)
    done[order] = True
    filled = np.bincount(w.line, minlength=r.lines) > 0
    blocks, lines = int(filled[order].sum()), int((filled & done).sum())
    used = np.flatnonzero(tree.runs)
    named = [
        f"{_word(r, int(tree.row[i]))} {'run ' if i == used[0] else ''}{_often(int(tree.runs[i]))}"
        for i in used[:NAMED]
    ]
    at = int(w.line_start[tree.call[np.argmax(tree.live)]])
    finding = note(
        "subprogram-run",
        "subprograms: {subprograms}; {blocks} blocks are run from {lines} lines",
        r.spans.at(at),
        subprograms=Listing(named, unnamed=max(0, len(used) - NAMED)),
        blocks=blocks,
        lines=lines,
    )
    r.findings.append((at, finding))
    _tell_idle(r, tree, filled & ~done)
    w = w.without_words(tree.spent | ~done[w.line])
    stray = w.stray[done[w.lines_at(w.stray)]]
    r.words = replace(w, stray=stray, skipped=w.skipped[done[w.skipped]])
    r.titles = r.titles[done[r.titles]]
    return order


def _often(times: int) -> str:
    return "once" if times == 1 else f"{times:,} times"


def _tell_idle(r: Reading, tree: CallTree, idle: Bools) -> None:
    """Warn of lines behind the end that no call runs, with the labels that they open with."""
    lines = np.flatnonzero(idle)
    if not len(lines):
        return
    # The first label of every stretch that ends with M99.
    labels = np.flatnonzero(idle[tree.line])
    first = np.unique(tree.back[labels], return_index=True)[1]
    names = [_word(r, int(tree.row[i])) for i in labels[first[:NAMED]]]
    at = int(r.words.line_start[lines[0]])
    finding = warning(
        "after-end",
        "{count} lines behind the end of the main program are not run; no call runs {labels}"
        if names
        else "{count} lines behind the end of the main program are not run",
        r.spans.at(at),
        count=len(lines),
        labels=Listing(names, unnamed=max(0, len(first) - NAMED)),
    )
    r.findings.append((at, finding))
