"""What is asked of a plan: where the wire runs, how it gets there, and which part of it is cut."""

from __future__ import annotations

from dataclasses import dataclass

from wedmcam.diag.run import WrongUse
from wedmcam.ir.choices import Order, Side
from wedmcam.option_table import check_kinds, usual

#: Sides that need an offset.
SIDED = (Side.PART, Side.DIE, Side.LEFT, Side.RIGHT)
#: Who can take a clearance -> the side on which it is cut.
CLEARANCE_ON = {"die": Side.DIE, "punch": Side.PART}


@dataclass(frozen=True, slots=True)
class Cutting:
    """Where the wire runs. Lengths in um.

    Attributes:
        offset_um: from the outline to the wire's centre; None where none was given.
        side: None for ``part`` with an offset and ``on`` without.
        layer_sides: name or wildcard of a layer, and the side of its contours.
        layer_offsets: likewise, and wire / 2 + gap of its contours.
        clearance_um: what punch and die leave between them on each side; whoever takes it is cut
            that much nearer to its outline, and behind it where that is more than the offset.
        clearance_on: who takes it, "die" or "punch".
        corner_um: radius rounded onto the part's own corners; 0 for none, with ``paper`` for the
            largest offset.
        paper: corners of the outline where a line meets a line or an arc have an arc, those
            between arcs none.
        sharp: at a corner that the wire goes round the offset lines are prolonged to meet.
        trim: leave out what the wire cannot reach instead of refusing.
        thin_wall_um: kept material thinner than this is a warning; 0 for none.
    """

    offset_um: float | None = usual("offset_um")
    side: Side | None = usual("side")
    layer_sides: tuple[tuple[str, Side], ...] = usual("layer_sides")
    layer_offsets: tuple[tuple[str, float], ...] = usual("layer_offsets")
    clearance_um: float = usual("clearance_um")
    clearance_on: str = usual("clearance_on")
    corner_um: float = usual("corner_um")
    paper: bool = usual("paper")
    sharp: bool = usual("sharp")
    trim: bool = usual("trim")
    thin_wall_um: float = usual("thin_wall_um")

    def __post_init__(self) -> None:
        check_kinds(self)
        if self.side is Side.ON and self.offset_um and not self.layer_sides:
            raise WrongUse("--side on runs on the line: it takes no offset")
        self._check_layers()
        if self.paper and self.sharp:
            raise WrongUse(
                "--convex sharp with --corners paper: no corner is left that could be prolonged; "
                "leave one of the two out"
            )
        if self.clearance_on not in CLEARANCE_ON:
            raise WrongUse(f"--clearance-on takes die or punch, not '{self.clearance_on}'")
        sided = [(side, um) for side, um in self._stated_sides() if side in SIDED]
        least = min((um - self.taken_um(side) for side, um in sided), default=0.0)
        if 0 < self.corner_um < least:
            raise WrongUse(
                f"--corner {self.corner_um / 1000:.3f} mm is below the offset "
                f"{least / 1000:.3f} mm: the wire could not follow it"
            )

    def _check_layers(self) -> None:
        """Refuse sides and offsets of layers that do not fit together."""
        for option, stated in (("side", self.layer_sides), ("offset", self.layer_offsets)):
            names = [name.casefold() for name, _ in stated]
            for name in names:
                if not name or names.count(name) > 1:
                    what = "is named twice" if name else "names no layer"
                    raise WrongUse(f"--layer-{option} {name}: {what}")
        for name, um in self.layer_offsets:
            if um <= 0:
                raise WrongUse(f"--layer-offset {name} must be above 0: the side says which way")
        offsets = {name.casefold() for name, _ in self.layer_offsets}
        for name, side in self.layer_sides:
            if side is Side.ON and name.casefold() in offsets:
                raise WrongUse(f"--layer-side {name}=on runs on the line: it takes no offset")

    def check_offsets(self) -> None:
        """Refuse sides to cut on without an offset.

        Raises:
            WrongUse: it names the side, or the layer.
        """
        if self.side in SIDED and not self.offset_um:
            raise WrongUse(f"--side {self.side} needs an offset (--offset, or --wire and --gap)")
        offsets = {name.casefold() for name, _ in self.layer_offsets}
        for name, side in self.layer_sides:
            if side in SIDED and not (name.casefold() in offsets or self.offset_um):
                raise WrongUse(f"--layer-side {name}={side} needs an offset")

    def check_clearance(self) -> None:
        """Refuse a clearance that no contour takes.

        Raises:
            WrongUse: with what would take it.
        """
        takes = CLEARANCE_ON[self.clearance_on]
        if self.clearance_um and not any(s is takes and um for s, um in self._stated_sides()):
            raise WrongUse(
                f"--clearance is taken by the {self.clearance_on}, and nothing is cut as one: "
                f"--side {takes}, --layer-side NAME={takes}, or --clearance-on "
                f"{'punch' if self.clearance_on == 'die' else 'die'}"
            )

    def _stated_sides(self) -> list[tuple[Side, float]]:
        """Return every side that is stated, with its offset."""
        every = self.offset_um or 0.0
        sides = {name.casefold(): side for name, side in self.layer_sides}
        offsets = {name.casefold(): um for name, um in self.layer_offsets}
        return [
            (self.effective_side, every),
            *((side, offsets.get(name, every)) for name, side in sides.items()),
            *((sides.get(name, self.side or Side.PART), um) for name, um in offsets.items()),
        ]

    def taken_um(self, side: Side) -> float:
        """Return by how much less than wire / 2 + gap the wire keeps from outlines of a side."""
        return self.clearance_um if side is CLEARANCE_ON[self.clearance_on] else 0.0

    @property
    def effective_side(self) -> Side:
        """The side in force."""
        if self.side is not None:
            return self.side
        return Side.PART if self.offset_um else Side.ON


