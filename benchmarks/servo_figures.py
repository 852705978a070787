"""The pictures of docs/servo.md: figure 4 of the patent as the simulated circuit has it, the ramp.

Run: python benchmarks/servo_figures.py. A test compares the files with what is drawn here.
"""

from pathlib import Path

from wedmcam.simulate.servo import Counters, Detectors, Settings, Wave, retract_times

HERE = Path(__file__).parents[1] / "docs" / "figures"

#: The curves of the figure: voltage and current at four times of each pulse.
OPEN = Wave((100, 100, 100, 100), (0, 0, 0, 0))
DISCHARGE = Wave((100, 25, 25, 25), (20, 20, 20, 20))
LATE = Wave((100, 100, 25, 25), (0, 0, 20, 20))
SHORT = Wave((2, 2, 2, 2), (30, 30, 30, 30))
FIGURE_4 = [
    (146, OPEN),
    (148, DISCHARGE),
    (150, LATE),
    (152, DISCHARGE),
    (154, SHORT),
    (156, SHORT),
    (158, SHORT),
    (160, SHORT),
]


def figure_4_rows():
    """Return number, detector pulses, A and B behind each of them, and the signal."""
    counters, detectors, rows = Counters(Settings(advance=4, retract=4)), Detectors(), []
    for number, wave in FIGURE_4:
        for voltage, current in detectors.edges(wave):
            signal = counters.detect(voltage, current)
            rows.append((number, voltage, current, counters.a, counters.b, signal))
    return rows


def _sheet(title, width, height, lines):
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" font-family="sans-serif" font-size="11" fill="#24303c">\n'
        f'<title>{title}</title>\n<rect width="{width}" height="{height}" fill="#fff"/>\n'
    )
    return head + "\n".join(lines) + "\n</svg>\n"


def _curve(points):
    path = " ".join(f"{x:g},{y:g}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="#1f5fa8" stroke-width="1.4"/>'


def figure_4():
    """Return the figure: curves of the gap and of the detectors, counters B and A, the signal."""
    left, pitch, row, high = 110, 72, 48, 28
    names = ("voltage", "current", "voltage detector", "current detector", "counter B", "counter A")
    lines = []
    for k, name in enumerate((*names, "retract")):
        lines.append(f'<text x="6" y="{(k + 1) * row}">{name}</text>')
    curves = {k: [(left, (k + 1) * row)] for k in range(2)}
    for n, (number, wave) in enumerate(FIGURE_4):
        x = left + n * pitch + 8
        lines.append(f'<text x="{x + 12}" y="14">{number}</text>')
        for k, (values, full) in enumerate(((wave.voltage, 100), (wave.current, 30))):
            base = (k + 1) * row
            last = base
            for t, value in enumerate(values):
                y = base - high * value / full
                curves[k] += [(x + 12 * t, last), (x + 12 * t, y)]
                last = y
            curves[k] += [(x + 48, last), (x + 48, base)]
    for k, points in curves.items():
        lines.append(_curve([*points, (left + len(FIGURE_4) * pitch, (k + 1) * row)]))
    first = {number: k for k, (number, _) in enumerate(FIGURE_4)}
    seen = set()
    for number, voltage, current, a, b, signal in figure_4_rows():
        late = number in seen
        seen.add(number)
        x = left + first[number] * pitch + 8 + (24 if late else 0)
        for k, detector in ((2, voltage), (3, current)):
            if detector:
                lines.append(_curve([(x, (k + 1) * row), (x, (k + 1) * row - high)]))
        for k, count in ((4, b), (5, a)):
            lines.append(f'<text x="{x}" y="{(k + 1) * row}">{count}</text>')
        if signal < 0:
            lines.append(_curve([(x, 7 * row), (x, 7 * row - high), (x + 20, 7 * row - high)]))
    title = "Figure 4: an open pulse, a discharge, a delayed one, a discharge, four shorts"
    return _sheet(title, left + len(FIGURE_4) * pitch + 10, 7 * row + 14, lines)


def ramp():
    """Return the frequency of the steps of a retract over time, with a mark at each step."""
    settings = Settings()
    times = retract_times(settings)
    whole, top = float(times[-1]), settings.lowest + settings.slope * float(times[-1]) / 2
    left, width, base, high = 60, 460, 190, 160

    def at(time):
        up = min(time, whole - time)
        y = base - high * (settings.lowest + settings.slope * up) / top
        return round(left + width * time / whole, 2), round(y, 2)

    lines = [_curve([at(0.0), at(whole / 2), at(whole)])]
    for time in times.tolist():
        x, y = at(time)
        lines.append(f'<circle cx="{x:g}" cy="{y:g}" r="2.6" fill="#b3402a"/>')
    lines += [
        f'<path d="M{left} 20V{base}H{left + width}" fill="none" stroke="#8894a0"/>',
        f'<text x="6" y="{base - high + 4}">{top:.0f}/s</text>',
        f'<text x="6" y="{base}">0</text>',
        f'<text x="{left + width - 40}" y="{base + 18}">{1000 * whole:.1f} ms</text>',
    ]
    title = f"A retract of {settings.steps} steps: none is lost"
    return _sheet(title, left + width + 20, base + 30, lines)


FIGURES = {"servo-figure-4.svg": figure_4, "servo-ramp.svg": ramp}


def main():
    HERE.mkdir(exist_ok=True)
    for name, draw in FIGURES.items():
        (HERE / name).write_text(draw(), "utf-8")


if __name__ == "__main__":
    main()
