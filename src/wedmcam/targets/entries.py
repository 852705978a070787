"""What the operator enters beside a file: copies and an angle, a gap and its side, a table of D.

A file in the ZD-065's rotation or compensation format is a figure; the cutting program is what the
controller makes of it with these numbers (``controllers.zd065``). An ISO file with G41 or G42 holds
outlines, and the table of D numbers says how far beside them the wire runs. Reader and writer of a
target do not know each other: both are handed the same entries.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from wedmcam.controllers.nby15.corrector import MOST_UM
from wedmcam.controllers.nby15.data import Switches
from wedmcam.diag.run import WrongUse

if TYPE_CHECKING:
    from wedmcam.frontends.iso.dialect import Dialect

#: Formats of outlines whose arcs the controller scales by a gap.
GAPPED = ("compensation", "4b")
#: Most copies of a figure [S].
MOST_COPIES = 99
#: Longest line of the ZD-065 on an axis, um: J has 6 digits [S].
MOST_LEAD_UM = 999_999


@dataclass(frozen=True, slots=True)
class Entries:
    """Numbers that belong to a rotation or a compensation file, or to ISO with G41 or G42.

    Attributes:
        copies: of a figure in rotation format, 0 to 99 [S].
        angle: degrees from copy to copy, counter-clockwise.
        lead_in: line before the figure, from the thread point to where it starts, whole um; None
            where none is entered: the format holds no lead outside the figure that it repeats. Of a
            compensation file: instead of its lead, to where its outline starts.
        lead_out: line behind the last copy, or instead of the lead back, likewise.
        open_loop: the ZD-065 processes data literally: roundings add up from block to block.
        gap_um: of a compensation or 4B file, whole um; None where it is not stated: what is read
            then is the outline, and `Target.unstated` says so.
        outwards: True for a part (punch), False for a die.
        corner_um: of a compensation file: radius of the arcs at corners of the outline, um, at
            least the gap; None for the gap.
        d: numbers and entries of the table of a controller that offsets an ISO program, um.
        letter: of those numbers, ``D`` or ``H``.
        diameter: an entry is twice the offset.
        every_um: the offset of all D numbers where ``d`` is empty; None where none is stated.
        dialect: how a foreign ISO program is read; None where its machine is known.
        switches: as set at an NBY-15: corrector, scale, directions of the axes.
        run_off: what its corrector is not safe for is run all the same, as the machine does.
    """

    copies: int = 0
    angle: float = 0.0
    gap_um: float | None = None
    outwards: bool = True
    corner_um: float | None = None
    d: tuple[tuple[int, float], ...] = ()
    letter: str = "D"
    diameter: bool = False
    every_um: float | None = None
    dialect: Dialect | None = None
    lead_in: tuple[int, int] | None = None
    lead_out: tuple[int, int] | None = None
    open_loop: bool = False
    switches: Switches = Switches()  # noqa: RUF009
    run_off: bool = False

    def __post_init__(self) -> None:
        if not 0 <= self.copies <= MOST_COPIES:
            raise WrongUse(f"--copies {self.copies}: the controller makes 0 to {MOST_COPIES}")
        if self.copies and not self.angle:
            raise WrongUse(
                f"--copies {self.copies} without an angle: --angle, other than 0, turns each copy"
            )
        if abs(self.switches.correct_um) > MOST_UM:
            raise WrongUse(
                f"--correct {self.switches.correct_um}: the corrector has a sign and three digits, "
                f"-{MOST_UM} to {MOST_UM} um"
            )
        for name, way in (("lead-in", self.lead_in), ("lead-out", self.lead_out)):
            if way is not None and max(abs(v) for v in way) > MOST_LEAD_UM:
                raise WrongUse(
                    f"--{name} {_mm(way)}: a line of the controller is up to "
                    f"{MOST_LEAD_UM / 1000:.3f} mm long on each axis"
                )

    @property
    def stated(self) -> bool:
        """Whether anything is entered beside a gap and a table."""
        return self.turns or self.open_loop or self.run_off or not self.switches.plain

    @property
    def turns(self) -> bool:
        """Whether copies or leads are entered."""
        return bool(self.copies) or self.lead_in is not None or self.lead_out is not None

    def check(self, source: str, target: str) -> None:
        """Refuse what neither format takes.

        Args:
            source: format of the program that is read.
            target: format that is written.

        Raises:
            WrongUse: with what would take it.
        """
        if (self.copies or self.angle) and source != "rotation":
            raise WrongUse(f"--copies and --angle turn a figure in rotation format, not {source}")
        if self.turns and source not in ("rotation", "compensation"):
            raise WrongUse(
                "--lead-in and --lead-out belong to a compensation file or a figure in rotation "
                f"format, not to {source}"
            )
        if self.open_loop and source not in ("rotation", "compensation"):
            raise WrongUse(
                "--open-loop is for the ZD-065's rotation and compensation formats, not for "
                f"{source}"
            )
        if (self.run_off or not self.switches.plain) and source != "nby15":
            raise WrongUse(
                "--correct, --scale, --mirror-axes and --run-off are switches of the NBY-15: "
                f"for nby15, not for {source}"
            )
        if self.d and source != "iso":
            raise WrongUse(f"--d is for ISO programs with G41 or G42, not for {source}")
        if self.corner_um is not None and (source != "compensation" or not self.gap_um):
            raise WrongUse(
                "--corner is the radius of the arcs at corners of a compensation file that is "
                "read, and goes with its --gap"
            )
        if not self.gap_um:
            return
        if not {source, target} & {*GAPPED}:
            raise WrongUse(
                f"--gap is for the compensation format and 4B, not for {source} to {target}"
            )
        if {source, target} <= {*GAPPED}:
            raise WrongUse(f"--gap would be applied to {source} data that stay an outline")
        if self.gap_um != round(self.gap_um) or self.gap_um < 0:
            raise WrongUse(f"--gap is a whole number of um from 0 on, not {self.gap_um:g} um")

    def offset_of(self) -> Callable[[int], float | None] | None:
        """Return the offset of each number of the controller's table, um; None where none is.

        Raises:
            WrongUse: an offset below 0, or two for one number.

        >>> table = Entries(d=((1, 100.0),)).offset_of()
        >>> table(1), table(2), Entries().offset_of(), Entries(every_um=90.0).offset_of()(7)
        (100.0, None, None, 90.0)
        """
        entered: dict[int, float] = {}
        for number, offset in self.d:
            if offset < 0:
                raise WrongUse(
                    f"--d {number}: an offset is not negative; G41 and G42 tell the side (one "
                    "below 0 would be the same offset with the other of the two)"
                )
            offset = offset / 2 if self.diameter else offset
            if entered.setdefault(number, offset) != offset:
                raise WrongUse(f"--d {number} is given twice")
        if entered:
            return entered.get
        every = self.every_um
        return None if every is None else lambda number: every

    def lines(self) -> list[tuple[str, str]]:
        """Return the entries as people enter them.

        >>> Entries(d=((1, 101.6),)).lines(), Entries(d=((1, 200.0),), diameter=True).lines()
        ([('D1', '0.1016 mm')], [('D1', '0.2000 mm (diameter)')])
        """
        what = " (diameter)" if self.diameter else ""
        return [(f"{self.letter}{number}", f"{um / 1000:.4f} mm{what}") for number, um in self.d]

    def turn_lines(self) -> list[tuple[str, str]]:
        """Return what is entered for a figure in rotation format, as people enter it.

        >>> Entries(35, 10.0, lead_in=(0, 3100)).turn_lines()
        [('copies', '35'), ('angle', '10 deg'), ('lead-in', 'X 0.000 Y 3.100 mm')]
        """
        rows = [("copies", f"{self.copies}"), ("angle", f"{self.angle:.8g} deg")]
        named = (("lead-in", self.lead_in), ("lead-out", self.lead_out))
        rows += [(name, _mm(way)) for name, way in named if way is not None]
        return rows if self.turns else []

    def as_data(self) -> dict[str, Any]:
        """Return what is entered for a figure in rotation format, as a certificate holds it.

        >>> Entries(35, 10.0, lead_in=(0, 3100)).as_data()
        {'copies': 35, 'angle_deg': 10.0, 'lead_in_um': [0, 3100], 'lead_out_um': None}
        """
        if not self.turns:
            return {}
        ways = {
            f"{name}_um": None if way is None else list(way)
            for name, way in (("lead_in", self.lead_in), ("lead_out", self.lead_out))
        }
        return {"copies": self.copies, "angle_deg": self.angle, **ways}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Entries:
        """Return entries of a certificate; the inverse of `as_data`.

        Raises:
            WrongUse: they are none.
        """
        ways = (data.get("lead_in_um"), data.get("lead_out_um"))
        whole = [None if way is None else (int(way[0]), int(way[1])) for way in ways]
        return cls(
            int(data.get("copies", 0)),
            float(data.get("angle_deg", 0.0)),
            lead_in=whole[0],
            lead_out=whole[1],
        )


def entered_of(
    copies: int | None,
    angle: float | None,
    lead_in: tuple[float, float] | None,
    lead_out: tuple[float, float] | None,
    open_loop: bool = False,
    switches: Switches | None = None,
    run_off: bool = False,
) -> Entries:
    """Return the entries for a figure in rotation format, or a tape, as options state them, um.

    Raises:
        WrongUse: a lead that is no whole um, or entries that do not fit together.
    """
    if (copies is None) != (angle is None):
        raise WrongUse("--copies and --angle go together")
    return Entries(
        copies or 0,
        angle or 0.0,
        lead_in=whole_um(lead_in, "--lead-in"),
        lead_out=whole_um(lead_out, "--lead-out"),
        open_loop=open_loop,
        switches=switches or Switches(),
        run_off=run_off,
    )


def whole_um(way: tuple[float, float] | None, option: str) -> tuple[int, int] | None:
    """Return a lead of whole um.

    Raises:
        WrongUse: it is none.

    >>> whole_um((0.0, -3100.0), "--lead-in")
    (0, -3100)
    """
    if way is None:
        return None
    x, y = round(way[0]), round(way[1])
    if max(abs(x - way[0]), abs(y - way[1])) > 1e-6:
        raise WrongUse(f"{option} is whole um, not {way[0] / 1000:g},{way[1] / 1000:g} mm")
    return x, y


def _mm(way: tuple[int, int]) -> str:
    return f"X {way[0] / 1000:.3f} Y {way[1] / 1000:.3f} mm"
