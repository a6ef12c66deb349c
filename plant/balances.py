"""Balances of what crosses the plant's boundaries, integrated inside the model, so that balances close to rounding.

    methane   Z_I F_in - z_1 F_L1 - F_G1 - F_flare1                       methane of S1 [mol]
    oil       (1 - Z_I) F_in - (1 - z_1) F_L1                             hexane of S1 [mol]
    moles     F_in - F_G1 - F_flare1 - F_L2 - F_G2 - F_flare2             S1 and S2 together [mol]
    gas       m_C4 + m_G1 + m_G2 - m_out2                                 gas in the four plena [kg]
    energy    (tau_d - tau_2 - tau_3) w                                   the turning shaft [J]

Each starts with what the plant holds.  A method keeps sums of states to rounding, so the first four must agree with
the contents however rough the tolerance; the energy is quadratic in w and agrees to the tolerance.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role
from stickslip.diagram import Diagram, wire

ACCOUNTS = ("methane", "oil", "moles", "gas", "energy")
FLOWS = {
    "F_in": "mol/s", "Z_I": "", "z_1": "", "F_L1": "mol/s", "F_G1": "mol/s", "F_flare1": "mol/s", "F_L2": "mol/s",
    "F_G2": "mol/s", "F_flare2": "mol/s", "m_C4": "kg/s", "m_G1": "kg/s", "m_G2": "kg/s", "m_out2": "kg/s",
    "tau_d": "N m", "tau_2": "N m", "tau_3": "N m", "w": "rad/s",
}  # fmt: skip


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    for i in range(5):
        y[i] = x[i]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = u[1] * u[0] - u[2] * u[3] - u[4] - u[5]
    dx[1] = (1.0 - u[1]) * u[0] - (1.0 - u[2]) * u[3]
    dx[2] = u[0] - u[4] - u[5] - u[6] - u[7] - u[8]
    dx[3] = u[9] + u[10] + u[11] - u[12]
    dx[4] = (u[13] - u[14] - u[15]) * u[16]


class Balances(Block):
    """The five accounts of the production plant, which start with the contents given."""

    role = Role.ARITHMETIC
    ports_in = tuple(Port(signal, unit) for signal, unit in FLOWS.items())
    ports_out = tuple(Port(f"balance_{account}") for account in ACCOUNTS)
    kernels = Kernels(out=_out, der=_der, feeds=False)

    def __init__(self, start: NDArray[np.float64]) -> None:
        super().__init__(name="balances", params={}, states=dict(zip(ACCOUNTS, start.tolist(), strict=True)))


def contents(plant: Diagram) -> NDArray[np.float64]:
    """Return what the plant holds by its states, shape (5,), as the accounts above.

    >>> from stickslip.plant import production_plant
    >>> contents(production_plant("B")).round(-2).tolist()
    [88500.0, 302000.0, 810600.0, 0.0, 9897000.0]
    """
    S1, S2 = plant["S1"].x0, plant["S2"].x0
    plena = [plant[f"C{i}_{side}"] for i in (2, 3) for side in ("inlet", "outlet")]
    gas = sum(float(one.x0[0]) * one.params["V"] / one.params["c_01"] ** 2 for one in plena)
    shaft = plant["shaft"]
    energy = 0.5 * shaft.params["J"] * float(shaft.x0[0]) ** 2
    return np.array([S1[1] + S1[2], S1[0], S1.sum() + S2.sum(), gas, energy])


def with_balances(plant: Diagram) -> Diagram:
    """Return the plant with its balances; at the end compare ``contents(run.final)`` with ``run.final["balances"].x0``.

    >>> from stickslip.diagram import simulate
    >>> from stickslip.plant import kicked, production_plant
    >>> run = simulate(with_balances(kicked(production_plant())), 50.0, every=10.0, method="stiff")
    >>> bool(abs(contents(run.final) / run.final["balances"].x0 - 1.0)[:4].max() < 1e-12)
    True
    """
    return wire([*plant.blocks, Balances(contents(plant))], name=plant.name)
