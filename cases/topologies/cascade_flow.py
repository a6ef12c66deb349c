"""A level controlled through a sticky valve, directly and through a flow loop: where does the limit cycle go?

    direct    LC -> valve -> flow -> level                  cascade    LC -> FC -> valve -> flow -> level

Between two slips OP must travel S.  Directly, the level drives it there: S = K_L (level swing).  In the cascade the
integral of the flow error does, and the level, which integrates the same error, swings by far less:

    direct    level swing = S/K_L                           cascade    level swing = S/(K_F (K_L + T_v/T_F))

K_L, K_F gains of level and flow controller, T_F integral time of the flow controller, T_v hold-up of the vessel [s]
(vessel 1/(T_v s), flow 1 x MV; the slow integral action of LC and the lag of the flow are neglected).
The cascade does not cure the valve: the flow jumps by J as before, and the valve slips eight times as often.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.case import Case, Number

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram

K_L, T_L = 4.0, 400.0  # level controller: gain [-], integral time [s]
K_F, T_F = 0.5, 3.0  # flow controller; T_F equals the lag of the flow
T_V, LAG = 200.0, 3.0  # s: hold-up of the vessel, lag of the flow
F_S, F_C, SPRING = 2250.0, 1250.0, 52500.0  # N, N, N per travel: high stiction, thesis table A.1
SETTLED = 4800.0  # s, after which the numbers are taken


def direct_loop() -> "Diagram":
    """Return the level loop without a flow loop; inputs open: ``SP_L`` and ``F_in`` [fractions].

    >>> direct_loop().signals
    ('OP', 'MV', 'F', 'net', 'L')
    """
    from stickslip.blocks import PI, FirstOrder, Integrator, StickSlip, Sum
    from stickslip.diagram import wire

    return wire(
        [
            PI(K_L, T_L, action="direct", start_op=0.5, name="LC", inputs=["SP_L", "L"], outputs="OP"),
            StickSlip(F_s=F_S, F_c=F_C, k=SPRING, start=0.5),
            FirstOrder(K=1.0, tau=LAG, start=0.5, name="pipe", inputs="MV", outputs="F"),
            Sum("net", {"F_in": 1.0, "F": -1.0}),
            Integrator(K=1.0, T=T_V, start=0.5, name="vessel", inputs="net", outputs="L", units={"PV": "1"}),
        ],
        inputs=["SP_L", "F_in"],
        name="direct",
    )


def cascade_loop() -> "Diagram":
    """Return the same with a flow loop: LC now moves the set point of FC, and FC the valve.

    >>> cascade_loop().signals
    ('SP_F', 'OP', 'MV', 'F', 'net', 'L')
    """
    from stickslip.blocks import PI
    from stickslip.diagram import wire

    direct = direct_loop()
    level = direct["LC"].relabelled("LC", ["SP_L", "L"], ["SP_F"])
    flow = PI(K_F, T_F, start_op=0.5, name="FC", inputs=["SP_F", "F"], outputs="OP")
    return wire([level, flow, *direct.blocks[1:]], inputs=["SP_L", "F_in"], name="cascade")


def both() -> "Diagram":
    """Return both loops side by side, fed alike: the inflow rises from 0.5 to 0.55 after a minute."""
    from stickslip.blocks import Constant, Step
    from stickslip.diagram import wire

    feed = Step("F_in", after=0.55, before=0.5, at=60.0)
    return wire([Constant("SP_L", 0.5), feed, direct_loop(), cascade_loop()], name="cascade_flow")


def numbers() -> Sequence[Number]:
    """Return what theory foretells of both cycles, and what the simulation gives."""
    run = CASE.run()
    late = run.log.t > SETTLED
    S, J = (F_S + F_C) / SPRING, (F_S - F_C) / SPRING

    def swing(signal: str) -> float:
        return 100.0 * float(np.ptp(run.log[signal][late]))

    def slips(loop: str) -> float:
        times = [e.t for e in run.events if e.block == f"{loop}/valve" and e.before == "stuck" and e.t > SETTLED]
        return 3600.0 / float(np.mean(np.diff(times)))

    calm = 100.0 * S / (K_F * (K_L + T_V / T_F))
    return [
        Number("level swing, direct", "% of span", None, 100.0 * S / K_L, swing("direct/L"), None, "",
               "S/K_L: the level itself must carry OP through the stick band"),
        Number("level swing, cascade", "% of span", None, calm, swing("cascade/L"), None, "",
               "S/(K_F (K_L + T_v/T_F)): the integral of the flow error carries OP there"),
        Number("flow swing, direct", "% of span", None, 100.0 * J, swing("direct/F"), None, "",
               "J, and what OP moves while the stem slips"),
        Number("flow swing, cascade", "% of span", None, 100.0 * J, swing("cascade/F"), None, "",
               "J again: the cascade moves the cycle out of the level, not out of the plant"),
        Number("slips, direct", "1/h", None, None, slips("direct"), None, "", "both directions"),
        Number("slips, cascade", "1/h", None, None, slips("cascade"), None, "", "the price: the packing wears faster"),
    ]  # fmt: skip


CASE = Case(
    "cascade_flow", "Level through a sticky valve, with and without a flow loop",
    "The flow loop takes the limit cycle out of the level, and makes the valve slip eight times as often.",
    both, 7200.0, 1.0, numbers,
    ("direct/L", "cascade/L", "direct/F", "cascade/F", "direct/OP", "direct/MV", "cascade/OP", "cascade/MV"),
)  # fmt: skip
