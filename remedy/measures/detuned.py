"""Detuning by lambda: the loop is made as slow as wanted.

    self-regulating   K_p = tau / (K (lambda + theta)),   T_i = tau            lambda = tau or 3 tau
    integrating       K_p = (2 lambda + theta) / (K (lambda + theta)^2),   T_i = 2 lambda + theta

Source: D. E. Rivera, M. Morari, S. Skogestad, Ind. Eng. Chem. Process Des. Dev. 25 (1986) 252-265.
"""

import math

from stickslip.remedy.measures.setting import Setting, Situation

TITLE = "lambda tuning"
AT_SHUTDOWN = False
NOT_FOR = "a gain that is not known"


def settings(at: Situation) -> list[Setting]:
    """Return the settings that are tried."""
    if not at.gain_known or at.T_i == float("inf") or at.lag <= 0.0:
        return []
    found = []
    for times in (1.0, 3.0):
        wanted = times * max(at.lag, at.theta, 2.0 * at.dt)
        if at.integrating:
            T_i = 2.0 * wanted + at.theta
            K_p = T_i / (at.K * (wanted + at.theta) ** 2)
        else:
            T_i, K_p = at.lag, at.lag / (at.K * (wanted + at.theta + 0.5 * at.dt))
        own = math.copysign(K_p, at.K_p)
        found.append(
            Setting(
                f"K_p {own:.3g}, T_i {T_i:.3g} s (lambda {wanted:.3g} s)", {"K_p": own, "T_i": T_i, "lambda": wanted},
                {"controller.K_p": K_p, "controller.T_i": T_i},
            )
        )  # fmt: skip
    return found
