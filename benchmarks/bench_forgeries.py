"""The kill rate: forgeries of golden programs, and what the judge makes of each.

Every forgery beyond 2 um has to be refused and its block named; those with the same steps have to
pass. Forged leads: none may pass in strict order or with a certificate, and without one none that
enters what is kept, meets another cut or ends where it may not. Run: python
benchmarks/bench_forgeries.py [--every 7] [--leads] [--json] [PROGRAM ...]. Exit status 1 if one got
through.
"""

import argparse
import itertools
import json
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "judge"))

import forgeries
import lead_forgeries


def rates(programs, every):
    """Return {sort: counts} over all programs, and the forgeries that got through."""
    counts, missed = {}, []
    for name in programs:
        g = forgeries.golden(name)
        rows = np.arange(0, len(g.program.blocks), every)
        for mutant in itertools.chain(forgeries.mutants(g, rows), forgeries.of_the_whole(g)):
            o = forgeries.judged(g, mutant)
            c = counts.setdefault(mutant.sort, Counter())
            reach = "far" if o.apart_um > forgeries.FAR else "same" if o.same else "near"
            c[reach] += 1
            c[f"{reach} refused"] += o.refused
            c["far named"] += reach == "far" and o.refused and o.named
            if (reach == "far" and not (o.refused and o.named)) or (reach == "same" and o.refused):
                missed.append([name, mutant.sort, mutant.row, o.apart_um, sorted(o.codes)])
    return counts, missed


def of_leads(every):
    """Return {case: counts} of forged leads, and those that got through."""
    counts, missed = {}, []
    for name in lead_forgeries.CASES:
        made = lead_forgeries.compiled(name)
        c = counts.setdefault(name, Counter())
        for f in list(lead_forgeries.forged(made))[::every]:
            ours = lead_forgeries.strict(made, f.program)
            ours |= lead_forgeries.passes(made, f.program, True)
            other = lead_forgeries.passes(made, f.program, False)
            c["forged"] += 1
            c["passed, ours"] += ours
            c["wrong for all"] += f.refused
            c["passed, wrong for all"] += other and f.refused
            c["passed, other leads"] += other and not f.refused
            if ours or (other and f.refused):
                missed.append([name, f.name])
    return counts, missed


def lead_table(counts):
    """Yield the lines of a Markdown table."""
    columns = ("forged", "passed, ours", "wrong for all", "passed, wrong for all")
    columns += ("passed, other leads",)
    yield "| leads of | " + " | ".join(columns) + " |"
    yield "|---" * (len(columns) + 1) + "|"
    total = sum(counts.values(), Counter())
    for name, c in [*counts.items(), ("**all**", total)]:
        yield f"| {name} | " + " | ".join(str(c[k]) for k in columns) + " |"


def table(counts):
    """Yield the lines of a Markdown table."""
    yield (
        "| forgery | beyond 2 um | refused | block named | within 2 um | refused | same steps | "
        "passed |"
    )
    yield "|---" * 8 + "|"
    total = sum(counts.values(), Counter())
    for sort, c in [*sorted(counts.items()), ("**all**", total)]:
        yield (
            f"| {sort} | {c['far']} | {c['far refused']} | {c['far named']} | {c['near']} | "
            f"{c['near refused']} | {c['same']} | {c['same'] - c['same refused']} |"
        )
    rate = 100 * total["far refused"] / max(total["far"], 1)
    yield ""
    yield f"Kill rate beyond 2 um: {rate:.2f} % of {total['far']}."


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", nargs="*", default=list(forgeries.PROGRAMS))
    parser.add_argument("--every", type=int, default=7, help="forge every so many blocks")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--leads", action="store_true", help="forge leads only, all of them")
    asked = parser.parse_args()
    if asked.leads:
        counts, missed = of_leads(1)
        print(json.dumps(counts, indent=1) if asked.json else "\n".join(lead_table(counts)))
        for one in missed:
            print("GOT THROUGH", one)
        sys.exit(bool(missed))
    counts, missed = rates(asked.programs or list(forgeries.PROGRAMS), asked.every)
    if asked.json:
        print(json.dumps({"counts": counts, "missed": missed}, indent=1))
    else:
        print("\n".join(table(counts)))
        for one in missed:
            print("GOT THROUGH", one)
    sys.exit(bool(missed))


if __name__ == "__main__":
    main()
