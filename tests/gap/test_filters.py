"""The filter of a diagram: its matrices against the engine, its likelihood against the whole covariance, its checks."""

import numpy as np
import pytest
from stickslip.blocks import Equations
from stickslip.cases.models import level_cascade, second_order_flow, site_flow
from stickslip.diagram import ensemble, simulate
from stickslip.diagram.inputs import close
from stickslip.diagram.playback import held
from stickslip.gap.effects import effect
from stickslip.gap.filters import filtering, kalman
from stickslip.gap.filters.affine import NotAffine, affine
from stickslip.gap.filters.checks import checks
from stickslip.gap.filters.filtering import Explanation
from stickslip.gap.filters.fitting import refined
from stickslip.gap.filters.lifted import NOWHERE, lifted
from stickslip.gap.filters.operating import operating
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.filters.scanned import scanned
from stickslip.gap.filters.stems import stuck
from stickslip.gap.fits.digits import levels
from stickslip.gap.insertion.straightness import lined
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import nuisances, read, silenced
from stickslip.logs import Log

NEAR = {"SP": 1.5, "PV": 1.5, "OP": 0.5, "MV": 0.5}
EFFECTS = [
    ("", "", {}),
    ("second_lag", "process", {"tau": 2.0}),
    ("positioner_lag", "valve", {"tau": 2.0}),
    ("dead_time", "process", {"theta": 2.3}),
    ("dead_time", "process", {"theta": 0.4}),
    ("controller_filter", "controller", {"tau": 3.0}),
    ("controller_gain", "controller", {"factor": 1.5}),
    ("sensor_drift", "sensor", {"rate": 0.3}),
    ("sensor_span", "sensor", {"factor": 1.1}),
    ("valve_leak", "valve", {"flow": 2.0}),
]


def matrices(quiet, noise=()):
    near = operating(quiet, NEAR, ["SP"], ["controller"])
    return scanned(quiet.blocks, noise, ["controller"], ["PV", "OP"], ["SP"], near)


def walked(one, SP):
    """Return logged signals at each scan, by the matrices alone."""
    z, found, n, C = one.start, [], one.n, len(one.v)
    for k, sp in enumerate(SP):
        row = np.concatenate([z, np.zeros(C + 1), [sp, float(k), 1.0, 0.0]])
        wanted = np.empty(C)
        for c in range(C):
            wanted[c] = one.v[c] @ row
            row[n + c] = np.clip(wanted[c], *one.limits[c])
        shown = one.H @ row
        shown[-1] = row[n + C - 1]  # the last one logged is the last controller's output, within its limits
        found.append(shown)
        z = one.F @ row
        for c in np.flatnonzero(row[n : n + C] != wanted):
            own = one.memory[one.of == c]
            side = 0 if wanted[c] > row[n + c] else 1
            further = (z[own[0]] > row[own[0]]) == (side == 0)
            z[own] = one.beyond[side, 0 if further else 1, one.of == c] @ row
    return np.array(found)


@pytest.mark.parametrize(("name", "place", "values"), EFFECTS)
def test_matrices_move_as_the_engine_does(name, place, values):
    # oracle: the engine integrates what the matrices say in one step; OP reaches its limit on the way
    quiet = silenced(site_flow(rest=1.5))
    changed = effect(name).insert(quiet, place, **values) if name else quiet
    t = np.arange(260.0)
    SP = np.where(t < 50.0, 1.5, np.where(t < 150.0, 2.9, 1.2))
    run = ensemble(changed, t[-1], times=t, inputs=Log(t, {"SP": SP}), seeds=[1], signals=["PV", "OP"], progress=False)
    found = walked(matrices(changed), SP)
    assert run.values["OP"][0].max() == 1.0
    assert np.abs(found[:, 0] - run.values["PV"][0]).max() < 1e-8
    assert np.abs(found[:, 1] - run.values["OP"][0]).max() < 1e-8


def test_a_process_with_a_dead_time_of_its_own_moves_as_the_engine_does():
    quiet = silenced(second_order_flow(rest=1.5))
    t = np.arange(200.0)
    SP = np.where(t < 50.0, 1.5, 1.8)
    run = ensemble(quiet, t[-1], times=t, inputs=Log(t, {"SP": SP}), seeds=[1], signals=["PV", "OP"], progress=False)
    assert np.abs(walked(matrices(quiet), SP)[:, 0] - run.values["PV"][0]).max() < 1e-8


