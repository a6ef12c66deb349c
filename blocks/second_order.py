"""A second-order process with dead time (SOPDT), over- or underdamped.

    y'' + 2 zeta omega y' + omega^2 y = omega^2 K u(t - theta)
    G(s) = K exp(-theta s)/(s^2/omega^2 + 2 zeta s/omega + 1)      two lags: K/((tau1 s + 1)(tau2 s + 1))

in   MV  stem position or flow [fraction]             out  PV  process variable [unit of PV]
K    gain [unit of PV per unit of MV]     omega  natural frequency [rad/s], > 0     zeta  damping ratio [-], >= 0
theta  dead time [s], >= 0       start  PV at the start, at rest     theta_start  MV before the start (start/K)

Two lags are omega = 1/sqrt(tau1 tau2), zeta = (tau1 + tau2)/(2 sqrt(tau1 tau2)) >= 1.
The dead time is exact in the engine; python-control sees its Pade approximation (see dead_time).
Textbook model.  See also: first_order, integrator.
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Kernels
from stickslip.blocks.dead_time import Delayed, check_dead_time
from stickslip.blocks.ports import Port, number, require


def _der(PV: float, rate: float, MV: float, K: float, omega: float, zeta: float) -> tuple[float, float]:
    return rate, omega * (omega * (K * MV - PV) - 2.0 * zeta * rate)


class SecondOrder(Delayed):
    """A process with gain ``K``, natural frequency ``omega`` [rad/s], damping ``zeta`` [-] and dead time ``theta`` [s].

    ``start`` [unit of PV], ``theta_start`` [unit of MV]: both before the start.
    Raises ``BlockError`` unless K is finite, omega > 0, zeta >= 0 and theta >= 0.

    >>> from stickslip.diagram import drive
    >>> process = SecondOrder.from_lags(K=2.0, tau1=10.0, tau2=10.0)
    >>> drive(process, 20.0, every=10.0, MV=1.0).log["PV"].round(4).tolist()  # 2 (1 - (1 + t/10) exp(-t/10))
    [0.0, 0.5285, 1.188]
    """

    ports_in = (Port("MV"),)
    ports_out = (Port("PV"),)
    kernels = Kernels(der=_der, linear=True)

    def __init__(
        self, K: float, omega: float, zeta: float, theta: float = 0.0, *, start: float = 0.0,
        theta_start: float | None = None, name: str = "process", **labels: Any,
    ) -> None:  # fmt: skip
        before = (start / K if K else 0.0) if theta_start is None else theta_start
        super().__init__(
            name=name,
            params={"K": K, "omega": omega, "zeta": zeta, "theta": theta, "theta_start": before},
            states={"PV": start, "rate": 0.0},
            **labels,
        )

    @classmethod
    def from_lags(cls, K: float, tau1: float, tau2: float, theta: float = 0.0, **keywords: Any) -> Self:
        """Return the process K exp(-theta s)/((tau1 s + 1)(tau2 s + 1)); both time constants [s] positive.

        Raises ``BlockError`` for a time constant that is not positive, and as ``SecondOrder`` does.
        """
        name = str(keywords.get("name", "process"))
        for key, tau in (("tau1", tau1), ("tau2", tau2)):
            rule = "a time constant is positive"
            require(0.0 < number(name, key, tau) < math.inf, name, key, tau, rule, "for a single lag use FirstOrder")
        omega = 1.0 / math.sqrt(tau1 * tau2)
        return cls(K, omega, 0.5 * (tau1 + tau2) * omega, theta, **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K is finite, omega > 0, zeta >= 0 and theta >= 0."""
        K, omega, zeta = float(params["K"]), float(params["omega"]), float(params["zeta"])
        require(math.isfinite(K), name, "K", K, "a gain is a finite number", "give a number")
        require(0.0 < omega < math.inf, name, "omega", omega, "a natural frequency is positive", "give it in rad/s")
        require(0.0 <= zeta < math.inf, name, "zeta", zeta, "a damping ratio is not negative", "1 is critical damping")
        check_dead_time(params, name)
