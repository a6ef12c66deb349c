"""Vapour pressure of methane in a separator: ``factor`` times the model's (p_metV), as another feed would have it."""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class VapourPressure(Factor):
    """A separator with a lighter or heavier feed.

    >>> from stickslip.plant import production_plant
    >>> VapourPressure().places(production_plant())
    ('S1', 'S2')
    """

    name = "vapour_pressure"
    role = Role.PROCESS
    key = "p_metV"
    parameters = (Parameter("factor", "-", 1.0, 0.7, 1.4, "log"),)