@pytest.mark.parametrize(
    ("name", "place", "values"),
    [
        ("", "", {}),
        ("second_lag", "vessel", {"tau": 20.0}),
        ("dead_time", "process", {"theta": 2.3}),
        ("controller_filter", "level_controller", {"tau": 30.0}),
        ("controller_limits", "level_controller", {"low": 0.0, "high": 60.0}),
        ("sensor_span", "level_sensor", {"factor": 1.1}),
    ],
)
def test_a_cascade_moves_as_the_engine_does_with_both_controllers_at_their_limits(name, place, values):
    # oracle: the engine; the level's set point jumps so far that the flow's set point and OP reach their limits
    quiet = silenced(level_cascade()).with_params({"process.K": 0.9})
    changed = effect(name).insert(quiet, place, **values) if name else quiet
    t = np.arange(900.0)
    SP = np.where(t < 50.0, 0.5, np.where(t < 400.0, 0.8, 0.45))
    names = ["L", "PV", "SP", "OP"]
    log = Log(t, {"SP_L": SP})
    run = simulate(
        close(changed, {"SP_L": held(log, "SP_L")}), t[-1], every=1.0, signals=names, rtol=1e-11, atol=1e-13
    ).log
    seen = {"SP_L": 0.5, "L": 0.5, "SP": 0.5, "PV": 0.5, "OP": 0.5}
    acting = ["level_controller", "controller"]
    one = scanned(changed.blocks, (), acting, names, ["SP_L"], operating(changed, seen, ["SP_L"], acting))
    found = walked(one, SP)
    low, high = changed["level_controller"].limits
    assert run["SP"].max() == pytest.approx(high)
    assert run["OP"].max() == pytest.approx(min(1.0, high / 0.9))
    for j, s in enumerate(names):
        value = np.clip(found[:, j], low, high) if s == "SP" else found[:, j]
        # at a limit a controller is looked at 50 beyond it: slopes lose four digits there, for 100 scans
        assert np.abs(value - run[s]).max() < 5e-8, s
        assert np.abs(value - run[s])[:50].max() < 1e-8, s  # before any limit is reached


def test_a_block_that_bends_has_no_matrices():
    curved = effect("valve_characteristic").insert(silenced(site_flow(rest=1.5)), "valve", rangeability=9.0)
    law = curved["valve:valve_characteristic/law"]
    with pytest.raises(NotAffine, match="not linear"):
        affine(law, np.array([0.5]))


def test_a_slow_block_that_multiplies_is_not_affine():
    # a zone of a dryer, in 1/s: the product is 2.5e-10 over the step, where 1e-9 passed for rounding
    def zone(der):
        return Equations("zone", der=der, states={"X": 10.0}, inputs="T", outputs="X")

    with pytest.raises(NotAffine, match="multiplies"):
        affine(zone(lambda X, T: (40.0 - X - 0.02 * (T - 40.0) * X) / 80.0), np.array([86.0]))
    moved = affine(zone(lambda X, T: (40.0 - 1.92 * X + 1e-3 * T) / 80.0), np.array([86.0])).moved
    np.testing.assert_allclose(moved, [[-0.024, 1.25e-5, 0.0, 0.5]], rtol=1e-6, atol=1e-12)


def test_the_likelihood_is_that_of_the_whole_covariance():
    # oracle: all rows at once, mean and covariance multiplied out from the matrices
    model = site_flow(rest=1.5)
    one = matrices(silenced(model), nuisances(model))
    n, rows, every = one.n, 7, 5
    rng = np.random.default_rng(0)
    scans = (rows - 1) * every + 1
    U = np.column_stack([np.full(scans, 1.5), np.arange(float(scans)), np.ones(scans), np.zeros(scans)])
    A = np.empty((n, n))
    told = np.zeros(one.F.shape[1])
    kalman.closed(one.F, one.free, told, n, 1.0, False, A)
    P0, r = 1e-4 * np.eye(n), np.array([2e-7, 8e-8])
    H = one.H[:, :n]
    mean, covariances, powers = one.start.copy(), [P0], [np.eye(n)]
    means = []
    for k in range(scans):
        row = np.concatenate([mean, [0.0, 0.0], U[k]])
        means.append(one.H @ row)
        row[n] = one.v[0] @ row
        mean = one.F @ row
        covariances.append(A @ covariances[-1] @ A.T + one.Q)
        powers.append(A @ powers[-1])
    C = np.zeros((2 * rows, 2 * rows))
    for i in range(rows):
        for j in range(i, rows):
            block = H @ powers[(j - i) * every] @ covariances[i * every] @ H.T
            C[2 * j : 2 * j + 2, 2 * i : 2 * i + 2] = block
            C[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] = block.T
    C += np.kron(np.eye(rows), np.diag(r))
    m = np.concatenate([means[i * every] for i in range(rows)])
    y = m + np.linalg.cholesky(C) @ rng.normal(size=len(m))
    whole = 0.5 * float((y - m) @ np.linalg.solve(C, y - m) + np.linalg.slogdet(C)[1])
    e, S = np.empty((rows, 2)), np.empty((rows, 2))
    empty, acts, none = np.zeros((rows, 2), dtype=bool), np.array([-1, 0]), np.zeros((every, n, n))
    kalman.filtered(
        one.F, one.v, told, one.H, one.Q, one.limits, one.memory, one.of, one.beyond, one.last, one.period, one.offset,
        one.start, U, y.reshape(rows, 2), r, empty, acts, every, 0, 0.0, 0.0, True, none, np.zeros((2, n)), np.ones(2),
        NOWHERE, e, S, np.empty((scans, 1)),
    )  # fmt: skip
    assert 0.5 * np.sum(e**2 + np.log(S)) == pytest.approx(whole, abs=1e-6)


