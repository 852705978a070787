"""The semantics of the target: integer interpolators by point-by-point comparison.

Twice: the step loop as the paper prints it (``steps``), and closed forms that answer at once for
whole arrays of blocks. Tests prove them equal; everything fast uses the closed forms.
"""

from wedmcam.controller.closed import Motion, position, run
from wedmcam.controller.deviate import deviation
from wedmcam.controller.ends import ArcEnd, arc_end
from wedmcam.controller.path import places, trace
from wedmcam.controller.reverse import reversals
from wedmcam.controller.steps import (
    Step,
    arc_quadrant,
    arc_steps,
    block_steps,
    line_axis,
    line_steps,
)

__all__ = [
    "ArcEnd",
    "Motion",
    "Step",
    "arc_end",
    "arc_quadrant",
    "arc_steps",
    "block_steps",
    "deviation",
    "line_axis",
    "line_steps",
    "places",
    "position",
    "reversals",
    "run",
    "trace",
]
