"""Fits and remedies on loops whose plant is not the fit's: ``python -m benchmarks.remedy [--loops N] [--json FILE]``.

Each loop has a stem with mass, Stribeck's or LuGre's friction, or Kano's moves, in turn; a process of two lags and dead
time, or an integrator with a lag; a load
before the process that wanders and steps, which the fit takes to be behind it.
4,000 samples at the controller's scan.  The fit sees OP, PV and SP.  Every remedy of the advice is then tried on the
hidden plant under its own load, and so is doing nothing.  One loop of five is sound.

S, J, K, K J     error of the middle of the interval over the truth, and how often the interval holds the truth
sd predicted     of SP - PV with each remedy, over what the hidden plant gives
best             the remedy recommended until the shutdown has a score within 5 % of the truly best one's, or of none's
harm             recommended, and swings more than none on the hidden plant
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.blocks import (
    ConstantReinforcement,
    FirstOrder,
    GapPI,
    Integrator,
    KanoValve,
    Knocker,
    LuGreStem,
    Noise,
    SampledSensor,
    SecondOrder,
    Step,
    StickSlip,
    StribeckStem,
    Sum,
    TwoMove,
)  # fmt: skip
from stickslip.blocks.block import Block
from stickslip.diagram import Diagram, simulate, wire
from stickslip.logs import LoopRecord
from stickslip.remedy import Advice, FitError, fit, remedies
from stickslip.remedy.advice import TRAVEL
from stickslip.remedy.measures.setting import Setting
from stickslip.remedy.trial import NOTHING

SAMPLES = 4_000
SKIPPED = 0.15
LAWS = ("mass", "stribeck", "lugre", "kano", "sound")
WIDE: dict[str, Any] = {"low": -math.inf, "high": math.inf}


class Plant:
    """A hidden loop drawn from a seed; all of OP and MV in % of span."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([seed, 26])
        self.seed, self.law = seed, LAWS[seed % len(LAWS)]
        self.integrating = rng.random() < 0.2
        self.dt = float(rng.choice([1.0, 2.0, 5.0]))
        self.tau = self.dt * float(rng.uniform(6.0, 30.0))
        self.tau_2 = self.tau * float(rng.uniform(0.05, 0.5))
        self.theta = self.tau * float(rng.uniform(0.05, 0.5))
        self.K = float(np.exp(rng.uniform(math.log(0.4), math.log(3.0)))) / (self.tau if self.integrating else 1.0)
        self.S = 0.0 if self.law == "sound" else float(rng.uniform(1.5, 8.0))
        self.J = self.S * float(rng.uniform(0.1, 0.6))
        wanted = float(rng.uniform(0.7, 2.0)) * max(self.tau, 2.0 * self.theta)
        if self.integrating:
            self.T_i = 2.0 * wanted + self.theta + self.tau_2
            self.K_p = self.T_i / (self.K * (wanted + self.theta + self.tau_2) ** 2)
        else:
            self.T_i = self.tau + 0.5 * self.tau_2
            self.K_p = self.T_i / (self.K * (wanted + self.theta + 0.5 * self.tau_2 + 0.5 * self.dt))
        size = max(self.S, 3.0)
        self.load = size * float(rng.uniform(0.1, 0.4))
        self.memory = self.tau * float(rng.uniform(5.0, 30.0))
        self.step = size * float(rng.uniform(0.0, 0.4))
        gain = self.K * (self.tau if self.integrating else 1.0)
        self.noise = gain * size * float(rng.uniform(0.01, 0.06))

    def valve(self, S: float, J: float) -> Block:
        """The stem, fast beside the scan where it has a mass."""
        if S <= 0.0:
            return KanoValve(0.0, 0.0, self.dt, **WIDE)
        if self.law == "kano":
            return KanoValve(S, J, self.dt, **WIDE)
        F_s, F_c, lag = 0.5 * (S + J), 0.5 * (S - J), 0.05 * self.dt
        if self.law == "mass":
            return StickSlip(F_s, F_c, k=1.0, M=lag**2 / 4.0, F_v=lag, v_stop=1e-3, **WIDE)
        if self.law == "stribeck":
            return StribeckStem(F_s, F_c, k=1.0, M=lag**2 / 4.0, F_v=lag, v_s=0.05 * J / lag, **WIDE)
        M, stiff = lag**2 / 4.0, 50.0 * F_s / max(S, 1.0)
        return LuGreStem(
            F_s, F_c, k=1.0, M=M, F_v=lag, sigma_0=stiff, sigma_1=math.sqrt(stiff * M), v_s=0.05 * J / lag, **WIDE
        )

    def diagram(self, setting: Setting = NOTHING) -> Diagram:
        """The loop with a setting of the advice."""
        dt, p = self.dt, setting.params
        K_p = p.get("controller.K_p", self.K_p * setting.factors.get("controller.K_p", 1.0))
        T_i = p.get("controller.T_i", self.T_i * setting.factors.get("controller.T_i", 1.0))
        left = setting.factors.get("valve.S", 1.0)
        process: Block = (
            Integrator(self.K, 1.0, self.theta, inputs="F_2", outputs="true") if self.integrating
            else SecondOrder.from_lags(self.K, self.tau, self.tau_2, self.theta, inputs="F", outputs="true")
        )  # fmt: skip
        lag = [FirstOrder(1.0, self.tau_2, name="lag", inputs="F", outputs="F_2")] if self.integrating else []
        at = SAMPLES * dt
        return wire([
            Step("SP", 0.0),
            GapPI(
                K_p, T_i, dt=dt, **WIDE, name="controller", gap=p.get("controller.gap", 0.0),
                zone=p.get("controller.zone", 0.0), outputs={"OP": "OP_c"},
            ),
            Knocker(
                p.get("knocker.a", 0.0), p.get("knocker.period", 5.0 * dt), p.get("knocker.width", 2.0 * dt), dt,
                outputs="OP_k",
            ),
            ConstantReinforcement(
                p.get("reinforcement.a", 0.0), dt, hold=p.get("reinforcement.hold", 0.0), inputs="OP_k", outputs="OP_r"
            ),
            TwoMove(
                p.get("two_move.S", 1.0), p.get("two_move.J", 0.0), p.get("two_move.band", math.inf),
                p.get("two_move.pause", dt), dt, inputs={"OP_c": "OP_r"},
            ),
            self.valve(left * self.S, left * self.J),
            Noise("wander", self.load, dt, correlation_time=self.memory, seed=self.seed),
            Step("jump", before=0.0, after=self.step, at=0.37 * at), Step("back", after=-1.6 * self.step, at=0.71 * at),
            Sum("F", {"MV": 1.0, "wander": 1.0, "jump": 1.0, "back": 1.0}), *lag, process,
            SampledSensor(dt, sd=self.noise, seed=self.seed + 1, inputs="true", outputs="PV"),
        ], outputs=["SP", "PV", "OP", "MV"])  # fmt: skip

    def run(self, setting: Setting = NOTHING) -> Any:
        """Its log."""
        return simulate(self.diagram(setting), (SAMPLES - 1) * self.dt, every=self.dt, rtol=1e-5, atol=1e-8).log

    def measured(self, setting: Setting = NOTHING) -> tuple[float, float]:
        """Standard deviation of SP - PV and travel per hour."""
        log, first = self.run(setting), int(SKIPPED * SAMPLES)
        e, moves = (log["SP"] - log["PV"])[first:], np.abs(np.diff(log["MV"][first:]))
        return float(np.std(e)), float(np.sum(moves)) / ((SAMPLES - first) * self.dt / 3600.0)


