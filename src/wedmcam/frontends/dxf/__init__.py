"""DXF drawings become sketches: loose lines and arcs in micrometres, each with its handle.

ezdxf reads the file, here and nowhere else in the project, and is imported on the first call. What
it would lose or guess is looked after in `load`; what an entity is as lines and arcs, in `shapes`;
blocks and layers, in `place`; units, in `units`; the whole, in `reader`.
"""

from __future__ import annotations

from wedmcam.frontends.dxf.reader import read

__all__ = ["read"]
