"""A shaft: a drive turns one or more loads.

    J dw/dt = tau_d - sum of tau_i

in   tau_d  torque of the drive [N m]      the load torques named [N m]       out  w  speed [rad/s]
J    moment of inertia of everything that turns [kg m2]

A stiff shaft.  The drive is whatever gives tau_d: a gas turbine, or at once what a speed controller asks, a constant.
Valid for a shaft that turns; not for: torsion, friction of bearings, a shaft at rest (loads that divide by w).
Source: thesis eq. 3.11, there I_tot; the thesis prints no number, J = 20 is calibrated [C].
See also: gas_turbine, compressor.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role

# p = J, loads (number of ports)


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    net = u[0]
    for i in range(1, 1 + int(p[1])):
        net -= u[i]
    dx[0] = net / p[0]


class Shaft(Block):
    """A shaft of inertia ``J`` [kg m2] with the load torques named, at first turning with ``start`` [rad/s].

    Raises ``BlockError`` unless J and start are positive and a load is named.

    >>> from stickslip.diagram import drive
    >>> shaft = Shaft(20.0, start=994.838, loads=["tau_2", "tau_3"])
    >>> drive(shaft, 2.0, every=1.0, tau_d=100.0, tau_2=50.0, tau_3=40.0).log["w"].round(3).tolist()
    [994.838, 995.338, 995.838]
    """

    role = Role.PROCESS
    ports_out = (Port("w", "rad/s"),)
    kernels = Kernels(out=_out, der=_der, feeds=False)

    def __init__(
        self, J: float = 20.0, *, start: float, loads: Sequence[str] = ("tau",), name: str = "shaft", **labels: Any
    ) -> None:
        loads = (loads,) if isinstance(loads, str) else tuple(loads)
        require(bool(loads), name, "loads", loads, "a shaft turns something", "name a load torque")
        require(0.0 < start < math.inf, name, "start", start, "the loads divide by the speed", "give rad/s")
        self.ports_in = (Port("tau_d", "N m"), *(Port(load, "N m") for load in loads))
        super().__init__(name=name, params={"J": J, "loads": len(loads)}, states={"w": start}, **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless J is positive."""
        J = float(params["J"])
        require(0.0 < J < math.inf, name, "J", J, "an inertia is positive", "give kg m2")

    def with_params(self, **changes: float) -> "Shaft":
        """Return a copy with another J; the number of loads belongs to the wiring.

        Raises ``BlockError`` for another number of loads, an unknown name, or a J that is not positive.
        """
        rule = "loads" not in changes
        require(rule, self.name, "loads", changes.get("loads"), "the loads are wired", "make another Shaft")
        return super().with_params(**changes)
