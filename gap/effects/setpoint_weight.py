"""Set-point weight of a controller with two degrees of freedom: its proportional part takes ``b`` times SP.

    v = K_p (b SP - PV) + K_p/T_i integral of (SP - PV)

It is the same as SP behind (1 + b T_i s)/(1 + T_i s), but for limits.  A controller that has a weight gets another one.
Source: Astrom and Hagglund, Advanced PID Control, ISA 2006, section 3.4.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.lead_lag import LeadLag
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, finite
from stickslip.gap.insertion.of_controller import OfController, ScannedLeadLag


class SetpointWeight(OfController):
    """A controller whose proportional part takes a share of the set point only.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> weighted = SetpointWeight().insert(self_regulating_loop(), "controller", b=0.4)
    >>> weighted["controller:setpoint_weight"].params["T_lead"]
    4.0
    """

    name = "setpoint_weight"
    parameters = (Parameter("b", "-", 1.0, 0.0, 2.0),)
    state = "x"
    own = ("b",)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the controller reads SP and has a weight or an integral time."""
        return super().fits(diagram, block) and (self.has(block) or 0.0 < block.params.get("T_i", 0.0) < math.inf)

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the lead and the lag."""
        at = diagram[place]
        T_i = at.params["T_i"]
        if not at.sampled:
            return LeadLag("out", "in", T_i, T_i, name=self.block(place))
        late = self.late(at)
        share = at.period / (T_i + (1.0 - late) * at.period)
        own = {"ratio": 1.0, "share": share, "late": late}
        return ScannedLeadLag("out", "in", own, **self.scans(at), name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the weight as the lead."""
        at, own = diagram[place], self.block(place)
        if self.has(at):
            return {f"{place}.b": values["b"]}
        return {f"{own}.ratio": values["b"]} if at.sampled else {f"{own}.T_lead": values["b"] * at.params["T_i"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return finite(values, "b", remedy="give 1 for none")
