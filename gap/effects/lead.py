"""Lead: the process answers the speed of what enters it as well, by ``T`` [s]; an inverse response where T < 0.

    u' = (1 + T s)/(1 + |T|/N s) u                  N = 10

Source: Seborg, Edgar and Mellichamp, Process Dynamics and Control, 2nd ed. 2004, section 6.1 (numerator dynamics).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.lead_lag import LeadLag
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, finite
from stickslip.gap.insertion.inserted import Inserted

N = 10.0
LEAST = 1e-9  # lead [s] below which there is none


class Lead(Inserted):
    """A process with numerator dynamics.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> Lead().insert(self_regulating_loop(), "process", T=-2.0)["process:lead"].params["T_lead"]
    -2.0
    """

    name = "lead"
    role = Role.PROCESS
    parameters = (Parameter("T", "s", 0.0, -1.0, 1.0, "linear", "time"),)
    where = "before"
    state = "x"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the lead and the lag."""
        return LeadLag("out", "in", 1.0, 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return lead and lag as parameters of the block."""
        own, T = self.block(place), values["T"]
        return {f"{own}.T_lead": T, f"{own}.T_lag": np.maximum(np.abs(T), LEAST) / N}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return finite(values, "T")
