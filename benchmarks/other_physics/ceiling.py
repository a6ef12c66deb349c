"""How many crossed loops could be found at all: the true stem, through the true process, against OP through the same.

    python -m benchmarks.other_physics.ceiling [--loops N] [--seed N]

    y = K g + line + noise,    g what the process makes of the stem or of OP, noise an autoregression

Stem, process and OP at every step of the simulation are known here, which no record shows.  A stick that gains little
even so can be found by nobody: the valve hardly slips, or noise and load hide what PV answers.
"""

import argparse
import math

import numpy as np
from stickslip.calibration.crossed.drawing import Drawn, draw
from stickslip.calibration.crossed.history import seen
from stickslip.calibration.crossed.loops import Numbers, run
from stickslip.calibration.crossed.tuning import tuned
from stickslip.logs.arrays import Values

ORDERS = (1, 2, 3, 5, 8, 12)  # of the noise
STEPS_MAX = 1_500_000  # of a simulation
NATS = (0.0, 3.0, 5.0, 10.0, 20.0)


def _lagged(x: Values, h: float, tau: float) -> Values:
    from scipy.signal import lfilter

    part = 1.0 - math.exp(-h / tau) if tau > 0.0 else 1.0
    return np.asarray(lfilter([part], [1.0, part - 1.0], x))


def _answer(n: Numbers, stem: Values) -> Values:
    """What the process and its transmitter make of a stem, at every step."""
    flow = n.K * stem * (1.0 + n.bend * stem / 100.0)
    x = _lagged(flow, n.h, n.tau_1) if n.tau_1 > 0.0 else np.cumsum(flow) * n.h
    late = max(int(n.theta / n.h), 0)
    return _lagged(_lagged(np.concatenate([np.zeros(late), x])[: len(x)], n.h, n.tau_2), n.h, n.filter)


def _explained(y: Values, g: Values | None) -> float:
    """The score of y by g, a line and noise, best over the orders [nats]."""
    n, most = len(y), max(ORDERS)
    X = np.column_stack([np.ones(n), np.linspace(-1.0, 1.0, n), *([] if g is None else [g])])
    scores = []
    for p in ORDERS:
        b = np.linalg.lstsq(X, y, rcond=None)[0]
        for _ in range(6):
            e = y - X @ b
            past = np.stack([e[most - i - 1 : n - i - 1] for i in range(p)], axis=1)
            a = np.linalg.lstsq(past, e[most:], rcond=None)[0]
            white = np.column_stack([y, X])[most:].copy()
            for i in range(p):
                white -= a[i] * np.column_stack([y, X])[most - i - 1 : n - i - 1]
            b = np.linalg.lstsq(white[:, 1:], white[:, 0], rcond=None)[0]
        left = float(np.mean((white[:, 0] - white[:, 1:] @ b) ** 2))
        scores.append(-0.5 * (n - most) * math.log(left) - 0.5 * p * math.log(n))
    return max(scores)


def gain(d: Drawn) -> float | None:
    """By how many nats the true stem tells PV better than OP or nothing; None where it takes too long to simulate."""
    made = tuned(d)
    n = made.numbers
    if n.steps > STEPS_MAX:
        return None
    out = np.zeros((4, n.steps))
    run(np.random.default_rng(d.seed), n, 1, out)
    rows = n.steps // made.every
    at = np.arange(0, n.steps, made.every)[:rows][min(20, rows // 10) :]
    y = seen(d).record.pv
    stuck, line = _answer(n, out[3])[at], _answer(n, _lagged(out[2], n.h, n.air))[at]
    return _explained(y, stuck) - max(_explained(y, line), _explained(y, None))


def main() -> int:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--loops", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    shown = [d for d in draw(asked.loops, asked.seed) if d.kind == "sticks" and seen(d).shows]
    gains = np.array([found for d in shown if (found := gain(d)) is not None])
    print(f"{len(gains)} of {len(shown)} loops that stick, turn four times and travel 0.8 S")
    for nats in NATS:
        print(f"the true stem gains more than {nats:g} nats in {np.mean(gains > nats):.0%}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
