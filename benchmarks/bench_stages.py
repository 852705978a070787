"""Compile time by stage against ezdxf.readfile alone, and the memory of both.

Each size runs in a process of its own; medians of five runs, one run of 100,000 entities. "prove"
decodes the bytes and judges them; its share is of the whole compile.

Run: python benchmarks/bench_stages.py [--json] [--most 100000]
"""

import argparse
import gc
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from stage_drawings import drawing

SIZES = (1_000, 10_000, 100_000)
STAGES = ("read", "plan", "lower", "encode", "prove")


def peak_mb():
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def read_alone(name):
    import ezdxf

    runs = []
    for _ in range(5 if Path(name).stat().st_size < 5e6 else 1):
        start = time.perf_counter()
        ezdxf.readfile(name)
        runs.append(time.perf_counter() - start)
    return {"s": sorted(runs)[len(runs) // 2], "mb": peak_mb()}


def compiled(name):
    from wedmcam import api, pipeline

    spent = dict.fromkeys(STAGES, 0.0)

    def timed(stage, function):
        def run(*arguments, **more):
            start = time.perf_counter()
            try:
                return function(*arguments, **more)
            finally:
                spent[stage] += time.perf_counter() - start

        return run

    for stage in STAGES:
        setattr(pipeline, stage, timed(stage, getattr(pipeline, stage)))
    data = Path(name).read_bytes()
    api.compile(drawing(200)[0], offset=0.1)  # imports are no part of this
    gc.disable()  # as the command does
    runs = []
    for _ in range(5 if len(data) < 5e6 else 1):
        spent.update(dict.fromkeys(STAGES, 0.0))
        start = time.perf_counter()
        made = api.compile(data, name="drawing", offset=0.1)
        runs.append((time.perf_counter() - start, dict(spent)))
        assert made.ok, [d.message for d in made.findings][:5]
    total, spent = sorted(runs, key=lambda r: r[0])[len(runs) // 2]
    v = made.verdict
    return {
        "s": total,
        "mb": peak_mb(),
        **spent,
        "blocks": v.blocks,
        "steps": v.steps,
        "deviation_um": round(v.max_deviation_um, 3),
    }


def rows(most=100_000):
    """Return a row a size, both programs run side by side in processes of their own."""
    out = []
    for size in SIZES:
        if size > most:
            continue
        with tempfile.TemporaryDirectory() as folder:
            name = str(Path(folder, "plate.dxf"))
            Path(name).write_bytes(drawing(size)[0])
            row = {"entities": size}
            for what in ("read_alone", "compiled"):
                command = [sys.executable, __file__, "--one", what, name]
                told = subprocess.run(command, check=True, capture_output=True, text=True).stdout
                row[what] = json.loads(told)
        row["ratio"] = round(row["compiled"]["s"] / row["read_alone"]["s"], 2)
        row["judge_share"] = round(row["compiled"]["prove"] / row["compiled"]["s"], 3)
        out.append(row)
    return out


def table(found):
    """Yield the lines of a Markdown table."""
    yield (
        "| entities | ezdxf.readfile | compile | ratio | "
        + " | ".join(STAGES)
        + (" | judge's share | memory: readfile, compile | blocks | deviation |")
    )
    yield "|---" * (9 + len(STAGES)) + "|"
    for r in found:
        c, alone = r["compiled"], r["read_alone"]
        stages = " | ".join(f"{1000 * c[s]:.0f} ms" for s in STAGES)
        yield (
            f"| {r['entities']} | {1000 * alone['s']:.0f} ms | {1000 * c['s']:.0f} ms | "
            f"{r['ratio']} | {stages} | {100 * r['judge_share']:.0f} % | {alone['mb']}, {c['mb']} "
            f"MB | {c['blocks']} | {c['deviation_um']} um |"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--most", type=int, default=100_000)
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one:
        what, name = asked.one
        print(json.dumps({"read_alone": read_alone, "compiled": compiled}[what](name)))
        return
    found = rows(asked.most)
    print(json.dumps(found, indent=1) if asked.json else "\n".join(table(found)))


if __name__ == "__main__":
    main()
