"""Machine: what one controller or dialect takes, as values.

Machines are data, one TOML each. The limits bind formats and profiles, not the compiler. Every
field here is read by an encoder, a decoder or lowering; what nothing reads is not a knob.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from wedmcam.machines.vocabulary import Vocabulary

if TYPE_CHECKING:
    from wedmcam.controllers import Stepping


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest numbers that fit, all inclusive.

    Attributes:
        count_um: count length J of one block.
        line_um: |x| and |y| of one line, and of one move that is no G00 (`Machine.move_um`).
        arc_um: |x| and |y| of an arc's start from its centre. A radius up to this fits wherever
            the arc starts; a compact controller refuses a larger radius.
        memory_bytes: bytes of a binary program, end byte included; 0 for no limit.
        blocks: records of a text program, control records included; 0 for no limit.
        travel_um: how far the table goes, (x, y); None for no limit.
        line_chars: characters of one line of an ISO program, header and footer too, without blanks
            and without text in parentheses or behind a semicolon; 0 for no limit.
    """

    count_um: int
    line_um: int
    arc_um: int
    memory_bytes: int = 0
    blocks: int = 0
    travel_um: tuple[int, int] | None = None
    line_chars: int = 0


@dataclass(frozen=True, slots=True)
class Words:
    """Control records of a 3B dialect, upper case, all different.

    Attributes:
        pause: the machine waits for the operator (threading, a piece that comes loose).
        stop: end of cutting, after the last block.
        end: end of the program, where a file has one.
    """

    pause: str = "D"
    stop: str = "DD"
    end: str = "E"


@dataclass(frozen=True, slots=True)
class Layout:
    """How a 3B record is laid out: ``N1: B  9900 B     0 B 039600 GY NR1 ; -0.100 , 0.000``.

    Attributes:
        after_b: between a B and its number.
        between: before the second and third B, before G and before Z.
        width: X, Y and J are right-aligned with blanks to this many characters.
        count_digits: where more than 1, J has this many digits instead, zeros in front.
        number_width: digits of N numbers, right-aligned with blanks; 0 for no N numbers. Control
            records are numbered too.
        after_number: what follows an N number.
        header: lines before the first record.
        footer: lines after the last record.
        end_coordinates: each cutting record ends in ``; x , y``: where it ends, absolute, mm.
        eol: what ends every line, the last included.
        encoding: of header and footer; records are ASCII.
    """

    after_b: str = ""
    between: str = ""
    width: int = 1
    count_digits: int = 1
    number_width: int = 0
    after_number: str = ": "
    header: tuple[str, ...] = ()
    footer: tuple[str, ...] = ()
    end_coordinates: bool = False
    eol: str = "\n"
    encoding: str = "ascii"


