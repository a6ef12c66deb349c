"""The trees in plain numpy say what the library says that fitted them."""

import numpy as np
import pytest
from stickslip.detect.judge.trees import Trees


@pytest.fixture(scope="module")
def data():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(400, 6))
    x[rng.random(x.shape) < 0.1] = np.nan
    y = np.nan_to_num(x[:, 0]) + np.nan_to_num(x[:, 1]) ** 2 + 0.1 * rng.normal(size=400)
    return x, y


def test_equal_to_the_library(data, tmp_path):
    pytest.importorskip("sklearn", reason="scikit-learn (extra calibration) is not installed")
    from stickslip.calibration.boosting import classifier, filled, quantile, start, taken

    x, y = data
    binary = classifier(x, y > 1, 30, 8, seed=0)
    several = classifier(x, np.digitize(y, [0.0, 1.0, 2.0]), 10, 6, seed=0)
    median = quantile(x, y, 0.5, 20, 8, seed=0)
    for model, raw in (
        (binary, binary.decision_function(filled(x))[:, None]),
        (several, several.decision_function(filled(x))),
        (median, median.predict(filled(x))[:, None]),
    ):
        trees = taken(model, start(model, x))
        assert trees(x) == pytest.approx(raw, abs=2e-6)  # values are kept in single precision
        file = tmp_path / "trees.npz"
        np.savez(file, **trees.arrays())
        with np.load(file) as kept:
            assert np.array_equal(Trees.read(kept)(x), trees(x))


def test_a_tree_by_hand():
    # x[0] <= 0 ? 1 : (x[1] <= 5 ? 2 : 3), and half of that from a second tree of one leaf
    trees = Trees(
        base=np.array([10.0]), root=np.array([0, 5]), output=np.array([0, 0]), feature=np.array([0, 0, 1, 0, 0, 0]),
        threshold=np.float32([0, 0, 5, 0, 0, 0]), value=np.float32([0, 1, 0, 2, 3, 0.5]),
        left=np.array([1, 0, 1, 0, 0, 0]), right=np.array([2, 0, 2, 0, 0, 0]),
    )  # fmt: skip
    x = np.array([[-1.0, 9.0], [1.0, 5.0], [1.0, 5.1], [np.nan, 9.0], [1.0, np.nan]])
    assert trees(x)[:, 0].tolist() == [11.5, 12.5, 13.5, 11.5, 12.5]
