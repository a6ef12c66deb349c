"""Relay auto-tuner: a relay in place of the controller finds ultimate gain and period, and from them PI settings.

    e     = action (SP - PV)                                          read every dt
    OP    = bias + amplitude once e > hysteresis,   bias - amplitude once e < -hysteresis
    K_u   = 4 amplitude/(pi sqrt(a^2 - hysteresis^2)),   a = half of the peak-to-peak value of e     (1)
    T_u   = time from one rise of OP to the next
    K_p   = gain_factor K_u,   T_i = time_factor T_u                                                 (2)

in   SP, PV          set point, process variable [unit of PV]
out  OP              controller output [fraction of span]; bias when the test is over
     K_u, T_u        ultimate gain [unit of OP per unit of PV] and period [s]; 0 until the test is over
     K_p, T_i        settings of a PI controller in ideal form, same units; 0 until then
amplitude, bias   of OP [fraction of span], amplitude > 0      hysteresis  [unit of PV], >= 0; more than the noise
cycles            over which K_u and T_u are averaged, after one to settle [-], >= 1
dt, offset        scan time and first scan [s]                 action  +1 reverse (gain of the process > 0), -1 direct
rule              "Tyreus-Luyben" (gentle): K_u/3.2, 2.2 T_u;  "Ziegler-Nichols": 0.45 K_u, T_u/1.2

Eq. 1 is the describing function of the relay: it leaves out harmonics, so K_u errs by some 5 to 20 % for processes with
much dead time.  The bias should hold PV near SP, else the halves of a cycle are unequal and K_u too small.  A
process of first order without dead time oscillates only by the hysteresis and the scan; a sticky valve adds its own
dead band to the hysteresis, which the settings do not know.
Source: Astrom and Hagglund, Automatica 20(5), 1984, pp. 645-651; rules: Ziegler and Nichols, Trans. ASME 64, 1942, pp.
759-768; Tyreus and Luyben, Ind. Eng. Chem. Res. 31, 1992, pp. 2625-2628.
See also: relay (continuous, located), pi, sampled_pi.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.pi import ACTIONS
from stickslip.blocks.ports import BlockError, Port, nearest, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan, finite, not_negative, positive

RULES = {"Tyreus-Luyben": (1.0 / 3.2, 2.2), "Ziegler-Nichols": (0.45, 1.0 / 1.2)}

# p = amplitude, bias, hysteresis, cycles, gain_factor, time_factor, action, dt, offset
# d = relay (+1, -1), last rise [s], highest and lowest e of the cycle, rises seen, sums of a and of periods


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    e = p[6] * (u[0] - u[1])
    wanted = p[3] + 2.0  # rises: the first begins the cycle to settle
    d[2] = max(d[2], e)
    d[3] = min(d[3], e)
    if d[0] > 0.0 and e < -p[2]:
        d[0] = -1.0
    elif d[0] < 0.0 and e > p[2] and d[4] < wanted:
        d[0] = 1.0
        if d[4] >= 2.0:
            d[5] += 0.5 * (d[2] - d[3])
            d[6] += t - d[1]
        d[4] += 1.0
        d[1] = t
        d[2] = e
        d[3] = e
    for i in range(5):
        y[i] = 0.0
    if d[4] < wanted:
        y[0] = p[1] + d[0] * p[0]
    else:
        a = d[5] / p[3]
        y[0] = p[1]
        y[1] = 4.0 * p[0] / (math.pi * math.sqrt(max(a * a - p[2] * p[2], 1e-12 * a * a)))
        y[2] = d[6] / p[3]
        y[3] = p[4] * y[1]
        y[4] = p[5] * y[2]


class RelayTuner(Block):
    """A relay test that ends in PI settings; wire it where the controller will be, and read K_p and T_i from the log.

    Raises ``BlockError`` for an unknown rule or action, amplitude <= 0, hysteresis < 0, cycles < 1 or dt <= 0.

    >>> from stickslip.blocks import FirstOrder, Step
    >>> from stickslip.diagram import simulate, wire
    >>> test = wire([Step("SP", 0.0), RelayTuner(amplitude=0.1, dt=0.1), FirstOrder(2.0, 10.0, theta=2.0, inputs="OP")])
    >>> log = simulate(test, 60.0, every=1.0).log
    >>> float(log["K_u"][-1].round(1)), float(log["T_u"][-1].round(1))
    (3.4, 7.6)
    """

    role = Role.CONTROLLER
    ports_in = (Port("SP"), Port("PV"))
    ports_out = (Port("OP"), Port("K_u"), Port("T_u", "s"), Port("K_p"), Port("T_i", "s"))
    kernels = Kernels(step=_step)
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self,
        amplitude: float,
        *,
        dt: float,
        bias: float = 0.0,
        hysteresis: float = 0.0,
        cycles: int = 3,
        rule: str = "Tyreus-Luyben",
        action: str = "reverse",
        offset: float = 0.0,
        name: str = "tuner",
        **labels: Any,
    ) -> None:
        if rule not in RULES:
            raise BlockError(f"{name}: rule = {rule!r}; {nearest(str(rule), list(RULES))}")
        if action not in ACTIONS:
            raise BlockError(f"{name}: action = {action!r}; {nearest(str(action), list(ACTIONS))}")
        gain, time = RULES[rule]
        test = {"amplitude": amplitude, "bias": bias, "hysteresis": hysteresis, "cycles": cycles}
        settings = {"gain_factor": gain, "time_factor": time, "action": ACTIONS[action]}
        memory = {"relay": -1.0, "rise": 0.0, "highest": 0.0, "lowest": 0.0, "rises": 0.0, "sum_a": 0.0, "sum_T": 0.0}
        super().__init__(
            name=name,
            params=test | settings | {"dt": dt, "offset": offset},
            memory=memory,
            start_output=[bias, 0.0, 0.0, 0.0, 0.0],
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless amplitude, factors, dt > 0, hysteresis >= 0 and cycles is a whole number >= 1."""
        positive(params, name, "amplitude", "gain_factor", "time_factor", remedy="give a positive one")
        not_negative(params, name, "hysteresis")
        finite(params, name, "bias")
        check_scan(params, name)
        cycles, action = float(params["cycles"]), float(params["action"])
        rule = cycles >= 1.0 and cycles == math.floor(cycles) and cycles < math.inf
        require(rule, name, "cycles", cycles, "it is a whole number of cycles", "give 1 or more")
        require(action in (1.0, -1.0), name, "action", action, "it is +1 (reverse) or -1 (direct)", "give one of them")
