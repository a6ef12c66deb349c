"""The bound on steps that the values of functions of the time tell, against functions whose scale is known."""

import numpy as np
import pytest
from stickslip.engine.probing import longest


def twice(f):  # type: ignore[no-untyped-def]
    """The same function at both points."""
    return lambda t: np.column_stack([f(t), f(t)])


@pytest.mark.parametrize("period", [1e-5, 3e-4, 0.07, 1.0, 9.0, 40.0])
@pytest.mark.parametrize("t0", [0.0, -50.0, 1e5])
def test_a_sine_gets_a_twenty_fourth_to_a_fiftieth_of_its_period(period: float, t0: float) -> None:
    step, guessed = longest(twice(lambda t: 5.0 + 1e-3 * np.sin(2.0 * np.pi * t / period)), t0, t0 + 100.0)
    assert 24.0 < period / step < 51.0 and not guessed  # analytic: the bend is 2 sin^2(pi d / period) / 2 of the range


def test_straight_lines_and_constants_have_no_bound() -> None:
    for f in (lambda t: 3.0 + 0.0 * t, lambda t: 1e9 - 7.0 * t, lambda t: 0.0 * t):
        assert longest(twice(f), 0.0, 100.0) == (np.inf, False)


def test_what_changes_within_any_interval_is_guessed() -> None:
    assert longest(twice(lambda t: np.sin(1e12 * t)), 0.0, 100.0) == (0.1, True)
    assert longest(twice(lambda t: np.nan * t), 0.0, 100.0) == (0.1, True)


def test_one_point_that_gives_numbers_is_enough() -> None:
    def half(t):  # type: ignore[no-untyped-def]
        return np.column_stack([np.nan * t, np.sin(2.0 * np.pi * t)])

    step, guessed = longest(half, 0.0, 100.0)
    assert 24.0 < 1.0 / step < 51.0 and not guessed


def test_it_never_looks_beyond_the_run() -> None:
    seen = []

    def f(t):  # type: ignore[no-untyped-def]
        seen.extend(t.tolist())
        return np.column_stack([np.exp(-t), np.sqrt(t)])

    longest(f, 0.0, 10.0)
    assert min(seen) >= 0.0 and max(seen) <= 10.0
