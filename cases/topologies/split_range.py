"""One pressure controller with two valves: inert gas below half of OP, a vent above; the vent sticks.

    OP  0 ......... 0.5 ......... 1
        inert open  both  vent open            OP_inert = 1 - 2 OP, OP_vent = 2 OP - 1, each kept within 0 ... 1
                    shut

A vessel is filled for half an hour and emptied for half an hour.  While it fills, gas must leave through the sticky
vent, and the pressure cycles; while it empties, the inert valve is in charge, and the pressure is calm: judged over a
whole day the loop looks half sticky.  And the vent does not shut: without seat force its stem stays F_c/k open, and
inert gas is lost all the time.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.case import Case, Number

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram

F_S, F_C, SPRING = 2250.0, 1250.0, 52500.0  # N, N, N per travel: high stiction, thesis table A.1
P_SP, P_ATM, P_SUPPLY = 2.0e5, 1.013e5, 6.0e5  # Pa
C_V_VENT, C_V_INERT = 1.0e-3, 4.0e-4  # kg/s/sqrt(Pa)
R = 30.0  # rangeability of both trims [-]
HALF = 1800.0  # s, filling and emptying


def split_range(F_s: float = F_S) -> "Diagram":
    """Return the vessel under split-range control; ``F_s`` of the vent [N].

    >>> loop = split_range()
    >>> loop["vent"].input_labels, loop["inert"].input_labels
    (['OP_vent'], ['OP_inert'])
    """
    from stickslip.blocks import (
        PI,
        Characteristic,
        Constant,
        ControlValveFlow,
        Gain,
        IdealValve,
        Plenum,
        Saturation,
        Square,
    )
    from stickslip.blocks import StickSlip as Sticky
    from stickslip.diagram import wire

    return wire(
        [
            Constant("SP", P_SP, unit="Pa"),
            Constant("p_atm", P_ATM, unit="Pa"),
            Constant("p_supply", P_SUPPLY, unit="Pa"),
            Square("m_pump", amplitude=0.04, period=2.0 * HALF),  # gas displaced by liquid pumped in (+) or out (-)
            PI(2e-5, 300.0, action="direct", start_op=0.5, name="PC", inputs=["SP", "p"], outputs="OP"),
            Gain("call_vent", "OP", 2.0, offset=-1.0),
            Gain("call_inert", "OP", -2.0, offset=1.0),
            Saturation("OP_vent", "call_vent", 0.0, 1.0),
            Saturation("OP_inert", "call_inert", 0.0, 1.0),
            Sticky(F_s=F_s, F_c=F_C, k=SPRING, name="vent", inputs="OP_vent", outputs="MV_vent"),
            IdealValve(name="inert", inputs="OP_inert", outputs="MV_inert"),
            Characteristic(R, name="vent_trim", inputs="MV_vent", outputs="open_vent"),
            Characteristic(R, name="inert_trim", inputs="MV_inert", outputs="open_inert"),
            ControlValveFlow(
                C_V_VENT, unit="kg/s", name="vent_body", inputs=["p", "p_atm", "open_vent"], outputs="m_vent"
            ),
            ControlValveFlow(
                C_V_INERT, unit="kg/s", name="inert_body", inputs=["p_supply", "p", "open_inert"], outputs="m_inert"
            ),
            Plenum(10.0, start=P_SP, inflows=["m_inert", "m_pump"], outflows=["m_vent"], c_01=298.0, name="vessel",
                   outputs="p"),  # isothermal nitrogen at 300 K
        ],
        name="split_range",
    )  # fmt: skip


def numbers() -> Sequence[Number]:
    """Return what the static map and the stem law foretell, and what the simulation gives."""
    run = CASE.run()
    log = run.log
    filling = log["m_pump"] > 0.0
    emptying = ~filling & (log.t % HALF > 0.5 * HALF)  # the second half, when the stems have come to rest
    both_open = np.minimum(log["OP_vent"], log["OP_inert"])
    slips = [e.t for e in run.events if e.block == "vent" and e.before == "stuck"]
    late = [t for t in slips if t % HALF > 600.0]
    turns = np.interp(late[:4], log.t, log["OP_vent"])
    stem = F_C / SPRING
    trim = (R**stem - 1.0) / (R - 1.0)
    lost = 3600.0 * C_V_VENT * trim * float(np.sqrt(P_SP - P_ATM))
    return [
        Number("most of both valves open at once", "% of travel", None, 0.0, 100.0 * float(both_open.max()), None, "",
               "the split map: only one of OP_vent and OP_inert is above zero"),
        Number("OP_vent between slips", "% of travel", None, 100.0 * (F_S + F_C) / SPRING,
               100.0 * float(np.abs(np.diff(turns)).mean()), None, "", "S, in the vent's own range: half of it in OP"),
        Number("slips while filling", "1/h", None, None, len([t for t in slips if t % (2.0 * HALF) < HALF])
               / float(filling.sum() / len(log) * log.duration / 3600.0), None, "", "the vent is in charge"),
        Number("vent moves while emptying", "% of travel", None, 0.0, 100.0 * float(np.ptp(log["MV_vent"][emptying])),
               None, "", "out of its range a valve stands still, sticky or not"),
        Number("vent open when told to shut", "% of travel", None, 100.0 * stem,
               100.0 * float(np.median(log["MV_vent"][emptying])), None, "", "F_c/k: friction holds what the spring "
               "leaves"),
        Number("inert gas lost through it", "kg/h", None, lost, 3600.0 * float(np.median(log["m_vent"][emptying])),
               None, "", "C_v (R^(F_c/k) - 1)/(R - 1) sqrt(p - p_atm)"),
    ]  # fmt: skip


CASE = Case(
    "split_range", "One pressure controller, an inert valve and a sticky vent",
    "The pressure cycles only while the sticky vent is in charge, and the vent never shuts quite.",
    split_range, 4.0 * HALF, 1.0, numbers,
    ("SP", "p", "m_pump", "m_inert", "m_vent", "OP", "OP_vent", "MV_vent", "OP_inert", "MV_inert"),
)  # fmt: skip
