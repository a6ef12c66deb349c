"""A bank of stems that draws OP: against a particle filter of its own, led by nothing, and what it decides."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal
from stickslip.cases.models import level_loop, site_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.exact.stems import left_by_stems
from stickslip.gap.likelihood.framing import frame_of, when_switched
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read
from stickslip.logs import Log

from benchmarks.gap.generator import record

FIRST, ROWS, S, J = 8, 60, 0.03, 0.009  # rows at the beginning tell where the stems are, and by how much is chance


def known(*names):
    return [effect(name) for name in names]


def blind(m, u, every, Y, r, count, seed):
    """Loss of the rows FIRST to ROWS [nats] by drawing OP at each scan from what the rows before tell."""
    rng = np.random.default_rng(seed)
    n, F, v = m.n, m.F, m.v[0]
    H = m.H[:, :n] + np.outer(m.H[:, n], v[:n])
    A, P = F[:, :n], 1e-4 * np.eye(n)
    before = []
    for k in range(60 * every):  # the covariance does not go by what is seen
        before = [*before[-every + 1 :], P] if every > 1 else [P]
        if k % every == 0:
            P = P - P @ H.T @ np.linalg.solve(H @ P @ H.T + np.diag(r), H @ P)
        gain = P @ v[:n] / (v[:n] @ P @ v[:n])
        P = A @ (P - np.outer(gain, v[:n] @ P)) @ A.T + m.Q
    at_row = before[0]
    z = np.repeat(m.start[:, None], count, axis=1)
    x = np.linspace(-1.0, 1.0, count) * 0.45 * (S + J) + m.command[:n] @ m.start + m.command[n] * m.start[m.last[0]]
    lost = []
    for k in range(ROWS * every):
        OP = v[:n] @ z + v[n + 2 :] @ u[k]
        if k % every == 0:
            P = at_row
            guess = (
                m.H[:, :n] @ z
                + np.outer(m.H[:, n], OP)
                + np.outer(m.H[:, n + 1], x)
                + (m.H[:, n + 2 :] @ u[k])[:, None]
            )
            miss, spread = Y[k // every][:, None] - guess, H @ P @ H.T + np.diag(r)
            w = multivariate_normal(np.zeros(len(r)), spread).pdf(miss.T) * (2.0 * np.pi) ** (0.5 * len(r))
            lost.append(-np.log(w.mean()))
            K = P @ H.T @ np.linalg.inv(spread)
            kept = rng.choice(count, count, p=w / w.sum())
            z, x, P = (z + K @ miss)[:, kept], x[kept], P - K @ H @ P
        OP, wide = v[:n] @ z + v[n + 2 :] @ u[k], v[:n] @ P @ v[:n]
        more = np.sqrt(wide) * rng.normal(size=count)
        z, P = z + np.outer(P @ v[:n] / wide, more), P - np.outer(P @ v[:n], v[:n] @ P) / wide
        told = m.command[:n] @ z + m.command[n] * (OP + more)
        way = told - x
        x = np.where(np.abs(way) > 0.5 * (S + J), told - np.sign(way) * 0.5 * (S - J), x)
        z = F[:, :n] @ z + np.outer(F[:, n], OP + more) + np.outer(F[:, n + 1], x) + (F[:, n + 2 :] @ u[k])[:, None]
        P = A @ P @ A.T + m.Q
    return float(sum(lost[FIRST:]))


@pytest.fixture(scope="module")
def sticks(site_record):
    return site_record("stiction", "valve", S=3.0, J=0.9)


def test_what_leads_a_draw_is_taken_back_by_its_weight(sticks):
    # oracle: an independent filter that draws blindly, 5,000 stems; without the weight rows are 1 nat likelier each
    f = when_switched(frame_of(*read(site_flow(), sticks)))
    one = Hypothesis(f)
    m = one.exact.scanned(*one.stated_of(one.exact, one.nominal), cut="MV")
    given = (m, f.scans.u, f.scans.every, f.Y, np.median(f.r, axis=0))
    expected = np.mean([blind(*given, 5_000, seed) for seed in (1, 2)])
    found = [float(left_by_stems(*given, S, J, 1_000, seed)[1][FIRST:ROWS].sum()) for seed in (1, 2)]
    assert np.mean(found) == pytest.approx(expected, abs=2.0)


def test_a_jump_of_a_third_of_S_is_seen_and_sized(sticks):
    # analytic: the sizes put in; a bank that does not draw OP finds a deadband between S - J and S as likely
    report = diagnose(site_flow(), sticks, catalogue=known("stiction", "deadband", "sensor_noise"))
    (cause,) = report.causes
    assert cause.effect == "stiction"
    assert cause.parameters["S"].value == pytest.approx(3.0, rel=0.05)
    assert cause.parameters["J"].value == pytest.approx(0.9, rel=0.25)


def test_a_deadband_has_its_width_and_no_jump(site_record):
    log = site_record("deadband", "valve", width=2.5)
    (cause,) = diagnose(site_flow(), log, catalogue=known("stiction", "deadband", "sensor_noise")).causes
    assert cause.effect == "deadband"
    assert cause.parameters["width"].value == pytest.approx(2.5, rel=0.05)


def stem_only(model, setting, seed):
    made = record(setting, ["stiction"], "typical", seed)
    half = slice(len(made.signals["time"]) // 2)
    log = Log(made.signals["time"][half], {s: made.signals[s][half] for s in ("SP", "PV", "OP")})
    return diagnose(model, log, catalogue=known("stiction", "deadband", "sensor_noise"))


def test_a_stem_that_hardly_moves_a_level_gets_no_other_name():
    for cause in stem_only(level_loop(), "level", 8601).causes:
        assert {cause.effect, *cause.ambiguous_with} <= {"stiction", "deadband"}


def test_a_stem_that_creeps_is_said_to_leave_the_log_of_a_play():
    # the program's own law: on the site's loop this stem creeps (LuGre), and its S - J alone shows
    report = stem_only(site_flow(), "site", 8633)
    assert report.causes[0].effect in ("deadband", "stiction")
    assert any(word.startswith("A stem that creeps") for word in report.words)