@dataclass(frozen=True, slots=True)
class Iso:
    """How ISO records are written, and what a program means that does not say it itself.

    Where `coordinates`, `integers`, `points` or `ij` is ``open``, the profile does not say it: a
    file that leaves it open too is asked. What is written then is G90, and from the start.

    Attributes:
        coordinates: ``incremental`` (G91) or ``absolute`` (G90, drawing coordinates).
        unit: ``um``: whole numbers; ``mm``: digits behind a point.
        integers: what 1 is in a number without a point where a program is read: ``um``, ``mm``,
            ``inch`` or ``0.0001in``. In the other system of units (G20 in a profile of mm, G21 in
            one of inches) it is the like of it (um and 0.0001 in, mm and inch), where the profile
            knows that code.
        points: what 1 is in a number with a point before the first G20, G21, G70 or G71.
        ij: what I and J of an arc are: ``start``: they lead from its start to its centre;
            ``absolute``: under G90 they are the place of the centre; ``to-start``: they lead from
            the centre to the start.
        semicolon: what stands behind ``;``: ``comment``, or a ``block`` of its own; not set: the
            profile does not say it.
        subprograms: how subprograms are called: ``N-label``: M98 P0001 runs the blocks from N0001
            to M99; ``O-number``: M98 P1234 runs those from O1234 to M99; ``none``: they are not.
        code_digits: of G and M codes: 2 writes G01, 1 writes G1.
        rapid: moves are G00; else G01 between two M00.
        sign: ``negative`` writes a minus only, ``always`` a plus too.
        width: numbers have at least so many characters, zeros in front, the sign not counted.
        between: what parts the words of a line.
        decimals: digits behind the point with ``unit`` mm.
        compensation: ``computed``: the path of the wire is written (G40); ``controller``: the
            outline is, with G41 or G42, and the offset is entered at the controller.
        full_circle: ``halves``: a full circle is two arcs of half a turn; ``one``: it is one, which
            ends where it starts. Some controllers take such an arc for none, or for a turn or none
            as the place falls. Of paths of the wire; an outline in G41 or G42 keeps its circle.
        d: number of the first offset in the controller's table; a program with several offsets
            takes the next ones too.
        offsets: what an entry of the controller's table is: ``radius``: how far the wire runs
            beside the outline; ``diameter``: twice that.
        offset_word: the letter of the numbers of offsets, ``D`` or ``H``; the other one is refused
            where a program is read. ``either``: D is written, and either is read.
        offset_change: what another number of an offset does while the path is offset: ``refused``:
            it is not known; ``skewed``: a straight block runs from the old offset to the new one.
        start: how a program tells where it starts: ``g92`` says that the wire stands there and what
            its place is called; ``move`` sets nothing and goes there with G00 in coordinates that
            are set at the machine, with a wire that stands there already. The first G00 of a
            program that is read then tells its start, and is no move.
        feed_um: F that is written where no ``--feed`` is given, um a minute; not set: no F at all.
            With it F is a word that is known where a program is read.
        arc_least_um: the controller refuses arcs of a smaller radius at start or end; they are
            written as lines. 0 for no such limit.
        packed_calls: P of more than four digits holds how often a numbered program is run, and its
            number: P51002 runs O1002 five times.
        modes: G codes of a line in front of G90 or G91, behind the header: the modes that the rest
            of a program depends on, whatever a controller was left in.
        feed_least_um: the controller cuts no slower than this, um a minute, whatever F says; 0 for
            no such limit.
        words: see `Vocabulary`.
    """

    coordinates: str = "incremental"
    unit: str = "um"
    integers: str = "um"
    points: str = "mm"
    ij: str = "start"
    semicolon: str = ""
    subprograms: str = "none"
    code_digits: int = 2
    rapid: bool = False
    sign: str = "negative"
    width: int = 1
    between: str = " "
    decimals: int = 3
    compensation: str = "computed"
    full_circle: str = "halves"
    d: int = 1
    offsets: str = "radius"
    offset_word: str = "either"
    offset_change: str = "refused"
    start: str = "g92"
    feed_um: int = 0
    arc_least_um: int = 0
    packed_calls: bool = False
    modes: str = ""
    feed_least_um: int = 0
    words: Vocabulary = field(default_factory=Vocabulary)

    @property
    def entry_factor(self) -> int:
        """How many offsets an entry of the controller's table is: 2 of a diameter, else 1."""
        return 2 if self.offsets == "diameter" else 1

    @property
    def offset_letter(self) -> str:
        """The letter with which numbers of offsets are written.

        >>> Iso().offset_letter, Iso(offset_word="H").offset_letter
        ('D', 'H')
        """
        return "D" if self.offset_word == "either" else self.offset_word


@dataclass(frozen=True, slots=True)
class Axes:
    """How the axes of the drawing lie on those of the controller, and how far a pulse moves them.

    A place (x, y) of the drawing is first mirrored, then exchanged: mirror_x makes it (-x, y),
    mirror_y (x, -y), exchange then (y, x). So mirrors speak of the drawing's axes: with exchange
    and mirror_x the drawing's x runs along -Y of the controller, and its y along X. One mirror or
    an exchange alone turns the sense of arcs around; two of them are a rotation and do not.

    Programs, their limits, travel and 45 degree lines are in the controller's frame; all reports,
    pictures and drawings in the frame of the drawing.

    A controller counts pulses; step_um is how far one moves the machine. A unit in a program (1, or
    0.001 in a file in mm) is one pulse, whatever the controller calls it, and limits on numbers
    count pulses: with 5 um a program of 3B reaches 4999.995 mm. What is proven then are twice as
    many um as a pulse moves, for the path, and 1.6 times as many for the gouge: 20 and 16 um with
    steps of 10 um. Thread points lie on whole steps from the drawing's zero.

    Attributes:
        exchange: the drawing's x lies along the controller's Y, and its y along X.
        mirror_x: what goes towards +x in the drawing goes towards minus at the machine.
        mirror_y: likewise for y.
        step_um: how far one pulse of the controller moves the machine, um.
    """

    exchange: bool = False
    mirror_x: bool = False
    mirror_y: bool = False
    step_um: float = 1.0

    @property
    def plain(self) -> bool:
        """Whether the axes of drawing and controller are the same."""
        return not (self.exchange or self.mirror_x or self.mirror_y)

    @property
    def text(self) -> str:
        """What is done to the axes, for people; empty for nothing.

        >>> Axes(exchange=True, mirror_x=True).text, Axes(step_um=2).text
        ('x mirrored, then x and y exchanged', 'steps of 2 um')
        """
        mirrored = [name for name, on in (("x", self.mirror_x), ("y", self.mirror_y)) if on]
        words = [f"{' and '.join(mirrored)} mirrored"] if mirrored else []
        words += ["x and y exchanged"] if self.exchange else []
        turned = ", then ".join(words)
        step = f"steps of {self.step_um:g} um" if self.step_um != 1 else ""
        return "; ".join(t for t in (turned, step) if t)


