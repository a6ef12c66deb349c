"""Two-phase separator: crude oil in, oil and gas out; hexane stays liquid, methane boils off.

    dN_oil/dt  = (1 - Z_I) F_in - (1 - z) F_L                     hexane, liquid          (thesis eq. 3.1)
    dN_metL/dt = Z_I F_in - z F_L - F_sep                         methane, dissolved      (eq. 3.2)
    dN_metG/dt = F_sep - F_G - F_flare                            methane, gas            (eq. 3.3, with a flare)
    F_sep = C_4 (p_metV z - p)                                    boil-off, Raoult        (eq. 3.4)
    V = v_oil N_oil + v_met N_metL                                liquid volume           (eq. 3.5)
    p = N_metG R T_sep / (V_sep - V)                              ideal gas               (footnote 2)
    z = N_metL / (N_oil + N_metL),   v = W/rho

in   F_in   feed [mol/s]               Z_I  methane fraction of the feed [-]
     F_L    oil drawn [mol/s]          F_G  gas drawn [mol/s]          F_flare  gas to flare [mol/s]
out  p  pressure [Pa]    V  liquid volume [m3]    z  methane fraction of the liquid [-]    F_sep  boil-off [mol/s]

V_sep volume [m3]   C_4 boil-off [mol/s/Pa]   p_metV vapour pressure of methane [Pa]   T_sep [K]   R [J/mol/K]
W_oil, W_met molar masses [kg/mol]   rho_oil, rho_met densities [kg/m3]

All methane of the feed arrives dissolved.  F_sep may be negative (gas dissolves again) and keeps its sign.  A second
separator behind it is fed with F_in = F_L and Z_I = z of the first.
Valid while there is both liquid and gas; not for: heat, water.  Where the vessel is full of liquid or has run dry
the equations end (p or z is 0/0, or negative beyond): all outputs and rates are NaN there, so a run stops at that
instant with a status, and ``trouble`` of the block at its end says what happened.
Source: thesis eqs. 3.1 to 3.5 and table A.1.  The printed W are in g/mol, which would make volumes a thousand times
too large; V_sep of separator 1 and C_4 are not printed.  See also: scrubber, flare, control_valve_flow.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive

# p = V_sep, C_4, p_metV, T_sep, R, W_oil, rho_oil, W_met, rho_met;  x = N_oil, N_metL, N_metG


NEARLY = 0.01  # of V_sep: a run that ended this close to full or dry ended because of it;
NOTHING = 1e-6  # so did one that ended with so little of one content, as a share of the others


def two_phases(x: Any, p: Any) -> bool:
    """Tell whether the contents are possible: some liquid, no negative moles, room for the gas."""
    possible: bool = x[0] >= 0.0 and x[1] >= 0.0 and x[2] >= 0.0 and x[0] + x[1] > 0.0 and p[0] > liquid_volume(x, p)
    return possible


def liquid_volume(x: Any, p: Any) -> float:
    """Return the liquid volume [m3]."""
    V: float = p[5] / p[6] * x[0] + p[7] / p[8] * x[1]
    return V


def gas_pressure(x: Any, p: Any) -> float:
    """Return the pressure of the gas above the liquid [Pa]."""
    pressure: float = x[2] * p[4] * p[3] / (p[0] - liquid_volume(x, p))
    return pressure


def boil_off(x: Any, p: Any) -> float:
    """Return the flow of methane from the liquid into the gas [mol/s]."""
    flow: float = p[1] * (p[2] * x[1] / (x[0] + x[1]) - gas_pressure(x, p))
    return flow


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    if not two_phases(x, p):
        for i in range(4):
            y[i] = math.nan
        return
    y[0] = gas_pressure(x, p)
    y[1] = liquid_volume(x, p)
    y[2] = x[1] / (x[0] + x[1])
    y[3] = boil_off(x, p)


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    if not two_phases(x, p):
        for i in range(3):
            dx[i] = math.nan
        return
    z = x[1] / (x[0] + x[1])
    F_sep = boil_off(x, p)
    dx[0] = (1.0 - u[1]) * u[0] - (1.0 - z) * u[2]
    dx[1] = u[1] * u[0] - z * u[2] - F_sep
    dx[2] = F_sep - u[3] - u[4]


class Separator(Block):
    """A separator that starts with the given contents [mol]; defaults are separator 1 of the thesis at rest.

    ``N_metG``: methane in the gas at the start [mol].
    Raises ``BlockError`` unless volume, densities, temperature and contents are positive and the liquid fits in.

    >>> S1 = Separator()
    >>> p, V, z, F_sep = S1.output(0.0, S1.x0, [8000.0, 0.37, 5716.3, 2283.7, 0.0])
    >>> round(float(p) / 1e5, 2), round(float(V), 2), round(float(z), 4), round(float(F_sep) / 100)
    (30.0, 40.95, 0.1183, 23)
    """

    role = Role.PROCESS
    ports_in = (
        Port("F_in", "mol/s"),
        Port("Z_I"),
        Port("F_L", "mol/s"),
        Port("F_G", "mol/s"),
        Port("F_flare", "mol/s"),
    )
    ports_out = (Port("p", "Pa"), Port("V", "m3"), Port("z"), Port("F_sep", "mol/s"))
    kernels = Kernels(out=_out, der=_der, feeds=False)

    def __init__(
        self,
        V_sep: float = 81.9,
        C_4: float = 0.026,
        *,
        p_metV: float = 261e5,
        T_sep: float = 308.15,
        R: float = 8.31,
        W_oil: float = 0.086,
        rho_oil: float = 659.0,
        W_met: float = 0.016,
        rho_met: float = 422.0,
        N_oil: float = 302017.0,
        N_metL: float = 40525.5,
        N_metG: float = 47974.7,
        name: str = "separator",
        **labels: Any,
    ) -> None:
        for key, moles in {"N_oil": N_oil, "N_metL": N_metL, "N_metG": N_metG}.items():
            require(moles > 0.0, name, key, moles, "a separator holds both phases", "give moles")
        liquid = W_oil / rho_oil * N_oil + W_met / rho_met * N_metL if rho_oil and rho_met else math.inf
        rule = f"the contents, {liquid:.4g} m3 of liquid, must fit in with room for gas"
        require(liquid < V_sep, name, "V_sep", V_sep, rule, "give a larger V_sep or less liquid")
        super().__init__(
            name=name,
            params={
                "V_sep": V_sep, "C_4": C_4, "p_metV": p_metV, "T_sep": T_sep, "R": R,
                "W_oil": W_oil, "rho_oil": rho_oil, "W_met": W_met, "rho_met": rho_met,
            },
            states={"N_oil": N_oil, "N_metL": N_metL, "N_metG": N_metG},
            **labels,
        )  # fmt: skip

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless every parameter is positive and finite."""
        positive(params, name, *params, remedy="give SI units, molar masses in kg/mol")
        for key in ("W_oil", "W_met"):
            mass = float(params[key])
            require(mass < 1.0, name, key, mass, "it is in kg/mol", "divide g/mol by 1000")

    def trouble(self) -> str:
        """Return why the equations end at the contents the block starts with, with the numbers; "" if they do not.

        >>> Separator().trouble()
        ''
        >>> Separator().starting_at(N_oil=6.12e5, N_metG=1.0).trouble()
        'separator is full: 81.4 of 81.9 m3 are liquid'
        """
        liquid, vessel = float(liquid_volume(self.x0, self.p)), float(self.p[0])
        fill = f"{liquid:.4g} of {vessel:.4g} m3 are liquid"
        if liquid > (1.0 - NEARLY) * vessel:
            return f"{self.name} is full: {fill}"
        if liquid < NEARLY * vessel:
            return f"{self.name} has run dry: {fill}"
        for name, what in (("N_oil", "oil"), ("N_metL", "dissolved methane"), ("N_metG", "gas")):
            moles = float(self.x0[self.state_names.index(name)])
            if moles < NOTHING * float(self.x0.max()):
                return f"{self.name} has no {what} left: {name} = {moles:.3g} mol"
        return ""
