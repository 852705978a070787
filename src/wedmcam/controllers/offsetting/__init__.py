"""What a controller makes of outlines that it offsets itself (G41, G42 D, G40): the model.

The judge holds a G41 program to the path that is computed here, so nothing here is shared with what
makes programs: plain geometry, block by block, slow and easy to follow.

What the controller does [R], after what handbooks of such controllers have in common:

* The lead-in, a straight line at least as long as the offset, ends beside the start of the outline,
  on the normal of the first block. The lead-out starts on the normal of the last block.
* Lines shift along their normal, arcs keep their centre. At outer corners an arc about the corner
  joins them, at inner corners they end where they cross (`path`).
* It looks one block ahead. A block that the offset leaves nothing of is refused; so is a wire that
  comes too near to a block farther on, which it cannot see (`clearance`). An outline may run on
  over its own start, and round again.
* A stated centre that is not as far from the end as from the start moves to where it is
  (`outlines`).
* The path is put on the grid and stepped within 1.6 um (`microns`, `staircase`).

Frame: the controller's own, in steps of the machine (um here, as most are).
"""

from __future__ import annotations

from wedmcam.controllers.offsetting.microns import BlockLimits
from wedmcam.controllers.offsetting.outlines import Refusal, offset_outlines

__all__ = ["BlockLimits", "Refusal", "offset_outlines"]
