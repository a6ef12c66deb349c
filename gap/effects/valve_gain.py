"""Gain of the valve: the flow is ``factor`` times what the stem position should give.

flow = factor x                      all of it
flow = at + factor (x - at)          about an opening ``at`` [% of travel] at which the model has the right flow
"""

from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.about import FactorAbout
from stickslip.gap.insertion.effect import NOMINAL, Parameter
from stickslip.gap.insertion.inserted import percent_out
from stickslip.gap.insertion.paths import given


class ValveGain(FactorAbout):
    """A valve of another size, or that passes more for each step than the model's.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> larger = ValveGain().insert(self_regulating_loop(), "valve", factor=1.2, at=40.0)["valve:valve_gain"]
    >>> larger.params["w_in"], round(larger.params["offset"], 3)
    (1.2, -0.08)
    """

    name = "valve_gain"
    role = Role.VALVE
    parameters = (Parameter("factor", "-", 1.0, 0.3, 3.0, "log"), Parameter("at", "% travel", NOMINAL, 0.0, 100.0))
    where = "after"

    def signal(self, diagram: Diagram, place: str) -> str:
        """Return what the valve gives."""
        return given(diagram, place)

    def unit_of(self, diagram: Diagram, place: str) -> float:
        """Return one percent of travel."""
        return percent_out(diagram, place)
