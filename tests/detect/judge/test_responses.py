"""The compiled bank of lags and dead times against one built from scipy's filters and least squares."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.judge.features.play import BANK, DELAYS, INTEGRATOR, responses


def left(x: np.ndarray, y: np.ndarray, turn: float, settle: int) -> tuple[float, int]:
    """Least sum of squares of y (m,) less b G(q) x + c + d t with b >= 0, and the number of its G; oracle."""
    m, centred = len(x), x - x[0]
    kinds = [*BANK, *((math.inf, 0, delay) for delay in DELAYS)]
    best = (math.inf, -1)
    load = np.column_stack([np.ones(m - settle), np.linspace(-1.0, 1.0, m - settle)])
    for number, (lag, order, delay) in enumerate(kinds):
        z = np.cumsum(centred - centred.mean()) if number >= INTEGRATOR else centred
        for _ in range(order if 0.0 < lag < math.inf else 0):
            a = math.exp(-1.0 / max(lag * turn, 0.05))
            z = lfilter([1.0 - a], [1.0, -a], z)
        d = min(round(delay * turn), settle)
        table = np.column_stack([load, z[settle - d : m - d]])
        fitted = np.linalg.lstsq(table, y[settle:], rcond=None)[0]
        if fitted[2] < 0.0:
            fitted = np.append(np.linalg.lstsq(load, y[settle:], rcond=None)[0], 0.0)
        loss = float(np.sum((y[settle:] - table @ fitted) ** 2))
        best = min(best, (loss, number), key=lambda one: one[0])
    return best


@pytest.mark.parametrize("turn", [4.0, 12.0, 40.0])
def test_losses_are_those_of_least_squares(turn):
    r = np.random.default_rng(5)
    m, s, c = 160, 2, 5
    x = np.cumsum(r.normal(size=(m, s, c)), axis=0)
    y = np.array(
        [lfilter([0.2], [1.0, -0.8], x[:, k, k]) + 0.3 * r.normal(size=m) + 0.01 * np.arange(m) for k in range(s)]
    )
    loss, which, tss = responses(x.astype(np.float32), y.astype(np.float32), turn)
    settle = min(round(turn), m // 4)
    for i in range(s):
        for j in range(c):
            expected, number = left(x[:, i, j], y[i], turn, settle)
            assert loss[i, j] == pytest.approx(expected, rel=2e-3, abs=2e-4 * tss[i])
            if loss[i, j] < 0.5 * tss[i]:
                assert which[i, j] == number
