"""What each type of entity can be in a drawing: a part of the part, or something said about it.

What is read stands in `shapes`. Of the rest, text, dimensions and pictures never bound a part.
Fills, wide lines and faces can: a drawing whose outer contour is one of them would be cut as its
holes. What is in neither list could be anything and is refused (DXF reference, ENTITIES section;
types that other programs add have names of their own).
"""

from __future__ import annotations

#: What is said about a part, and what shows another file. Says nothing of where material ends.
ANNOTATION = frozenset(
    {
        *("TEXT", "MTEXT", "RTEXT", "ARCALIGNEDTEXT", "ATTDEF", "ATTRIB", "ACAD_TABLE"),
        *("DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION", "TOLERANCE"),
        *("LEADER", "MULTILEADER", "MLEADER", "POINT", "XLINE", "RAY"),
        *("IMAGE", "OLEFRAME", "OLE2FRAME", "VIEWPORT", "LIGHT"),
        *("PDFUNDERLAY", "DWFUNDERLAY", "DGNUNDERLAY"),
    }
)
#: Entity types that hold geometry: as many must come out of the reader as the file has.
GEOMETRY = frozenset(
    {"LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE", "INSERT"}
)
#: What stands in a repaired drawing for an entity that cannot be read. See `salvage`.
UNREADABLE = "WEDMCAM_UNREADABLE"
#: A POLYLINE that is a net of faces; `--ignore-type` takes this name, too.
MESH = "POLYLINE (mesh)"
#: What is not read, and has a boundary that could be an outline. See `unread`.
BOUNDED = frozenset(
    {"SOLID", "TRACE", "3DFACE", "MESH", MESH, "HATCH", "MPOLYGON", "WIPEOUT", "MLINE"}
)
#: Likewise, as files name them.
WITH_BOUNDS = BOUNDED - {MESH}

#: Arrow heads that CAD programs bring along, as names of blocks (DXF reference, DIMBLK).
_ARROWS = frozenset(
    f"_{name}"
    for name in (
        *("archtick", "boxblank", "boxfilled", "closed", "closedblank", "closedfilled"),
        *("datumblank", "datumfilled", "dot", "dotblank", "dotsmall", "dotsmallblank"),
        *("integral", "none", "oblique", "open", "open30", "open90", "origin", "origin2"),
        *("origin indicator", "origin indicator 2", "right angle", "small"),
    )
)


def is_annotation(block: str) -> bool:
    """Return whether a block is a dimension's picture or an arrow head.

    >>> [is_annotation(name) for name in ("*D12", "_Open30", "*U3", "PLATE", "*Die")]
    [True, True, False, False, False]
    """
    name = block.casefold()
    return name in _ARROWS or (name[:2] == "*d" and name[2:].isdecimal())
