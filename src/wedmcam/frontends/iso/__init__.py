"""ISO G-code: a text becomes stepped blocks, or outlines that its controller offsets.

`words` splits a text, `offsets` takes its tables out, `dialect` knows what a text leaves open and
who says it, `tape` finds its number and its end, `subprograms` puts lines in the order in which
they are run, `known` takes out the words of its profile, `codes` knows what changes no path,
`lines` gives what every line says and the modes in force there, `lengths` gives numbers a unit,
`centres` says what I and J are, `table` and `modes` follow G41 and G42, `blocks` and `arcs` step
motions, `reading` is a text with its findings, and `reader` puts them together.
`style` tells which profiles know the words of a text.
"""

from wedmcam.frontends.iso.reader import decode, read

__all__ = ["decode", "read"]
