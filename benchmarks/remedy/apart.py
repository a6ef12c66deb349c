"""Other hidden loops: more laws of friction, gains of either sign and any size, walks, second order, 1 to 5 s.

law            karnopp, stribeck, kano, he, lugre, backlash and stick; choudhury, stenman, chen; one of ten is sound
process        first or second order, or an integrator;  dead time up to twice the lag
load           first-order autoregression, steps, or a walk
rows           3,000 to 7,200

``shaken`` draws a sound loop whose load is the stem or PV of a sticky neighbour, of 750 to 2,500 rows.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from stickslip.calibration.crossed.stems import LAWS as ALL

from benchmarks.remedy.plants import Loads, Plant
from benchmarks.remedy.running import Numbers, Settings
from benchmarks.remedy.sampled_stems import CHEN, CHOUDHURY, STENMAN

__all__ = ["LAWS", "drawn", "shaken"]

CODES = {
    "karnopp": 2, "choudhury": CHOUDHURY, "kano": 0, "lugre": -1, "he": 1, "chen": CHEN, "stribeck": 3,
    "stenman": STENMAN, "backlash_and_stick": 5, "sound": ALL.index("backlash"),
}  # fmt: skip
LAWS = tuple(CODES)


def drawn(seed: int) -> Plant:
    """The loop of a seed."""
    r = np.random.default_rng([seed, 1126])

    def between(low: float, high: float) -> float:
        return float(np.exp(r.uniform(math.log(low), math.log(high))))

    law, kind, moved = (
        LAWS[seed % len(LAWS)],
        r.choice(["first", "second", "integrating"]),
        r.choice(["ar", "steps", "walk"]),
    )
    dt, n = float(r.choice([1.0, 2.0, 3.0, 5.0])), int(r.integers(3000, 7201))
    tau, integrating = dt * between(3.0, 40.0), kind == "integrating"
    T_2 = tau * (float(r.uniform(0.3, 1.0)) if kind == "second" else 0.02)
    theta, air = (
        dt * float(r.uniform(0.2, 1.0)) + tau * float(r.choice([0.0, r.uniform(0.1, 1.0)])),
        dt * float(r.uniform(0.1, 0.8)),
    )
    gain = between(0.1, 10.0) * float(r.choice([-1.0, 1.0]))
    K = gain / tau if integrating else gain
    S = between(0.8, 10.0) if law != "sound" else 0.0
    J = S * float(r.uniform(0.1, 0.9)) * (0.5 if law == "backlash_and_stick" else 1.0)
    J = S if law == "stenman" else J
    late = theta + T_2 * (0.5 if kind == "second" else 1.0) + air + 0.5 * dt
    wanted = float(r.uniform(0.7, 3.0)) * max(late, 0.3 * tau)
    lag = tau + (0.5 * T_2 if kind == "second" else 0.0)
    T_i = 2.0 * wanted + late if integrating else min(lag, 4.0 * (wanted + late))
    K_p = T_i / (K * (wanted + late) ** 2) if integrating else lag / (K * (wanted + late))
    mass = (0.25 if law == "lugre" else 0.05) * air**2
    fine = math.sqrt(mass / 50.0) / 8.0 if law == "lugre" else dt
    h = dt / math.ceil(dt / min(0.25 * air, 0.1 * T_2, 0.1 * dt, fine))
    numbers = Numbers(
        h, round(dt / h), CODES[law], S, J, air, mass, float(r.uniform(-0.6, 0.6)), K, 0.0 if integrating else tau,
        T_2, 0.01 * tau, theta, bool(r.random() < 0.5),
    )  # fmt: skip
    size = max(S, 2.0)
    loads = Loads(
        size, size * float(r.uniform(0.1, 0.6)) * (moved != "steps"),
        math.inf if moved == "walk" else tau * float(r.uniform(3.0, 40.0)) / dt,
        dt / (tau * float(r.uniform(30.0, 120.0))) * (moved == "steps"), size * float(r.uniform(0.2, 0.7)),
    )  # fmt: skip
    sp = np.zeros(n)
    if r.random() < 0.3:
        for at in np.sort(r.integers(200, n, size=3)):
            sp[at:] = gain * size * float(r.uniform(-0.6, 0.6))
    noise = abs(gain) * size * between(0.003, 0.08)
    noise = min(noise, 0.15 * S / abs(K_p)) if law != "sound" else noise
    return Plant(seed, law, numbers, Settings(K_p, T_i), loads, noise, sp, loads.drawn(r, n), noise * r.normal(size=n))


def shaken(seed: int) -> Plant:
    """A sound loop that a sticky neighbour shakes."""
    r, sound = np.random.default_rng([seed, 1127]), drawn(len(LAWS) * seed + LAWS.index("sound"))
    rows = int(r.integers(750, 2501))
    near = (drawn(len(LAWS) * seed + i).log() for i in r.permutation(len(LAWS) - 1))
    pv, _, stem = next(log for log in near if np.ptp(log[2]) > 0.0 and np.all(np.abs(log[1]) < 50.0))
    wave = np.resize(stem if seed % 2 else pv, rows)
    load = 0.2 * sound.load[:rows] + 0.5 * sound.loads.size * (wave - wave.mean()) / np.std(wave)
    return replace(sound, seed=seed, load=load, noise=sound.noise[:rows], sp=sound.sp[:rows])
