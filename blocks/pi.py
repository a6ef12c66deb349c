"""PI controller in continuous time, ideal form, with output limits and anti-windup.

    e  = action (SP - PV)              action = +1 reverse (OP falls when PV rises), -1 direct (OP rises)
    v  = K_p e + z                     z integral part [unit of OP]
    OP = v limited to low ... high
    dz/dt = K_p e / T_i                                     anti_windup = "none"
    dz/dt = K_p e / T_i + (OP - v) / T_t                    anti_windup = "back_calculation"
    dz/dt = 0 if v is beyond a limit and e pushes           anti_windup = "conditional"
            further out, else K_p e / T_i

in   SP  set point   PV  measured process variable (one unit)        out  OP  controller output
K_p  gain [unit of OP / unit of PV]   T_i  integral time [s] (inf: P only)   T_t  tracking time [s] (0: as T_i)

Source: Astrom and Hagglund, Advanced PID Control, ISA 2006, sections 3.5 (windup; back-calculation and
conditional integration).  Valid for continuous measurements; not for a loop that computes at scan times, whose
lag matters as soon as the scan time is a noticeable share of T_i (see sampled_pi).

Modes.  Reaching and leaving a limit are located events, so no integration step crosses them; a band of 1e-12
(relative) around the limit keeps rounding from switching modes.  Conditional integration has a right-hand side that
jumps at the limit: where the integrator would drive v out (e > 0) while the falling error draws it back, a plain
switch would chatter.  That sliding along the limit is a mode of its own, "riding high limit": OP stays at the limit
exactly and z = limit - K_p e, Filippov's solution of the equations above.  It ends when K_p (de/dt + e/T_i) points
inwards, or when the error grows again.  While riding, the stored state z is not updated.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.limited_pi import LimitedController, limited, limited_output, output_events, tracking_rate
from stickslip.blocks.limits import BAND, MODES, limit_transition
from stickslip.blocks.ports import BlockError, Labels, Port, nearest, require
from stickslip.blocks.rules import check_limits, finite

NEAR = 1e-9  # an event this close to its limit (relative) was located there; farther away, an input has jumped
RIDING = 3.0  # times +-1: held at the limit exactly
RATE_BAND = 1e-4  # a ride goes on until the error grows faster than this share of e / T_i: rates near 0 are noisy
ACTIONS = {"reverse": 1.0, "direct": -1.0}
ANTI_WINDUP = ("none", "conditional", "back_calculation")

# p = K_p, T_i, low, high, T_t, action (as limited_pi)


def _conditional_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    if d[0] == RIDING:
        y[0] = p[3]
    elif d[0] == -RIDING:
        y[0] = p[2]
    else:
        y[0] = limited(u[0] - u[1], x[0], p)


def _conditional_der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    runs = d[0] == 0.0 or d[0] == 2.0 or d[0] == -2.0
    dx[0] = p[0] * p[5] * (u[0] - u[1]) / p[1] if runs else 0.0


def _conditional_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    e = p[5] * (u[0] - u[1])
    v = p[0] * e + x[0]
    if d[0] == 0.0:
        g[0] = v - p[3] - BAND * (1.0 + abs(p[3]) + abs(p[0] * e))
        g[1] = p[2] - v - BAND * (1.0 + abs(p[2]) + abs(p[0] * e))
    else:
        s = 1.0 if d[0] > 0.0 else -1.0
        limit = p[3] if d[0] > 0.0 else p[2]
        inside = s * (limit - v) - BAND * (1.0 + abs(limit) + abs(p[0] * e))
        if d[0] == s:  # held: back inside, or the error has changed sign
            g[0] = inside
            g[1] = -s * e
        elif d[0] == 2.0 * s:  # integrator runs inwards: back inside, or the error has changed sign
            g[0] = inside
            g[1] = s * e
        else:  # riding: drawn inwards, or the error grows again
            rate = p[5] * (u[2] - u[3])
            g[0] = -s * (rate + e / p[1])
            g[1] = s * rate - RATE_BAND * abs(e) / p[1]


def _conditional_jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    e = p[5] * (u[0] - u[1])
    rate = p[5] * (u[2] - u[3])
    v = p[0] * e + x[0]
    first = k[0] == 0.0
    if d[0] == 0.0:
        s = 1.0 if first else -1.0
        limit = p[3] if first else p[2]
        if s * e <= 0.0:
            d[0] = 2.0 * s
        elif s * rate < 0.0 and s * (v - limit) <= NEAR * (1.0 + abs(limit) + abs(p[0] * e)):
            d[0] = 3.0 * s
        else:
            d[0] = s
    else:
        s = 1.0 if d[0] > 0.0 else -1.0
        limit = p[3] if d[0] > 0.0 else p[2]
        near = s * (limit - v) <= NEAR * (1.0 + abs(limit) + abs(p[0] * e))
        if d[0] == s and not first:
            d[0] = 2.0 * s if s * (v - limit) > NEAR * (1.0 + abs(limit) + abs(p[0] * e)) else 0.0
        elif d[0] == 2.0 * s and not first:
            d[0] = s
        elif d[0] == 3.0 * s:
            x[0] = limit - p[0] * e
            d[0] = 0.0 if first else s
        else:
            d[0] = 3.0 * s if near and s * e > 0.0 and s * (rate + e / p[1]) > 0.0 else 0.0


_PLAIN = Kernels(
    out=limited_output, der=tracking_rate, zc=output_events, jump=limit_transition, n_events=2, linear=True
)
_CONDITIONAL = Kernels(  # a ride along a limit ends with a jump of OP where PV jumps
    out=_conditional_out,
    der=_conditional_der,
    zc=_conditional_zc,
    jump=_conditional_jump,
    n_events=2,
    rates=True,
    rate_modes=(3.0, -3.0),
    jumps=True,
    linear=True,
)


def tuned(
    K_p: float, T_i: float, low: float, high: float, T_t: float, action: str, anti_windup: str, name: str
) -> dict[str, float]:
    """Return the parameters of a PI controller by name, with ``action`` as +1 or -1 and no tracking as T_t = inf.

    Raises ``BlockError`` for an ``action`` or ``anti_windup`` that is not known.
    """
    if action not in ACTIONS:
        raise BlockError(f"{name}: action = {action!r}; {nearest(str(action), list(ACTIONS))}")
    if anti_windup not in ANTI_WINDUP:
        raise BlockError(f"{name}: anti_windup = {anti_windup!r}; {nearest(str(anti_windup), ANTI_WINDUP)}")
    tracking = T_t if anti_windup == "back_calculation" else math.inf
    return {"K_p": K_p, "T_i": T_i, "low": low, "high": high, "T_t": tracking, "action": ACTIONS[action]}


def check_tuning(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless gain, times and limits of a PI controller make sense."""
    finite(params, name, "K_p")
    K_p, T_i, T_t, action = (float(params[key]) for key in ("K_p", "T_i", "T_t", "action"))
    require(K_p > 0.0, name, "K_p", K_p, "it must be positive", "turn the sign round with action='direct'")
    require(T_i > 0.0, name, "T_i", T_i, "it must be positive", "give seconds, or T_i=math.inf for P only")
    require(T_t >= 0.0, name, "T_t", T_t, "it must not be negative", "give seconds, or 0 for T_t = T_i")
    require(action in (1.0, -1.0), name, "action", action, "it is +1 (reverse) or -1 (direct)", "give one of them")
    check_limits(params, name)


