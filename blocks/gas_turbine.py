"""A gas turbine that drives a shaft: its torque follows what the speed controller asks, late and within its rating.

    T dtau/dt = limited(tau_SP) - tau            limited to 0 ... min(tau_max, P_max/w)

in   tau_SP  torque asked for [N m]    w  speed of the shaft [rad/s]          out  tau_d  torque of the drive [N m]
T        lag of fuel system, combustor and gas generator [s]
tau_max  highest torque [N m]          P_max  highest power [W]

At rest the torque is what is asked, so it changes no operating point.  Taking hold and letting go of a limit is
located and logged (modes).  It cannot brake.  Against windup the controller in front needs the rating as its ``high``.
Valid near design speed; not for: starting, the gas generator's own speed, exhaust temperature, ambient air.
Source: first-order part of Rowen, J. Eng. Power 105 (1983) 865-869 [E]; the thesis prints no turbine: there the
torque is what SC001 asks (section 3.5.2).
See also: shaft, pi.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.limits import FREE, HIGH, LOW, limit_events, limit_transition
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive

STILL = 1e-3  # rad/s, keeps the power limit finite at standstill

# p = T, tau_max, P_max


def _highest(w: float, p: Any) -> float:
    """Return the highest torque at the speed ``w`` [N m]."""
    limit: float = min(p[1], p[2] / max(w, STILL))
    return limit


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = (min(max(u[0], 0.0), _highest(u[1], p)) - x[0]) / p[0]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    limit_events(u[0], 0.0, _highest(u[1], p), d, g)


class GasTurbine(Block):
    """A turbine that starts with the torque ``start`` [N m]; defaults [E] fit the production plant's 13 to 16 MW.

    Raises ``BlockError`` unless T, tau_max and P_max are positive and start lies within 0 ... tau_max.

    >>> from stickslip.diagram import drive
    >>> turbine = GasTurbine(T=0.5, start=10e3)
    >>> drive(turbine, 1.0, every=0.5, tau_SP=12e3, w=994.838).log["tau_d"].round(1).tolist()  # 12e3 - 2e3 exp(-t/T)
    [10000.0, 11264.2, 11729.3]
    """

    role = Role.PROCESS
    ports_in = (Port("tau_SP", "N m"), Port("w", "rad/s"))
    ports_out = (Port("tau_d", "N m"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=limit_transition, n_events=2, feeds=False)
    modes = {"free": FREE, "at its rating": HIGH, "idle": LOW}

    def __init__(
        self,
        T: float = 0.2,
        tau_max: float = 25e3,
        P_max: float = 22e6,
        *,
        start: float = 0.0,
        name: str = "turbine",
        **labels: Any,
    ) -> None:
        rule = 0.0 <= start <= tau_max
        require(rule, name, "start", start, f"the torque is limited to 0 ... {tau_max}", "start within the limits")
        super().__init__(
            name=name,
            params={"T": T, "tau_max": tau_max, "P_max": P_max},
            states={"tau": start},
            memory={"mode": FREE},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless T, tau_max and P_max are positive."""
        positive(params, name, "T", "tau_max", "P_max")
