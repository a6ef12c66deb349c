"""Temperature of a separator: ``factor`` times the model's absolute temperature (T_sep).

No log tells it from a gas that is not ideal.
"""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class GasTemperature(Factor):
    """A separator that is warmer or colder.

    >>> from stickslip.plant import production_plant
    >>> GasTemperature().places(production_plant())
    ('S1', 'S2')
    """

    name = "gas_temperature"
    role = Role.PROCESS
    key = "T_sep"
    parameters = (Parameter("factor", "-", 1.0, 0.8, 1.25, "log"),)
