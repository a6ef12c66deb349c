"""Fouling: a compressor makes ``factor`` times the head of its map at the same corrected flow and speed (h_d)."""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class CompressorFouling(Factor):
    """A compressor whose blades are dirty.

    >>> from stickslip.plant import production_plant
    >>> CompressorFouling().places(production_plant())
    ('C3', 'C2')
    """

    name = "compressor_fouling"
    role = Role.PROCESS
    key = "h_d"
    parameters = (Parameter("factor", "-", 1.0, 0.6, 1.2, "log"),)
