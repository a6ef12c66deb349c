"""Real gas: the pressure of the gas in a separator is ``factor`` times that of an ideal gas, the compressibility Z.

No log tells it from another gas temperature.
"""

from blocks.block import Block
from blocks.role import Role
from blocks.separator import Separator
from diagram.diagram import Diagram
from gap.insertion.effect import Parameter
from gap.insertion.factor import Factor


class RealGas(Factor):
    """A separator with a gas that is not ideal.

    >>> from plant import production_plant
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
