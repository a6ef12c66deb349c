"""PID controller in continuous time: filtered derivative, set-point weights, output limits and anti-windup.

    w  = b SP - PV + (T_d/T_f) (c SP - PV - f)      T_f = T_d/N
    v  = K_p action w + z                           action = +1 reverse (OP falls when PV rises), -1 direct
    OP = v limited to low ... high
    dz/dt = K_p action (SP - PV)/T_i                at a limit also (OP - v)/T_t   (back-calculation)
    df/dt = (c SP - PV - f)/T_f

Between the limits this is OP = K_p action (b SP - PV + int (SP - PV) dt/T_i + s T_d/(1 + s T_f) (c SP - PV)).

in   SP  set point   PV  measured process variable (one unit)        out  OP  controller output
K_p  gain [unit of OP / unit of PV]    T_i  integral time [s] (inf: PD)    T_d  derivative time [s]
N    ratio of derivative time to filter time [-]: the derivative's gain at high frequency is K_p N
b, c weights of the set point in the proportional and the derivative part [-]: b below 1 softens a set-point step,
     c = 0 keeps it out of the derivative
T_t  tracking time [s] (0: sqrt(T_i T_d))

Source: Astrom and Hagglund, Advanced PID Control, ISA 2006, sections 3.3 to 3.5.
Valid for a continuous measurement; not for: noise without its own filter (a gain of K_p (1 + N) meets it), a sampled
controller.  Reaching and leaving a limit are located events.
See also: pi (no derivative, three kinds of anti-windup), sampled_pid.
"""

import math
from typing import Any

from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.limited_pi import LimitedController, limited, output_events
from stickslip.blocks.limits import limit_transition
from stickslip.blocks.pi import check_tuning, op_span, start_integral, tuned
from stickslip.blocks.ports import Port
from stickslip.blocks.rules import not_negative, positive

# p = K_p, T_i, low, high, T_t, action (as limited_pi), T_d, N, b, c;  x = z, f


def _weighted(x: Any, u: Any, p: Any) -> float:
    """Return w."""
    w: float = p[8] * u[0] - u[1] + p[7] * (p[9] * u[0] - u[1] - x[1])
    return w


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = limited(_weighted(x, u, p), x[0], p)


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = p[0] * p[5] * (u[0] - u[1]) / p[1]
    dx[1] = (p[9] * u[0] - u[1] - x[1]) * p[7] / p[6]
    if d[0] != 0.0:
        limit = p[3] if d[0] > 0.0 else p[2]
        tracking = p[4] if p[4] > 0.0 else math.sqrt(p[1] * p[6])
        dx[0] += (limit - p[0] * p[5] * _weighted(x, u, p) - x[0]) / tracking


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    output_events(t, x, d, (_weighted(x, u, p), 0.0), p, g)


class PID(LimitedController):
    """PID controller, ideal form, with a filter on the derivative and weights on the set point.

    ``action``: "reverse" or "direct".  Bumpless start: OP starts at ``start_op`` if SP and PV start at ``start_SP`` and
    ``start_PV``; without ``start_op`` the integral part z starts at 0.  The span of OP is low ... high as built.
    Python-control, which knows no events, sees the equations above with the mode read from the present values.

    ``start_SP``, ``start_PV`` [unit of PV]: where SP and PV start.
    Raises ``BlockError`` for K_p, T_i, T_d or N not positive, T_t, b or c negative, low >= high, or a start_op outside
    the limits.

    >>> pid = PID(K_p=0.4, T_i=10.0, T_d=2.5, start_op=0.5)
    >>> [round(float(pid.output(0.0, pid.x0, [SP, 0.0])[0]), 6) for SP in (0.0, 0.1)]  # c = 0: no kick
    [0.5, 0.54]
    >>> from stickslip.diagram import drive
    >>> drive(pid, 20.0, every=10.0, SP=0.1, PV=0.0).log["OP"].round(6).tolist()  # 0.4 x 0.1 (1 + t/10) on top
    [0.54, 0.58, 0.62]
    """

    ports_in = (Port("SP"), Port("PV"))
    one_unit = ("SP", "PV")
    ports_out = (Port("OP"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=limit_transition, n_events=2, linear=True)

    def __init__(
        self,
        K_p: float,
        T_i: float,
        T_d: float,
        *,
        N: float = 10.0,
        b: float = 1.0,
        c: float = 0.0,
        low: float = 0.0,
        high: float = 1.0,
        action: str = "reverse",
        T_t: float = 0.0,
        start_op: float | None = None,
        start_SP: float = 0.0,
        start_PV: float = 0.0,
        name: str = "controller",
        **labels: Any,
    ) -> None:
        params = tuned(K_p, T_i, low, high, T_t, action, "back_calculation", name)
        params |= {"T_d": T_d, "N": N, "b": b, "c": c}
        self.check(params, name)
        start_z = start_integral(params, start_op, b * start_SP - start_PV, name)
        super().__init__(
            name=name,
            params=params,
            states={"z": start_z, "f": c * start_SP - start_PV},
            memory={"mode": 0.0},
            spans=op_span(params, labels.pop("spans", None)),
            **labels,
        )

    @staticmethod
    def check(params: Any, name: str) -> None:
        """Raise ``BlockError`` unless the tuning makes sense."""
        check_tuning(params, name)
        positive(params, name, "T_d", remedy="give seconds, or take PI for none")
        positive(params, name, "N", remedy="8 to 20 is usual")
        not_negative(params, name, "b", "c", rule="a weight must not be negative", remedy="give 0 to 1")

    def unlimited(self, x: Floats, u: Floats) -> float:
        """Return v = K_p w + z."""
        return float(self._p_now[0] * self._p_now[5] * _weighted(x, u, self._p_now) + x[0])
