"""The controllers that can be simulated, by their names."""

from __future__ import annotations

from wedmcam.simulate.controller import Controller
from wedmcam.simulate.eindhoven import EINDHOVEN
from wedmcam.simulate.nby15 import NBY15
from wedmcam.simulate.zd065 import ZD065

#: Name -> controller; a machine may be called by its controller, and by its own name.
CONTROLLERS: dict[str, Controller] = {one.name: one for one in (ZD065, NBY15, EINDHOVEN)}
ALIASES = {"dem15": "eindhoven"}


def controller_of(name: str) -> Controller | None:
    """Return the controller of a name; None where none has it.

    >>> controller_of("dem15").title, controller_of("zx")
    ('DEM-15 of Eindhoven', None)
    """
    return CONTROLLERS.get(ALIASES.get(name, name))
