"""Flow through a control valve body: turbulent, incompressible law, signed.

    F = C_v x root(p_up - p_down)                  root(d) = d / (d^2 + p_lam^2)^(1/4)     (thesis eq. 4.2)

in   p_up, p_down  pressures [Pa]      MV  stem position [fraction of travel], below 0 it passes nothing
out  F  flow in the unit of C_v times sqrt(Pa): mol/s unless ``unit`` says otherwise
C_v    flow per root of pressure drop at full travel [unit/sqrt(Pa)]
p_lam  drop below which the flow becomes laminar [Pa]; the root is |d|^(1/2) sgn(d) for p_lam = 0

root() is smooth at d = 0, where the bare square root has an infinite slope; at 1 bar it differs by 2.5e-7 of the
flow.  With ``check_valve`` nothing flows backwards; opening and shutting are located and logged.
A recycle valve is this with unit="kg/s", from discharge to suction of its compressor.
Source: thesis eqs. 4.1 and 4.2 (printed with the condition on the pressures reversed), sizes in table A.2.  The
thesis uses the incompressible law for gas too; docs/evidence/measured.md says how far that is from IEC 60534.
Valid for any sign of the drop; not for: choked flow, flashing, a characteristic (put a Characteristic before MV).
See also: gas_valve_flow (gas that expands and chokes), sizing (Kv and Cv), check_valve, flow_resistance, stick_slip
and its siblings (OP to MV).
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.sizing import C_v_from_Kv

OPEN, SHUT = 0.0, 1.0
BAND = 1e-8  # of the pressures: a drop that rounding makes and unmakes must not count as opening and shutting


def root(drop: float, p_lam: float) -> float:
    """Return the signed square root of a pressure drop, laminar below ``p_lam`` [Pa].

    >>> round(root(1e6, 100.0), 6), root(-1e6, 100.0) == -root(1e6, 100.0), root(0.0, 100.0)
    (999.999997, True, 0.0)
    """
    square = drop * drop + p_lam * p_lam
    return drop / math.sqrt(math.sqrt(square)) if square > 0.0 else 0.0


def drop_for(flow: float, p_lam: float) -> float:
    """Return the pressure drop [Pa] whose ``root`` is ``flow`` [sqrt(Pa)], exactly.

    >>> round(drop_for(root(2e4, 100.0), 100.0), 6)
    20000.0
    """
    square = flow * flow
    return math.copysign(math.sqrt(0.5 * square * (square + math.hypot(square, 2.0 * p_lam))), flow)


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] * max(u[2], 0.0) * root(u[0] - u[1], p[1])


def _check_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] * max(u[2], 0.0) * root(max(u[0] - u[1], 0.0), p[1])


def _check_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    drop = u[0] - u[1]
    g[0] = (-drop if d[0] == 0.0 else drop) - BAND * (abs(u[0]) + abs(u[1]))


def _check_jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    d[0] = 1.0 - d[0]


class ControlValveFlow(Block):
    """A valve body with flow coefficient ``C_v`` [``unit``/sqrt(Pa)].

    Raises ``BlockError`` unless C_v > 0 and p_lam >= 0.

    >>> body = ControlValveFlow(6.1)
    >>> [round(float(body.output(0.0, [], [30e5, p_down, 0.6985])[0]), 1) for p_down in (12e5, 30e5, 48e5)]
    [5716.5, 0.0, -5716.5]
    >>> float(ControlValveFlow(6.1, check_valve=True).output(0.0, [], [30e5, 48e5, 0.5])[0])
    0.0
    """

    role = Role.PROCESS
    ports_in = (Port("p_up", "Pa"), Port("p_down", "Pa"), Port("MV"))
    ports_out = (Port("F", "mol/s"),)

    def __init__(
        self,
        C_v: float,
        *,
        p_lam: float = 100.0,
        check_valve: bool = False,
        unit: str = "mol/s",
        name: str = "body",
        **labels: Any,
    ) -> None:
        if check_valve:
            self.kernels = Kernels(out=_check_out, zc=_check_zc, jump=_check_jump, n_events=1)
            self.modes = {"open": OPEN, "shut": SHUT}
        else:
            self.kernels = Kernels(out=_out)
        super().__init__(
            name=name,
            params={"C_v": C_v, "p_lam": p_lam},
            memory={"mode": OPEN} if check_valve else None,
            units={"F": unit},
            **labels,
        )

    @classmethod
    def from_Kv(cls, Kv: float, density: float, molar_mass: float | None = None, **options: Any) -> "ControlValveFlow":
        """Return the valve of a data sheet: ``Kv`` [m3/h], for a fluid of ``density`` [kg/m3] before the valve.

        With ``molar_mass`` [kg/mol] the flow is in mol/s, without it in kg/s.  Of a Cv take ``sizing.Kv_from_Cv``.
        Raises ``BlockError`` unless all are positive, or if ``unit`` says otherwise.

        >>> water = ControlValveFlow.from_Kv(36.0, 999.1)
        >>> round(float(water.output(0.0, [], [2e5, 1e5, 1.0])[0]), 3), water.units["F"]  # 36 m3/h are 9.991 kg/s
        (9.991, 'kg/s')
        """
        unit = "kg/s" if molar_mass is None else "mol/s"
        if options.setdefault("unit", unit) != unit:
            raise BlockError(
                f"{options.get('name', 'body')}: unit = {options['unit']!r}, but this size is in {unit}; "
                "give molar_mass for mol/s, leave it out for kg/s"
            )
        return cls(C_v_from_Kv(Kv, density, molar_mass), **options)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless C_v > 0 and p_lam >= 0."""
        C_v, p_lam = float(params["C_v"]), float(params["p_lam"])
        require(
            0.0 < C_v < math.inf, name, "C_v", C_v, "a flow coefficient is positive", "give F/sqrt(drop) at full travel"
        )
        require(0.0 <= p_lam < math.inf, name, "p_lam", p_lam, "a pressure drop is not negative", "give Pa, or 0")