@dataclass(frozen=True, slots=True)
class Leading:
    """Where the wire is threaded, how it comes to its path and leaves it. Lengths in um.

    Attributes:
        starts_um: thread points, drawing coordinates.
        lead_um: length of a lead where no thread point is given.
        stop_um: how far before its end each closed path pauses; 0 for no pause.
        overcut_um: how far past its start each closed path is cut.
        order: see `Order`; None for inner-first.
        reverse: clockwise instead of counter-clockwise; cuts of a part program the other way than
            it says.
    """

    starts_um: tuple[tuple[float, float], ...] = usual("starts_um")
    lead_um: float = usual("lead_um")
    stop_um: float = usual("stop_um")
    overcut_um: float = usual("overcut_um")
    order: Order | None = usual("order")
    reverse: bool = usual("reverse")

    def __post_init__(self) -> None:
        check_kinds(self)


@dataclass(frozen=True, slots=True)
class Portion:
    """Which part of a program is cut.

    Attributes:
        cuts: only these contours of the program, first and last, 1-based; None for all.
        blocks: only these blocks of the program of these contours, likewise: a load that begins or
            ends in the kerf of a contour.
        from_block: only the rest of the program from this block on, 1-based; 0 for all of it.
        backwards: the rest of the contour of ``from_block`` from its end back to that block.
    """

    cuts: tuple[int, int] | None = usual("cuts")
    blocks: tuple[int, int] | None = usual("blocks")
    from_block: int = usual("from_block")
    backwards: bool = usual("backwards")

    def __post_init__(self) -> None:
        check_kinds(self)
        if self.cuts is not None and not 1 <= self.cuts[0] <= self.cuts[1]:
            raise WrongUse("--cuts takes the first and the last contour, such as 2-5")
        if self.blocks is not None and not 1 <= self.blocks[0] <= self.blocks[1]:
            raise WrongUse("--blocks takes the first and the last block, such as 1-480")
        if self.blocks is not None and self.from_block:
            raise WrongUse(
                "--blocks is a load of the whole program: not of what --from-block leaves"
            )
        if self.backwards and not self.from_block:
            raise WrongUse("--backwards goes with --from-block N: back to where that block starts")
