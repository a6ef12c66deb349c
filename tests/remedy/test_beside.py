"""Noise, load and level of two times, by blocks: named where they change, and not where another one does."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.remedy.changing import _fine, _level, _slow, _spread

N = 4000
STILL = [[np.zeros(N)], [np.zeros(N)]]  # answers to a stem that stands: what is left is all that PV does


def left(load=1.0, noise=0.1, off=0.0, seed=1):
    """A load that wanders, memory 50 rows, behind a lag of 10, with white noise, about a level."""
    rng = np.random.default_rng(seed)
    wander = lfilter([0.1], [1.0, -0.9], lfilter([0.2], [1.0, -0.98], rng.normal(size=N)))
    return [off + load * wander + noise * rng.normal(size=N)]


def named(earlier, later):
    lefts = [earlier, later]
    fine = [_fine(one) for one in lefts]
    slow = _slow(lefts, STILL, [float(np.mean(one)) for one in fine])
    level = _level("sensor_drift", lefts, "K", (), 0.0)
    found = (_spread("sensor_noise", fine, "K"), _spread("disturbance", slow, "K"), level)
    return [one.effect for one in found if one.changed]


CHANGES = {"disturbance": {"load": 3.0}, "sensor_noise": {"noise": 0.3}, "sensor_drift": {"off": 6.0}}


@pytest.mark.parametrize("effect", CHANGES)
def test_what_changes_is_named_alone(effect):
    change = CHANGES[effect]
    assert named(left(), left(seed=2, **change)) == [effect]
    assert named(left(seed=2, **change), left()) == [effect]


def test_nothing_is_named_where_load_and_noise_are_drawn_anew():
    assert not any(named(left(seed=seed), left(seed=seed + 100)) for seed in range(20))


def test_a_load_that_goes_with_the_gain_has_not_changed():
    slow = _slow([left(), left(load=0.4, seed=2)], STILL, [0.01, 0.01])
    assert _spread("disturbance", slow, "K").changed
    assert not _spread("disturbance", slow, "K", np.log(0.4)).changed  # the gain is 0.4 of what it was


def test_behind_an_integrator_a_load_that_stays_is_no_larger_load():
    ramp = [np.linspace(0.0, 900.0, N) + left(seed=2)[0]]  # a load of one size, which the integrator adds up
    assert _spread("disturbance", _slow([left(), ramp], STILL, [0.01, 0.01]), "K").changed
    assert not _spread("disturbance", _slow([left(), ramp], STILL, [0.01, 0.01], 2), "K").changed


def test_a_drift_does_not_count_against_itself():
    ramp = [left(seed=2)[0] + np.linspace(0.0, 16.0, N)]
    assert named(left(), ramp) == ["sensor_drift"]
