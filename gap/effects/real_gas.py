"""Real gas: the pressure of the gas in a separator is ``factor`` times that of an ideal gas, the compressibility Z.

No log tells it from another gas temperature.
"""

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.separator import Separator
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class RealGas(Factor):
    """A separator with a gas that is not ideal.

    >>> from stickslip.plant import production_plant
    >>> RealGas().places(production_plant())
    ('S1', 'S2')
    """

    name = "real_gas"
    role = Role.PROCESS
    key = "R"
    parameters = (Parameter("factor", "-", 1.0, 0.6, 1.3, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block is a separator."""
        return isinstance(block, Separator)
