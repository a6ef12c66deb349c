"""Boil-off: gas leaves the liquid of a separator ``factor`` times as fast for the same driving pressure (C_4)."""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class BoilOffRate(Factor):
    """A separator that boils off faster or slower.

    >>> from stickslip.plant import production_plant
    >>> BoilOffRate().places(production_plant())
    ('S1', 'S2')
    """

    name = "boil_off_rate"
    role = Role.PROCESS
    key = "C_4"
    parameters = (Parameter("factor", "-", 1.0, 0.1, 10.0, "log"),)
