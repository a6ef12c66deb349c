"""Least squares without negative weights: the conditions of Karush, Kuhn and Tucker, and SciPy's answer."""

import numpy as np
import pytest
from stickslip.detect.stem.nonnegative import nonnegative


@pytest.mark.parametrize("seed", range(20))
def test_the_conditions_hold_and_scipy_agrees(seed):
    from scipy.optimize import nnls

    rng = np.random.default_rng(seed)
    columns = np.cumsum(rng.normal(size=(120, 1 + seed)), axis=0) + 20.0 * rng.normal(size=(120, 1))
    y = columns @ np.where(rng.random(1 + seed) < 0.5, rng.normal(size=1 + seed), 0.0) + rng.normal(size=120)
    gram, product = columns.T @ columns, columns.T @ y
    weights = nonnegative(gram, product)
    slope = product - gram @ weights
    assert (weights >= 0.0).all() and slope.max() <= 1e-9 * np.abs(product).max()
    assert np.abs(weights * slope).max() <= 1e-9 * np.abs(product).max()  # analytic
    assert nonnegative(gram, product, rng.normal(size=1 + seed)) == pytest.approx(weights, rel=1e-9, abs=1e-12)
    assert weights == pytest.approx(nnls(columns, y)[0], rel=1e-6, abs=1e-9)


def test_nothing_is_found_of_nothing():
    assert nonnegative(np.eye(3), np.zeros(3)).tolist() == [0.0, 0.0, 0.0]
