"""An integrating process with dead time: a level, or a gas pressure without outflow of its own.

    dy/dt = (K/T) (u(t - theta) - u_0)            G(s) = K exp(-theta s)/(T s)

in   MV  stem position or flow [fraction]             out  PV  process variable [unit of PV]
K    gain [unit of PV per unit of MV]     T  time [s], > 0; only the rate K/T [unit of PV per s] matters
u_0  MV at which PV stands still [unit of MV]: inflow equals outflow        theta  dead time [s], >= 0
start  PV at the start                    theta_start  MV before the start; default u_0

A negative K is a tank whose valve is at its outlet.
The dead time is exact in the engine; python-control sees its Pade approximation (see dead_time).
Thesis test loop: 3/(10 s), K = 3, T = 10 s.  Not for: tanks that overflow or run empty.
See also: first_order, second_order.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.dead_time import Delayed, check_dead_time
from stickslip.blocks.ports import Port, require
from stickslip.blocks.rules import finite


def _der(MV: float, K: float, T: float, u_0: float) -> float:
    return K / T * (MV - u_0)


class Integrator(Delayed):
    """A process that integrates its input at the rate ``K/T`` [unit of PV per s], balanced at ``u_0``.

    ``start`` [unit of PV], ``theta_start`` [unit of MV]: both before the start.
    Raises ``BlockError`` unless K and u_0 are finite, T > 0 and theta >= 0.

    >>> from stickslip.diagram import drive
    >>> drive(Integrator(K=3.0, T=10.0), 4.0, every=2.0, MV=1.0).log["PV"].round(6).tolist()
    [0.0, 0.6, 1.2]
    """

    ports_in = (Port("MV"),)
    ports_out = (Port("PV"),)
    kernels = Kernels(der=_der, linear=True)

    def __init__(
        self, K: float, T: float = 1.0, theta: float = 0.0, *, u_0: float = 0.0, start: float = 0.0,
        theta_start: float | None = None, name: str = "process", **labels: Any,
    ) -> None:  # fmt: skip
        before = u_0 if theta_start is None else theta_start
        super().__init__(
            name=name,
            params={"K": K, "T": T, "u_0": u_0, "theta": theta, "theta_start": before},
            states={"PV": start},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K and u_0 are finite, T > 0 and theta >= 0."""
        finite(params, name, "K", "u_0")
        T = float(params["T"])
        require(0.0 < T < math.inf, name, "T", T, "an integration time is positive", "give T in seconds")
        check_dead_time(params, name)