def start_integral(params: Mapping[str, float], start_op: float | None, start_error: float, name: str) -> float:
    """Return the integral part with which OP starts at ``start_op`` when SP - PV is ``start_error`` (None: 0).

    Raises ``BlockError`` unless ``start_op`` lies within the limits.
    """
    if start_op is None:
        return 0.0
    low, high = params["low"], params["high"]
    rule = low <= start_op <= high and math.isfinite(start_op)
    require(rule, name, "start_op", start_op, f"OP is limited to {low} ... {high}", "start within the limits")
    return start_op - params["K_p"] * params["action"] * start_error


def op_span(params: Mapping[str, float], spans: Mapping[str, tuple[float, float]] | None) -> dict[str, Any]:
    """Return the spans of the ports: those given, and for OP the limits if they are finite.

    Limits within 0 to 1, or 0 to 100, that leave at least half of it are limits of a share or of per cent.

    >>> op_span({"low": 10.0, "high": 95.0}, None), op_span({"low": 4.0, "high": 20.0}, None)
    ({'OP': (0.0, 100.0)}, {'OP': (4.0, 20.0)})
    """
    low, high = params["low"], params["high"]
    full = next((end for end in (1.0, 100.0) if 0.0 <= low < high <= end and high - low >= 0.5 * end), None)
    limits = (low, high) if full is None else (0.0, full)
    return ({"OP": limits} if all(map(math.isfinite, limits)) else {}) | dict(spans or {})


