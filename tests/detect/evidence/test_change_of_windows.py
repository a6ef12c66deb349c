"""A valve is said to have changed where a constant one shows such a trend in at most one record of a hundred."""

from types import SimpleNamespace

import numpy as np
import pytest
from stickslip.detect.evidence.windows import FALSE_ALARMS_SHARE, OverTime, Window
from stickslip.detect.judge.answer import Amount

DRAWS = 2000


def said(sizes, half=0.05):
    windows = tuple(
        Window(float(k), k + 1.0, 500, "stiction", 0.99, Amount(float(S), float(S) - half, float(S) + half, "%"))
        for k, S in enumerate(sizes)
    )
    return OverTime(windows, "", SimpleNamespace()).words


@pytest.mark.parametrize("n", [6, 12])
def test_a_constant_valve_rarely_changes(n):  # analytic: at most the stated rate, 3 standard errors above it
    random = np.random.default_rng(5)
    alarms = sum("has changed" in said(6.3 + 0.2 * random.normal(size=n)) for _ in range(DRAWS))
    assert alarms / DRAWS <= FALSE_ALARMS_SHARE + 3.0 * np.sqrt(FALSE_ALARMS_SHARE / DRAWS)


def test_a_growing_valve_is_seen():  # snapshot of the power: S doubles over 12 windows, each 0.2 off
    random = np.random.default_rng(6)
    seen = sum("has changed" in said(np.linspace(3, 6, 12) + 0.2 * random.normal(size=12)) for _ in range(200))
    assert seen >= 198


def test_intervals_that_do_not_overlap_are_no_trend():
    assert "has changed" not in said([6.3, 6.1, 6.4, 6.2, 6.4, 6.3], half=0.01)


def test_few_windows_are_not_tested():
    assert "tested from 6" in said([3.0, 4.0, 5.0])
