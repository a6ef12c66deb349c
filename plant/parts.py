"""The parts of the production plant, each a list of blocks: wire one alone, or all of them together.

    separator      S1 or S2 with level, pressure and safety controller, its two valves, cooler and scrubber
    compressor     C2 or C3 with plena, recycle valve and anti-surge controller
    shaft          the shaft, the cascaded speed control and the turbine that turn it
    boundaries     the world outside: C1, C4, the atmosphere

Signals carry the thesis's tags: ``OP_VPCS1`` what controller PCS11 wants of valve VPCS1, ``MV_VPCS1`` where its stem
stands, ``p_1``, ``V_1``, ``z_1`` of separator 1, ``p_in2``, ``m_2``, ``q_2``, ``tau_2`` of compressor 2, set points
``SP_LCS11``.
Blocks: the stem is called ``VPCS1``, its body ``VPCS1_body``; plena ``C2_inlet`` and ``C2_outlet``.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.blocks.anti_surge import AntiSurge
from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.compressor import Compressor
from stickslip.blocks.control_valve_flow import ControlValveFlow
from stickslip.blocks.flare import Flare
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.gas_turbine import GasTurbine
from stickslip.blocks.ideal_valve import IdealValve
from stickslip.blocks.pi import PI
from stickslip.blocks.plenum import Plenum
from stickslip.blocks.ports import nearest, number
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.scrubber import Scrubber
from stickslip.blocks.separator import Separator
from stickslip.blocks.shaft import Shaft
from stickslip.blocks.sources import Constant
from stickslip.blocks.stick_slip import StickSlip
from stickslip.diagram.wiring import WiringError
from stickslip.plant.parameters import STICTION, Production
from stickslip.plant.rest import InfeasibleFeed, Rest

VALVES = ("VLCS1", "VPCS1", "VLCS2", "VPCS2", "VRVC2", "VRVC3")
STEMS = ("quasi_static", "full")
TURBINES = ("direct", "lag")
Friction = Mapping[str, float]


def friction(
    plant: Production, sticky: Sequence[str], F_s: float | str | Mapping[str, float | str]
) -> dict[str, float]:
    """Return the static friction [N] of each sticky valve; ``F_s`` is a number, a name of STICTION, or one per valve.

    Raises ``WiringError`` for an unknown valve or name, and for a friction below the Coulomb friction.

    >>> from stickslip.plant.parameters import SET_B
    >>> friction(SET_B, ["VPCS1"], "high")
    {'VPCS1': 2250.0}
    """
    found = {}
    sticky = (sticky,) if isinstance(sticky, str) else tuple(sticky)
    given = F_s if isinstance(F_s, Mapping) else dict.fromkeys(sticky, F_s)
    for valve in [*sticky, *given]:
        if valve not in VALVES:
            raise WiringError(f"no valve '{valve}' can stick; {nearest(valve, VALVES)}")
        if valve not in sticky:
            raise WiringError(f"F_s gives '{valve}' {given[valve]!r}, but sticky does not name it; add it there")
    for valve in sticky:
        size = given.get(valve)
        if isinstance(size, str) and size not in STICTION:
            raise WiringError(f"no stiction is called '{size}'; {nearest(size, list(STICTION))}; or give F_s in N")
        if size is None:
            raise WiringError(f"valve '{valve}' is sticky, but F_s has no value for it; add '{valve}' to F_s")
        found[valve] = STICTION[size] if isinstance(size, str) else number(valve, "F_s", size)
        if not plant.stem.F_c <= found[valve] < math.inf:
            raise WiringError(
                f"{valve}: F_s = {found[valve]:g} N, but static friction is finite and at least the Coulomb friction, "
                f"F_c = {plant.stem.F_c:g} N; raise F_s, or lower stem.F_c"
            )
    return found


def stem(plant: Production, valve: str, opening: float, F_s: Friction, kind: str = "quasi_static") -> Block:
    """Return the stem of a valve, at rest at ``opening``: sticky if ``F_s`` names it, else ideal.

    ``kind``: "quasi_static" (massless, the fast one) or "full" (with mass).
    Raises ``WiringError`` for another kind.
    """
    if kind not in STEMS:
        raise WiringError(f"no stem is called '{kind}'; {nearest(kind, STEMS)}")
    labels: dict[str, Any] = {"name": valve, "inputs": f"OP_{valve}", "outputs": f"MV_{valve}"}
    if valve not in F_s:
        return IdealValve(**labels)
    data = plant.stem
    if kind == "full":
        return StickSlip(F_s[valve], data.F_c, k=data.k, M=data.M, F_v=data.F_v, start=opening, **labels)
    return QuasiStaticStem.from_friction(F_s[valve] / data.k, data.F_c / data.k, start=opening, **labels)


def separator(plant: Production, rest: Rest, number: int, F_s: Friction, kind: str = "quasi_static") -> list[Block]:
    """Return separator 1 or 2 with its controllers and valves.

    Needs the signals ``F_in``, ``Z_I`` (1) or ``F_L1``, ``z_1`` (2), ``p_2`` (1) or ``p_atm`` (2), and the suction
    pressure ``p_in2`` (1) or ``p_in3`` (2); gives ``p_1``, ``V_1``, ``z_1``, ``F_L1``, ``F_G1``, ``m_G1`` and so on.
    Raises ``WiringError`` for another number.

    >>> from stickslip.plant import SET_E, steady_state
    >>> separator(SET_E, steady_state(SET_E), 3, {})
    Traceback (most recent call last):
    ...
    stickslip.diagram.wiring.WiringError: separator: number = 3, but the plant has separators 1 and 2; give one of them
    """
    _one_of("separator", number, (1, 2))
    i, first = number, number == 1
    data, at = (plant.S1, rest.S1) if first else (plant.S2, rest.S2)
    fluids = plant.fluids
    suction, oil_to = ("p_in2", "p_2") if first else ("p_in3", "p_atm")
    oil, gas = f"VLCS{i}", f"VPCS{i}"
    oil_open, gas_open = (rest.VLCS1, rest.VPCS1) if first else (rest.VLCS2, rest.VPCS2)
    level = {"SP": "m3", "PV": "m3"}
    pressure = {"SP": "Pa", "PV": "Pa"}
    return [
        Separator(
            data.V_sep, data.C_4, p_metV=fluids.p_metV, T_sep=fluids.T_sep, R=fluids.R,
            W_oil=fluids.W_oil, rho_oil=fluids.rho_oil, W_met=fluids.W_met, rho_met=fluids.rho_met,
            N_oil=at.N_oil, N_metL=at.N_metL, N_metG=at.N_metG, name=f"S{i}",
            inputs=["F_in" if first else "F_L1", "Z_I" if first else "z_1", f"F_L{i}", f"F_G{i}", f"F_flare{i}"],
            outputs=[f"p_{i}", f"V_{i}", f"z_{i}", f"F_sep{i}"],
        ),
        Constant(f"SP_LCS{i}1", data.V_SP, unit="m3"),
        PI(
            data.K_p_level, data.T_i_level, action="direct", anti_windup="conditional", start_op=oil_open,
            name=f"LCS{i}1", inputs=[f"SP_LCS{i}1", f"V_{i}"], outputs=f"OP_{oil}", units=level,
        ),
        stem(plant, oil, oil_open, F_s, kind),
        ControlValveFlow(
            data.C_v_oil, p_lam=plant.p_lam, name=f"{oil}_body",
            inputs=[f"p_{i}", oil_to, f"MV_{oil}"], outputs=f"F_L{i}",
        ),
        Constant(f"SP_PCS{i}1", data.p_SP, unit="Pa"),
        PI(
            data.K_p_pressure, data.T_i_pressure, action="direct", anti_windup="conditional", start_op=gas_open,
            name=f"PCS{i}1", inputs=[f"SP_PCS{i}1", f"p_{i}"], outputs=f"OP_{gas}", units=pressure,
        ),
        stem(plant, gas, gas_open, F_s, kind),
        Scrubber(plant.dp_scrubber, name=f"scrubber_{i}", inputs=f"p_{i}", outputs=f"p_gas{i}"),
        ControlValveFlow(
            data.C_v_gas, p_lam=plant.p_lam, check_valve=True, name=f"{gas}_body",
            inputs=[f"p_gas{i}", suction, f"MV_{gas}"], outputs=f"F_G{i}",
        ),
        Gain(f"m_G{i}", f"F_G{i}", fluids.W_met, unit="kg/s"),
        Constant(f"SP_PCS{i}2", data.p_safe, unit="Pa"),
        Flare(
            plant.K_p_flare, plant.T_i_flare, name=f"PCS{i}2",
            inputs=[f"SP_PCS{i}2", f"p_{i}"], outputs=f"F_flare{i}",
        ),
    ]  # fmt: skip


def compressor(
    plant: Production, rest: Rest, number: int, F_s: Friction, kind: str = "quasi_static", *,
    anti_surge: bool | str = True,
) -> list[Block]:  # fmt: skip
    """Return compressor 2 or 3 with plena, discharge pipe, recycle valve and anti-surge controller.

    Needs ``w`` and what feeds it: ``m_G1`` and ``m_link`` (2) or ``m_G2`` and ``m_C4`` (3); and the pressure it
    discharges to, ``p_C1`` (2) or ``p_in2`` (3).  Gives ``p_in2``, ``p_out2``, ``m_2``, ``tau_2``, ``q_2``, ``m_out2``
    (of C3: ``m_link``).  Without anti-surge control the recycle valve stays as it is at rest; ``anti_surge="gradient"``
    adds gradient action.
    Raises ``WiringError`` for another number or another ``anti_surge``.
    """
    _one_of("compressor", number, (2, 3))
    if isinstance(anti_surge, str) and anti_surge != "gradient":
        raise WiringError(f"anti_surge = {anti_surge!r}, but it is True, False or 'gradient'")
    i, second = number, number == 2
    data, at = (plant.C2, rest.C2) if second else (plant.C3, rest.C3)
    fluids = plant.fluids
    feeds = ("m_G1", "m_link") if second else ("m_G2", "m_C4")
    away, K, to = ("m_out2", rest.design.K_out, "p_C1") if second else ("m_link", rest.design.K_link, "p_in2")
    h_d = rest.design.h_d2 if second else rest.design.h_d3
    recycle = f"VRVC{i}"
    controller: Block = Constant(f"OP_{recycle}", at.recycle, name=f"ASC{i}")
    if anti_surge:
        controller = AntiSurge(
            data.K_p, data.T_i, margin=plant.margin, boost=plant.boost, start=at.recycle, start_flow=at.q,
            gradient=plant.gradient if anti_surge == "gradient" else 0.0,
            limit=plant.gradient_limit, T_f=plant.T_gradient,
            name=f"ASC{i}", inputs=[f"q_{i}", f"q_s{i}"], outputs=f"OP_{recycle}",
        )  # fmt: skip
    return [
        Plenum(
            plant.V_plenum, start=at.p_in, inflows=(*feeds, f"m_rv{i}"), outflows=(f"m_{i}",), c_01=fluids.c_01,
            name=f"C{i}_inlet", outputs=f"p_in{i}",
        ),
        Compressor(
            data.map, start=at.m, A_c=plant.A_c, L_c=plant.L_c, c_01=fluids.c_01, gamma=fluids.gamma,
            m_d=data.m_d, p_ref=data.p_ref, h_d=h_d, w_d=plant.w_d,
            name=f"C{i}", inputs=[f"p_in{i}", f"p_out{i}", "w"], outputs=[f"m_{i}", f"tau_{i}", f"q_{i}", f"q_s{i}"],
        ),
        Plenum(
            plant.V_plenum, start=at.p_out, inflows=(f"m_{i}",), outflows=(f"m_rv{i}", away), c_01=fluids.c_01,
            name=f"C{i}_outlet", outputs=f"p_out{i}",
        ),
        FlowResistance(K, p_lam=plant.p_lam, name=f"C{i}_pipe", inputs=[f"p_out{i}", to], outputs=away),
        controller,
        stem(plant, recycle, at.recycle, F_s, kind),
        ControlValveFlow(
            data.C_v_recycle, p_lam=plant.p_lam, unit="kg/s", name=f"{recycle}_body",
            inputs=[f"p_out{i}", f"p_in{i}", f"MV_{recycle}"], outputs=f"m_rv{i}",
        ),
    ]  # fmt: skip


def shaft(
    plant: Production, rest: Rest, loads: Sequence[str] = ("tau_2", "tau_3"), turbine: str = "direct"
) -> list[Block]:
    """Return the shaft with its cascaded speed control: SC002 sets the speed from OP_VPCS2, SC001 the torque.

    ``turbine``: "direct", the torque is what SC001 asks, as in the thesis; "lag", a GasTurbine stands between
    (signal ``tau_SP``), with SC001 limited to its rating.  Neither can brake.
    Needs ``OP_VPCS2`` and the load torques; gives ``w``, ``w_SP``, ``tau_d``.
    Raises ``WiringError`` for another turbine, ``InfeasibleFeed`` if its rating is below the loads at rest.
    """
    if turbine not in TURBINES:
        raise WiringError(f"no turbine is called '{turbine}'; {nearest(turbine, TURBINES)}")
    asked, highest, drive = "tau_d", math.inf, []
    if turbine == "lag":
        data = plant.turbine
        asked, highest = "tau_SP", min(data.tau_max, data.P_max / rest.w)
        if rest.tau_d > highest:
            raise InfeasibleFeed(
                f"the loads at rest take {rest.tau_d:.5g} N m at {rest.w:.5g} rad/s ({rest.power / 1e6:.4g} MW), but "
                f"the turbine gives at most {highest:.5g} N m there; lower the feed or raise its tau_max or P_max"
            )
        drive = [GasTurbine(data.T, data.tau_max, data.P_max, start=rest.tau_d, inputs=["tau_SP", "w"])]
    return [
        Constant("SP_VPCS2", plant.OP_VPCS2),
        PI(
            plant.K_p_outer, plant.T_i_outer, low=-math.inf, high=math.inf, action="direct", anti_windup="none",
            start_op=rest.w, name="SC002", inputs=["SP_VPCS2", "OP_VPCS2"], outputs="w_SP", units={"OP": "rad/s"},
        ),
        PI(
            plant.K_p_speed, plant.T_i_speed, low=0.0, high=highest, anti_windup="conditional",
            start_op=rest.tau_d, name="SC001", inputs=["w_SP", "w"], outputs=asked,
            units={"SP": "rad/s", "PV": "rad/s", "OP": "N m"},
        ),
        *drive,
        Shaft(plant.J, start=rest.w, loads=loads, outputs="w"),
    ]  # fmt: skip


def _one_of(part: str, number: int, known: tuple[int, int]) -> None:
    if number not in known:
        raise WiringError(
            f"{part}: number = {number!r}, but the plant has {part}s {known[0]} and {known[1]}; give one of them"
        )


def boundaries(plant: Production) -> list[Block]:
    """Return the signals of the world outside: ``p_C1``, ``m_C4``, ``p_atm``."""
    return [
        Constant("p_C1", plant.p_C1, unit="Pa"),
        Constant("m_C4", plant.m_C4, unit="kg/s"),
        Constant("p_atm", plant.fluids.p_atm, unit="Pa"),
    ]