def test_a_fit_finds_gain_and_time_constant_and_leaves_white_innovations(site_record):
    log = site_record()
    model, record = read(site_flow(rest=1.5), log)
    f = Filtering(Given(model), record, np.zeros((1, len(log)), dtype=np.int64))
    found = refined(Explanation(f).filtered({"process.K": 2.88, "process.tau": 10.8}), tuple(f.free))
    assert found.best.values["process.K"] == pytest.approx(3.0, rel=0.01)
    assert found.best.values["process.tau"] == pytest.approx(10.0, rel=0.05)
    assert np.nanstd(found.best.judged, axis=0) == pytest.approx([1.0, 1.0], abs=0.08)
    assert max(map(abs, checks(found.best).values())) < 5.0


def test_a_leak_that_looks_like_a_gain_is_found_from_afar(site_record):
    # both move PV; a step along the ridge between them that is cut short must stay on it
    log = site_record("valve_leak", "valve", flow=3.0)
    model, record = read(site_flow(rest=1.5), log)
    f = Filtering(Given(model), record, np.zeros((1, len(log)), dtype=np.int64))
    one = Explanation(f, effect("valve_leak"), "valve")
    names = (*one.own, *f.free)
    far, near = (
        refined(one.filtered({"flow": flow, "process.K": 1.59 / (0.5 + 0.01 * flow), "process.tau": 9.9}), names, 20)
        for flow in (0.3, 3.0)
    )
    assert far.nll == pytest.approx(near.nll, abs=0.3)
    assert far.best.values["flow"] == pytest.approx(near.best.values["flow"], rel=0.1)


def test_checks_see_innovations_that_remember(site_record):
    log = site_record()
    model, record = read(site_flow(rest=1.5), log)
    f = Filtering(Given(model), record, np.zeros((1, len(log)), dtype=np.int64))
    wrong = checks(Explanation(f).filtered({"process.K": 2.85, "process.tau": 11.0}))
    assert max(map(abs, wrong.values())) > 6.0


def test_digits_tell_levels_and_straight_lines():
    rng = np.random.default_rng(1)
    fine = np.round(rng.normal(1.5, 0.2, 2000) / 0.0015) * 0.0015
    assert levels(fine) == 0.0
    assert levels(np.round(np.round(fine / 0.02) * 0.02 / 0.0015) * 0.0015) == pytest.approx(0.02, rel=1e-3)
    line = np.interp(np.arange(300.0), np.arange(0.0, 301.0, 10.0), rng.normal(size=31))
    assert lined(line, 0.0) > 0.85 > 0.05 > lined(rng.normal(size=300), 0.0)


def test_a_stem_sticks_and_jumps():
    # analytic: f_s = (S + J)/2 = 4 %, f_c = (S - J)/2 = 2 %
    assert [round(stuck(0.5, told, 0.06, 0.02, 1.0), 6) for told in (0.53, 0.539, 0.545, 0.45)] == [
        0.5, 0.5, 0.525, 0.47,
    ]  # fmt: skip
    # one that breaks away late, at 0.044, and a play, which never goes back however early it breaks away
    assert [round(stuck(0.5, told, 0.06, 0.02, 1.1), 6) for told in (0.543, 0.545)] == [0.5, 0.525]
    assert [round(stuck(0.5, told, 0.06, 0.0, 0.9), 6) for told in (0.528, 0.531)] == [0.5, 0.501]


