"""What white innovations leave: each figure is a normal number, also where few rows hold all of its weight."""

from types import SimpleNamespace

import numpy as np
from stickslip.gap.likelihood.checks import checks
from stickslip.logs import Log

ROWS, TRIALS = 800, 600


def test_figures_of_white_innovations_are_normal_though_a_set_point_switches_only_twice():
    # analytic: |normal| is below 2.58 in 99 of 100; sums of a few squares are above 3.2 in one of 100
    rng = np.random.default_rng(20261127)
    t = 5.0 * np.arange(ROWS)
    SP = np.select([t < 1800.0, t < 3000.0], [7.0, 6.2], 7.3)
    PV, OP = SP + 0.01 * np.cumsum(rng.normal(size=ROWS)), np.convolve(rng.normal(size=ROWS), np.ones(9), "same")
    record = SimpleNamespace(log=Log(t, {"SP": SP, "PV": PV, "OP": OP}), played=("SP",))
    explanation = SimpleNamespace(
        filtering=SimpleNamespace(
            signals=("PV", "OP"), record=record, skipped=1, computed=np.zeros(2), r=np.zeros((ROWS, 2))
        )
    )
    S = np.ones((ROWS - 1, 2))
    each = [
        checks(SimpleNamespace(explanation=explanation, judged=rng.normal(size=S.shape), S=S)) for _ in range(TRIALS)
    ]
    rare = {name: float(np.quantile([abs(one[name]) for one in each], 0.99)) for name in each[0]}
    assert max(rare.values()) < 3.0, max(rare, key=lambda name: rare[name])
    assert np.mean(list(rare.values())) > 2.4  # they tell as much as normal ones
