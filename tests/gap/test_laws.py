"""Laws of a valve on an opening that is not quite known: against closed forms and random draws."""

import numpy as np
import pytest
from stickslip.gap.filters.laws import CURVED, SLOW, STOPS, blurred, through, within


def test_an_opening_that_is_known_goes_through_the_law_as_it_is():
    for law, a, b in ((STOPS, 0.1, 0.6), (CURVED, 4.0, 0.0), (SLOW, 0.02, 0.0)):
        mean, slope, more, end, loose = blurred(law, a, b, 0.63, 0.0, 0.6, 0.0)
        assert (mean, slope, end) == through(law, a, b, 0.63, 0.6)
        assert more == loose == 0.0


@pytest.mark.parametrize("far", [-2.0, -0.5, 0.0, 0.5, 2.0])
def test_a_stop_leaves_the_mean_of_what_it_lets_through(far):
    sd = 0.01  # analytic: mean and share of a normal law between limits; seven points are good to 5 % of sd at the kink
    mean, slope, more, _, _ = blurred(STOPS, -np.inf, 0.6, 0.6 + far * sd, sd, 0.0, 0.0)
    exact, share = within(0.6 + far * sd, sd, -1e3, 0.6)
    assert mean == pytest.approx(exact, abs=0.05 * sd)
    assert slope == pytest.approx(share, abs=0.1)
    assert 0.0 <= more < 0.2 * sd**2


def test_the_moments_of_a_slow_stem_are_those_of_many_draws():
    rng, sd, loose = np.random.default_rng(0), 0.004, 0.002**2
    told, held = 0.512 + sd * rng.normal(size=200_000), 0.5 + np.sqrt(loose) * rng.normal(size=200_000)
    drawn = np.array([through(SLOW, 0.01, 0.0, x, h) for x, h in zip(told, held, strict=True)])
    mean, slope, more, end, after = blurred(SLOW, 0.01, 0.0, 0.512, sd, 0.5, loose)
    assert mean == pytest.approx(drawn[:, 0].mean(), abs=0.05 * sd)
    assert end == pytest.approx(drawn[:, 2].mean(), abs=0.05 * sd)
    assert slope**2 * sd**2 + more == pytest.approx(drawn[:, 0].var(), rel=0.15)
    assert after + np.cov(drawn[:, 2], told)[0, 1] ** 2 / sd**2 == pytest.approx(drawn[:, 2].var(), rel=0.2)


def test_a_characteristic_keeps_its_slope_on_average():
    mean, slope, more, _, _ = blurred(CURVED, 9.0, 0.0, 0.5, 0.02, 0.0, 0.0)  # analytic: E[9^x] of a normal x
    wide = np.exp(0.5 * (np.log(9.0) * 0.02) ** 2)
    assert mean == pytest.approx((9.0**0.5 * wide - 1.0) / 8.0, abs=1e-9)
    assert slope == pytest.approx(9.0**0.5 * np.log(9.0) * wide / 8.0, abs=1e-9)
    assert more == pytest.approx(0.0, abs=1e-6)
