"""The table of ``inspect`` on standard output: what is in a source."""

from __future__ import annotations

from typing import Any

from wedmcam.cli.terminal import print_text


def _counted(census: dict[str, dict[str, int]]) -> str:
    """Return '14 LINE, 3 ARC (layers CUT, 0)'."""
    parts = [f"{sum(layers.values())} {kind}" for kind, layers in sorted(census.items())]
    names = sorted({name for layers in census.values() for name in layers})
    return f"{', '.join(parts)} (layers {', '.join(names)})" if parts else "none"


def _pair(values: list[float], decimals: int = 3) -> str:
    return " x ".join(f"{v:.{decimals}f}" for v in values)


def _at(values: list[float]) -> str:
    return f"({values[0]:.3f}, {values[1]:.3f})"


def print_inspection(f: dict[str, Any], verbose: bool) -> None:
    """Print the facts of a drawing."""
    rows = [
        ("file", f"{f['input']}  {f['version']}"),
        ("units", f"{f['units']} ({f['units_from']})"),
        ("size", f"{_pair(f['size_mm'])} mm = {_pair(f['size_inch'], 4)} in"),
        ("extents", f"{_at(f['extents_mm'][:2])} to {_at(f['extents_mm'][2:])} mm"),
        ("read", _counted(f["entities"])),
        ("not cut", _counted(f["ignored"])),
        (
            "contours",
            f"{f['understood'] or 'none'}; {f['length_mm']:.3f} mm in all",
        ),
        (
            "repairs",
            f"{f['joins']} joins (largest shift {f['largest_join_um']} um), "
            f"{f['duplicates']} duplicates, {f['zero_length']} without length",
        ),
    ]
    if f["thread_points_mm"]:
        points = ", ".join(_at(p) for p in f["thread_points_mm"][:8])
        more = len(f["thread_points_mm"]) - 8
        rows.append(("thread", points + (f" and {more} more" if more > 0 else "")))
    smallest = f["smallest_radius"]
    if smallest:
        text = f"{smallest['radius_mm']:.3f} mm at {_at(smallest['center_mm'])}"
        rows.append(("smallest", f"radius {text}  {smallest['where']}"))
    largest = f["largest_offset"]
    if largest:
        open_ = "" if largest["limited_by"] else " or more"
        text = f"{largest['offset_mm']:.3f} mm{open_} with --side {largest['side']}"
        if largest["limited_by"]:
            what = {
                "radius": "an inside radius",
                "passage": "a narrow place",
                "neighbour": "another contour near",
                "vanished": "the size of a contour",
            }.get(largest["limited_by"], largest["limited_by"])
            text += f", limited by {what} at {_at(largest['at_mm'])}  {largest['where'] or ''}"
        rows.append(("offset up to", text.rstrip()))
    for name, text in rows:
        print_text(f"{name:13}{text}")
    listed = f["list"] if verbose else f["list"][:20]
    for c in listed:
        inside = f" in {c['inside']}" if c["inside"] else ""
        area = f", {c['area_mm2']:.3f} mm2" if c["area_mm2"] is not None else ""
        print_text(
            f"{c['number']:5d} {c['role']}{inside}: {c['lines']} lines, {c['arcs']} arcs, "
            f"{c['length_mm']:.3f} mm{area}, {_at(c['extents_mm'][:2])} to "
            f"{_at(c['extents_mm'][2:])}  {c['first'] or ''}"
        )
    if len(f["list"]) > len(listed):
        print_text(f"      and {len(f['list']) - len(listed)} more (-v lists all)")
