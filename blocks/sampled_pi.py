"""PI controller that computes at scan times and holds its output in between, as a DCS does.

    e_k  = action (SP_k - PV_k)                           sampled at t_k = offset + k dt
    v_k  = K_p e_k + z_k,    OP_k = v_k limited to low ... high, held until t_(k+1)
    z_(k+1) = z_k + dt K_p e_k / T_i                      anti_windup = "none"
            + min(dt / T_t, 1) (OP_k - v_k)               anti_windup = "back_calculation"
    z_(k+1) = z_k if v_k is at or beyond a limit and      anti_windup = "conditional"
            e_k pushes further out, else as "none"

Positional, ideal form; z is updated after the output, that is, the integral is the forward (left) rectangle rule.
With ``integral="present"`` it takes in the present error before the output is made (backward rectangle rule):
v_k = K_p e_k + z_k + dt K_p e_k / T_i, the rest as above; makers of control systems do either.
With ``T_t=dt`` back-calculation takes back at once all that lies beyond a limit, as many control systems do, which
limit v and make z from it.  Both together are the velocity form, which sampled_pid has by name, with a derivative.

It approaches the continuous PI with first order as dt -> 0.  Ports and parameters as in pi, and ``dt`` scan time [s],
``offset`` first scan [s].  With respect to the loop the hold adds about dt/2 of dead time.

Source: Astrom and Wittenmark, Computer-Controlled Systems, 3rd ed. 1997, section 8.5 (operational aspects of PID).
Valid for any dt > 0; stability of the loop is the user's affair.
See also: sampled_pid (derivative, set-point weights), pi, pid (continuous).
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.limited_pi import LimitedController
from stickslip.blocks.pi import PI, check_tuning, op_span, start_integral, tuned
from stickslip.blocks.ports import BlockError, Labels, Port, nearest, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan

INTEGRAL = {"previous": 0.0, "present": 1.0}

# p = K_p, T_i, low, high, T_t, action, dt, offset, present; d = z


def taken(w: float, e: float, d: Any, p: Any, y: Any) -> None:
    """Write OP = K_p ``w`` + z between its limits, and move z by the error ``e``, both signed as ``action`` says."""
    gained = p[6] * p[0] * e / p[1]
    v = p[0] * w + d[0] + p[8] * gained
    y[0] = min(max(v, p[2]), p[3])
    track = p[6] / (p[4] if p[4] > 0.0 else p[1])
    d[0] += gained + min(track, 1.0) * (y[0] - v)


def taken_within(w: float, e: float, d: Any, p: Any, y: Any) -> None:
    """Do the same with conditional integration."""
    gained = p[6] * p[0] * e / p[1]
    v = p[0] * w + d[0] + p[8] * gained
    y[0] = min(max(v, p[2]), p[3])
    outwards = (v >= p[3] and e > 0.0) or (v <= p[2] and e < 0.0)
    if not outwards:
        d[0] += gained


def _plain_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    e = p[5] * (u[0] - u[1])
    taken(e, e, d, p, y)


def _conditional_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    e = p[5] * (u[0] - u[1])
    taken_within(e, e, d, p, y)


class SampledPI(Block):
    """PI controller, ideal positional form, with scan time ``dt`` [s]; otherwise the interface of ``PI``.

    ``low``, ``high`` [unit of OP]; ``T_t`` [s]; ``start_error``: SP - PV at the start [unit of PV].
    ``integral``: "previous" or "present", the error that the integral has taken in when the output is made; the
    parameter ``present`` [-] is 0 or 1.  ``own``, ``kept`` [units of their own]: parameters and memories that a
    subclass has besides, for its ``plain_step`` and its ``conditional_step``.
    Raises ``BlockError`` as ``PI`` does, and for dt <= 0.

    >>> pi = SampledPI(K_p=0.4, T_i=10.0, dt=1.0, start_op=0.5)
    >>> z = pi.dynamics(0.0, pi.d0, [0.6, 0.5])                # one scan with e = 0.1: z = 0.5 + 0.4 x 0.1 / 10
    >>> round(float(z[0]), 6), round(float(pi.output(1.0, z, [0.6, 0.5])[0]), 6)
    (0.504, 0.544)
    """

    role = Role.CONTROLLER
    ports_in = (Port("SP"), Port("PV"))
    one_unit = ("SP", "PV")
    ports_out = (Port("OP"),)
    period_param = "dt"
    limit_params = ("low", "high")
    offset_param = "offset"
    plain_step = staticmethod(_plain_step)
    conditional_step = staticmethod(_conditional_step)

    def __init__(
        self, K_p: float, T_i: float = math.inf, *, dt: float, offset: float = 0.0, low: float = 0.0,
        high: float = 1.0, action: str = "reverse", anti_windup: str = "back_calculation", integral: str = "previous",
        T_t: float = 0.0, start_op: float | None = None, start_error: float = 0.0, name: str = "controller",
        inputs: Labels = None, outputs: Labels = None, units: Mapping[str, str] | None = None,
        spans: Mapping[str, tuple[float, float]] | None = None, own: Mapping[str, float] | None = None,
        kept: Mapping[str, float] | None = None,
    ) -> None:  # fmt: skip
        if integral not in INTEGRAL:
            raise BlockError(f"{name}: integral = {integral!r}; {nearest(str(integral), list(INTEGRAL))}")
        scan = {"dt": dt, "offset": offset, "present": INTEGRAL[integral]}
        params = tuned(K_p, T_i, low, high, T_t, action, anti_windup, name) | scan | dict(own or {})
        self.anti_windup = anti_windup
        kind = type(self)
        self.kernels = Kernels(step=kind.conditional_step if anti_windup == "conditional" else kind.plain_step)
        self.check(params, name)
        super().__init__(
            name=name,
            params=params,
            memory={"z": start_integral(params, start_op, start_error, name), **(kept or {})},
            start_output=[min(max(0.0 if start_op is None else start_op, low), high)],
            inputs=inputs,
            outputs=outputs,
            units=units,
            spans=op_span(params, spans),
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` as ``PI`` does, and unless dt > 0 and ``present`` is 0 or 1."""
        check_tuning(params, name)
        check_scan(params, name)
        present = float(params["present"])
        require(
            present in (0.0, 1.0), name, "present", present, "it is 0 (previous) or 1 (present)", "give one of them"
        )

    def settled(self, u: Floats, y: Floats) -> Self:
        """Return the controller with the integral part at which it gives OP for SP and PV."""
        own = self.params
        return self.starting_at(z=float(y[0] - own["K_p"] * own["action"] * (u[0] - u[1])))

    def smooth(self) -> LimitedController:
        """Return the continuous PI controller that this one approaches as dt -> 0."""
        values = dict(zip(self.param_names, self.p, strict=True))
        return PI(
            values["K_p"],
            values["T_i"],
            low=values["low"],
            high=values["high"],
            action="reverse" if values["action"] > 0.0 else "direct",
            anti_windup=self.anti_windup,
            T_t=values["T_t"],
            name=self.name,
            inputs=self.input_labels,
            outputs=self.output_labels,
            units=self.units,
            spans=self.spans,
        ).starting_at(z=float(self.d0[0]))
