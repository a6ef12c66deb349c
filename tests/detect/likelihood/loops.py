"""A PI loop written anew for these tests: plain recursions, no block, no engine, no code of the detectors."""

import numpy as np


def play(u, S, x):
    """Backlash of width S, by its closed form; J = 0."""
    return min(max(x, u - S / 2), u + S / 2)


def slip(u, S, J, x):
    """A valve that holds until OP is (S + J) / 2 away and then slips to (S - J) / 2 from it (He 2007)."""
    if abs(u - x) <= (S + J) / 2:
        return x
    return u - np.sign(u - x) * (S - J) / 2


def run(
    S=0.0, J=0.0, *, n=2000, noise=0.05, seed=0, wave=3.0, period=90.0, moves=2.0, hysteresis=0.0, bend=0.0, up=1.0,
    tau=8.0, dead=2, K_p=0.6, T_i=12.0, ramp=0.0,
):  # fmt: skip
    """OP and PV (n,) of a loop with a sine on the load and a wandering set point, all in %.

    `hysteresis` of the sensor, `bend` of the characteristic, `up` the process gain upwards over that downwards.
    """
    rng = np.random.default_rng(seed)
    sp, steps = 50.0, rng.normal(size=n) * (rng.random(n) < 1 / 60) * moves
    phase = 2 * np.pi * np.cumsum(1 + 0.1 * rng.normal(size=n)) / period
    x, integral, state, seen, late = 50.0, 50.0, 0.0, 50.0, [50.0] * (dead + 1)
    op, pv = np.empty(n), np.empty(n)
    for k in range(n):
        sp += steps[k] - 0.02 * (sp - 50)
        true = 50 + state + noise * rng.normal()
        seen = play(true, hysteresis, seen) if hysteresis else true
        e = sp - seen
        integral += K_p * e / T_i
        u = integral + K_p * e
        op[k], pv[k] = u, seen + (noise * rng.normal() if hysteresis else 0.0)
        before = x
        x = slip(u, S, J, x) if J else play(u, S, x)
        late.append(x + bend * (x - 50) ** 2)
        drive = late.pop(0) - 50 + wave * np.sin(phase[k]) + ramp * k + 0.02 * rng.normal()
        gain = up if x > before else 1.0
        state += gain * (drive - state) / tau
    return op, pv
