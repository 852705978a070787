"""Integer interpolators by point-by-point comparison (逐点比较法): the ZD-065, and all of 3B.

Twice: the step loop as the paper prints it (``steps``), and closed forms that answer at once for
whole arrays of blocks. Tests prove them equal; everything fast uses the closed forms.
"""

from wedmcam.controllers.pointwise.closed import position, run
from wedmcam.controllers.pointwise.deviate import deviation
from wedmcam.controllers.pointwise.ends import arc_end
from wedmcam.controllers.pointwise.interpolator import MIRROR, Pointwise, of_table
from wedmcam.controllers.pointwise.path import places, trace
from wedmcam.controllers.pointwise.reverse import reversals
from wedmcam.controllers.pointwise.steps import (
    arc_quadrant,
    arc_steps,
    block_steps,
    counts,
    line_axis,
    line_steps,
)
from wedmcam.controllers.pointwise.table import LineTable
from wedmcam.controllers.stepping import ArcEnd, Motion, Step

__all__ = [
    "MIRROR",
    "ArcEnd",
    "LineTable",
    "Motion",
    "Pointwise",
    "Step",
    "arc_end",
    "arc_quadrant",
    "arc_steps",
    "block_steps",
    "counts",
    "deviation",
    "line_axis",
    "line_steps",
    "of_table",
    "places",
    "position",
    "reversals",
    "run",
    "trace",
]
