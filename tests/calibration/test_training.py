"""The calibration on made-up tables whose answer is known, and the figures by hand."""

import numpy as np
import pytest
from stickslip.calibration import CAUSES
from stickslip.calibration.records import Table
from stickslip.calibration.scoring import auc, calibration_error, score
from stickslip.detect.judge.actions import CAUSES as SPOKEN

FEATURES = ("d", "network_sticky", "travel_gain", "travel_bent", "travel_between", "travel_turned",
            "travel_rows", "a", "b", "c", "tell", "network_S", "network_J", "other")  # fmt: skip


def made(n, seed):
    """Loops whose feature "tell" says stiction with noise of 1, the network ln S and ln J over OP's travel."""
    rng = np.random.default_rng(seed)
    sticky = rng.random(n) < 0.5
    cause = np.where(sticky, "stiction", np.where(rng.random(n) < 0.5, "healthy", "tight_tuning"))
    x = rng.normal(size=(n, len(FEATURES)))
    x[:, 10] = 2.5 * sticky + rng.normal(size=n)
    share = np.exp(rng.uniform(-1.5, -0.2, n))
    x[:, 11] = np.log(share) + 0.05 * rng.normal(size=n)
    x[:, 12] = np.log(0.5 * share) + 0.05 * rng.normal(size=n)
    x[:, 13] = (cause == "tight_tuning") + 0.3 * rng.normal(size=n)
    x[rng.random(n) < 0.02] = np.nan
    unit = np.where(np.isnan(x).all(axis=1), np.nan, 10.0)
    S = np.where(sticky, 10 * share, np.nan)
    truth = {"cause": cause, "group": cause, "S": S, "J": 0.5 * S, "process": np.full(n, "self_regulating"),
             "cycling": sticky, "travel": 1 / share, "op_range": np.full(n, 10.0)}  # fmt: skip
    return Table(np.array(FEATURES), x, unit, truth)


@pytest.fixture(scope="module")
def model():
    pytest.importorskip("sklearn", reason="scikit-learn (extra calibration) is not installed")
    from stickslip.calibration.training import fit

    return fit(made(1200, 0), made(800, 1), say=lambda text: None, trees=120)


def test_what_is_known_is_found_again(model):
    found = score(model, made(2000, 2))
    # analytic: two Gaussians 2.5 apart have the AUC Phi(2.5 / sqrt 2) = 0.961; 2 % of the records show nothing
    assert found["auc"] == pytest.approx(0.95, abs=0.02)
    assert found["false_alarm"] < 0.035 and found["calibration_error"] < 0.04
    assert found["s_error"] < 0.12 and found["j_error"] < 0.12  # the size is told with an error of 5 %
    assert 0.85 < found["s_inside"] < 0.97  # intervals of 90 %
    assert found["by_group"]["healthy"]["loops"] + found["by_group"]["tight_tuning"]["loops"] > 900
    x = made(500, 3)
    p, others = model.probabilities(x.x[x.seen])
    assert p + others.sum(axis=1) == pytest.approx(np.ones(len(p)))


def test_it_is_kept_and_read_the_same(model, tmp_path):
    file = tmp_path / "model.npz"
    model.write(file)
    rows = made(50, 4)
    again, x = type(model).read(file), rows.x[rows.seen]
    assert np.array_equal(again.probabilities(x)[0], model.probabilities(x)[0])
    assert np.array_equal(again.sizes(x, "J"), model.sizes(x, "J"))
    assert (again.accuse, again.clear, again.about) == (model.accuse, model.clear, model.about)


def test_tables_of_other_features_are_refused():
    pytest.importorskip("sklearn", reason="scikit-learn (extra calibration) is not installed")
    from stickslip.calibration.training import fit

    one, two = made(20, 0), made(20, 1)
    with pytest.raises(ValueError, match="different features"):
        fit(one, Table(two.names[::-1], two.x, two.unit, two.truth))


def test_figures_by_hand():
    sticky = np.array([True, True, False, False])
    assert auc(np.array([0.9, 0.8, 0.2, 0.1]), sticky) == 1.0  # analytic
    assert auc(np.array([0.9, 0.1, 0.8, 0.2]), sticky) == 0.5  # analytic: 2 of 4 pairs
    assert calibration_error(np.array([1.0, 1.0, 0.0, 0.0]), sticky) == 0.0
    assert calibration_error(np.full(4, 0.9), sticky) == pytest.approx(0.4)  # analytic: |0.5 - 0.9|


def test_every_cause_has_its_words():
    assert set(SPOKEN) == set(CAUSES)
