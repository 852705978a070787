"""Compile time by stage against ezdxf.readfile alone, and the memory of both.

Each size runs in a process of its own, in 8-digit decimals and in float64; processor time, medians
of five runs, one run of 100,000 entities. "prove" decodes the bytes and judges them; what it adds
is told as a part of the rest of the compile.

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
ARITHMETICS = ("decimal8", "float64")
STAGES = ("read", "plan", "lower", "encode", "prove")


def peak_mb():
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def read_alone(name):
    import ezdxf

    runs = []
    for _ in range(5 if Path(name).stat().st_size < 5e6 else 1):
        start = time.process_time()
        ezdxf.readfile(name)
        runs.append(time.process_time() - start)
    return {"s": sorted(runs)[len(runs) // 2], "mb": peak_mb()}


def compiled(name, arithmetic="decimal8"):
    import wedmcam.transforms.lower as lowering
    from wedmcam import api
    from wedmcam.compiler import pipeline
    from wedmcam.targets.stated import Stated

    places = {
        "read": (pipeline, "read"),
        "plan": (pipeline, "where_the_wire_goes"),
        "lower": (lowering, "lower"),
        "encode": (Stated, "write"),
        "prove": (pipeline, "prove_program"),
    }

    spent = dict.fromkeys(STAGES, 0.0)

    def timed(stage, function):
        def run(*arguments, **more):
            start = time.process_time()
            try:
                return function(*arguments, **more)
            finally:
                spent[stage] += time.process_time() - start

        return run

    for stage, (place, name_) in places.items():
        setattr(place, name_, timed(stage, getattr(place, name_)))
    data = Path(name).read_bytes()
    asked = {"offset": 0.1, "arithmetic": arithmetic}
    api.compile(drawing(200)[0], **asked)  # imports are no part of this
    gc.disable()  # as the command does
    runs = []
    for _ in range(5 if len(data) < 5e6 else 1):
        spent.update(dict.fromkeys(STAGES, 0.0))
        start = time.process_time()
        made = api.compile(data, name="drawing", **asked)
        runs.append((time.process_time() - start, dict(spent)))
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


def of_its_own(*what):
    """Return what one measurement tells in a process of its own."""
    command = [sys.executable, __file__, "--one", *what]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


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
            row["read_alone"] = of_its_own("read_alone", name)
            for arithmetic in ARITHMETICS:
                made = of_its_own("compiled", name, arithmetic)
                made["ratio"] = round(made["s"] / row["read_alone"]["s"], 2)
                made["judge_adds"] = round(made["prove"] / (made["s"] - made["prove"]), 3)
                row[arithmetic] = made
        out.append(row)
    return out


def table(found):
    """Yield the lines of a Markdown table."""
    yield (
        "| entities | figures in | ezdxf.readfile | compile | ratio | "
        + " | ".join(STAGES)
        + " | prove adds | memory: readfile, compile | blocks | deviation |"
    )
    yield "|---" * (9 + len(STAGES)) + "|"
    for r in found:
        alone = r["read_alone"]
        for arithmetic in ARITHMETICS:
            c = r[arithmetic]
            stages = " | ".join(f"{1000 * c[s]:.0f} ms" for s in STAGES)
            yield (
                f"| {r['entities']} | {arithmetic} | {1000 * alone['s']:.0f} ms | "
                f"{1000 * c['s']:.0f} ms | {c['ratio']} | {stages} | "
                f"{100 * c['judge_adds']:.0f} % | {alone['mb']}, {c['mb']} MB | {c['blocks']} | "
                f"{c['deviation_um']} um |"
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--most", type=int, default=100_000)
    parser.add_argument("--one", nargs="+", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.one:
        what, *arguments = asked.one
        print(json.dumps({"read_alone": read_alone, "compiled": compiled}[what](*arguments)))
        return
    found = rows(asked.most)
    print(json.dumps(found, indent=1) if asked.json else "\n".join(table(found)))


if __name__ == "__main__":
    main()
