"""PID controller that computes at scan times, as a DCS does: positional or velocity form, derivative, weights.

    f_k  = f_(k-1) + dt/(T_f + dt) (c SP_k - PV_k - f_(k-1))       sampled at t_k = offset + k dt
    D_k  = T_d (f_k - f_(k-1)) / dt                                T_f = T_d/N
    w_k  = action (b SP_k - PV_k + D_k),    e_k = action (SP_k - PV_k)

positional  v_k = K_p w_k + z_k,  OP_k = v_k limited to low ... high, held until t_(k+1);  z and its anti-windup as in
            sampled_pi, by e_k
velocity    OP_k = OP_(k-1) + K_p (w_k - w_(k-1)) + dt K_p e_(k-1) / T_i, limited;  e_k with integral="present"

in   SP  set point   PV  measured process variable (one unit)        out  OP  controller output
K_p  gain [unit of OP / unit of PV]; of a gain in % of OP per % of PV's span: K_p = gain (high - low) / span of PV
T_i  integral time [s] (inf: none)    T_d  derivative time [s] (0: none)
N    ratio of derivative time to filter time [-], inf: no filter, D is the difference of two scans
b, c weights of the set point in the proportional and the derivative part [-]: c = 0 is derivative on PV, c = 1 on the
     error, b = 0 proportional on PV
low, high, T_t, action, dt, offset, present   as in sampled_pi.  OP in per cent: high = 100

The velocity form is the positional form whose tracking takes back at once what lies beyond a limit, T_t -> 0:
z_(k+1) is then OP_k - K_p w_k + dt K_p e_k / T_i.  It has nothing that winds up.
A controller in series form with K', T_i', T_d' has T_i = T_i' + T_d', K_p = K' T_i/T_i', T_d = T_i' T_d'/T_i.

It approaches the continuous PID with first order as dt -> 0.  With respect to the loop the hold adds about dt/2 of dead
time.  T_d = 0 and b = 1 is sampled_pi.
Source: Astrom and Wittenmark, Computer-Controlled Systems, 3rd ed. 1997, section 8.5 (backward difference for the
derivative, set-point weights, velocity form).
Valid for any dt > 0; not for noise with a large N, which OP shows K_p (1 + N) times.  See also: pid (continuous).
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Floats
from stickslip.blocks.pid import PID
from stickslip.blocks.ports import BlockError, nearest, require
from stickslip.blocks.rules import not_negative
from stickslip.blocks.sampled_pi import SampledPI, taken, taken_within

FORMS = ("positional", "velocity")
USUAL = 10.0  # N of most controllers
AT_ONCE = 1e-9  # [s] tracking time of the velocity form, shorter than any scan
LEAST = 0.1  # scans of the derivative's filter in the continuous twin: a shorter one is not seen between samples

# p = as sampled_pi, T_d, N, b, c; d = z, f


def _acting(d: Any, u: Any, p: Any) -> float:
    """Return w, and take the sample into f."""
    new = p[12] * u[0] - u[1] - d[1]
    lag = p[9] / p[10] + p[6]
    d[1] += p[6] / lag * new
    w: float = p[5] * (p[11] * u[0] - u[1] + p[9] / lag * new)
    return w


def _plain_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    taken(_acting(d, u, p), p[5] * (u[0] - u[1]), d, p, y)


def _conditional_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    taken_within(_acting(d, u, p), p[5] * (u[0] - u[1]), d, p, y)


class SampledPID(SampledPI):
    """PID controller, ideal form, with scan time ``dt`` [s], first at ``offset`` [s]; see the module docstring.

    ``form``: "positional", or "velocity", which has no ``anti_windup`` and no ``T_t``.  ``N`` or, in its place, ``T_f``
    [s], the time constant of the derivative's filter; the parameter is N = T_d/T_f.  ``integral``, ``anti_windup``,
    ``action`` as of ``SampledPI``; ``low``, ``high`` [unit of OP]; ``T_t`` [s].
    Bumpless start: OP starts at ``start_op`` [unit of OP] if SP and PV start at ``start_SP`` and ``start_PV`` [unit of
    PV].  Give these two even without ``start_op``: the first sample is no step to the derivative then.
    Raises ``BlockError`` as ``SampledPI`` does, for negative T_d, b, c or T_f, N <= 0, N beside T_f, or an anti-windup
    in velocity form.

    >>> from stickslip.diagram import drive
    >>> pid = SampledPID(K_p=0.4, T_i=10.0, T_d=2.0, T_f=1.0, dt=1.0, start_op=0.5)
    >>> drive(pid, 2.0, every=1.0, SP=0.1, PV=0.0).log["OP"].round(6).tolist()       # c = 0: no kick, as SampledPI
    [0.54, 0.544, 0.548]
    >>> drive(pid, 2.0, every=1.0, SP=0.0, PV=-0.1).log["OP"].round(6).tolist()      # K_p T_d/(T_f + dt) e on top
    [0.58, 0.564, 0.558]
    """

    plain_step = staticmethod(_plain_step)
    conditional_step = staticmethod(_conditional_step)

    def __init__(
        self, K_p: float, T_i: float = math.inf, T_d: float = 0.0, *, dt: float, offset: float = 0.0,
        form: str = "positional", N: float | None = None, T_f: float | None = None, b: float = 1.0, c: float = 0.0,
        low: float = 0.0, high: float = 1.0, action: str = "reverse", anti_windup: str = "back_calculation",
        integral: str = "previous", T_t: float = 0.0, start_op: float | None = None, start_SP: float = 0.0,
        start_PV: float = 0.0, name: str = "controller", **labels: Any,
    ) -> None:  # fmt: skip
        if form not in FORMS:
            raise BlockError(f"{name}: form = {form!r}; {nearest(str(form), FORMS)}")
        if form == "velocity":
            rule = "the velocity form has nothing that winds up"
            require(anti_windup == "back_calculation", name, "anti_windup", anti_windup, rule, "leave it out")
            require(T_t == 0.0, name, "T_t", T_t, rule, "leave it out")
            T_t = AT_ONCE
        super().__init__(
            K_p, T_i, dt=dt, offset=offset, low=low, high=high, action=action, anti_windup=anti_windup,
            integral=integral, T_t=T_t, start_op=start_op, start_error=b * start_SP - start_PV, name=name,
            own={"T_d": T_d, "N": _ratio(T_d, N, T_f, name), "b": b, "c": c}, kept={"f": c * start_SP - start_PV},
            **labels,
        )  # fmt: skip

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` as ``SampledPI`` does, and unless T_d, b, c >= 0 and N > 0."""
        SampledPI.check(params, name)
        not_negative(params, name, "T_d", remedy="give seconds, or 0 for none")
        N = float(params["N"])
        require(N > 0.0, name, "N", N, "it must be positive", "8 to 20 is usual; math.inf is no filter")
        not_negative(params, name, "b", "c", rule="a weight must not be negative", remedy="give 0 to 1")

    def settled(self, u: Floats, y: Floats) -> Self:
        """Return the controller with the memories at which it gives OP for SP and PV that rest."""
        own, (SP, PV) = self.params, u
        z = y[0] - own["K_p"] * own["action"] * (own["b"] * SP - PV)
        return self.starting_at(z=float(z), f=float(own["c"] * SP - PV))

    def smooth(self) -> PID:
        """Return the continuous PID controller that this one approaches as dt -> 0; neither T_d nor T_f is 0 in it."""
        own = self.params
        T_f = max(own["T_d"] / own["N"], LEAST * own["dt"])
        T_d = max(own["T_d"], LEAST**3 * own["dt"])
        twin = PID(
            own["K_p"],
            own["T_i"],
            T_d,
            N=T_d / T_f,
            b=own["b"],
            c=own["c"],
            low=own["low"],
            high=own["high"],
            action="reverse" if own["action"] > 0.0 else "direct",
            T_t=max(own["T_t"], own["dt"]) if own["T_t"] > 0.0 else own["T_i"],
            name=self.name,
            inputs=self.input_labels,
            outputs=self.output_labels,
            units=self.units,
            spans=self.spans,
        )
        return twin.starting_at(z=float(self.d0[0]), f=float(self.d0[1]))


def _ratio(T_d: float, N: float | None, T_f: float | None, name: str) -> float:
    """Return N, of which a filter time ``T_f`` is the other way to say it."""
    if T_f is None:
        return USUAL if N is None else N
    require(N is None, name, "N", N, "T_f is given as well", "give one of the two")
    require(0.0 <= T_f < math.inf, name, "T_f", T_f, "it must be finite and not negative", "give 0 for none")
    if T_f == 0.0:
        return math.inf
    return T_d / T_f if T_d > 0.0 else USUAL
