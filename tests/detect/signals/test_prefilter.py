import numpy as np
import pytest
from stickslip.detect.signals import prefilter


def reference(noise_std, q, t, z):
    """Independent Kalman filter and smoother in plain numpy: information-free start at the first sample, the
    covariance in the short form P - K H P, the smoother in the order of its textbook recursion."""
    n, r = len(t), noise_std**2
    x, P = np.zeros((n, 2)), np.zeros((n, 2, 2))
    xp, Pp, F = np.zeros((n, 2)), np.zeros((n, 2, 2)), np.zeros((n, 2, 2))
    x[0], P[0] = (z[0], 0.0), np.diag([r, max(100 * r, q)])
    for k in range(1, n):
        h = t[k] - t[k - 1]
        F[k] = [[1, h], [0, 1]]
        Q = q * np.array([[h**3 / 3, h**2 / 2], [h**2 / 2, h]])
        xp[k], Pp[k] = F[k] @ x[k - 1], F[k] @ P[k - 1] @ F[k].T + Q
        if np.isnan(z[k]):
            x[k], P[k] = xp[k], Pp[k]
            continue
        K = Pp[k][:, 0] / (Pp[k][0, 0] + r)
        x[k] = xp[k] + K * (z[k] - xp[k][0])
        P[k] = Pp[k] - np.outer(K, Pp[k][0])
    xs, Ps = x.copy(), P.copy()
    for k in range(n - 2, -1, -1):
        C = np.linalg.solve(Pp[k + 1], F[k + 1] @ P[k]).T
        xs[k] = x[k] + C @ (xs[k + 1] - xp[k + 1])
        Ps[k] = P[k] + C @ (Ps[k + 1] - Pp[k + 1]) @ C.T
    return x, xs, Ps


@pytest.fixture
def noisy():
    rng = np.random.default_rng(7)
    t = np.cumsum(rng.uniform(0.2, 2.0, 300))
    z = np.sin(t / 10) + rng.normal(0, 0.2, 300)
    z[[20, 21, 22, 150]] = np.nan
    return t, z


def test_filter_and_smoother_equal_an_independent_one(noisy):
    t, z = noisy
    p = prefilter.Params(noise_std=0.2, q=1e-4)
    x, xs, Ps = reference(0.2, 1e-4, t, z)
    assert prefilter.filter(p, t, z).level == pytest.approx(x[:, 0], abs=1e-9)
    smooth = prefilter.smooth(p, t, z)
    assert smooth.level == pytest.approx(xs[:, 0], abs=1e-8)
    assert smooth.slope == pytest.approx(xs[:, 1], abs=1e-8)
    assert smooth.level_std == pytest.approx(np.sqrt(Ps[:, 0, 0]), abs=1e-8)


def test_stream_is_the_filter(noisy):
    t, z = noisy
    p = prefilter.Params(0.2, 1e-4)
    s, levels = prefilter.init(p), []
    for ti, zi in zip(t, z, strict=True):
        before = s.x.copy()
        new = prefilter.update(p, s, float(ti), float(zi))
        assert (s.x == before).all()  # the old state is a value
        s = new
        levels.append(s.x[0])
    assert levels == prefilter.filter(p, t, z).level.tolist()


def test_line_is_followed_without_lag():
    t = np.arange(200.0)
    p = prefilter.Params(0.1, 1e-6)
    assert prefilter.filter(p, t, 2 + 0.5 * t).level[100:] == pytest.approx((2 + 0.5 * t)[100:], abs=1e-3)  # analytic


def test_estimate_finds_the_noise_and_removes_most(noisy):
    t, z = noisy
    p = prefilter.estimate(t, z)
    assert p.noise_std == pytest.approx(0.2, rel=0.2)  # analytic
    error = prefilter.smooth(p, t, z).level - np.sin(t / 10)
    assert np.std(error) < 0.08


def test_missing_samples_at_the_start_stay_unknown():
    t, z = np.arange(30.0), np.full(30, np.nan)
    z[5:] = 1.0
    level = prefilter.smooth(prefilter.Params(0.1, 1e-4), t, z).level
    assert np.isnan(level[:5]).all()
    assert level[5:] == pytest.approx(1.0)


def test_covariance_stays_symmetric_and_positive():
    p, s = prefilter.Params(1e-3, 1e6), prefilter.init(prefilter.Params(1e-3, 1e6))
    rng = np.random.default_rng(0)
    t = 0.0
    for _ in range(2000):
        t += float(10 ** rng.uniform(-6, 4))
        s = prefilter.update(p, s, t, float(rng.normal()))
        assert (s.P == s.P.T).all()
        assert s.P[0, 0] > 0


def test_backward_time_is_refused():
    p = prefilter.Params(1.0, 1.0)
    s = prefilter.update(p, prefilter.init(p), 1.0, 0.0)
    with pytest.raises(ValueError, match="time must increase"):
        prefilter.update(p, s, 1.0, 0.0)


@pytest.mark.parametrize("noise_std, q", [(0.0, 1.0), (1.0, -1.0), (float("nan"), 1.0)])
def test_wrong_params_are_refused(noise_std, q):
    with pytest.raises(ValueError, match="positive"):
        prefilter.Params(noise_std, q)
