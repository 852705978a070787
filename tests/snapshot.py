"""All that the command line says and writes of the samples, as files: what a move must not change.

``python tests/snapshot.py FOLDER`` writes, for every sample and every profile, the program, its
certificate, what ``--json`` says and what the commands that read a program say. ``--corpus DIR``
adds the outcome of every real drawing there; ``--plans`` their plans to the bit, for all sides, in
both arithmetics.

``python tests/snapshot.py --against REV`` does so for that revision (in a worktree of its own) and
for this tree, and names every file that differs: nothing else may change when code only moves.
"""

from __future__ import annotations

import argparse
import csv
import filecmp
import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
DRAWINGS = {
    "bracket-inch": ["--offset", "0.1"],
    "cam": ["--offset", "0.1"],
    "cover": ["--offset", "0.1"],
    "damaged": ["--offset", "0.1", "--units", "mm"],
    "gear-24": ["--offset", "0.1"],
    "key-punch": ["--offset", "0.1"],
    "plate": ["--offset", "0.1"],
    "stator-36": ["--offset", "0.1"],
}
PROFILES = {
    "b3-compact": ".3b",
    "b3-columns": ".3b",
    "b3-numbered": ".3b",
    "b4-compact": ".4b",
    "iso-um": ".nc",
    "iso-mm": ".nc",
    "iso-fixed": ".nc",
    "iso-g41": ".nc",
    "iso-g41-mm": ".nc",
    "zd065": ".zd",
    "zd065-rotation": ".zdr",
    "zd065-compensation": ".zdc",
}
#: How a sample is cut besides: name -> options; with the first profile alone.
MANNERS = {
    "die": ["--side", "die", "--ignore-layer", "START"],
    "on": ["--side", "on"],
    "corner": ["--corner", "0.3", "--ignore-layer", "START"],
    "trim": ["--on-interference", "trim"],
    "textbook": ["--count", "textbook"],
    "reverse": ["--reverse", "--stop", "0.5", "--overcut", "0.2"],
    "float64": ["--arithmetic", "float64"],
    "first": ["--cuts", "1-1"],
    "rest": ["--from-block", "5"],
    "backwards": ["--from-block", "5", "--backwards"],
    "turned": ["--transform", "rotate 3 copies 120 about (0, 0)"],
}
SIDES = {
    "part": {"offset_um": 50.0},
    "die": {"offset_um": 50.0, "side": "die"},
    "on": {"side": "on"},
    "trim": {"offset_um": 50.0, "trim": True},
}


def command(*arguments: str) -> None:
    """Run a command of this source tree; keep what it says, and its exit status, beside outputs."""
    from click.testing import CliRunner

    from wedmcam.cli.main import cli

    done = CliRunner().invoke(cli, list(arguments), standalone_mode=False)
    status = done.return_value if done.exception is None else f"{done.exception!r}"
    name = "-".join(a.lstrip("-").replace("/", "_") for a in arguments)
    if len(name) > 120:
        name = f"{name[:100]}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"
    Path(f"said-{name}.txt").write_text(f"{done.stdout}---\n{done.stderr}---\n{status}\n", "utf-8")


def samples(names: list[str] | None = None) -> None:
    """Write everything of the samples into the current folder."""
    sources = {**{f"{n}.dxf": o for n, o in DRAWINGS.items()}}
    sources |= {p.name: [] for p in sorted((ROOT / "samples").glob("*.wed"))}
    for name, options in sources.items():
        if names is not None and name not in names:
            continue
        Path(name).write_bytes((ROOT / "samples" / name).read_bytes())
        command("inspect", name, "--json")
        command("check", name, *options, "--json")
        for profile, ending in PROFILES.items():
            out = f"{name}.{profile}{ending}"
            writes = ["--certificate", f"{out}.json", "--map", f"{out}.map.json"]
            writes += ["--setup-sheet", f"{out}.md", "--plot", f"{out}.svg"]
            command("compile", name, "-o", out, "--profile", profile, *options, *writes, "--json")
            if Path(out).exists():
                command("verify", out, "--certificate", f"{out}.json", "--json")
                command("verify", out, "--certificate", f"{out}.json", "--against", name, "--json")
                command("dump", out, "--profile", profile)
                command("identify", out)
        first, one = f"{name}.b3-compact.3b", "b3-compact"
        for manner, more in MANNERS.items():
            out = f"{name}.{manner}.3b"
            asked = [o for o in options if manner != "on" or o not in ("--offset", "0.1")]
            writes = ["--certificate", f"{out}.json"]
            command("compile", name, "-o", out, "--profile", one, *asked, *more, *writes, "--json")
        command("verify", first, "--against", name, *options, "--metamorphic", "--json")
        command("compile", name, "-o", f"{name}.both", "--to", "3b,iso,compact", *options)
        command("compile", name, "-o", f"{name}.split.zd", "--split", *options, "--json")
        for ending in (".nc", ".zd", ".4b", ".wed", ".dxf", ".svg"):
            command("convert", first, "-o", f"{name}.converted{ending}")
        command("diff", first, f"{name}.zd065.zd")
        command("explain", first, "--block", "3")


