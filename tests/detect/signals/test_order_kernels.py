"""Compiled places on a clock and medians; expected numbers: numpy's."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from stickslip.detect.signals.order_kernels import count_before, count_until, median, median_step

NUMBERS = st.lists(st.sampled_from([0.0, 0.5, 1.0, 1.5, 7.0, -3.25]), min_size=1, max_size=40)


@given(NUMBERS, st.floats(-4.0, 8.0) | st.sampled_from([0.5, 1.0]))
def test_places_on_a_clock(numbers: list[float], when: float) -> None:
    t = np.sort(numbers)
    assert count_before(t, when) == np.searchsorted(t, when)
    assert count_until(t, when) == np.searchsorted(t, when, side="right")


@given(NUMBERS)
def test_medians(numbers: list[float]) -> None:
    x = np.array(numbers)
    assert median(x.copy()) == np.median(x)
    if len(x) > 1:
        assert median_step(x) == np.median(np.diff(x))


def test_the_median_of_many() -> None:
    for n in (1_000, 1_001):
        x = np.random.default_rng(n).normal(size=n)
        assert median(x.copy()) == np.median(x)
