"""Compile time of a small part against reading it, and the start of the command line.

The bounds of the first release, as ratios side by side in one run: a small part compiles and
verifies in under 1.5 times the time of ``python -c "import ezdxf; ezdxf.readfile(...)"``, and
``wedmcam --help`` takes under 100 ms more than ``python -c pass``. Medians of interleaved runs.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROUNDS = 9
SMALL = ("key-punch", "bracket-inch", "plate")


def timed(command: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return 1000 * (time.perf_counter() - start)


def main() -> None:
    python = sys.executable
    with tempfile.TemporaryDirectory() as folder:
        commands = {"pass": [python, "-c", "pass"], "help": [python, "-m", "wedmcam", "--help"]}
        for name in SMALL:
            drawing = str(ROOT / "samples" / f"{name}.dxf")
            commands[f"read {name}"] = [
                python,
                "-c",
                f"import ezdxf; ezdxf.readfile({drawing!r})",
            ]
            commands[f"compile {name}"] = [
                *(python, "-m", "wedmcam", "compile", drawing, "--offset", "0.1"),
                *("-o", f"{folder}/{name}.3b"),
            ]
        times: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(ROUNDS):
            for name, command in commands.items():
                times[name].append(timed(command))
        ms = {name: statistics.median(values) for name, values in times.items()}
    print(f"python -c pass            {ms['pass']:7.0f} ms")
    print(f"wedmcam --help            {ms['help']:7.0f} ms  +{ms['help'] - ms['pass']:.0f} ms")
    print("part           ezdxf.readfile   compile + verify   ratio")
    for name in SMALL:
        read, made = ms[f"read {name}"], ms[f"compile {name}"]
        print(f"{name:14} {read:11.0f} ms {made:15.0f} ms   {made / read:5.2f}")


if __name__ == "__main__":
    main()
