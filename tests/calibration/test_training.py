"""The calibration on made-up tables whose answer is known, and the figures by hand."""

import numpy as np
import pytest
from stickslip.calibration import CAUSES
from stickslip.calibration.drawing import OTHERS
from stickslip.calibration.records import Table
from stickslip.calibration.scoring import auc, calibration_error, estimates, opinions, score
from stickslip.calibration.training import fit
from stickslip.detect.judge.actions import CAUSES as SPOKEN

FEATURES = ("network_sticky", "dead_travel", "samples", "turns", "network_S", "network_J", "likely_S", "likely_share",
            *(f"network_{kind}" for kind in OTHERS))  # fmt: skip


def made(n, seed):
    """Loops whose feature "network_sticky" says stiction with noise of 1, and ln S and ln J over OP's travel."""
    rng = np.random.default_rng(seed)
    sticky = rng.random(n) < 0.5
    cause = np.where(sticky, "stiction", np.where(rng.random(n) < 0.5, "healthy", "tight_tuning"))
    x = rng.normal(size=(n, len(FEATURES)))
    x[:, 0] = 2.5 * sticky + rng.normal(size=n)
    share = np.exp(rng.uniform(-1.5, -0.2, n))
    x[:, 4] = np.log(share) + 0.05 * rng.normal(size=n)
    x[:, 5] = np.log(0.5 * share) + 0.05 * rng.normal(size=n)
    x[:, 6] = np.where(rng.random(n) < 0.5, x[:, 4], np.nan)
    x[:, FEATURES.index("network_tight_tuning")] = 9.0 * (cause == "tight_tuning")
    x[rng.random(n) < 0.02] = np.nan
    unit = np.where(np.isnan(x).all(axis=1), np.nan, 10.0)
    S = np.where(sticky, 10 * share, np.nan)
    truth = {"cause": cause, "group": cause, "S": S, "J": 0.5 * S, "process": np.full(n, "self_regulating"),
             "cycling": sticky, "travel": 1 / share, "op_range": np.full(n, 10.0)}  # fmt: skip
    return Table(np.array(FEATURES), x, unit, truth)


@pytest.fixture(scope="module")
def model():
    return fit(made(2000, 0), say=lambda text: None)


def test_what_is_known_is_found_again(model):
    table = made(2000, 2)
    found = score(model, table)
    # analytic: two Gaussians 2.5 apart have the AUC Phi(2.5 / sqrt 2) = 0.961; 2 % of the records show nothing
    assert found["auc"] == pytest.approx(0.95, abs=0.02)
    assert found["false_alarm"] < 0.035 and found["calibration_error"] < 0.04
    assert found["s_error"] < 0.12 and found["j_error"] < 0.12  # the size is told with an error of 5 %
    assert 0.85 < found["s_inside"] < 0.97  # intervals of 90 %
    assert found["by_group"]["healthy"]["loops"] + found["by_group"]["tight_tuning"]["loops"] > 900
    for one, cause in zip(opinions(model, table), table.truth["cause"].tolist(), strict=True):
        if one is not None:
            assert sum(one.causes.values()) == pytest.approx(1.0)
            assert cause != "tight_tuning" or max(set(one.causes) - {"stiction"}, key=one.causes.get) == cause


def test_the_line_is_that_of_its_gaussians(model):
    # analytic: log odds of two Gaussians 2.5 apart are 2.5 x - 3.125, and the evidence says nothing
    assert model.learnt == pytest.approx(2.5, abs=0.3) and model.base == pytest.approx(-3.125, abs=0.4)
    assert model.evidence == pytest.approx(0.0, abs=1.0)  # of gains below 3 nats: its standard error is 0.4


def test_learnt_odds_fall_back_as_a_record_leaves_what_was_learnt_and_the_evidence_stays(model):
    names = made(1, 0).names.tolist()
    near = dict.fromkeys(names, 0.0) | {"network_sticky": 4.0, "dead_travel": 20.0}
    near |= dict(zip(("samples", "turns", "network_S"), model.middle, strict=True))
    known, strange = model.judge(near), model.judge(near | {"samples": near["samples"] + 12.0})
    assert known.far == pytest.approx(0.0, abs=1e-9) and strange.far > 3.0
    learnt, evidence = (
        [model.shares(near | {"samples": near["samples"] + more})[name] for more in (0.0, 12.0)]
        for name in ("network_sticky", "dead_travel")
    )
    assert learnt[1] == pytest.approx(learnt[0] / strange.far) and evidence[1] == evidence[0]  # as the module says
    inside = model.far(made(2000, 4).x[:, [2, 3, 4]])
    assert np.mean(inside[np.isfinite(inside)] < 1.0) == pytest.approx(0.95, abs=0.02)  # analytic: 95 % by definition


def test_the_interval_of_s_is_that_of_loops_whose_likelihood_is_as_sure():
    table = made(4000, 5)
    rng, names = np.random.default_rng(6), table.names.tolist()
    S, likely, share = (names.index(name) for name in ("network_S", "likely_S", "likely_share"))
    table.x[:, share] = np.where(rng.random(len(table)) < 0.5, 0.9, np.nan)
    table.x[:, likely] = table.x[:, S] + table.x[:, share] / 9.0 * rng.normal(size=len(table))
    rough = np.where(np.isnan(table.x[:, share]), 0.3, 0.03) * rng.normal(size=len(table))
    table.truth["S"] = 10.0 * np.exp(table.x[:, S] + rough)
    model = fit(table, say=lambda text: None)
    near = dict.fromkeys(names, 0.0) | {"network_S": -1.0}
    for says, spread in ((np.nan, 0.3), (-1.0, np.hypot(0.9 * 0.1, 0.03))):  # analytic: network alone, mean of both
        _, low, high = model.judge(near | {"likely_S": says, "likely_share": 0.9}).S
        assert np.log(high / low) == pytest.approx(2 * 1.645 * spread, rel=0.15)


def test_it_is_kept_and_read_the_same(model, tmp_path):
    file = tmp_path / "model.json"
    model.write(file)
    again = type(model).read(file)
    assert np.array_equal(estimates(again, made(50, 4))[2], estimates(model, made(50, 4))[2], equal_nan=True)
    assert (again.accuse, again.clear, again.about) == (model.accuse, model.clear, model.about)


def test_figures_by_hand():
    sticky = np.array([True, True, False, False])
    assert auc(np.array([0.9, 0.8, 0.2, 0.1]), sticky) == 1.0  # analytic
    assert auc(np.array([0.9, 0.1, 0.8, 0.2]), sticky) == 0.5  # analytic: 2 of 4 pairs
    assert calibration_error(np.array([1.0, 1.0, 0.0, 0.0]), sticky) == 0.0
    assert calibration_error(np.full(4, 0.9), sticky) == pytest.approx(0.4)  # analytic: |0.5 - 0.9|


def test_every_cause_has_its_words():
    assert set(SPOKEN) == set(CAUSES)
