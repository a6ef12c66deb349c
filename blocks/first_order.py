"""A first-order process with dead time (FOPDT): the usual model of a flow, pressure or temperature loop.

    tau dy/dt = K u(t - theta) - y                G(s) = K exp(-theta s)/(tau s + 1)

in   MV  stem position or flow [fraction]             out  PV  process variable [unit of PV]
K    gain [unit of PV per unit of MV]     tau  time constant [s], > 0     theta  dead time [s], >= 0
start        PV at the start              theta_start  MV before the start; default start/K, so that nothing moves

The dead time is exact in the engine; python-control sees its Pade approximation (see dead_time).
Thesis section 3.3 of its test loops: K = 3, tau = 10 s, no dead time.  Self-regulating; not for levels.
See also: second_order, integrator, dead_time.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.dead_time import Delayed, check_dead_time
from stickslip.blocks.ports import Port, require


def _der(PV: float, MV: float, K: float, tau: float) -> float:
    return (K * MV - PV) / tau


class FirstOrder(Delayed):
    """A lag with gain ``K``, time constant ``tau`` [s] and dead time ``theta`` [s].

    ``start`` [unit of PV], ``theta_start`` [unit of MV]: both before the start.
    Raises ``BlockError`` unless K is finite, tau > 0 and theta >= 0.

    >>> from stickslip.diagram import drive
    >>> process = FirstOrder(K=3.0, tau=10.0, theta=2.0)
    >>> drive(process, 12.0, every=4.0, MV=1.0).log["PV"].round(4).tolist()  # 3 (1 - exp(-(t - 2)/10))
    [0.0, 0.5438, 1.3536, 1.8964]
    """

    ports_in = (Port("MV"),)
    ports_out = (Port("PV"),)
    kernels = Kernels(der=_der, linear=True)
    lag_param = "tau"

    def __init__(
        self, K: float, tau: float, theta: float = 0.0, *, start: float = 0.0, theta_start: float | None = None,
        name: str = "process", **labels: Any,
    ) -> None:  # fmt: skip
        before = (start / K if K else 0.0) if theta_start is None else theta_start
        super().__init__(
            name=name,
            params={"K": K, "tau": tau, "theta": theta, "theta_start": before},
            states={"PV": start},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K is finite, tau > 0 and theta >= 0."""
        K, tau = float(params["K"]), float(params["tau"])
        require(math.isfinite(K), name, "K", K, "a gain is a finite number", "give a number")
        require(0.0 < tau < math.inf, name, "tau", tau, "a time constant is positive", "give tau in seconds")
        check_dead_time(params, name)
