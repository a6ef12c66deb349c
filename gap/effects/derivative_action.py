"""Derivative action: the controller answers the speed of PV as well, with the time ``T_d`` [s], behind a lag T_d/N.

    v = K_p (SP - PV - D) + K_p/T_i integral of (SP - PV),      D = N (PV - f),   T_d/N df/dt = PV - f

What enters only the proportional part is the same as if it entered PV without what a lag of T_i makes of it, but for
limits.  A controller that has a derivative gets another one.
Source: Astrom and Hagglund, Advanced PID Control, ISA 2006, section 3.3.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, above, not_below
from stickslip.gap.insertion.of_controller import AtScans, OfController

LEAST = 1e-9  # derivative time [s] below which there is none
MISSING = 1e-3  # of the smallest derivative time that is searched for: no log shows as little


def _out(f: float, x: float, in_: float, N: float) -> float:
    return in_ + N * (in_ - f) - x


def _der(f: float, x: float, in_: float, N: float, T_f: float, T_i: float) -> tuple[float, float]:
    return (in_ - f) / T_f, (N * (in_ - f) - x) / T_i


class Derivative(OneToOne):
    """PV and its derivative, as a controller with the integral time ``T_i`` [s] takes it in its proportional part.

    >>> from stickslip.diagram import drive
    >>> drive(Derivative("y", "u", N=5.0, T_f=1.0, T_i=math.inf), 1.0, every=1.0, u=1.0).log["y"].round(3).tolist()
    [6.0, 2.839]
    """

    role = Role.FILTER
    kernels = Kernels(out=_out, der=_der, linear=True)

    def __init__(self, signal: str, source: str, N: float, T_f: float, T_i: float, *, name: str = "") -> None:
        params = {"N": N, "T_f": T_f, "T_i": T_i}
        super().__init__(signal, source, params, states={"f": 0.0, "x": 0.0}, unit="", name=name)


def _step(
    f: float, x: float, in_: float, N: float, T_f: float, T_i: float, late: float, dt: float
) -> tuple[float, float, float]:
    f += dt / (T_f + dt) * (in_ - f)
    D = N * (in_ - f)
    if late == 0.0:
        x += dt / (T_i + dt) * (D - x)
    shown = in_ + D - x
    if late != 0.0:
        x += dt / T_i * (D - x)
    return f, x, shown


class ScannedDerivative(AtScans):
    """The same at the scans of a controller; ``late``: its integral takes in the previous error.

    >>> from stickslip.diagram import drive
    >>> scanned = ScannedDerivative("y", "u", {"N": 4.0, "T_f": 1.0, "T_i": math.inf, "late": 0.0}, dt=1.0)
    >>> drive(scanned, 2.0, every=1.0, u=1.0).log["y"].tolist()
    [3.0, 2.0, 1.5]
    """

    kernels = Kernels(step=_step)
    memories = ("f", "x")


class DerivativeAction(OfController):
    """A controller with derivative action on PV.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> with_d = DerivativeAction().insert(self_regulating_loop(), "controller", T_d=2.0)
    >>> with_d["controller:derivative_action"].params["T_f"]
    0.2
    """

    name = "derivative_action"
    parameters = (
        Parameter("T_d", "s", 0.0, 0.02, 1.0, "log", "time"),
        Parameter("N", "-", 10.0, 1.0, 100.0, "log", nuisance=True),
    )
    reads = ("PV",)
    state = "f"
    own = ("T_d", "N")

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return PV and its derivative."""
        at = diagram[place]
        T_i = at.params.get("T_i", math.inf)
        if not at.sampled:
            return Derivative("out", "in", 10.0, 1.0, T_i, name=self.block(place))
        own = {"N": 10.0, "T_f": 1.0, "T_i": T_i, "late": self.late(at)}
        return ScannedDerivative("out", "in", own, **self.scans(at), name=self.block(place))

    def bounds(self, diagram: Diagram, place: str) -> dict[str, tuple[float, float]]:
        """Return the bounds; a derivative that the model has may be missing in the plant."""
        found = super().bounds(diagram, place)
        low, high = found["T_d"]
        return found | {"T_d": (MISSING * low, high)} if diagram[place].params.get("T_d", 0.0) > 0.0 else found

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the filter of the derivative as parameters of the block, or both as parameters of the controller."""
        T_d = np.maximum(values["T_d"], LEAST)
        if self.has(diagram[place]):
            return {f"{place}.T_d": T_d, f"{place}.N": values["N"]}
        return {f"{self.block(place)}.N": values["N"], f"{self.block(place)}.T_f": T_d / values["N"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"T_d": 0.0}) or above(values, "N", remedy="give 10, as most controllers have")
