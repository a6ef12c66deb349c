"""The read-out of patterns: limits with the shares asked for, and a regression that finds what is there."""

import numpy as np
import pytest
from stickslip.calibration.patterns import SHARES, fit, kernels, pooled_loops, views
from stickslip.calibration.scoring import auc
from stickslip.detect.judge.features.channels import channels
from stickslip.detect.judge.features.convolutions import POOLED


@pytest.fixture(scope="module")
def drawn():
    few = pytest.MonkeyPatch()
    few.setattr("stickslip.calibration.patterns.PART", 24)
    few.setattr("stickslip.calibration.patterns.COUNT", {"odd": 21, "even": 14})
    yield [view for view, _ in views(77)], few
    few.undo()


def test_limits_hold_the_shares_asked_for(drawn):
    looked_at, _ = drawn
    odd, even = kernels(looked_at)
    assert (len(odd.channel), len(even.channel)) == (21, 14)
    for own, number, kind in ((odd, 0, "odd"), (even, 1, "even")):
        told = np.stack([own(channels(view)[number]).reshape(-1, POOLED) for view in looked_at])
        above = np.nanmean(told[:, :, :4], axis=0).mean(axis=0)
        assert above == pytest.approx(1.0 - np.array(SHARES[kind]), abs=0.08)
        assert own.weight.sum(axis=2) == pytest.approx(np.zeros((len(own.weight), 3)), abs=1e-5)  # blind to offsets


def test_parts_are_kept_and_equal_when_made_again(drawn, tmp_path):
    looked_at, _ = drawn
    odd, even = kernels(looked_at)
    x, group = pooled_loops(tmp_path, 78, 2, odd, even)
    parts = sorted((tmp_path / "parts").iterdir())
    assert len(parts) == 2 and x.shape[1] == 6 * 35 + 40
    parts[0].unlink()
    anew, same = pooled_loops(tmp_path, 78, 2, odd, even)
    assert np.array_equal(x, anew, equal_nan=True) and np.array_equal(group, same)
    with pytest.raises(ValueError, match="holds another pooled"):
        pooled_loops(tmp_path, 78, 2, odd, odd)


def test_the_read_out_finds_what_is_there(drawn):
    looked_at, _ = drawn
    odd, even = kernels(looked_at)
    rng = np.random.default_rng(0)
    group = rng.choice(["cycling", "healthy", "drift"], 12_000)
    x = rng.normal(size=(12_000, 30)).astype(np.float32)
    x[:, 7] += 2.0 * (group == "cycling")
    read = fit(x[:10_000], group[:10_000], odd, even, say=lambda text: None)
    assert read.names == ("cycling", "drift", "healthy", "sticky")
    told = read.scores(x[10_000:])
    shares = np.exp(told[:, :3])
    assert shares.sum(axis=1) == pytest.approx(np.ones(2000), abs=1e-4)  # analytic
    assert told[:, 3] == pytest.approx(np.log(shares[:, 0] / (1 - shares[:, 0])), abs=1e-3)  # analytic: ln of the odds
    # analytic: two Gaussians 2 apart have the AUC Phi(2 / sqrt 2) = 0.921
    assert auc(told[:, 3], group[10_000:] == "cycling") == pytest.approx(0.921, abs=0.03)
