"""A compressor of the user's own map: from a table of curves to surge, and to the anti-surge control that prevents it.

Curves on a data sheet are numbers, so the map is data: ``TabulatedMap.read("head.csv", "efficiency.csv")`` or, as
here, ``from_curves``.  The point it is scaled to becomes the compressor's m_d, p_ref, w_d and h_d.

The feed falls to half within ten seconds.  Without anti-surge control the flow passes the surge line, breaks down and
reverses again and again; with it the recycle valve opens, and the flow comes to rest at ``margin`` times surge.
The curves were made up; they are no machine's.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.case import Case, Number

if TYPE_CHECKING:
    from stickslip.blocks import TabulatedMap
    from stickslip.diagram.diagram import Diagram
    from stickslip.plant import Production

HEAD = {  # speed [rpm]: inlet flow [m3/h], head [kJ/kg]
    8000.0: ([4000.0, 4800.0, 5600.0, 6400.0, 7000.0], [77.0, 75.5, 71.5, 63.0, 52.0]),
    9000.0: ([4600.0, 5500.0, 6400.0, 7200.0, 7900.0], [98.0, 96.0, 91.0, 81.0, 66.0]),
    10000.0: ([5300.0, 6200.0, 7100.0, 8000.0, 8800.0], [122.0, 120.0, 114.0, 103.0, 83.0]),
}
EFFICIENCY = {  # speed [rpm]: inlet flow [m3/h], efficiency [-]
    8000.0: ([4000.0, 5500.0, 7000.0], [0.76, 0.81, 0.70]),
    9000.0: ([4600.0, 6200.0, 7900.0], [0.77, 0.82, 0.70]),
    10000.0: ([5300.0, 7000.0, 8800.0], [0.77, 0.82, 0.69]),
}
C_01, GAMMA = 453.43, 1.3067  # methane at 30 degrees Celsius: speed of sound [m/s], heat capacity ratio
P_IN, DROP = 30e5, 3e5  # Pa: suction at rest, drop over the discharge pipe at rest
MARGIN, C_V = 1.15, 0.020  # anti-surge set point over surge flow; recycle valve [kg/s/sqrt(Pa)]


def own_map() -> "TabulatedMap":
    """Return the map, scaled to 7500 m3/h at 10 000 rpm.

    >>> [round(value, 1) for value in own_map().point]
    [10000.0, 7500.0, 110.0]
    """
    from stickslip.blocks import TabulatedMap

    return TabulatedMap.from_curves(HEAD, EFFICIENCY, speed=10000.0, flow=7500.0)


def station(guarded: bool) -> "Diagram":
    """Return the compressor between two plena; inputs open: ``m_in`` [kg/s], ``p_C1`` [Pa], ``w`` [rad/s].

    >>> station(guarded=True).open_inputs
    ('m_in', 'p_C1', 'w')
    """
    from stickslip.blocks import AntiSurge, Compressor, Constant, ControlValveFlow, FlowResistance, IdealValve, Plenum
    from stickslip.diagram import wire

    shape = own_map()
    m, p_out, w, h_d = at_rest(shape)
    watch = AntiSurge(0.5, 3.0, margin=MARGIN, name="ASC", inputs=["q", "q_s"], outputs="OP")
    return wire(
        [
            Plenum(2.0, start=P_IN, inflows=["m_in", "m_rv"], outflows=["m"], name="suction", outputs="p_in"),
            Compressor(shape, start=m, m_d=m, p_ref=P_IN, h_d=h_d, w_d=w),  # p_in, p_out, w -> m, tau, q, q_s
            Plenum(2.0, start=p_out, inflows=["m"], outflows=["m_rv", "m_out"], name="discharge", outputs="p_out"),
            FlowResistance(m / math.sqrt(DROP), name="pipe", inputs=["p_out", "p_C1"], outputs="m_out"),
            watch if guarded else Constant("OP", 0.0, name="ASC"),
            IdealValve(),  # OP -> MV
            ControlValveFlow(C_V, unit="kg/s", name="recycle", inputs=["p_out", "p_in", "MV"], outputs="m_rv"),
        ],
        inputs=["m_in", "p_C1", "w"],
        name="guarded" if guarded else "bare",
    )


def at_rest(shape: "TabulatedMap") -> tuple[float, float, float, float]:
    """Return flow [kg/s], discharge pressure [Pa], speed [rad/s] and head [J/kg] at the point of the map."""
    from stickslip.blocks.compressor_map import pressure_ratio

    rpm, volume, head = shape.point
    density = GAMMA * P_IN / C_01**2
    return volume / 3600.0 * density, P_IN * pressure_ratio(1e3 * head, C_01, GAMMA), rpm * math.pi / 30.0, 1e3 * head


def both() -> "Diagram":
    """Return the machine with and without anti-surge control, fed alike; the feed falls to half from 10 to 20 s."""
    from stickslip.blocks import Constant, Ramp
    from stickslip.diagram import wire

    m, p_out, w, _ = at_rest(own_map())
    trip = Ramp("m_in", -0.05 * m, start=10.0, end=20.0, before=m, unit="kg/s")
    around = [Constant("p_C1", p_out - DROP, unit="Pa"), Constant("w", w, unit="rad/s")]
    return wire([trip, *around, station(guarded=True), station(guarded=False)], name="own_map")


def numbers() -> Sequence[Number]:
    """Return the rest that anti-surge control must reach, and the marks of surge without it."""
    from stickslip.diagram import simulate

    run = simulate(both(), 240.0, every=0.01, method="stiff")
    log, shape = run.log, own_map()
    end = {s: float(log[f"guarded/{s}"][-1]) for s in ("q", "m", "m_rv", "MV", "p_in", "p_out")}
    m, p_out, _, _ = at_rest(shape)
    opening = (end["m"] - 0.5 * m) / (C_V * math.sqrt(end["p_out"] - end["p_in"]))
    late = log.t > 60.0
    bare, t = log["bare/m"][late], log.t[late]
    forward = t[1:][(bare[1:] > 0.0) & (bare[:-1] <= 0.0)]
    return [
        Number("least flow over surge flow, with", "-", None, None,
               float((log["guarded/q"] / log["guarded/q_s"]).min()), None, "", "above 1: it never surges"),
        Number("flow at rest over surge flow, with", "-", None, MARGIN, end["q"] / shape.surge(), None, "",
               "integral action holds the set point"),
        Number("recycle valve at rest, with", "% of travel", None, 100.0 * opening, 100.0 * end["MV"], None, "",
               "what the compressor passes beyond the feed, over C_v sqrt(p_out - p_in)"),
        Number("discharge pressure at rest, with", "bar", None, (p_out - 0.75 * DROP) / 1e5, end["p_out"] / 1e5, None,
               "", "half the flow takes a quarter of the drop over the pipe"),
        Number("least flow, without", "kg/s", None, None, float(bare.min()), None, "", "below zero: deep surge"),
        Number("surge cycles, without", "1/s", None, None, 1.0 / float(np.mean(np.diff(forward))), None, "",
               "between the feed's steady state, which is unstable there, and reverse flow"),
    ]  # fmt: skip


# --- the same map in the production plant ------------------------------------------------------------------


def plant_with_own_map(shape: "TabulatedMap | None" = None) -> "Production":
    """Return set B with C2 on another map, sized so that the map's point is C2's duty at the design feed.

    >>> from stickslip.plant import steady_state
    >>> rest = steady_state(plant_with_own_map())
    >>> round(rest.C2.q, 6), round(rest.C2.m, 2), round(rest.power / 1e6, 1)
    (1.0, 47.05, 14.3)
    """
    from stickslip.plant import SET_B, steady_state

    duty = steady_state(SET_B).C2
    C2 = replace(SET_B.C2, map=own_map() if shape is None else shape, m_d=duty.m, p_ref=duty.p_in)
    return replace(SET_B, name="B, own map", C2=C2)


def plant() -> "Diagram":
    """Return the production plant with C2 on the map, high stiction, kicked."""
    from stickslip.plant import kicked, production_plant

    return kicked(production_plant(plant_with_own_map(), F_s="high", name="plant_own_map"))


def plant_numbers() -> Sequence[Number]:
    """Return where the plant with the user's map rests, and how far it drifts from there."""
    from stickslip.blocks.compressor_map import head_for
    from stickslip.diagram import simulate
    from stickslip.plant import production_plant, steady_state

    own = plant_with_own_map()
    rest = steady_state(own)
    log = simulate(production_plant(own, F_s="high"), 2000.0, every=10.0, method="stiff").log
    drift = max(float(np.abs(log[s] / log[s][0] - 1.0).max()) for s in ("p_1", "p_out2", "q_2", "w", "tau_2"))
    efficiency = own.C2.map.psi(1.0) / own.C2.map.work(1.0)
    C2 = rest.C2.m * head_for(rest.C2.p_out / rest.C2.p_in, own.fluids.c_01, own.fluids.gamma) / efficiency
    C3 = rest.C3.m * rest.design.h_d3 / 0.78
    return [
        Number("drift from rest in 2000 s", "-", None, 0.0, drift, None, "", "relative, worst of five signals"),
        Number("corrected flow of C2", "-", None, 1.0, float(log["q_2"][-1]), None, "", "sized to its duty"),
        Number("power", "MW", None, (C2 + C3) / 1e6, rest.power / 1e6, None, "",
               "flow times head over efficiency, both compressors, at the design speed"),
    ]  # fmt: skip


CASE = Case(
    "own_map", "A compressor of the user's own map, with and without anti-surge control",
    "The feed falls to half; without anti-surge control the machine surges, with it the recycle valve opens.",
    both, 60.0, 0.01, numbers, ("m_in", "guarded/m", "bare/m", "guarded/p_out", "bare/p_out", "guarded/MV"),
)  # fmt: skip
PLANT = Case(
    "plant_own_map", "Production plant, compressor 2 of the user's own map",
    "Set B with C2's cubic replaced by tabulated curves sized to its duty; VLCS1 and VPCS1 stick, started kicked.",
    plant, 2000.0, 0.1, plant_numbers, ("p_1", "V_1", "OP_VPCS1", "MV_VPCS1", "p_out2", "q_2", "w"),
)  # fmt: skip