def test_rows_in_which_a_signal_is_missing_are_filtered_as_the_whole_covariance_says():
    # oracle: the covariance carried along from the beginning, which the test before holds to all rows at once
    model = site_flow(rest=1.5)
    one = matrices(silenced(model), nuisances(model))
    n, rows, every, told = one.n, 400, 5, np.zeros(one.F.shape[1])
    rng, scans = np.random.default_rng(0), 399 * 5 + 1
    U = np.column_stack([np.full(scans, 1.5), np.arange(float(scans)), np.ones(scans), np.zeros(scans)])
    r, found = np.array([2e-7, 8e-8]), []
    Y = np.array([1.5, 0.5]) + 0.01 * rng.normal(size=(rows, 2))
    Y[200:230] = np.nan
    Y[300, 0] = np.nan
    A, K, s = np.empty((n, n)), np.zeros((2, n)), np.ones(2)
    P = np.zeros((every + 1, n, n))
    P[0] = 1e-4 * np.eye(n)
    kalman.closed(one.F, one.free, told, n, 1.0, False, A)
    kalman.steady(A, one.Q, one.shown, r, every, P, K, s)
    for exact in (True, False):
        e, S = np.empty((rows, 2)), np.empty((rows, 2))
        kalman.filtered(
            one.F, one.v, told, one.H, one.Q, one.limits, one.memory, one.of, one.beyond, one.last, one.period,
            one.offset, one.start, U, Y, r, np.zeros((rows, 2), dtype=bool), np.array([-1, 0]), every, 0, 0.0, 0.0,
            exact, P, K, s, NOWHERE, e, S, np.empty((scans, 1)),
        )  # fmt: skip
        found.append((e[100:], S[100:]))
    (e, S), (e_fast, S_fast) = found
    assert S[130, 0] > 1.5 * S[99, 0]  # behind 30 rows of nothing less is known
    assert np.nanmax(np.abs(np.log(S_fast / S))) < 0.03  # variances may differ by 2 % where they count as settled
    assert np.nanmax(np.abs(e_fast - e)) < 0.02 * np.nanmax(np.abs(e))


@pytest.mark.parametrize(
    ("name", "values"), [("", {}), ("valve_saturation", {"low": 0.0, "high": 88.0}), ("dead_time", {"theta": 2.3})]
)
def test_a_row_passed_in_one_step_leaves_what_scan_by_scan_leaves(site_record, monkeypatch, name, values):
    # oracle: the same filter, one scan after the other; limits are reached, and values are missing
    log = site_record(middle=2.5)
    PV = log["PV"].copy()
    PV[400:430] = np.nan
    model, record = read(site_flow(rest=2.5), Log(log.t, {"SP": log["SP"], "PV": PV, "OP": log["OP"]}))
    f = Filtering(Given(model), record, np.zeros((1, len(log)), dtype=np.int64))
    one = Explanation(f, effect(name), "process" if name == "dead_time" else "valve") if name else Explanation(f)
    steps = []

    def counted(*given):
        steps.append(lifted(*given))
        return steps[-1]

    monkeypatch.setattr(filtering, "lifted", counted)
    fast = one.filtered(values)
    monkeypatch.setattr(filtering, "lifted", lambda *given: NOWHERE)
    slow = one.filtered(values)
    assert len(steps[0].at_row) == len(f.Y) - 1
    assert np.array_equal(np.isnan(fast.e), np.isnan(slow.e)) and np.isnan(slow.e[500:, 1]).any()
    assert np.nanmax(np.abs(fast.e - slow.e)) < 1e-7
    assert np.nanmax(np.abs(fast.S / slow.S - 1.0)) < 1e-9
    assert np.abs(fast.OP - slow.OP).max() < 1e-9


def test_a_stop_of_the_valve_far_away_needs_no_covariance_of_its_own(site_record):
    # oracle: the covariance carried along from the beginning
    log = site_record("valve_saturation", "valve", low=0.0, high=56.0)
    model, record = read(site_flow(rest=1.5), log)
    f = Filtering(Given(model), record, np.zeros((1, len(log)), dtype=np.int64))
    one = Explanation(f, effect("valve_saturation"), "valve")
    values = {"low": 0.0, "high": 56.0, "process.K": 3.0, "process.tau": 10.0}
    whole = one.filtered(values, exact=True)
    assert one.filtered(values).nll == pytest.approx(whole.nll, abs=0.5)
    assert Explanation(f).filtered(values).nll > whole.nll + 20.0
