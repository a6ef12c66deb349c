"""Lag of the positioner: the stem follows with the time constant ``tau`` [s]."""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.lag import Lag


class PositionerLag(Lag):
    """A valve whose stem lags.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> PositionerLag().insert(self_regulating_loop(), "valve", tau=2.0)["valve:positioner_lag"].params["tau"]
    2.0
    """

    name = "positioner_lag"
    role = Role.VALVE
    where = "at"
