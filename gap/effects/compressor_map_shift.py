"""Shift of the map: a compressor swallows ``factor`` times the flow at the same head and speed (m_d)."""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class CompressorMapShift(Factor):
    """A compressor whose map lies elsewhere.

    >>> from stickslip.plant import production_plant
    >>> CompressorMapShift().places(production_plant())
    ('C3', 'C2')
    """

    name = "compressor_map_shift"
    role = Role.PROCESS
    key = "m_d"
    parameters = (Parameter("factor", "-", 1.0, 0.6, 1.5, "log"),)
