"""ISO G-code: a text becomes stepped blocks, or outlines that its controller offsets.

`words` splits a text, `offsets` takes its tables out, `dialect` knows what a text leaves open and
who says it, `subprograms` puts lines in the order in which they are run, `codes` knows what changes
no path, `lengths` gives numbers a unit, `table` and `modes` follow G41 and G42, `arcs` steps arcs,
and `reader` puts them together.
"""

from wedmcam.frontends.iso.reader import decode, read

__all__ = ["decode", "read"]
