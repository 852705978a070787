"""A ``.wed`` text becomes a `Part`: statement by statement, all mistakes of a text in one run."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from wedmcam.diag import Diagnostic, TextSpan, error, has_errors, option_texts, warning
from wedmcam.frontends.wed.blocks import SAME_PLACE_UM, Builder, Chain, minus, size
from wedmcam.frontends.wed.chunks import RESERVED, Piece, Source, pieces
from wedmcam.frontends.wed.grammar import Node, parse
from wedmcam.frontends.wed.numbers import Number, Numbers, Point, Wrong, wrong
from wedmcam.frontends.wed.values import FACTORS, KNOWN, Scope, Stop, Value, kind_of, near
from wedmcam.ir.contour import Contour
from wedmcam.ir.figure import Sequence as Stages
from wedmcam.ir.figure import Transform
from wedmcam.ir.part import CutItem, Part, Shape

#: More characters than this are no program.
MOST_TEXT = 20_000_000


def read(
    data: bytes, file: str, *, arithmetic: str = "decimal8", defines: Sequence[str] = ()
) -> tuple[Part | None, list[Diagnostic]]:
    """Return what a program of the part language says.

    Args:
        data: its text, UTF-8.
        file: name for findings.
        arithmetic: "decimal8" or "float64".
        defines: ``name=value``: each sets a ``let`` from outside.

    Returns:
        The part, or None when there is an error.

    >>> part, _ = read(b"contour a { circle center (0, 0) radius 2 } cut a inside offset 0.1", "x")
    >>> part.cuts[0].side, part.cuts[0].offset
    ('inside', 100.0)
    """
    if len(data) > MOST_TEXT:
        return None, [
            error(
                "too-large",
                "{characters} characters are no program of a part",
                characters=len(data),
            )
        ]
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as why:
        line = data.count(b"\n", 0, why.start) + 1
        return None, [
            error(
                "wed-syntax",
                "this is no UTF-8 text",
                TextSpan(file, line, 1),
                hint="save the program as UTF-8",
            )
        ]
    reader = _Reader(Source(text, file), Numbers(arithmetic), defines)
    part = reader.part()
    findings = sorted(reader.scope.findings, key=_place)
    return (None if has_errors(findings) else part), findings


def parse_transform(
    text: str, name: str = "--transform"
) -> tuple[Transform | None, list[Diagnostic]]:
    """Return the transform that a text describes; lengths are mm.

    Args:
        text: one transform, or several with ``|`` between them, first one first.
        name: of the text, for the places of findings.

    Returns:
        The transform, or None when there is an error; the mistakes of all of them.

    >>> parse_transform("rotate 10 copies 35 about (0, 0)")[0]
    Rotate(degrees=Fraction(10, 1), copies=35, about=(0.0, 0.0))
    >>> parse_transform("mirorr 45")[1][0].hint
    "did you mean 'mirror'?"
    """
    source = Source(text, name)
    scope = Scope(source, Numbers("float64"))
    out: list[Transform] = []
    at = 0
    for stage in text.split("|"):
        start = at + len(stage) - len(stage.lstrip())
        end = max(at + len(stage.rstrip()), start)
        at += len(stage) + 1
        tree, findings = parse(source, "transform", start, end)
        scope.findings += findings
        if tree is not None:
            with contextlib.suppress(Stop):
                out.append(scope.transform(tree))
    if scope.findings:
        return None, scope.findings
    return (out[0] if len(out) == 1 else Stages(tuple(out))), []


def parse_transforms(texts: Sequence[str]) -> tuple[list[Transform], list[Diagnostic]]:
    """Return what ``--transform`` says, each time that it is given, and the mistakes."""
    named = option_texts("--transform", texts)
    parsed = [parse_transform(text, name) for name, text in named.items()]
    return [t for t, _ in parsed if t is not None], [d for _, found in parsed for d in found]


class _Reader:
    def __init__(self, source: Source, numbers: Numbers, defines: Sequence[str]) -> None:
        self.source = source
        self.scope = Scope(source, numbers)
        self.cuts: list[CutItem] = []
        self.title = ""
        self.units_at: TextSpan | None = None
        self.used: set[str] = set()
        self.defines = self._defines(defines)
        self.blocks: dict[str, int] = {}

    # --- the text as a whole ---

    def part(self) -> Part:
        """Read everything."""
        scope = self.scope
        todo = pieces(self.source.text)
        trees: list[tuple[Piece, Node | None]] = []
        for piece in todo:
            if piece.entry in ("brace", "open"):
                trees.append((piece, None))
                continue
            tree, findings = parse(self.source, piece.entry, piece.start, piece.end)
            scope.findings += findings
            trees.append((piece, tree))
        scope.later = {
            name.text: self.scope.span(name).line
            for _, tree in reversed(trees)
            if tree is not None and (name := _name_node(tree)) is not None
        }
        at = 0
        while at < len(trees):
            piece, tree = trees[at]
            at += 1
            if piece.entry == "heading":
                body = []
                while at < len(trees) and trees[at][0].entry == "command":
                    body.append(trees[at])
                    at += 1
                ended = at < len(trees) and trees[at][0].entry == "brace"
                at += at < len(trees) and trees[at][0].entry in ("brace", "open")
                self._contour(piece, tree, body, ended)
            elif tree is not None and piece.entry == "statement" and tree.items:
                try:
                    getattr(self, f"_{tree.items[0].kind}")(tree.items[0], piece)
                except Stop:
                    continue
        for defined, (_, span) in self.defines.items():
            if defined not in self.used:
                lets = [n for n in scope.later if n not in self.blocks]
                scope.tell_unknown("-D: no 'let' is called '{name}'", span, lets, name=defined)
        if not self.cuts and not has_errors(scope.findings):
            scope.findings.append(
                error(
                    "no-cut",
                    "the program says what the part is, and cuts nothing"
                    if trees
                    else "the program is empty",
                    self.source.span(0, 1),
                    hint="such as: cut NAME outside offset 0.1",
                )
            )
        return Part(self.title, scope.units, tuple(self.cuts), self.blocks)

    def _defines(self, texts: Sequence[str]) -> dict[str, tuple[Value | None, TextSpan]]:
        out: dict[str, tuple[Value | None, TextSpan]] = {}
        for place, text in option_texts("-D", texts).items():
            name, equals, value = text.partition("=")
            name = name.strip()
            source = Source(text, place)
            if not equals or not name.isidentifier():
                self.scope.findings.append(
                    error(
                        "wed-syntax",
                        "'{text}' is no NAME=VALUE",
                        source.span(0, len(text)),
                        text=text,
                    )
                )
                continue
            tree, findings = parse(source, "expression", len(text) - len(value), len(text))
            self.scope.findings += findings
            meaning: Value | None = None
            if tree is not None:
                scope = Scope(source, self.scope.numbers)
                with contextlib.suppress(Stop):
                    meaning = scope.value(tree)
                self.scope.findings += scope.findings
            out[name] = (meaning, source.span(0, len(name)))
        return out

    # --- statements ---

    def _part(self, node: Node, piece: Piece) -> None:
        self.title = node.items[0].text.strip('"')

    def _units(self, node: Node, piece: Piece) -> None:
        word = node.items[0]
        span = self.scope.span(word)
        if word.text not in FACTORS:
            nearest = near(word.text, FACTORS)
            self.scope.tell(
                "wed-value",
                "no unit is called '{name}'",
                span,
                "did you mean '{nearest}'?" if nearest else "mm, um or inch",
                name=word.text,
                nearest=nearest,
            )
        elif self.units_at is not None and word.text != self.scope.units:
            self.scope.tell(
                "wed-value",
                "the unit is {units} already, since line {line}",
                span,
                units=self.scope.units,
                line=self.units_at.line,
            )
        elif self.units_at is None and (self.scope.names or self.cuts):
            self.scope.tell("wed-value", "the unit comes before what is measured in it", span,
                            "put it at the top")  # fmt: skip
        else:
            self.scope.units, self.units_at = word.text, span

    def _named(self, word: Node) -> str | None:
        """Return a name that may be given, or None."""
        name, span = word.text, self.scope.span(word)
        if name in RESERVED or name in KNOWN:
            self.scope.tell(
                "name-taken",
                "'{name}' is a word of the language and can be no name",
                span,
                name=name,
            )
            return None
        if name in self.scope.places:
            line = self.scope.places[name].line
            self.scope.tell(
                "name-taken",
                "'{name}' is given already, in line {line}",
                span,
                name=name,
                line=line,
            )
            return None
        self.scope.places[name] = span
        return name

    def _let(self, node: Node, piece: Piece) -> None:
        name = self._named(node.items[0])
        value: Value | None = None
        try:
            if name in self.defines:
                self.used.add(name)
                value, _ = self.defines[name]
            else:
                value = self._figure(node.items[1], node.items[2:])
        finally:
            if name is not None:
                self.scope.names[name] = value

    def _figure(self, base: Node, stages: Sequence[Node]) -> Value:
        """Return a value, or a figure with what a pipeline makes of it."""
        value = self.scope.value(base)
        if not stages:
            return value
        if not isinstance(value, Shape):
            self.scope.tell(
                "wed-kind",
                "transforms are of figures, not of {kind}s",
                self.scope.span(base),
                "figures are named by 'contour' or 'let'",
                kind=kind_of(value).removeprefix("a "),
            )
            raise Stop
        transforms, stopped = [], False
        for stage in stages:
            span = self.scope.span(stage)
            try:
                transforms.append((self.scope.transform(stage), span))
            except Stop:
                stopped = True
        if stopped:
            raise Stop
        return Shape(value.chains, (*value.stages, *transforms))

    def _cut(self, node: Node, piece: Piece) -> None:
        scope = self.scope
        side = next(k for k, item in enumerate(node.items) if item.kind == "SIDE")
        span = self.source.span(piece.start, piece.end)
        clauses: dict[str, Node] = {}
        for clause in node.items[side + 1 :]:
            value = clause.items[0]
            if clause.kind in clauses:
                scope.tell(
                    "wed-syntax", "'{clause}' stands twice", scope.span(value), clause=clause.kind
                )
            clauses[clause.kind] = value
        values: dict[str, float] = {}
        points: dict[str, tuple[float, float, TextSpan]] = {}
        stopped, paper = False, None
        for kind, value in clauses.items():
            try:
                if kind in ("start", "enter"):
                    p = scope.point(value)
                    um = scope.numbers.um
                    where = scope.span(value)
                    points[kind] = (um(p.x, scope.factor), um(p.y, scope.factor), where)
                elif kind == "corners":
                    paper = value.text == "paper"
                else:
                    values[kind] = scope.um(value, f"'{kind}'")
                    if kind in ("stop", "overcut") and 0 < values[kind] < 1:
                        scope.tell(
                            "wed-value",
                            "'{clause}' is 0 or 1 um at least: no step is shorter",
                            scope.span(value),
                            clause=kind,
                        )
                        stopped = True
            except Stop:
                stopped = True
        word = node.items[side].text
        if word == "on" and values.get("offset"):
            scope.tell("wed-value", "'on' runs on the line: it takes no offset", span,
                       "inside, outside, left or right")  # fmt: skip
            stopped = True
        shape = self._figure(node.items[0], node.items[1:side])
        if not isinstance(shape, Shape):
            scope.tell(
                "wed-kind",
                "a figure is cut, not {kind}",
                scope.span(node.items[0]),
                kind=kind_of(shape),
            )
            raise Stop
        if stopped:
            raise Stop
        name = self.source.text[node.items[0].start : node.items[0].end]
        start, enter = points.get("start"), points.get("enter")
        self.cuts.append(
            CutItem(name, shape, word, span, start=start, enter=enter, paper=paper, **values)
        )

    # --- contours ---

    def _contour(
        self, piece: Piece, heading: Node | None, body: list[tuple[Piece, Node | None]], ended: bool
    ) -> None:
        scope = self.scope
        name = None
        if heading is not None:
            name = self._named(heading.items[0])
        if not ended and heading is not None:
            scope.tell("wed-syntax", "the '}}' of this contour is missing",
                       self.source.span(piece.start, piece.end))  # fmt: skip
        chains, good = self._chains(body)
        contours: list[Contour] = []
        builder = Builder(scope.numbers, scope.factor)
        for chain in chains:
            if not chain.blocks:
                if good:
                    scope.tell("wed-contour", "no block follows: a point cannot be cut", chain.span)
                good = False
                continue
            with_corners, failures = builder.finished(chain)
            for why, span in failures:
                scope.tell_wrong("wed-contour", why, span)
                good = False
            if failures:
                continue
            if (
                with_corners.closed
                and len(with_corners.blocks) < 3
                and not any(b.turn for b in with_corners.blocks)
            ):
                scope.tell("wed-contour", "this contour runs out and back on one line: it encloses "
                           "nothing", chain.span)  # fmt: skip
                good = False
                continue
            contours.append(builder.contour(with_corners))
        if good and not contours and heading is not None:
            span = self.source.span(piece.start, piece.end)
            scope.tell("wed-contour", "there is nothing in this contour", span)
            good = False
        if name is not None:
            self.blocks[name] = sum(len(c) for c in contours)
            scope.names[name] = Shape(tuple(contours)) if good and heading is not None else None

    def _chains(self, body: list[tuple[Piece, Node | None]]) -> tuple[list[Chain], bool]:
        chains: list[Chain] = []
        good = True
        lost = False  # where the path stands is not known: until the next `from`
        for piece, node in body:
            span = self.source.span(piece.start, piece.end)
            if node is None:
                good, lost = False, True
                continue
            command = node.items[0] if node.kind == "command" else node
            if command.kind in ("from", "circle"):
                lost = False
            elif lost:
                self._values_of(command)
                continue
            elif not chains or chains[-1].closed:
                self.scope.tell(
                    "wed-contour",
                    "it is not said where this block starts",
                    span,
                    "after 'close' a new chain begins with 'from'"
                    if chains
                    else "a contour begins with 'from' or is a 'circle'",
                )
                good, lost = False, True
                continue
            try:
                self._block(chains, command, span)
            except Stop:
                good, lost = False, True
            except (Wrong, ArithmeticError, ValueError) as why:
                self.scope.tell_wrong("wed-contour", why, span)
                good, lost = False, True
        return chains, good

    def _values_of(self, command: Node) -> None:
        """Look at the values of a block that cannot be placed: their mistakes count as well."""
        for item in command.items:
            if item.kind not in ("SENSE", "fillet", "chamfer"):
                try:
                    self.scope.value(item)
                except Stop:
                    continue

    def _block(self, chains: list[Chain], node: Node, span: TextSpan) -> None:
        scope = self.scope
        builder = Builder(scope.numbers, scope.factor)
        items = list(node.items)
        corner = None
        if items and items[-1].kind in ("fillet", "chamfer"):
            last = items.pop()
            value = scope.length(last.items[0])
            corner = (last.kind, value, scope.span(last.items[0]))
        turn = 1
        if items and items[0].kind == "SENSE":
            turn = 1 if items.pop(0).text == "ccw" else -1
        kind = node.kind
        if kind == "from":
            chains.append(Chain(self._xy(items[0]), span))
            return
        if kind == "circle":
            radius = scope.length(items[1])
            chains.append(builder.circle(turn, self._xy(items[0]), radius.value, span))
            return
        chain = chains[-1]
        block = None
        if kind == "line_to":
            block = builder.line(chain, self._xy(items[0]), span)
        elif kind == "line_by":
            x, y = self._xy(items[0])
            block = builder.line(chain, (chain.here[0] + x, chain.here[1] + y), span)
        elif kind == "line_polar":
            p = scope.polar(scope.length(items[0]), scope.number(items[1]), None, items[0])
            end = (chain.here[0] + p.x.value, chain.here[1] + p.y.value)
            block = builder.line(chain, end, span)
        elif kind == "arc_center":
            block = builder.arc_center(chain, turn, self._xy(items[0]), self._xy(items[1]), span)
        elif kind == "arc_radius":
            r = scope.length(items[1])
            block = builder.arc_radius(chain, turn, self._xy(items[0]), r.value, span)
        elif kind == "arc_sweep":
            block = builder.arc_sweep(chain, turn, self._xy(items[0]), scope.number(items[1]), span)
        elif kind == "arc_tangent":
            block = builder.arc_tangent(chain, self._xy(items[0]), span)
        elif kind == "close":
            self._close(builder, chain, corner, span)
            return
        if block is None:
            scope.findings.append(
                warning("zero-length", "this block ends where it starts and is left out", span)
            )
        elif corner is not None:
            block.corner = corner

    def _close(
        self,
        builder: Builder,
        chain: Chain,
        corner: tuple[str, Number, TextSpan] | None,
        span: TextSpan,
    ) -> None:
        if not chain.blocks:
            raise wrong("there is nothing to close yet")
        if float(size(*minus(chain.here, chain.start))) * self.scope.factor > SAME_PLACE_UM:
            builder.line(chain, chain.start, span)
        else:
            chain.blocks[-1].end = chain.start
        chain.closed = True
        if corner is not None:
            chain.blocks[-1].corner = corner

    def _xy(self, node: Node) -> tuple[object, object]:
        p: Point = self.scope.point(node)
        return p.x.value, p.y.value


def _place(d: Diagnostic) -> tuple[int, int]:
    """Return where a finding stands in the text."""
    return (d.span.line, d.span.column) if isinstance(d.span, TextSpan) else (0, 0)


def _name_node(tree: Node) -> Node | None:
    """Return the name that a statement gives, or None."""
    if tree.kind == "heading":
        return tree.items[0]
    if tree.items and tree.items[0].kind == "let":
        return tree.items[0].items[0]
    return None
