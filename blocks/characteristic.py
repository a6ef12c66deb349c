"""The inherent characteristic of a valve: flow at constant pressure drop against stem position.

    linear                    flow = x + leak
    equal percentage          flow = (R^x - 1)/(R - 1) + leak
    classical equal percentage  flow = R^(x - 1) + leak
    quick opening             flow = sqrt(x) + leak          (x < 0 counts as 0)

in   MV  stem position [fraction of travel]          out  flow  [fraction of the flow at full travel]
R     rangeability [-], > 0        leak  flow that passes the shut valve [fraction of full flow]; an offset

Equal percentage means that equal steps of the stem change the flow by equal percentages: d flow/dx = ln(R) flow.
The classical law does so exactly, but passes 1/R when shut; the first form is shifted to shut tight, equal
percentage only approximately, linear for R = 1 and quick opening for R < 1, so that one number R spans all.
Valid for the inherent characteristic; the installed one follows from the pressure drop of the plant around it.
A static block: MV acts on the flow at once.
Source: textbook laws, in the terms of IEC 60534-2-4.
See also: stick_slip and its siblings (OP to MV), first_order (flow to PV).
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port, nearest, require
from stickslip.blocks.role import Role


def _shifted_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    log_R = math.log(p[0])
    y[0] = p[1] + (u[0] if log_R == 0.0 else math.expm1(log_R * u[0]) / math.expm1(log_R))


def _classical_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] + p[0] ** (u[0] - 1.0)


def _quick_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] + math.sqrt(max(u[0], 0.0))


LAWS = {
    "equal percentage": Kernels(out=_shifted_out),
    "classical equal percentage": Kernels(out=_classical_out),
    "quick opening": Kernels(out=_quick_out),
}


class Characteristic(Block):
    """Flow against stem position; without arguments linear.

    ``R`` is the rangeability [-] of the equal percentage laws (R = 1 is linear), ``leak`` the flow of the shut
    valve [fraction of full flow].  Raises ``BlockError`` for an unknown law, R <= 0, or R = 1 in the classical law.

    >>> [round(float(Characteristic(R=50.0).output(0.0, [], [x])[0]), 3) for x in (0.0, 0.5, 1.0)]
    [0.0, 0.124, 1.0]
    >>> round(float(Characteristic.quick_opening(leak=0.01).output(0.0, [], [0.25])[0]), 3)
    0.51
    """

    role = Role.PROCESS
    ports_in = (Port("MV"),)
    ports_out = (Port("flow"),)

    def __init__(
        self,
        R: float = 1.0,
        leak: float = 0.0,
        *,
        law: str = "equal percentage",
        name: str = "characteristic",
        **labels: Any,
    ) -> None:
        if law not in LAWS:
            raise BlockError(f"{name}: no law '{law}'; {nearest(law, list(LAWS))}")
        require(law != "classical equal percentage" or R != 1.0, name, "R", R, "R^(x - 1) is then 1 at every stem "
                "position", "give R > 1, or take the linear law")  # fmt: skip
        self.kernels = LAWS[law]
        super().__init__(name=name, params={"R": R, "leak": leak}, **labels)

    @classmethod
    def classical(cls, R: float = 50.0, leak: float = 0.0, **keywords: Any) -> Self:
        """Return the classical equal percentage law R^(x - 1), which passes 1/R of the full flow when shut."""
        return cls(R, leak, law="classical equal percentage", **keywords)

    @classmethod
    def quick_opening(cls, leak: float = 0.0, **keywords: Any) -> Self:
        """Return the quick opening law sqrt(x)."""
        return cls(1.0, leak, law="quick opening", **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless R > 0 and the leak is finite."""
        R, leak = float(params["R"]), float(params["leak"])
        require(0.0 < R < math.inf, name, "R", R, "a rangeability is positive and finite", "R = 1 is linear, 50 usual")
        require(math.isfinite(leak), name, "leak", leak, "it must be a finite number", "give a fraction of full flow")
