"""Flow of gas through a control valve body: expansion and choking by IEC 60534, signed.

    F = Kv/3600 sqrt(rho_0/1e5) x Y sqrt(rho) root(dp) / W             root() as in control_valve_flow
    rho = p W/(Z R T),   dp = min(drop, F_g x_T p)                     p: the higher of the two pressures
    Y = 1 - dp/(3 F_g x_T p)  (1 ... 2/3),   F_g = gamma/1.4           beyond F_g x_T p the flow is choked

in   p_up, p_down  pressures [Pa]      MV  stem position [fraction of travel], below 0 it passes nothing
out  F  flow [mol/s]; with ``unit="kg/s"`` without the division by W
Kv     size at full travel [m3/h]      W  molar mass [kg/mol]    T  temperature before the valve [K]
Z, gamma  compressibility and heat capacity ratio [-]            x_T  pressure drop ratio at choking with air [-]
p_lam  drop below which the flow becomes laminar [Pa]

Flow and its slope are continuous where choking begins; the instants are located and logged (modes).  With
``check_valve`` nothing flows backwards.  At a small drop it is control_valve_flow with
C_v = sizing.C_v_from_Kv(Kv, rho, W), which has the same size at every drop and never chokes.
Valid for single gases, turbulent, without fittings; not for: temperature that changes, noise, x_T that depends on MV.
Source: IEC 60534-2-1:2011, sections 5 and 6; an alternative to the thesis's incompressible law (eq. 4.2).
See also: control_valve_flow, sizing.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.control_valve_flow import BAND, root
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive
from stickslip.blocks.sizing import PER_KV, C_v_from_Kv, R

VACUUM = 1.0  # Pa, keeps Y finite where python-control first evaluates a diagram with all signals at zero
UNITS = ("mol/s", "kg/s")

# p = Kv, W, T, Z, gamma, x_T, p_lam, molar, check


def choking(higher: float, p: Any) -> float:
    """Return the drop [Pa] at which the flow chokes."""
    drop: float = p[4] / 1.4 * p[5] * max(higher, VACUUM)
    return drop


def gas_flow(p_up: float, p_down: float, MV: float, p: Any) -> float:
    """Return the flow in the unit of the block."""
    drop = p_up - p_down
    if p[8] > 0.0 and drop < 0.0:
        return 0.0
    higher = max(p_up, p_down, VACUUM)
    most = choking(higher, p)
    felt = min(max(drop, -most), most)
    expansion = 1.0 - abs(felt) / (3.0 * most)
    size = p[0] * PER_KV * math.sqrt(higher * p[1] / (p[3] * R * p[2])) / (p[1] if p[7] > 0.0 else 1.0)
    flow: float = size * max(MV, 0.0) * expansion * root(felt, p[6])
    return flow


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = gas_flow(u[0], u[1], u[2], p)


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    drop, band = u[0] - u[1], BAND * (abs(u[0]) + abs(u[1]))
    over = max(drop, 0.0 if p[8] > 0.0 else -drop) - choking(max(u[0], u[1]), p)
    if d[0] == 0.0:  # flowing: chokes, or shuts
        g[0] = over
        g[1] = -drop - band if p[8] > 0.0 else -1.0
    else:  # choked or shut: flows again
        g[0] = (-over if d[0] == 1.0 else drop) - band
        g[1] = -1.0


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    d[0] = (1.0 if k[0] == 0.0 else 2.0) if d[0] == 0.0 else 0.0


class GasValveFlow(Block):
    """A gas valve body of size ``Kv`` [m3/h]; defaults are methane as the compressors of the thesis suck it.

    Raises ``BlockError`` unless all parameters are positive, x_T < 1 < gamma and the unit is mol/s or kg/s.

    >>> body = GasValveFlow(3620.0)
    >>> [round(float(body.output(0.0, [], [29.9e5, p_down, 0.1])[0])) for p_down in (29.9e5, 22.1e5, 12e5, 6e5, 1e5)]
    [0, 2096, 2544, 2551, 2551]
    """

    role = Role.PROCESS
    ports_in = (Port("p_up", "Pa"), Port("p_down", "Pa"), Port("MV"))
    ports_out = (Port("F", "mol/s"),)
    kernels = Kernels(out=_out, zc=_zc, jump=_jump, n_events=2)
    modes = {"flowing": 0.0, "choked": 1.0, "shut": 2.0}

    def __init__(
        self,
        Kv: float,
        *,
        W: float = 0.016,
        T: float = 302.95,
        Z: float = 1.0,
        gamma: float = 1.3067,
        x_T: float = 0.7,
        p_lam: float = 100.0,
        check_valve: bool = False,
        unit: str = "mol/s",
        name: str = "body",
        **labels: Any,
    ) -> None:
        if unit not in UNITS:
            raise BlockError(f"{name}: unit = {unit!r}, but a flow of gas is in mol/s or kg/s; give one of them")
        super().__init__(
            name=name,
            params={
                "Kv": Kv, "W": W, "T": T, "Z": Z, "gamma": gamma, "x_T": x_T, "p_lam": p_lam,
                "molar": float(unit == "mol/s"), "check": float(check_valve),
            },
            memory={"mode": 0.0},
            units={"F": unit},
            **labels,
        )  # fmt: skip

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all parameters are positive and x_T < 1 < gamma."""
        positive(params, name, "Kv", "W", "T", "Z", "gamma", "x_T", "p_lam")
        x_T, gamma, W = float(params["x_T"]), float(params["gamma"]), float(params["W"])
        require(W < 1.0, name, "W", W, "it is in kg/mol", "divide g/mol by 1000")
        require(
            x_T < 1.0, name, "x_T", x_T, "the drop at choking is a share of the pressure", "0.7 suits a globe valve"
        )
        require(gamma > 1.0, name, "gamma", gamma, "a heat capacity ratio exceeds 1", "1.3 suits methane")

    def with_params(self, **changes: float) -> "GasValveFlow":
        """Return a copy with other parameters; unit and check valve belong to the wiring.

        Raises ``BlockError`` for those two, an unknown name, or a value that breaks the rules.
        """
        for key in ("molar", "check"):
            rule = key not in changes
            require(rule, self.name, key, changes.get(key), "unit and flap are wired", "make another GasValveFlow")
        return super().with_params(**changes)

    @classmethod
    def passing(cls, F: float, p_up: float, p_down: float, MV: float = 1.0, **options: Any) -> "GasValveFlow":
        """Return the valve that passes ``F`` at these pressures [Pa] and the opening ``MV``.

        Raises ``BlockError`` unless F, MV and the drop are positive.

        >>> body = GasValveFlow.passing(2283.7, 29.9e5, 22.1e5, 0.0944)
        >>> round(body.params["Kv"]), round(float(body.output(0.0, [], [29.9e5, 22.1e5, 0.0944])[0]), 1)
        (4178, 2283.7)
        """
        name = str(options.get("name", "body"))
        require(0.0 < F < math.inf, name, "F", F, "a duty is a positive flow", "give mol/s or kg/s")
        require(0.0 < MV < math.inf, name, "MV", MV, "a valve is sized open", "give the opening at that flow")
        rule = f"it must lie between 0 and p_up = {p_up!r}"
        require(0.0 <= p_down < p_up < math.inf, name, "p_down", p_down, rule, "give absolute pressures in Pa")
        one = cls(1.0, **options)
        return one.with_params(Kv=F / gas_flow(p_up, p_down, MV, one.p))

    def incompressible(self, p_up: float) -> float:
        """Return the C_v of ControlValveFlow that agrees with this valve at small drops below ``p_up`` [Pa]."""
        W = self.params["W"]
        density = p_up * W / (self.params["Z"] * R * self.params["T"])
        return C_v_from_Kv(self.params["Kv"], density, W if self.params["molar"] else None)
