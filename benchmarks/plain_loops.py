"""The verdict on loops of plain recursions, half of them sticky: no block, no engine, no simulator of the calibration.

    python -m benchmarks.plain_loops [--quick] [--json FILE]

Flows, pressures, temperatures and levels under a PI of plain steps, with six kinds of load and three of set point.
Three stems stick: one slips to a distance from OP (He), one by the way from its last stop (Kano), one creeps.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from stickslip.detect import Diagnosis, diagnose
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

from benchmarks.report import Figures, options, publish

LOOPS, QUICK, FIRST = 1000, 20, 95_000  # and the first seed
KINDS = {"flow": (2.0, 8.0, 0.5), "pressure": (5.0, 30.0, 0.5), "temperature": (60.0, 300.0, 2.0)}  # lags, scan [s]
LOADS = ("none", "autoregressive", "sine", "triangle", "steps", "walk")
LEVEL_SCAN, LEVEL_GAIN, LEVEL_DEAD = 1.0, 0.005, 2.0  # s, 1/s, s
FALSE = 0.02  # share of the sound loops at which what is found is counted

NOTES = {
    "auc": "sticky loops against sound ones, by the probability",
    "found": f"share of the sticky loops that are found at {100.0 * FALSE:g} % false alarms",
    "called": "share of the sticky loops that are called",
    "accused": "share of the sound loops that are called",
    "accused_triangle": "the same of those whose load is a triangle",
    "cleared": "share of the sticky loops that are cleared of their own S (required: at most 0.005)",
    "S_error": "median of |found / true - 1| of S where called",
}


@dataclass(frozen=True)
class Plain:
    """A record, its S [% of OP], 0 of a sound valve, and its load."""

    record: LoopRecord
    S: float
    load: str


def plain_loop(seed: int) -> Plain:
    """Return the loop of a seed; those of even seeds stick."""
    rng = np.random.default_rng(seed)
    kind = str(rng.choice([*KINDS, "level"]))
    low, high, scan = KINDS.get(kind, (1.0, 1.0, LEVEL_SCAN))
    tau, level = float(rng.uniform(low, high)), kind == "level"
    dead = LEVEL_DEAD if level else float(rng.uniform(0.1, 0.6)) * tau
    K = float(np.exp(rng.uniform(-1.0, 1.0))) * (LEVEL_GAIN if level else 1.0)
    wanted = float(rng.uniform(30.0, 120.0)) if level else float(rng.uniform(0.6, 3.0)) * (tau + dead)
    K_p = 2.0 / (K * wanted) if level else tau / (K * (wanted + dead))
    T_i = 2.0 * wanted if level else tau * float(rng.uniform(0.6, 1.2))
    S = float(rng.uniform(0.6, 6.0)) if seed % 2 == 0 else 0.0
    stem = _stem(str(rng.choice(["slips", "steps", "creeps"])), S, S * float(rng.uniform(0.1, 0.6)), scan)
    every, name = int(rng.choice([1, 1, 2, 4])), str(rng.choice(LOADS))
    slow = 20.0 if level else tau + dead
    n = int(rng.choice([1500, 3000, 5000])) * every
    load = _load(name, n, scan, slow, rng)
    noise = 10.0 ** rng.uniform(-2.0, -0.5) * float(np.ptp(load) + 1.0) * (0.2 if level else 0.1 * K)
    log = _run(n, scan, K_p, T_i, (K, tau, level, dead), stem, load, noise, _set_point(n, scan, slow, rng), rng)
    log = log[::every]
    step = float(rng.choice([0.0, 0.01, 0.05]))  # to which the log is rounded
    sp, pv, op = (np.round(log / step) * step if step else log).T
    tag = {"flow": "FIC", "pressure": "PIC", "temperature": "TIC", "level": "LIC"}[kind]
    t = scan * every * np.arange(len(log))
    return Plain(LoopRecord.from_arrays(t, pv=pv, op=op, sp=sp, op_span=(0, 100), name=f"{tag}{seed}"), S, name)


def _load(name: str, n: int, scan: float, slow: float, rng: np.random.Generator) -> Values:
    """A load at the input of the process [% of OP]."""
    size, phase = float(rng.uniform(1.0, 6.0)), 2.0 * np.pi * scan * np.arange(n) / (slow * float(rng.uniform(8, 40)))
    white, kept = rng.standard_normal(n), float(np.exp(-scan / (3.0 * slow)))
    if name == "sine":
        return size * np.sin(phase)
    if name == "triangle":
        return size * 2.0 / np.pi * np.arcsin(np.sin(phase))
    if name == "walk":
        return np.cumsum(0.02 * size * np.sqrt(scan / slow) * white)
    if name == "steps":
        ahead = rng.random(n) < scan / (40.0 * slow)
        return np.asarray(
            np.concatenate([[0.0], size * white])[np.maximum.accumulate(np.where(ahead, np.arange(n), 0))]
        )
    out = np.zeros(n)
    for k in range(1, n if name == "autoregressive" else 0):
        out[k] = kept * out[k - 1] + 0.3 * size * np.sqrt(1.0 - kept**2) * white[k]
    return out


def _set_point(n: int, scan: float, slow: float, rng: np.random.Generator) -> Values:
    """A set point [% of PV] that stands, steps or wanders."""
    kind, out = int(rng.integers(3)), np.full(n, 50.0)
    for k in range(1, n if kind else 0):
        if kind == 1:
            out[k] = 50.0 + float(rng.uniform(-4.0, 4.0)) if rng.random() < scan / (25.0 * slow) else out[k - 1]
        else:
            out[k] = out[k - 1] - 0.01 * (out[k - 1] - 50.0) * scan / slow
            out[k] += 0.15 * np.sqrt(scan / slow) * rng.standard_normal()
    return out


def _stem(law: str, S: float, J: float, scan: float) -> Callable[[float, float], float]:
    """Where a stem goes from x at an output u, [% of OP]; a sound one follows with a lag of 0.7 s."""
    stopped = [50.0]

    def sound(u: float, x: float) -> float:
        return x + (u - x) * min(1.0, scan / 0.7)

    def slips(u: float, x: float) -> float:
        return x if abs(u - x) <= 0.5 * (S + J) else u - float(np.sign(u - x)) * 0.5 * (S - J)

    def steps(u: float, x: float) -> float:
        way = float(np.sign(u - stopped[0]))
        if abs(u - stopped[0]) <= S:
            return x
        stopped[0] = u - way * (S - J)
        return u - way * 0.5 * (S - J)

    def creeps(u: float, x: float) -> float:
        pull = 2.0 * (u - x) / S
        jump = 0.5 * J * float(np.sign(pull)) if abs(pull) > 1.25 else 0.0
        return x + jump + float(np.sign(pull)) * max(abs(pull) - 1.0, 0.0) * 0.5 * S * min(1.0, scan / 0.6)

    return {"slips": slips, "steps": steps, "creeps": creeps}[law] if S else sound


def _run(
    n: int, scan: float, K_p: float, T_i: float, process: tuple[float, float, bool, float],
    stem: Callable[[float, float], float], load: Values, noise: float, sp: Values, rng: np.random.Generator,
) -> Values:  # fmt: skip
    """SP, PV and OP (n, 3) of the loop."""
    K, tau, level, dead = process
    x, y, total, late = 50.0, 0.0, 50.0, [0.0] * max(int(dead / scan), 1)
    out = np.empty((n, 3))
    for k, white in enumerate(rng.standard_normal(n)):
        pv = 50.0 + y + noise * white
        e = sp[k] - pv
        u = min(max(total + K_p * (scan / T_i + 1.0) * e, 0.0), 100.0)
        total = u - K_p * e
        x = stem(u, x)
        late.append(x - 50.0 + load[k])
        z = late.pop(0)
        y += K * z * scan if level else (K * z - y) * scan / tau
        out[k] = sp[k], pv, u
    return out


def judged(seed: int) -> tuple[Plain, Diagnosis]:
    """Return the loop of a seed and the verdict on it."""
    one = plain_loop(seed)
    return one, diagnose(one.record, [])


def figures(found: list[tuple[Plain, Diagnosis]]) -> Figures:
    """Return the figures of verdicts; one that was refused has even odds."""
    p = np.array([0.5 if said.probability is None else said.probability for _, said in found])
    sticky, word = np.array([one.S > 0.0 for one, _ in found]), np.array([said.verdict for _, said in found])
    triangle = np.array([one.load == "triangle" for one, _ in found])
    more = p[sticky][:, None] - p[~sticky]
    limits = [
        (said.detection_limit or (0.0, ""))[0] - one.S
        for one, said in found
        if said.verdict == "no_stiction" and one.S > 0.0
    ]
    error = [abs(said.amount["S"].value / one.S - 1.0) for one, said in found if one.S > 0.0 and said.amount]
    return {
        "auc": float(np.mean(more > 0.0) + 0.5 * np.mean(more == 0.0)),
        "found": float(np.mean(p[sticky] > np.quantile(p[~sticky], 1.0 - FALSE))),
        "called": float(np.mean(word[sticky] == "stiction")),
        "accused": float(np.mean(word[~sticky] == "stiction")),
        "accused_triangle": float(np.mean(word[~sticky & triangle] == "stiction")),
        "cleared": float(np.sum(np.array(limits) <= 0.0) / np.sum(sticky)),
        "S_error": float(np.median(error)) if error else None,
    }  # fmt: skip


def main() -> int:
    """Judge and print; 1 if a requirement is missed."""
    asked = options(__doc__.splitlines()[0])
    count = QUICK if asked.quick else LOOPS
    found = [judged(seed) for seed in range(FIRST, FIRST + count)]
    return 0 if publish(figures(found), NOTES, asked.json, asked.quick) else 1


if __name__ == "__main__":
    raise SystemExit(main())
