"""PRBS: the published properties of maximum-length sequences, exact instants, few steps."""

import math

import numpy as np
import pytest
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.ports import BlockError
from stickslip.blocks.prbs import PRBS
from stickslip.diagram import simulate, wire


@pytest.mark.parametrize("order", [2, 3, 7, 10])
def test_properties_of_a_sequence_of_maximum_length(order):
    n = 2**order - 1
    signal = PRBS("u", 1.0, 0.3, order=order)
    bits = np.array([float(signal.output(0.3 * k, [], [])[0]) for k in range(2 * n)])
    assert np.array_equal(bits[:n], bits[n:])  # repeats
    assert abs(bits[:n].sum()) == 1.0  # published: one bit more of one kind
    correlation = [np.dot(bits[:n], np.roll(bits[:n], lag)) for lag in range(n)]
    assert correlation[0] == n and set(correlation[1:]) == {-1.0}  # published: N, else -1


def test_compiled_it_changes_where_it_should_and_nowhere_else():
    run = simulate(wire([PRBS("u", 0.05, 0.7, order=5, mean=0.5, start=2.0)], outputs=["u"]), 60.0, every=0.1)
    k = np.floor((run.log.t - 2.0) / 0.7 + 1e-9).astype(int)
    signal = PRBS("u", 0.05, 1.0, order=5, mean=0.5)
    expected = [0.5 if i < 0 else float(signal.output(float(i), [], [])[0]) for i in k]
    np.testing.assert_array_equal(run.log["u"], expected)


def test_a_process_behind_it_is_exact():
    dt, tau = 2.0, 5.0
    run = simulate(wire([PRBS("MV", 1.0, dt, order=4), FirstOrder(3.0, tau)]), 60.0, every=dt, rtol=1e-10, atol=1e-12)
    PV, a = [0.0], math.exp(-dt / tau)
    for u in run.log["MV"][:-1]:
        PV.append(a * PV[-1] + (1 - a) * 3.0 * u)  # analytic: a lag behind a held input
    np.testing.assert_allclose(run.log["PV"], PV, atol=1e-8)
    assert simulate(wire([PRBS("MV", 1.0, dt, order=4), FirstOrder(3.0, tau)]), 600.0).statistics.steps < 300 * 12


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PRBS("u", 1.0, 0.0), "dt = 0.0, but it must be positive"),
        (lambda: PRBS("u", 1.0, 1.0, order=1), "order = 1, but it is a whole number from 2 to 15"),
        (lambda: PRBS("u", 1.0, 1.0, order=3.5), "order = 3.5"),
        (lambda: PRBS("u", math.nan, 1.0), "amplitude = nan"),
        (lambda: PRBS("u", 1.0, 1.0).with_params(n=3), "n = 3, but it is the length"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()