def row(seed: int) -> dict[str, Any]:
    """What a loop showed."""
    plant = Plant(seed)
    log = plant.run()
    record = LoopRecord.from_arrays(log.t, pv=log["PV"], op=log["OP"], sp=log["SP"], op_span=None, name=str(seed))
    began = time.process_time()
    found: dict[str, Any] = {"seed": seed, "law": plant.law, "integrating": plant.integrating}
    try:
        one = fit(record)
        took = time.process_time()
        advice = remedies(one)
    except FitError as fault:
        return found | {"refused": str(fault)}
    found |= {"fit_s": took - began, "remedy_s": time.process_time() - took, "sticks": one.sticks, "gain": one.gain}
    found["kind"] = one.best.integrating
    K = plant.K
    tau = plant.tau if not plant.integrating else math.nan
    for key, true in (("S", plant.S), ("J", plant.J), ("K", K), ("KJ", K * plant.J), ("tau", tau)):
        if one.sticks and plant.S > 0.0 and one.best.integrating == plant.integrating and math.isfinite(true):
            size = getattr(one, key)
            found[key] = [size.value, size.low, size.high, true]
    if plant.S > 0.0 and one.sticks:
        found |= _judged(plant, advice)
    return found


def _judged(plant: Plant, advice: Advice) -> dict[str, Any]:
    sd, travel = plant.measured()
    true = {}
    for one in advice.tried:
        own = plant.measured(one.outcome.setting)
        true[one.name] = (own[0], own[0] / sd + TRAVEL * own[1] / travel)
    true_sd = [*(true[one.name][0] for one in advice.tried), sd]
    ratios = [
        [*(float(x) for x in np.percentile(one.outcome.pv_sd, [50.0, 5.0, 95.0])), own]
        for one, own in zip((*advice.tried, advice.none), true_sd, strict=True)
    ]
    now = {name: value for name, value in true.items() if not advice[name].at_shutdown}
    best = min(now, key=lambda name: now[name][1])
    chosen = advice.until_shutdown
    score = 1.0 + TRAVEL if chosen is None else now[chosen][1]
    return {
        "sd": ratios, "names": [one.name for one in advice.tried] + ["none"], "chosen": chosen, "best": best,
        "picked": score <= 1.05 * min(now[best][1], 1.0 + TRAVEL),
        "harm": chosen is not None and now[chosen][0] > sd, "true": {k: v[0] / sd for k, v in true.items()},
    }  # fmt: skip


