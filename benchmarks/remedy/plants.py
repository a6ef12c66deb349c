"""Hidden loops drawn from a seed: laws of friction, processes, loads and set points that the fit has none of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from stickslip.calibration.crossed.stems import LAWS as ALL
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.remedy.measures.setting import Setting
from stickslip.remedy.trial import AWAY, NOTHING

from benchmarks.remedy.running import Numbers, Settings, run

__all__ = ["LAWS", "Plant"]

SAMPLES = 4_000
SKIPPED = 0.15
LAWS = ("karnopp", "stribeck", "lugre", "kano", "backlash_and_stick", "sound")
LOADS = ("wander", "steps", "both")


class Loads(NamedTuple):
    """How the load goes [% of OP]: a wander of a spread and a memory [samples], and steps at so many of the samples.

    With an infinite memory it walks: by ``wander`` in a thousand samples.
    """

    size: float
    wander: float
    memory: float
    rate: float
    jump: float

    def drawn(self, r: Any, samples: int = SAMPLES) -> Values:
        """A load, (samples,)."""
        load = self.wander * _wander(r, self.memory, samples)
        at = np.flatnonzero(r.random(samples) < self.rate)
        for one, jump in zip(at, self.jump * r.normal(size=len(at)), strict=True):
            load[one:] += jump - 0.3 * load[one]  # it stays in bounds
        load[:40] += 0.4 * self.size * (1.0 - np.arange(40) / 40.0)  # a push, so that what can cycle does
        return load


@dataclass(frozen=True)
class Plant:
    """A hidden loop; OP and stem in % of span."""

    seed: int
    law: str
    numbers: Numbers
    settings: Settings
    loads: Loads
    noise_sd: float  # [unit of PV]
    sp: Values = field(repr=False)
    load: Values = field(repr=False)
    noise: Values = field(repr=False)

    @classmethod
    def drawn(cls, seed: int) -> Plant:
        """The loop of a seed."""
        r = np.random.default_rng([seed, 2026])
        law = LAWS[seed % len(LAWS)]
        integrating = r.random() < 0.25
        dt = float(r.choice([1.0, 2.0, 5.0]))
        tau = dt * float(np.exp(r.uniform(math.log(4.0), math.log(30.0))))
        T_2, T_3 = tau * float(r.uniform(0.05, 0.6)), tau * (float(r.uniform(0.05, 0.4)) if r.random() < 0.3 else 0.01)
        theta, air = tau * float(r.uniform(0.05, 0.6)), dt * float(r.uniform(0.1, 0.8))
        gain = float(np.exp(r.uniform(math.log(0.4), math.log(3.0))))
        K = gain / tau if integrating else gain
        sticks = law != "sound"
        S = float(np.exp(r.uniform(math.log(1.0), math.log(8.0))))
        J = S * float(r.uniform(0.1, 0.7)) * (0.5 if law == "backlash_and_stick" else 1.0)
        late, slow = theta + 0.5 * (T_2 + T_3) + air + 0.5 * dt, float(r.uniform(0.8, 3.0))
        wanted = slow * max(late, 0.3 * tau)
        T_i = 2.0 * wanted + late if integrating else min(tau + 0.5 * T_2, 4.0 * (wanted + late))
        K_p = T_i / (K * (wanted + late) ** 2) if integrating else (tau + 0.5 * T_2) / (K * (wanted + late))
        mass = (0.05 if law != "lugre" else 0.25) * air**2
        fine = math.sqrt(mass / 50.0) / 8.0 if law == "lugre" else dt
        h = dt / math.ceil(dt / min(0.25 * air, 0.1 * T_2, 0.1 * dt, fine))
        numbers = Numbers(
            h, round(dt / h), -1 if law == "lugre" else ALL.index(law if sticks else "backlash"), S if sticks else 0.0,
            J if sticks else 0.0, air, mass, float(r.uniform(-0.6, 0.6)), K, 0.0 if integrating else tau,
            T_2, T_3, theta, bool(r.random() < 0.5),
        )  # fmt: skip
        size, kind = max(S, 2.0), LOADS[int(r.integers(len(LOADS)))]
        loads = Loads(
            size, size * float(r.uniform(0.1, 0.5)) * (kind != "steps"), tau * float(r.uniform(5.0, 40.0)) / dt,
            dt / (tau * float(r.uniform(30.0, 120.0))) * (kind != "wander"), size * float(r.uniform(0.2, 0.6)),
        )  # fmt: skip
        sp = np.zeros(SAMPLES)
        if r.random() < 0.3:
            for at in np.sort(r.integers(200, SAMPLES, size=3)):
                sp[at:] = gain * S * float(r.uniform(-0.6, 0.6))
        noise = gain * size * float(np.exp(r.uniform(math.log(0.005), math.log(0.08))))
        noise = min(noise, 0.15 * S / K_p) if sticks else noise
        return cls(
            seed, law, numbers, Settings(K_p, T_i), loads, noise, sp, loads.drawn(r), noise * r.normal(size=SAMPLES)
        )

    def later(self, change: str) -> Plant:
        """The same loop at another time: another load and noise of the same kind, and one thing changed.

        The stick two and a half times as large, or gone; 0.55 of the process's gain; dead time longer by all that is
        late; half the gain or 1.8 times the integral time of the controller; three times the load or the noise; a
        sensor that is off by 1.5 times the load's size, at once or little by little; or "nothing".
        """
        n, c, loads, noise = self.numbers, self.settings, self.loads, self.noise_sd
        r = np.random.default_rng([self.seed, 2027])
        off = np.zeros(len(self.sp))
        if change == "stiction":
            n = n._replace(S=2.5 * n.S, J=2.5 * n.J)
        elif change == "stiction_gone":
            n = n._replace(law=ALL.index("backlash"), S=0.0, J=0.0)
        elif change == "process_gain":
            n = n._replace(K=0.55 * n.K)
        elif change == "dead_time":
            n = n._replace(theta=2.0 * n.theta + 0.5 * (n.T_2 + n.T_3) + n.air + 0.5 * self.dt)
        elif change == "controller_gain":
            c = c._replace(K_p=0.5 * c.K_p)
        elif change == "controller_integral_time":
            c = c._replace(T_i=1.8 * c.T_i)
        elif change == "disturbance":
            loads = loads._replace(wander=3.0 * loads.wander, jump=3.0 * loads.jump)
        elif change == "sensor_noise":
            noise = 3.0 * noise
        elif change == "sensor_drift":
            far = 1.5 * loads.size * n.K * (1.0 if n.T_1 > 0.0 else n.T_2 + n.theta)
            off += far * (np.minimum(np.arange(len(off)) / len(off) * 2.0, 1.0) if r.random() < 0.5 else 1.0)
        load = loads.drawn(r, len(off))
        return replace(
            self,
            numbers=n,
            settings=c,
            loads=loads,
            noise_sd=noise,
            load=load,
            noise=noise * r.normal(size=len(off)) + off,
        )

    @property
    def dt(self) -> float:
        """The scan [s]."""
        return self.numbers.h * self.numbers.scan

    @property
    def integrating(self) -> bool:
        """Kind of the process."""
        return self.numbers.T_1 <= 0.0

    @property
    def truth(self) -> Mapping[str, float]:
        """What a fit should say; lags: the sum of all lags and dead time [s]."""
        n = self.numbers
        lags = n.T_1 + n.T_2 + n.T_3 + n.theta + n.air
        return {"S": n.S, "J": n.J, "K": n.K, "KJ": n.K * n.J, "lags": lags}

    def log(self, setting: Setting = NOTHING) -> Values:
        """PV, OP and stem (3, samples) with a setting of the advice."""
        p, factors, own = setting.params, setting.factors, self.settings
        dt = self.dt
        left = factors.get("stick", 1.0)
        settings = own._replace(
            K_p=math.copysign(p.get("controller.K_p", abs(own.K_p) * factors.get("controller.K_p", 1.0)), own.K_p),
            T_i=p.get("controller.T_i", own.T_i * factors.get("controller.T_i", 1.0)),
            gap=p.get("controller.gap", 0.0), zone=p.get("controller.zone", 0.0), pulse=p.get("knocker.a", 0.0),
            period=round(p.get("knocker.period", 5.0 * dt) / dt), width=round(p.get("knocker.width", 2.0 * dt) / dt),
            push=p.get("reinforcement.a", 0.0), hold=p.get("reinforcement.hold", 0.0),
            move_S=p.get("two_move.S", 0.0), move_J=p.get("two_move.J", 0.0), band=p.get("two_move.band", math.inf),
            pause=math.ceil(p.get("two_move.pause", dt) / dt - 1e-9),
        )  # fmt: skip
        n = self.numbers
        if left <= 0.0:
            n = n._replace(law=ALL.index("backlash"), S=0.0, J=0.0)
        out = np.zeros((3, len(self.sp)))
        run(n._replace(S=left * n.S, J=left * n.J), settings, self.sp, self.load, self.noise, out)
        return out

    def record(self) -> LoopRecord:
        """What a historian has of it: OP, PV and SP at each scan."""
        pv, op, _ = self.log()
        t = self.dt * np.arange(len(pv))
        return LoopRecord.from_arrays(
            t, pv=50.0 + pv, op=50.0 + op, sp=50.0 + self.sp, op_span=(0.0, 100.0), name=str(self.seed)
        )

    @cached_property
    def measured_as_it_is(self) -> tuple[float, float, float]:
        """``measured`` without a remedy."""
        return self.measured(NOTHING)

    def measured(self, setting: Setting) -> tuple[float, float, float]:
        """Standard deviation and rms of SP - PV, travel per hour under the same load; inf where PV runs away."""
        pv, _, stem = self.log(setting)
        if not np.all(np.abs(pv) < AWAY * np.ptp(self.log()[0])):
            return math.inf, math.inf, math.inf
        first = int(SKIPPED * len(pv))
        travel = float(np.sum(np.abs(np.diff(stem[first:])))) / ((len(pv) - first) * self.dt / 3600.0)
        e = (self.sp - pv)[first:]
        return float(np.std(e)), float(np.sqrt(np.mean(e**2))), travel


def _wander(r: Any, memory: float, samples: int) -> Values:
    """A first-order wander of spread 1 and ``memory`` [samples], or a walk."""
    from scipy.signal import lfilter

    a = math.exp(-1.0 / memory)
    size = math.sqrt(1.0 - a * a) if a < 1.0 else math.sqrt(1e-3)
    return np.asarray(lfilter([size], [1.0, -a], r.normal(size=samples)))