@dataclass(frozen=True, slots=True)
class Vectors:
    """How a controller runs displacement vectors, and what its job records say of the generator.

    Attributes:
        direction: how the speeds of the axes are computed: ``root``: in whole numbers, by the root
            of the vector's length; ``sines``: by sine and cosine from a table of 255 values.
        positions: what a position counts: ``um``: a step is 2; ``steps``: a step is 1, and 16 bits
            reach twice as far.
        speed: of cutting where no ``--feed`` is given, in units of 15.75 um a minute.
        t_i: control word of the pulse duration, 5 V at 255.
        t_p: control word of the pulse period, 15 V at 255.
    """

    direction: str = "root"
    positions: str = "um"
    speed: int = 64
    t_i: int = 100
    t_p: int = 200


@dataclass(frozen=True, slots=True)
class Machine:
    """One controller or dialect.

    Attributes:
        name: of the profile, e.g. ``b3-compact``.
        title: one line for people.
        format: what programs are written in and read as.
        line_table: which axis a line steps first outside quadrants 1 and 3, and with it on which
            axis a 45 degree line is counted: see `controllers.pointwise.LineTable`. In the
            controller's own frame; `table` is how it looks from the drawing.
        count: ``exact``: J by running the interpolator; ``textbook``: J by geometry.
        limits: see `Limits`.
        words: see `Words`; used by 3B.
        layout: see `Layout`; used by 3B and, as far as it fits, by ISO.
        iso: see `Iso`; used by ISO.
        vectors: see `Vectors`; used by the DEM-15.
        axes: see `Axes`.
        writes: programs are written for it; else they are only read. A profile that only reads says
            what a source states of its machine, and leaves the rest to the file and the user.
    """

    name: str
    title: str
    format: str
    line_table: Literal["mirror", "rotate"]
    count: Literal["exact", "textbook"]
    limits: Limits
    words: Words = field(default_factory=Words)
    layout: Layout = field(default_factory=Layout)
    iso: Iso = field(default_factory=Iso)
    axes: Axes = field(default_factory=Axes)
    writes: bool = True
    vectors: Vectors = field(default_factory=Vectors)

    @property
    def table(self) -> str:
        """How lines are stepped, as it looks from the drawing: a name for `stepping_of`.

        Mostly a value of `pointwise.LineTable`.

        >>> from dataclasses import replace
        >>> from wedmcam.machines import builtin
        >>> classic = builtin("b3-compact")
        >>> classic.table, replace(classic, axes=Axes(mirror_y=True)).table
        ('rotate', 'rotate-exchanged')
        """
        a = self.axes
        if self.is_of("dem15"):
            return self.own_table + "-exchanged" * a.exchange
        if self.line_table == "mirror":  # every quadrant alike: mirrors change nothing
            turned = a.exchange
        else:  # quadrants 1 and 3 change places with 2 and 4 at every mirror, x with y at exchange
            turned = a.exchange ^ a.mirror_x ^ a.mirror_y
        return f"{self.line_table}-exchanged" if turned else self.line_table

    @property
    def own_table(self) -> str:
        """How lines are stepped in the controller's own frame: a name for `stepping_of`.

        >>> from wedmcam.machines import builtin
        >>> builtin("b3-compact").own_table, builtin("dem15").own_table
        ('rotate', 'root-um')
        """
        if self.is_of("dem15"):
            return f"{self.vectors.direction}-{self.vectors.positions}"
        return self.line_table

    @property
    def stepping(self) -> Stepping:
        """Its interpolator, as it looks from the drawing.

        >>> from wedmcam.machines import builtin
        >>> builtin("zd065").stepping
        Pointwise(table=<LineTable.MIRROR: 'mirror'>)
        """
        from wedmcam.controllers import stepping_of

        return stepping_of(self.format, self.table)

    @property
    def move_um(self) -> int | None:
        """|x| and |y| of one move between two cuts; None for any: G00 is no block that counts.

        Nor is a vector of the DEM-15 longer than the table, which the writer looks at.
        """
        free = self.is_of("dem15") or (self.is_of("iso") and self.iso.rapid)
        return None if free else self.limits.line_um

    @property
    def own_stepping(self) -> Stepping:
        """Its interpolator in the controller's own frame, in which programs are written."""
        from wedmcam.controllers import stepping_of

        return stepping_of(self.format, self.own_table)

    @property
    def counts_speed(self) -> bool:
        """Whether ``count`` of a line is its cutting speed, and no count length."""
        return self.is_of("dem15")

    def is_of(self, format_: str) -> bool:
        """Return whether its programs are in a format."""
        return self.format == format_
