"""Valve sizes: from a data sheet's Kv or Cv to the coefficient of a block, and from a duty to Kv (IEC 60534-2-1).

    Q = Kv sqrt(dp/1 bar) sqrt(rho_0/rho)         Kv: m3/h of water at a drop of 1 bar;  Cv = 1.156 Kv (US gallons, psi)
    C_v = Kv/3600 sqrt(rho rho_0/1e5) / W         of control_valve_flow [mol/s/sqrt(Pa)]; without W [kg/s/sqrt(Pa)]

rho    density before the valve [kg/m3]         rho_0  density of water at 15 degrees Celsius, 999.1 kg/m3
W      molar mass [kg/mol]                      dp     pressure drop [Pa]

The thesis sizes its valves by C_v = F/sqrt(dp) at design flow and drop (section 4.2.2), with one law for oil and gas.
``size_liquid_valve`` and ``size_gas_valve`` also know choking, pipe fittings and laminar flow; they ask the library
``fluids`` (the extra ``sizing``), which is loaded when they are called.
Valid for single fluids; the standard excludes mixtures that flash, slurries, non-Newtonian liquids.
Source: IEC 60534-1 (Kv), IEC 60534-2-1:2011 (sizing).  See also: control_valve_flow, gas_valve_flow.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.blocks.ports import BlockError, require
from stickslip.blocks.rules import positive

WATER = 999.1  # kg/m3 at 15 degrees Celsius, to which the standard refers densities
PER_KV = math.sqrt(WATER / 1e5) / 3600.0  # flow [kg/s] of Kv = 1 per root of density [kg/m3] times drop [Pa]
GALLON, PSI = 231.0 * 0.0254**3, 4.4482216152605 / 0.0254**2  # m3, Pa
CV_PER_KV = math.sqrt(PSI / 1e5) / (60.0 * GALLON)  # Cv: US gallons per minute at 1 psi, Kv: m3/h at 1 bar
R = 8.314462618  # J/(mol K)


def C_v_from_Kv(Kv: float, density: float, molar_mass: float | None = None) -> float:
    """Return C_v [mol/s/sqrt(Pa)] of a valve with ``Kv`` [m3/h] for a fluid, or [kg/s/sqrt(Pa)] without molar mass.

    ``density`` [kg/m3] is that before the valve, ``molar_mass`` in kg/mol.  Raises ``BlockError`` unless positive.

    >>> round(3600.0 * C_v_from_Kv(1.0, 999.1) * 1e5**0.5 / 999.1, 9)  # 1 m3/h of water at 1 bar
    1.0
    """
    _positive(Kv=Kv, density=density)
    _molar(molar_mass)
    return Kv * PER_KV * math.sqrt(density) / (1.0 if molar_mass is None else molar_mass)


def Kv_from_C_v(C_v: float, density: float, molar_mass: float | None = None) -> float:
    """Return Kv [m3/h] of a valve with ``C_v`` [mol/s/sqrt(Pa)], or [kg/s/sqrt(Pa)] if no molar mass is given.

    >>> round(Kv_from_C_v(6.1, density=650.0, molar_mass=0.0777), 1)  # VLCS1 of the thesis
    669.6
    """
    _positive(C_v=C_v)
    return C_v / C_v_from_Kv(1.0, density, molar_mass)


def Kv_from_Cv(Cv: float) -> float:
    """Return Kv [m3/h] of a Cv [US gallons per minute at 1 psi].

    >>> round(Kv_from_Cv(1.0), 4)
    0.865
    """
    _positive(Cv=Cv)
    return Cv / CV_PER_KV


@dataclass(frozen=True)
class Sizing:
    """The valve that a duty needs: ``Kv`` [m3/h]; whether flow is ``choked`` or ``laminar``; expansion factor ``Y``.

    >>> round(Sizing(100.0).Cv, 1)
    115.6
    """

    Kv: float
    choked: bool = False
    laminar: bool = False
    Y: float = 1.0

    @property
    def Cv(self) -> float:
        """Cv [US gallons per minute at 1 psi]."""
        return self.Kv * CV_PER_KV


def size_liquid_valve(
    m: float, p_up: float, p_down: float, *, density: float, p_vapour: float, p_critical: float, F_L: float = 0.9,
    viscosity: float = 1e-3, diameters: tuple[float, float, float] | None = None, F_d: float = 1.0,
) -> Sizing:  # fmt: skip
    """Return the size of a valve that passes ``m`` [kg/s] of liquid from ``p_up`` to ``p_down`` [Pa].

    ``density`` [kg/m3], ``p_vapour`` and ``p_critical`` [Pa]; ``F_L`` recovery factor and ``F_d`` style of the valve
    [-]; ``viscosity`` [Pa s] counts only with ``diameters`` (pipe before, pipe behind, valve) [m].
    Beyond the drop F_L^2 (p_up - F_F p_vapour) the flow is choked and a larger drop does not help.
    Raises ``BlockError`` for a drop that is not positive or that the fittings alone use up, ``ImportError`` without
    the library ``fluids``.

    >>> duty = size_liquid_valve(999.1 / 3600.0, 3e5, 2e5, density=999.1, p_vapour=2e3, p_critical=221e5)
    >>> round(duty.Kv, 3), duty.choked
    (1.0, False)
    """
    _positive(m=m, density=density, p_vapour=p_vapour, p_critical=p_critical, F_L=F_L, viscosity=viscosity, F_d=F_d)
    _falling(p_up, p_down)
    _shares(F_L=F_L)
    rule = f"liquid stands before the valve, at p_up = {p_up:g} Pa"
    require(p_vapour < p_up, "sizing", "p_vapour", p_vapour, rule, "raise p_up, or check the units")
    rule = f"it lies below p_critical = {p_critical:g} Pa"
    require(p_vapour < p_critical, "sizing", "p_vapour", p_vapour, rule, "check the units")
    found = _library().size_control_valve_l(
        rho=density, Psat=p_vapour, Pc=p_critical, mu=viscosity, P1=p_up, P2=p_down, Q=m / density, FL=F_L, Fd=F_d,
        full_output=True, **_fittings(diameters),
    )  # fmt: skip
    _converged(found, p_up - p_down, diameters)
    return Sizing(float(found["Kv"]), bool(found["choked"]), bool(found["laminar"]))


def size_gas_valve(
    m: float, p_up: float, p_down: float, *, molar_mass: float, T: float, gamma: float, Z: float = 1.0,
    x_T: float = 0.7, F_L: float = 0.9, viscosity: float = 1e-5,
    diameters: tuple[float, float, float] | None = None, F_d: float = 1.0,
) -> Sizing:  # fmt: skip
    """Return the size of a valve that passes ``m`` [kg/s] of gas from ``p_up`` to ``p_down`` [Pa].

    ``molar_mass`` [kg/mol], ``T`` [K], heat capacity ratio ``gamma`` and compressibility ``Z`` [-] before the valve;
    ``x_T`` pressure drop ratio at choking (air) [-]; the rest as in ``size_liquid_valve``.
    Beyond the drop (gamma/1.4) x_T p_up the flow is choked.  The library works with the standard's rounded constants,
    so GasValveFlow of the Kv found passes the flow within 0.2 %.
    Raises ``BlockError`` and ``ImportError`` as ``size_liquid_valve`` does.

    >>> duty = size_gas_valve(36.54, 29.9e5, 22.1e5, molar_mass=0.016, T=302.95, gamma=1.3067)
    >>> round(duty.Kv, -1), duty.choked, round(duty.Y, 3)
    (390.0, False, 0.867)
    """
    _positive(m=m, T=T, Z=Z, x_T=x_T, F_L=F_L, viscosity=viscosity, F_d=F_d)
    require(1.0 < gamma < math.inf, "sizing", "gamma", gamma, "a heat capacity ratio exceeds 1", "1.3 suits methane")
    _falling(p_up, p_down)
    _shares(F_L=F_L, x_T=x_T)
    _molar(molar_mass)
    normal = m / molar_mass * R * 273.15 / 101325.0  # m3/s at 0 degrees Celsius and 1 atm
    found = _library().size_control_valve_g(
        T=T, MW=1e3 * molar_mass, mu=viscosity, gamma=gamma, Z=Z, P1=p_up, P2=p_down, Q=normal, FL=F_L, Fd=F_d,
        xT=x_T, full_output=True, **_fittings(diameters),
    )  # fmt: skip
    _converged(found, p_up - p_down, diameters)
    return Sizing(float(found["Kv"]), bool(found["choked"]), bool(found["laminar"]), float(found["Y"]))


def _library() -> Any:
    try:
        from fluids import control_valve
    except ImportError as error:
        raise ImportError("sizing by IEC 60534 needs the library fluids; pip install 'stickslip[sizing]'") from error
    return control_valve


def _converged(found: Mapping[str, Any], drop: float, diameters: tuple[float, float, float] | None) -> None:
    """Refuse what the library returns with a warning only: sizes up to 1e45 where the fittings take the whole drop."""
    if "warning" in found:
        raise BlockError(
            f"sizing: diameters = {diameters!r}, but no valve passes the flow at a drop of {drop:g} Pa with such "
            "fittings: they alone take more; give a larger valve and pipe, or a larger drop"
        )


def _fittings(diameters: tuple[float, float, float] | None) -> dict[str, float]:
    if diameters is None:
        return {}
    three = len(diameters) == 3
    require(three, "sizing", "diameters", diameters, "they are pipe before, pipe behind, valve", "give three, in m")
    before, behind, valve = diameters
    _positive(before=before, behind=behind, valve=valve)
    rule = "the standard's fittings narrow towards the valve"
    require(valve <= min(before, behind), "sizing", "valve", valve, rule, "give the valve's diameter last")
    return {"D1": before, "D2": behind, "d": valve}


def _positive(**values: float) -> None:
    positive(values, "sizing", *values)


def _shares(**values: float) -> None:
    for key, value in values.items():
        require(value <= 1.0, "sizing", key, value, "it is a share", "0.9 (F_L) and 0.7 (x_T) suit a globe valve")


def _molar(mass: float | None) -> None:
    if mass is not None:
        require(0.0 < mass < 1.0, "sizing", "molar_mass", mass, "it is positive, in kg/mol", "divide g/mol by 1000")


def _falling(p_up: float, p_down: float) -> None:
    if not 0.0 <= p_down < p_up < math.inf:
        raise BlockError(
            f"sizing: p_up = {p_up!r}, p_down = {p_down!r}, but a valve is sized for a falling pressure; "
            "give absolute pressures in Pa, the higher one first"
        )
