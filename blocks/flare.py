"""Safety pressure controller: gas beyond a pressure limit goes to the flare, at once and without bound.

    e = p - SP,   v = K_p e + z,   F_flare = max(0, v)
    dz/dt = K_p e / T_i, but 0 while v < 0 and e < 0                          (thesis section 3.5.4)

in   SP  pressure limit [Pa]    PV  pressure [Pa]         out  OP  flow to the flare [mol/s]
K_p  gain [mol/s/Pa]            T_i  integral time [s]

A PI controller that acts directly on the flow: no valve, no upper limit.
Valid for a relief that is always large enough; not for: a flare header with its own pressure.
Source: thesis section 3.5.4 and table 5.1.  See also: pi, separator (port F_flare).
"""

import math
from typing import Any

from stickslip.blocks.pi import PI
from stickslip.blocks.role import Role


class Flare(PI):
    """Flow to the flare; defaults are PCS12 and PCS22 of thesis table 5.1.

    Raises ``BlockError`` for K_p <= 0 or T_i <= 0.

    >>> flare = Flare()
    >>> [round(float(flare.output(0.0, flare.x0, [40e5, p])[0]), 6) for p in (30e5, 40e5, 40.1e5)]
    [0.0, 0.0, 100.0]
    """

    role = Role.VALVE

    def __init__(self, K_p: float = 0.01, T_i: float = 0.8, *, name: str = "flare", **labels: Any) -> None:
        super().__init__(
            K_p,
            T_i,
            low=0.0,
            high=math.inf,
            action="direct",
            anti_windup="conditional",
            name=name,
            units={"SP": "Pa", "PV": "Pa", "OP": "mol/s"} | labels.pop("units", {}),
            **labels,
        )
