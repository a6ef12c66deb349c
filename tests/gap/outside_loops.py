"""The site's flow loop from scan to scan, in plain Python, with effects that no catalogue has, and some that it has.

y_k+1 = a y_k + (1 - a) K (OP_k + load_k),  a = exp(-1/tau)        a first order under inputs that are held: exact
"""

import math

import numpy as np
from stickslip.logs import Log

K_P, T_I = 0.4, 10.0


def autoregression(rng, n, time):
    """Return a load of standard deviation 1 with a correlation time [scans]."""
    a, x = math.exp(-1.0 / time), np.empty(n)
    x[0] = rng.normal()
    for k in range(1, n):
        x[k] = a * x[k - 1] + math.sqrt(1.0 - a * a) * rng.normal()
    return x


KINDS = {
    "none": lambda t, rng: {},
    "step": lambda t, rng: {"load": 0.06 * (t >= 3400.0)},
    "sine": lambda t, rng: {"load": 0.02 * np.sin(2.0 * np.pi * t / 140.0)},
    "more noise": lambda t, rng: {"noise": 0.007 * rng.normal(size=len(t))},
    "a gain that switches": lambda t, rng: {"K": np.where(t < 3400.0, 3.0, 2.75)},
    "a gain that oscillates": lambda t, rng: {"K": 3.0 * (1.0 + 0.06 * np.sin(2.0 * np.pi * t / 140.0))},
    "a gain that wears": lambda t, rng: {"K": 3.0 * (1.0 - 0.13 * t / t[-1])},
    "a square wave of the load": lambda t, rng: {"load": 0.02 * np.sign(np.sin(2.0 * np.pi * t / 300.0))},
    "a slow load": lambda t, rng: {"load": 0.018 * autoregression(rng, len(t), 1200.0)},
    "a ramp of the load": lambda t, rng: {"load": 0.05 * np.clip((t - 2800.0) / 1800.0, 0.0, 1.0)},
    "a gain that goes with the direction": lambda t, rng: {"way": 0.03},
    "a restless stem": lambda t, rng: {"load": 0.025 * rng.normal(size=len(t))},
    "a noise that grows with the level": lambda t, rng: {"grows": 0.0025 * rng.normal(size=len(t))},
    "a sensor whose noise is coloured": lambda t, rng: {"noise": 0.01 * autoregression(rng, len(t), 15.0)},
}
TWO = {"a gain and a sine of the load": lambda t, rng: {"K": 3.9, "load": 0.03 * np.sin(2.0 * np.pi * t / 140.0)}}


def site_log(kind="none", seed=5, hours=2.0):
    """Return a log of the loop, a row every 5 s, rounded as the site's is."""
    rng = np.random.default_rng(seed)
    t = np.arange(3600.0 * hours + 1.0)
    n = len(t)
    SP = np.repeat(rng.uniform(1.05, 1.95, n // 250 + 1).round(2), 250)[:n]
    own = (KINDS | TWO)[kind](t, rng)
    K = np.broadcast_to(own.get("K", 3.0), n)
    load = 0.01 * autoregression(rng, n, 60.0) + own.get("load", 0.0)
    noise = 0.004 * rng.normal(size=n) + own.get("noise", 0.0)
    grows = np.broadcast_to(own.get("grows", 0.0), n)
    y, z, a = SP[0], SP[0] / 3.0, math.exp(-0.1)
    PV, OP = np.empty(n), np.empty(n)
    for k in range(n):
        PV[k] = y + noise[k] + grows[k] * y
        e = SP[k] - PV[k]
        z += K_P / T_I * e
        OP[k] = min(max(K_P * e + z, 0.0), 1.0)
        way = np.sign(OP[k] - OP[k - 1]) if k else 0.0
        y = a * y + (1.0 - a) * K[k] * (OP[k] * (1.0 + own.get("way", 0.0) * way) + load[k])
    rows = slice(None, None, 5)
    return Log(t[rows], {"SP": SP[rows], "PV": np.round(PV[rows] / 0.0015) * 0.0015, "OP": OP[rows].round(3)})
