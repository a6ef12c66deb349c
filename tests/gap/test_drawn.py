"""A bank of stems that draws OP: against a particle filter of its own, led by nothing, and what it decides."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from stickslip.cases.models import level_loop, site_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.filters.diagnosing import filtering_of
from stickslip.gap.filters.drawn import Draws, drawn
from stickslip.gap.filters.explaining import settled
from stickslip.gap.filters.filtering import Explanation
from stickslip.gap.filters.hysteresis import fitted_stems, looked_at
from stickslip.gap.filters.jumping import decided
from stickslip.gap.records.model import read
from stickslip.logs import Log

from benchmarks.gap.generator import record

FIRST, ROWS, S, J = 8, 60, 0.03, 0.009  # rows at the beginning tell where the stems are, and by how much is chance


def known(*names):
    return [effect(name) for name in names]


def blind(one, values, count, seed):
    """Loss of the rows FIRST to ROWS [nats] by drawing OP at each scan from what the rows before tell."""
    f = one.filtering
    m, rng = one.matrices({**one.nominal, **values}), np.random.default_rng(seed)
    n, F, v = m.n, m.F, m.v[0]
    H = np.stack([m.free[0] if c >= 0 else m.shown[j] for j, c in enumerate(f.acts)])
    A, P = F[:, :n], 1e-4 * np.eye(n)
    before = []
    for k in range(60 * f.every):  # the covariance does not go by what is seen
        before = [*before[-f.every + 1 :], P] if f.every > 1 else [P]
        if k % f.every == 0:
            P = P - P @ H.T @ np.linalg.solve(H @ P @ H.T + np.diag(f.r), H @ P)
        gain = P @ v[:n] / (v[:n] @ P @ v[:n])
        P = A @ (P - np.outer(gain, v[:n] @ P)) @ A.T + m.Q
    at_row = before[0]
    z = np.repeat(m.start[:, None], count, axis=1)
    U = np.column_stack([f.played, f.time, np.ones(f.scans), np.zeros(f.scans)])
    x = np.linspace(-1.0, 1.0, count) * 0.45 * (S + J) + m.told[:n] @ m.start + m.told[n] * m.start[m.last[0]]
    lost = []
    for k in range(ROWS * f.every):
        OP = v[:n] @ z + v[n + 2 :] @ U[k]
        if k % f.every == 0:
            P = at_row
            at = k // f.every
            guess = [OP if c >= 0 else m.H[j, :n] @ z + m.H[j, n] * OP + m.H[j, n + 1] * x + m.H[j, n + 2 :] @ U[k]
                     for j, c in enumerate(f.acts)]  # fmt: skip
            miss, spread = f.Y[at][:, None] - np.array(guess), H @ P @ H.T + np.diag(f.r)
            w = multivariate_normal(np.zeros(len(f.r)), spread).pdf(miss.T) * (2.0 * np.pi) ** (0.5 * len(f.r))
            lost.append(-np.log(w.mean()))
            K = P @ H.T @ np.linalg.inv(spread)
            kept = rng.choice(count, count, p=w / w.sum())
            z, x, P = (z + K @ miss)[:, kept], x[kept], P - K @ H @ P
        OP, wide = v[:n] @ z + v[n + 2 :] @ U[k], v[:n] @ P @ v[:n]
        more = np.sqrt(wide) * rng.normal(size=count)
        z, P = z + np.outer(P @ v[:n] / wide, more), P - np.outer(P @ v[:n], v[:n] @ P) / wide
        told = m.told[:n] @ z + m.told[n] * (OP + more)
        way = told - x
        x = np.where(np.abs(way) > 0.5 * (S + J), told - np.sign(way) * 0.5 * (S - J), x)
        z = F[:, :n] @ z + np.outer(F[:, n], OP + more) + np.outer(F[:, n + 1], x) + (F[:, n + 2 :] @ U[k])[:, None]
        P = A @ P @ A.T + m.Q
    return float(sum(lost[FIRST:]))


@pytest.fixture(scope="module")
def sticks(site_record):
    return site_record("stiction", "valve", S=3.0, J=0.9)


def test_what_leads_a_draw_is_taken_back_by_its_weight(sticks):
    # oracle: an independent filter that draws blindly, 5,000 stems; without the weight rows are 1 nat likelier each
    f = settled(filtering_of(*read(site_flow(), sticks))).best.explanation.filtering
    one, values = Explanation(f, effect("stiction"), "valve"), {"S": 100.0 * S, "J": 100.0 * J}
    expected = np.mean([blind(one, values, 5_000, seed) for seed in (1, 2)])
    found = [float(drawn(one, values, Draws.of(one, 1_000, seed)).losses[FIRST:ROWS].sum()) for seed in (1, 2)]
    assert np.mean(found) == pytest.approx(expected, abs=2.0)


def test_a_jump_of_a_third_of_S_is_seen_and_sized(sticks):
    # analytic: the sizes put in; a bank that does not draw OP finds a deadband between S - J and S as likely
    report = diagnose(site_flow(), sticks, catalogue=known("stiction", "deadband", "sensor_noise"))
    (cause,) = report.causes
    assert cause.effect == "stiction"
    assert cause.parameters["S"].value == pytest.approx(3.0, rel=0.05)
    assert cause.parameters["J"].value == pytest.approx(0.9, rel=0.25)


def test_a_deadband_has_no_jump_and_its_width(site_record):
    log = site_record("deadband", "valve", width=2.5)
    plain = settled(filtering_of(*read(site_flow(), log)))
    (flat, *stuck) = sorted(
        fitted_stems(looked_at(plain, "valve"), known("stiction", "deadband"), 16.0),
        key=lambda found: len(found.best.explanation.own),
    )
    (best,) = decided(flat.best, effect("stiction"), [found.best for found in stuck])
    assert best.explanation.effect.name == "deadband"
    assert best.values["width"] == pytest.approx(2.5, rel=0.05)


def stem_only(model, setting, seed):
    made = record(setting, ["stiction"], "typical", seed)
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    return diagnose(model, log, catalogue=known("stiction", "deadband", "sensor_noise"))


def test_a_stem_that_hardly_moves_a_level_is_called_either():
    (cause,) = stem_only(level_loop(), "level", 8601).causes
    assert {cause.effect, *cause.ambiguous_with} == {"stiction", "deadband"}


def test_a_stem_that_creeps_is_said_to_leave_the_log_of_a_play():
    # the program's own law: on the site's loop this stem creeps (LuGre), and its S - J alone shows
    report = stem_only(site_flow(), "site", 8633)
    assert report.causes[0].effect in ("deadband", "stiction") and report.causes[0].probability < 0.8
    assert any(word.startswith("A stem that creeps") for word in report.words)