def outcomes(corpus: Path) -> Iterator[str]:
    """Yield a line for each real drawing: exit status, codes, fingerprint of the program."""
    from wedmcam import api

    for path, units in drawings(corpus):
        compilation = api.compile(path.read_bytes(), name=path.name, offset=0.05, units=units)
        codes = sorted({f"{d.severity.name[0]}:{d.code}" for d in compilation.findings})
        data = compilation.data
        print_ = hashlib.sha256(data).hexdigest()[:16] if data else "-"
        yield f"{path.name}\t{compilation.status}\t{print_}\t{','.join(codes)}"


def drawings(corpus: Path) -> Iterator[tuple[Path, str | None]]:
    """Yield the real drawings with the unit that ``expected.tsv`` gives them."""
    with (ROOT / "tests" / "corpus" / "expected.tsv").open(encoding="utf-8") as table:
        for row in csv.DictReader(table, delimiter="\t"):
            yield corpus / row["file"], row["units"] or None


def plans(corpus: Path) -> Iterator[str]:
    """Yield a line for each real drawing, side and arithmetic: the plan's fingerprint."""
    from wedmcam.options import ARITHMETICS, Options

    for path, units in drawings(corpus):
        data = path.read_bytes()
        for side, more in SIDES.items():
            for arithmetic in ARITHMETICS:
                options = Options.from_data({**more, "units": units, "arithmetic": arithmetic})
                yield f"{path.name}\t{side}\t{arithmetic}\t{plan_of(data, path.name, options)}"


def plan_of(data: bytes, name: str, options: Any) -> str:
    """Return the fingerprint of a plan, or the codes that refuse it."""
    try:  # where the stages are, in this revision or an older one
        from wedmcam.compiler import pipeline
        from wedmcam.diag.run import Refused, Run
    except ImportError:
        from wedmcam.pipeline import Refused, Run

        from wedmcam import pipeline

    run = Run()
    try:
        if hasattr(pipeline, "planned"):
            plan = pipeline.plan_source(data, name, options, [], run)[1]
        else:
            plan = pipeline.plan(pipeline.read(data, name, options, run), options, run)
    except Refused:
        return ",".join(sorted({d.code for d in run.findings if d.severity.name == "ERROR"}))
    digest = hashlib.sha256()

    def add(contour: Any) -> None:
        if contour is not None:
            digest.update(contour.vertices.tobytes() + bytes([contour.closed]))

    for cut in plan.cuts:
        add(cut.path)
        add(cut.outline)
        rest = (cut.thread, cut.depth, cut.keeps_left, cut.stop_um, cut.overcut_um, cut.number)
        digest.update(repr(rest).encode())
    for outline in plan.outlines:
        add(outline)
    digest.update(repr((tuple(plan.depths), str(plan.side), plan.offset_um)).encode())
    return digest.hexdigest()[:16]


def write(folder: Path, corpus: Path | None, with_plans: bool, names: list[str] | None) -> None:
    """Write a whole snapshot into an empty folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with chdir(folder):
        samples(names)
        if corpus is not None:
            Path("outcomes.tsv").write_text("\n".join(outcomes(corpus)) + "\n", "utf-8")
            if with_plans:
                Path("plans.tsv").write_text("\n".join(plans(corpus)) + "\n", "utf-8")


@contextmanager
def worktree(revision: str) -> Iterator[Path]:
    """Give a checkout of a revision for as long as it is needed."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder, "tree")
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "-q", "--detach", str(tree), revision], check=True)
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


def source_of(tree: Path) -> dict[str, str]:
    """Return an environment in which Python imports the package of a checkout."""
    return {**os.environ, "PYTHONPATH": str(tree / "src"), "PYTHONHASHSEED": "0"}


def differences(one: Path, two: Path) -> list[str]:
    """Return the names of files that are not the same in two folders."""
    names = sorted({p.relative_to(f).as_posix() for f in (one, two) for p in f.rglob("*")})
    _, differ, missing = filecmp.cmpfiles(one, two, names, shallow=False)
    return sorted([*differ, *missing])


def main() -> int:
    """Write a snapshot, or compare two."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--against", metavar="REV")
    parser.add_argument("--corpus", type=Path)
    parser.add_argument("--plans", action="store_true")
    parser.add_argument("--only", nargs="+", metavar="SAMPLE", help="names of samples")
    options = parser.parse_args()
    corpus = None if options.corpus is None else options.corpus.resolve()
    if options.against is None:
        write(Path(options.folder), corpus, options.plans, options.only)
        return 0
    with tempfile.TemporaryDirectory() as scratch, worktree(options.against) as tree:
        kept = Path(options.folder or scratch).resolve()
        more = ["--plans"] * options.plans + (["--corpus", str(corpus)] if corpus else [])
        more += ["--only", *options.only] if options.only else []
        folders = [kept / "before", kept / "now"]
        runs = [
            subprocess.Popen([sys.executable, __file__, str(f), *more], env=source_of(t))
            for f, t in zip(folders, (tree, ROOT), strict=True)
        ]
        statuses = [run.wait() for run in runs]
        if any(statuses):
            return 2
        differ = differences(*folders)
        count = sum(1 for p in folders[1].rglob("*") if p.is_file())
        print(*differ, f"{len(differ)} of {count} files differ from {options.against}", sep="\n")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
