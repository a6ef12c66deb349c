"""The network against convolutions by scipy, closed forms of what it gives, and its indifference to units."""

import numpy as np
import pytest
from scipy.signal import correlate
from stickslip.detect.judge.features import network
from stickslip.detect.judge.features.candidates import CANDIDATES, JUMP, SHARES, candidates
from stickslip.detect.judge.features.channels import innovations
from stickslip.detect.judge.features.network import (
    CHANNELS,
    EVEN,
    FILE,
    KERNEL,
    LAYERS,
    POOLED,
    STRIDE,
    Network,
    network_features,
    read,
    seen_by,
    shipped_networks,
    write,
)  # fmt: skip
from stickslip.detect.judge.features.view import view_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.stick import stick
from stickslip.logs import LoopRecord

KINDS = ("cycling", "drift", "excited", "healthy")
WIDTH = dict(zip((name for name, *_ in LAYERS), (4, 6, 6, 5, 5, 7, 7), strict=True))
RNG = np.random.default_rng(3)
T = np.arange(1500.0)
TRIANGLE = 2 / np.pi * np.arcsin(np.sin(2 * np.pi * T / 60))
STUCK = np.sign(np.roll(TRIANGLE, 15)) + 0.05 * RNG.normal(size=1500)


def view(pv, op, sp=0.0):
    return view_of(Prepared(LoopRecord.from_arrays(T, pv=pv, op=op, sp=sp + 0 * T)))


def random_network() -> Network:
    weights, width = {}, CHANNELS
    for name, *_ in LAYERS:
        weights[f"{name}/w"] = RNG.normal(size=(WIDTH[name], width * KERNEL.get(name, 5))) / np.sqrt(width)
        weights[f"{name}/b"] = RNG.normal(size=WIDTH[name])
        width = WIDTH[name]
    pooled = sum(WIDTH[name] for name in POOLED) + 4 * width  # mean, deviation, two weighted means
    for name, out, into in (("att", 2, width), ("fc", 8, pooled), ("out", len(KINDS), 8), ("size", 4, 8)):
        weights |= {f"{name}/w": RNG.normal(size=(out, into)) / 10.0, f"{name}/b": RNG.normal(size=out)}
    return Network({name: w.astype(np.float32) for name, w in weights.items()}, KINDS)


def by_scipy(net: Network, x: np.ndarray) -> np.ndarray:
    """What is pooled, one output channel after the other, by ``scipy.signal.correlate`` over all points."""
    n = x.shape[1]
    h, every, found = x.astype(float), 1, []
    for name, stride, spread, added in LAYERS:
        taps = KERNEL.get(name, 5)
        w = net.weights[f"{name}/w"].reshape(WIDTH[name], len(h), taps).astype(float)
        wide = np.zeros((*w.shape[:2], (taps - 1) * spread + 1))
        wide[:, :, ::spread] = w
        far = taps // 2 * spread
        padded = np.pad(h, ((0, 0), (far, far + stride)))
        every *= stride
        points = -(-n // every)
        own = np.array([
            sum(correlate(line, kernel, "valid") for line, kernel in zip(padded, one, strict=True))[::stride][:points]
            for one in wide
        ]) + net.weights[f"{name}/b"][:, None]  # fmt: skip
        h = np.maximum(own, 0.0) + (h if added else 0.0)
        if name in POOLED:
            found.append(h.mean(axis=1))
    a = np.exp(net.weights["att/w"] @ h + net.weights["att/b"][:, None])
    weighted = (a / a.sum(axis=1, keepdims=True)) @ h.T
    return np.concatenate([*found, h.mean(axis=1), h.std(axis=1), weighted.ravel()])


@pytest.mark.parametrize("points", [60, 15 * STRIDE, 333])
def test_what_is_pooled_is_what_scipy_finds(points):
    net, x = random_network(), RNG.normal(size=(CHANNELS, points)).astype(np.float32)
    expected = by_scipy(net, x)
    assert net.pooled(x) == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())  # an independent convolution


