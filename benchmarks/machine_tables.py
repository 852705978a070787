"""The measured parts of docs/machines.md: one part on every machine, and one arc under a glass.

``benchmarks/pages.py`` writes the page and its picture; a test compares them.
"""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from wedmcam import api
from wedmcam.compiler.results import Compilation
from wedmcam.machines import reading
from wedmcam.simulate.controllers import CONTROLLERS
from wedmcam.simulate.feeding import feeding_of
from wedmcam.simulate.laws import LAWS
from wedmcam.simulate.motion import Setup
from wedmcam.simulate.process import Way
from wedmcam.simulate.record import Record
from wedmcam.simulate.run import run
from wedmcam.simulate.scenario import Fault, Trouble, fault_of, scenario_of
from wedmcam.targets import Entries, target_of

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "machines.md"
FIGURE = ROOT / "docs" / "figures" / "machines-arc.svg"
PART = ROOT / "samples" / "quarter.wed"

#: Controller -> its format.
FORMATS = {name: one.format for name, one in CONTROLLERS.items()}
#: What goes wrong at each machine, um of the path.
SHORT_UM, SHORT_LENGTH_UM, BREAK_UM, POWER_UM = 12_000, 60, 30_000, 50_000
#: Of the path that is cut with a servo, um; one seed.
SERVO_UM, SEED = 1500, 1
#: The arc under the glass: radius, mm, and how much of it is shown, degrees.
RADIUS_MM, FROM, TO = 20, 20.0, 24.0

CIRCLE = (
    'part "a circle"\n'
    f"contour c {{ circle center (0, 0) radius {RADIUS_MM - 0.1:g} }}\n"
    f"cut c outside offset 0.1 start ({RADIUS_MM + 1}, 0)\n"
)


@cache
def compilation(format_: str, text: str | None = None) -> Compilation:
    """Return the sample, or a text, compiled to a format at 1 mm a minute."""
    source = PART if text is None else text.encode()
    name = None if text is None else "circle.wed"
    result = api.compile(source, to=format_, name=name, feed=1.0)
    assert result.ok, result.findings
    return result


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a table of Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def part_table() -> str:
    """Return what the same part is on each machine."""
    rows = []
    for name, format_ in FORMATS.items():
        result = compilation(format_)
        facts, data = result.summary, result.data
        assert data is not None
        limits = facts["limits"]
        rows.append(
            [
                CONTROLLERS[name].title,
                f"`--to {format_}`",
                f"{len(data):,}",
                f"{facts['blocks']:,}",
                f"{facts['steps']:,} of {facts['step_um']} um",
                f"{facts['max_deviation_um']:.2f} (limit {limits['path_um']:g})",
                f"{facts['gouge_um']:.2f} (limit {limits['gouge_um']:g})",
                f"{facts['closure_um']:g}",
            ]
        )
    head = ["controller", "format", "bytes", "blocks that run", "steps"]
    return table([*head, "deviation, um", "into the part, um", "closure, um"], rows)


def record_of(name: str, faults: list[Fault], servo: str | None = None) -> Record:
    """Return a run of the sample on a controller; screws without play."""
    controller = CONTROLLERS[name]
    machine = reading(controller.format)
    data = compilation(controller.format).data
    assert data is not None
    program, _ = target_of(machine).read(data, "sample", Entries())
    route = controller.lay(program, machine.stepping)
    feeder = None if servo is None else feeding_of(servo, SEED, step_um=route.step_um)
    setup = Setup(backlash=(0, 0), play=(0, 0))
    ends = servo is not None
    done, wrong = run(
        controller, route, scenario_of(faults), setup, stop_at_power=ends, feeder=feeder
    )
    assert done is not None, wrong
    return done


def fault_table() -> str:
    """Return what each controller does about the same faults, and where it ends."""
    rows = []
    for name, controller in CONTROLLERS.items():
        um = int(reading(controller.format).axes.step_um)
        texts = (
            f"short@{SHORT_UM // um}:{SHORT_LENGTH_UM}",
            f"break@{BREAK_UM // um}",
            f"power@{POWER_UM // um}",
        )
        faults = [fault for text in texts if (fault := fault_of(text)) is not None]
        record, plain = record_of(name, faults), record_of(name, [])
        same = record.final_um == plain.final_um and record.state.axes == plain.state.axes
        walked = dict.fromkeys(Way, 0)
        for session in record.sessions:
            for leg in session.legs:
                walked[leg.way] += leg.steps
        back = walked[Way.RETURN] + walked[Way.SHORTEST]
        rows.append(
            [
                controller.title,
                f"{walked[Way.RETREAT] * um} um back along the path",
                f"{walked[Way.SERVO_FEED] * um} um with a reference current"
                if controller.answers.servo_feed
                else "cut again",
                f"back to the thread point, {back * um:,} um" if back else "threaded on the spot",
                "on from the saved state",
                "as without faults" if same else "elsewhere",
            ]
        )
    head = ["controller", f"short circuit, free {SHORT_LENGTH_UM} um back", "forward again"]
    return table([*head, "wire break", "power cut", "end"], rows)


