"""Figures of the rotation format, and where their vertices are in 50 digits."""

import mpmath
import numpy as np

from wedmcam.controllers.zd065.data import POLAR
from wedmcam.ir.program import Kind


def figure_of(*rows):
    out = np.zeros(len(rows), POLAR)
    for k, row in enumerate(rows):
        out[k] = row
    return out


def random_figure(random, n, largest, most_sweep=200.0):
    """Return lines and arcs whose chords are at most about ``largest`` um."""
    out = np.zeros(n, POLAR)
    for k in range(n):
        start = float(f"{random.uniform(0, 360):.8g}")
        if random.random() < 0.4:
            out[k] = (Kind.LINE, 0, start, int(random.uniform(1, largest)), 0.0)
            continue
        # 8 digits, none behind the eighth decimal.
        sweep = np.exp(random.uniform(np.log(0.01), np.log(most_sweep)))
        sweep = float(f"{round(sweep, 8):.8g}")
        radius = min(largest / np.radians(sweep), 10_000_000)
        out[k] = (Kind.ARC, random.choice([-1, 1]), start, max(int(radius), 2), sweep)
    return out


def vertices(figure, copies, step):
    """Return the stated vertices in 50 digits: arcs by their centres, unlike the machine."""
    at, out = mpmath.mpc(0), []
    with mpmath.workdps(50):
        for k in range(copies + 1):
            for row in figure:
                start = mpmath.mpf(repr(float(row["start"]))) + k * mpmath.mpf(repr(step))
                size, sweep = int(row["size"]), mpmath.mpf(repr(float(row["sweep"])))
                here = size * mpmath.expjpi(start / 180)
                if row["kind"] == Kind.ARC:
                    at += here * (mpmath.expjpi(int(row["turn"]) * sweep / 180) - 1)
                elif row["kind"] <= Kind.MOVE:
                    at += here
                out.append(complex(at))
    return np.array(out)
