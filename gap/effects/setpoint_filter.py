"""Filter of the set point: the controller reads SP behind a lag of time constant ``tau`` [s]; PV is not filtered."""

from stickslip.gap.effects.controller_filter import ControllerFilter


class SetpointFilter(ControllerFilter):
    """A controller that filters its set point.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> SetpointFilter().insert(self_regulating_loop(), "controller", tau=2.0)["controller"].input_labels
    ['SP:controller:setpoint_filter SP', 'PV']
    """

    name = "setpoint_filter"
    reads = ("SP",)