def summary(rows: Sequence[dict[str, Any]]) -> list[str]:
    """The table of all loops."""
    told = [r for r in rows if "refused" not in r]
    sticky = [r for r in told if r["law"] != "sound"]
    sound = [r for r in told if r["law"] == "sound"]
    seen = [r for r in sticky if r["sticks"]]
    lines = [
        f"loops {len(rows)}, refused {len(rows) - len(told)}",
        f"sticky loops in which stick is seen: {len(seen)} of {len(sticky)}; sound ones accused: "
        f"{sum(r['sticks'] for r in sound)} of {len(sound)}",
        f"kind of process right: {sum(r['kind'] == r['integrating'] for r in seen)} of {len(seen)}",
    ]
    for key in ("S", "J", "K", "KJ", "tau"):
        own = np.array([[math.nan if x is None else x for x in r[key]] for r in seen if key in r])
        if len(own):
            given = own[np.isfinite(own[:, 0])]
            error = np.abs(given[:, 0] / given[:, 3] - 1.0)
            holds = np.mean((own[:, 1] <= own[:, 3]) & (own[:, 3] <= own[:, 2]))
            lines.append(
                f"{key}: median error {100 * np.median(error):.0f} % of {len(given)} told; the 90 % interval holds "
                f"{100 * holds:.0f} % of {len(own)}"
            )
    pairs = np.array([pair for r in seen for pair in r.get("sd", [])])
    if len(pairs):
        error = np.abs(pairs[:, 0] / pairs[:, 3] - 1.0)
        holds = np.mean((pairs[:, 1] <= pairs[:, 3]) & (pairs[:, 3] <= pairs[:, 2]))
        lines.append(
            f"predicted sd: median error {100 * np.median(error):.0f} %; the interval holds {100 * holds:.0f} %"
        )
        judged = [r for r in seen if "picked" in r]
        lines.append(f"best remedy picked: {sum(r['picked'] for r in judged)} of {len(judged)}")
        chosen = [r for r in judged if r["chosen"]]
        lines.append(f"recommended: {len(chosen)}; though worse than none: {sum(r['harm'] for r in chosen)}")
    lines.append(
        f"processor time, median: fit {np.median([r['fit_s'] for r in told]):.1f} s (most "
        f"{max(r['fit_s'] for r in told):.1f}), remedies {np.median([r['remedy_s'] for r in told]):.1f} s"
    )
    return lines


def main() -> None:
    """Run the loops and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--loops", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--quick", action="store_true", help="five loops")
    parser.add_argument("--json", type=Path, help="write the rows here")
    given = parser.parse_args()
    rows = []
    for seed in range(given.first, given.first + (5 if given.quick else given.loops)):
        rows.append(row(seed))
        if given.json:
            given.json.write_text(json.dumps(rows))
    print("\n".join(summary(rows)))


if __name__ == "__main__":
    main()