def servo_table() -> str:
    """Return how long the first stretch of the sample takes with each law at each controller."""
    rows = []
    for name, controller in CONTROLLERS.items():
        um = int(reading(controller.format).axes.step_um)
        cells = []
        for servo in LAWS:
            record = record_of(name, [Fault(Trouble.POWER, SERVO_UM // um)], servo)
            shorts = sum(event.kind == "short" for event in record.events)
            cells.append(f"{record.state.time_s:.0f} s, {shorts} shorts")
        rows.append([controller.title, *cells])
    return table(["controller", *(f"`--servo {servo}`" for servo in LAWS)], rows)


def radial(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return angle, degrees, and how far outside its circle each place of an arc lies, um."""
    controller = CONTROLLERS[name]
    machine = reading(controller.format)
    data = compilation(controller.format, CIRCLE).data
    assert data is not None
    program, _ = target_of(machine).read(data, "circle", Entries())
    places = machine.stepping.trace(program.blocks)[0] * program.step_um
    x, y = (places + np.array([RADIUS_MM * 1000 + 1000, 0])).T
    off = np.hypot(x, y) - RADIUS_MM * 1000
    on_circle = (np.abs(y) > 50) | (x < 0)  # not the lead
    return np.degrees(np.arctan2(y, x))[on_circle], off[on_circle]


def arc_table() -> str:
    """Return how far off its circle each controller is, over the whole turn."""
    rows = []
    for name, controller in CONTROLLERS.items():
        _, off = radial(name)
        rms = math.sqrt(float(np.mean(off**2)))
        rows.append([controller.title, f"{off.min():.2f}", f"{off.max():.2f}", f"{rms:.2f}"])
    return table(
        ["controller", "most inside, um", "most outside, um", "root mean square, um"], rows
    )


WIDTH, HEIGHT, LEFT, TOP, ROW = 960, 560, 120, 40, 150
COLOURS = {"zd065": "#1d4ed8", "nby15": "#c2410c", "eindhoven": "#0b7a55"}
SHORT = {"zd065": "ZD-065", "nby15": "NBY-15", "eindhoven": "DEM-15"}
#: Units of the picture a um, and the um that a row shows to either side.
SCALE, MOST = 22.0, 3.0


def figure() -> str:
    """Return the picture: how far each controller is off the circle, over some degrees of it."""

    def across(degrees: float) -> float:
        return LEFT + (degrees - FROM) / (TO - FROM) * (WIDTH - LEFT - 30)

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="15">',
        f"<title>Off a circle of R {RADIUS_MM} mm, step by step</title>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
    ]
    for k, name in enumerate(CONTROLLERS):
        middle = TOP + ROW * k + ROW / 2
        lines.append(
            f'<path d="M{LEFT} {middle:g}H{WIDTH - 30}" stroke="#24303c" stroke-width="1"/>'
        )
        for um in (-2, 2):
            y = middle - um * SCALE
            lines.append(f'<path d="M{LEFT} {y:g}H{WIDTH - 30}" stroke="#d4dae1"/>')
            lines.append(
                f'<text x="{LEFT - 8}" y="{y + 5:g}" text-anchor="end" fill="#5b6770">'
                f"{um:+d} um</text>"
            )
        lines.append(f'<text x="12" y="{middle + 5:g}" fill="#24303c">{SHORT[name]}</text>')
        angle, off = radial(name)
        shown = (angle >= FROM) & (angle <= TO)
        x, y = across(angle[shown]), middle - np.clip(off[shown], -MOST, MOST) * SCALE
        way = " ".join(f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
        lines.append(f'<path d="M{way}" fill="none" stroke="{COLOURS[name]}" stroke-width="1"/>')
    bottom = TOP + ROW * len(CONTROLLERS)
    for degree in range(int(FROM), int(TO) + 1):
        x = across(degree)
        lines.append(f'<path d="M{x:g} {TOP}V{bottom}" stroke="#d4dae1" stroke-dasharray="4 4"/>')
        lines.append(f'<text x="{x:g}" y="{bottom + 20}" text-anchor="middle">{degree} deg</text>')
    lines.append(
        f'<text x="{LEFT}" y="{HEIGHT - 14}" fill="#5b6770">outside the circle of R {RADIUS_MM} mm '
        "is up; every motor step</text>"
    )
    return "\n".join([*lines, "</svg>"]) + "\n"


#: Name of a part of the page -> what writes it.
PARTS: dict[str, Callable[[], str]] = {
    "part": part_table,
    "arc": arc_table,
    "faults": fault_table,
    "servos": servo_table,
}


def made() -> dict[Path, str]:
    """Return path -> text of the page and its picture."""
    from made_parts import filled

    return {PAGE: filled(PAGE.read_text("utf-8"), PARTS), FIGURE: figure()}