def test_shares_sum_to_one_and_the_odds_are_theirs():
    net = random_network()
    scores = net.scores(RNG.normal(size=(CHANNELS, 200)).astype(np.float32))
    assert net.names == (*KINDS, "sticky", "S", "J") and len(scores) == len(net.names)
    shares = np.exp(scores[:4].astype(float))
    assert shares.sum() == pytest.approx(1.0, abs=1e-4)  # analytic
    bad = shares[0] + shares[2]
    assert scores[4] == pytest.approx(np.log(bad / (shares[1] + shares[3])), abs=1e-3)  # analytic


def test_the_right_stick_leaves_least_new():
    u = np.interp(np.arange(600.0), np.arange(0, 600, 16), RNG.uniform(-1.0, 1.0, 38))
    S = 0.5 * float(np.percentile(u, 99) - np.percentile(u, 1))
    x, y = stick(u, S, JUMP * S), np.zeros(600)
    for k in range(1, 600):
        y[k] = 0.8 * y[k - 1] + 0.2 * x[k - 1] + 0.01 * RNG.normal()
    stems = candidates(u, y)
    assert stems.shape == (CANDIDATES, 600)
    new = np.sqrt(np.mean(stems[len(SHARES) :, 8:] ** 2, axis=1))
    assert SHARES[np.argmin(new)] == 0.5 and new.min() == pytest.approx(1.0, abs=1e-6)
    assert new[[0, -1]].min() > 1.2
    # analytic: with the stem itself the noise is all that is new
    assert np.mean(innovations(x, y)[8:] ** 2) == pytest.approx(1e-4, rel=0.15)


def test_candidates_change_sign_with_the_record():
    u, y = TRIANGLE + 0.3 * np.roll(TRIANGLE, 7), STUCK
    assert candidates(-u, -y)[:, 200:] == pytest.approx(-candidates(u, y)[:, 200:], abs=1e-6)  # once a stem has moved


def test_units_do_not_matter():
    features = network_features(view(STUCK, 50 + 5 * TRIANGLE))
    other = network_features(view(300 + 7 * STUCK, 0.4 * TRIANGLE, sp=300.0))
    assert {name: other[name] for name in features} == pytest.approx(features, abs=0.02)


def test_a_stick_is_seen_and_noise_is_none():
    lone = network_features(view(np.cos(2 * np.pi * T / 60) + 0.3 * RNG.normal(size=1500), 50 + RNG.normal(size=1500)))
    assert network_features(view(STUCK, 50 + 5 * TRIANGLE))["network_sticky"] > 0.0 > lone["network_sticky"]


def test_networks_are_kept_with_one_byte_a_weight(tmp_path):
    nets = [random_network(), random_network()]
    nets[0].weights["fc/w"][0] = 0.0  # a row of zeros has no unit of its own
    write(nets, tmp_path / "networks.npz")
    x = RNG.normal(size=(CHANNELS, 200)).astype(np.float32)
    kept = read(tmp_path / "networks.npz")
    for own, net in zip(kept, nets, strict=True):
        assert own.kinds == net.kinds and own.scores(x) == pytest.approx(net.scores(x), abs=0.3)
        for name, w in net.weights.items():
            most = np.abs(w).max(axis=-1, keepdims=True)
            assert (np.abs(own.weights[name] - w) <= most / 250.0).all()  # analytic: half of one step in 127, and a bit


def test_features_are_means_over_the_shipped_networks(monkeypatch):
    shown = view(STUCK, 50 + 5 * TRIANGLE)
    both = network_features(shown)
    alone = []
    for net in shipped_networks():
        monkeypatch.setattr(network, "shipped_networks", lambda own=net: (own,))
        alone.append(network_features(shown))
    assert len(alone) > 1
    for name, value in both.items():
        assert value == pytest.approx(np.mean([one[name] for one in alone]), abs=1e-4)  # analytic


def test_the_shipped_ones_are_small():
    assert FILE.stat().st_size < 1_000_000
    shown = view(STUCK, 50 + 5 * TRIANGLE)
    assert seen_by(shown).shape[0] == CHANNELS == 7 + EVEN + CANDIDATES
    assert all(np.isfinite(list(network_features(shown).values())))
    assert all(len(net.kinds) == 15 for net in shipped_networks())