class PI(LimitedController):
    """PI controller, ideal form, continuous: OP = K_p (e + 1/T_i int e dt), limited to ``low`` ... ``high``.

    ``action``: "reverse" or "direct".  ``anti_windup``: "back_calculation" (tracking time ``T_t`` [s], 0 for T_i),
    "conditional" or "none".  Bumpless start: OP starts at ``start_op`` if SP - PV starts at ``start_error``;
    without ``start_op`` the integral part z starts at 0.  The span of OP is low ... high as built, if finite.
    Python-control, which knows no events, sees the equations above with the mode read from the present values.
    Conditional integration watches input rates, which makes event searching in its loop slower.

    ``start_op``: OP at the start [unit of OP].
    Raises ``BlockError`` for K_p <= 0, T_i <= 0, T_t < 0, low >= high, or a start_op outside the limits.

    >>> pi = PI(K_p=0.4, T_i=10.0, start_op=0.5, start_error=0.1)
    >>> round(float(pi.output(0.0, pi.x0, [0.6, 0.5])[0]), 6)
    0.5
    """

    ports_in = (Port("SP"), Port("PV"))
    one_unit = ("SP", "PV")
    ports_out = (Port("OP"),)
    modes = {
        **MODES,
        "leaving high limit": 2.0,
        "leaving low limit": -2.0,
        "riding high limit": 3.0,
        "riding low limit": -3.0,
    }

    def __init__(
        self, K_p: float, T_i: float = math.inf, *, low: float = 0.0, high: float = 1.0, action: str = "reverse",
        anti_windup: str = "back_calculation", T_t: float = 0.0, start_op: float | None = None,
        start_error: float = 0.0, name: str = "controller", inputs: Labels = None, outputs: Labels = None,
        units: Mapping[str, str] | None = None, spans: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:  # fmt: skip
        params = tuned(K_p, T_i, low, high, T_t, action, anti_windup, name)
        self.anti_windup = anti_windup
        self.kernels = _CONDITIONAL if anti_windup == "conditional" else _PLAIN
        self.check(params, name)
        super().__init__(
            name=name,
            params=params,
            states={"z": start_integral(params, start_op, start_error, name)},
            memory={"mode": 0.0},
            inputs=inputs,
            outputs=outputs,
            units=units,
            spans=op_span(params, spans),
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless gain, times and limits make sense."""
        check_tuning(params, name)

    def unlimited(self, x: Floats, u: Floats) -> float:
        """Return v = K_p e + z."""
        return float(self._p_now[0] * (self._p_now[5] * (u[0] - u[1])) + x[0])

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,): where v lies, and whether the error draws it back (conditional integration)."""
        side = super().seen_memory(x, u)
        leaving = self.anti_windup == "conditional" and side[0] * self._p_now[5] * (u[0] - u[1]) <= 0.0
        return 2.0 * side if leaving else side
