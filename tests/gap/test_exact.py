"""The exact filter: its matrices against the engine, its likelihood against the whole covariance and another filter."""

import numpy as np
import pytest
from stickslip.blocks import Equations, IdealValve
from stickslip.cases.models import level_cascade, level_loop, second_order_flow, site_flow
from stickslip.diagram import ensemble
from stickslip.gap.diagnosis import frame_of
from stickslip.gap.effects import effect
from stickslip.gap.exact.affine import NotAffine, affine, straight_between
from stickslip.gap.exact.kalman import filtered
from stickslip.gap.exact.operating import operating
from stickslip.gap.exact.rows import by_rows
from stickslip.gap.exact.scanned import scanned
from stickslip.gap.exact.stems import stuck
from stickslip.gap.fits.digits import levels
from stickslip.gap.fits.straightness import lined
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.fit import refined
from stickslip.gap.likelihood.framing import when_switched
from stickslip.gap.likelihood.hypothesis import Hypothesis
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
    return scanned(quiet.blocks, noise, ["controller"], ["PV", "OP"], ["SP"], near, 1.0)


def walked(one, SP):
    """Return logged signals at each scan, by the matrices alone."""
    z, found = one.start, []
    for k, sp in enumerate(SP):
        F, H = one.closed(k)
        row = np.concatenate([z, [sp, float(k), 1.0]])
        found.append(H @ row)
        z = F @ row
    return np.array(found)


def settled_at(quiet, name, place, values, first):
    """Return a model with an effect, if any, that begins settled: far from it OP would be at its limit."""
    return effect(name).started(effect(name).insert(quiet, place, **values), place, first) if name else quiet


def frame(model, log):
    return when_switched(frame_of(*read(model, log)))


@pytest.mark.parametrize(("name", "place", "values"), EFFECTS)
def test_matrices_move_as_the_engine_does(name, place, values):
    # oracle: the engine integrates what the matrices say in one step
    quiet = silenced(site_flow(rest=1.5))
    changed = settled_at(quiet, name, place, values, NEAR)
    t = np.arange(260.0)
    SP = np.where(t < 50.0, 1.5, np.where(t < 150.0, 1.9, 1.2))
    run = ensemble(changed, t[-1], times=t, inputs=Log(t, {"SP": SP}), seeds=[1], signals=["PV", "OP"], progress=False)
    found = walked(matrices(changed), SP)
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
        ("scan_time", "level_controller", {"period": 4.0, "offset": 1.0, "present": 1.0}),
        ("sensor_span", "level_sensor", {"factor": 1.1}),
    ],
)
def test_a_cascade_moves_as_the_engine_does(name, place, values):
    # oracle: the engine; the outer controller may scan more slowly than the inner one
    quiet = silenced(level_cascade())
    changed = settled_at(quiet, name, place, values, dict.fromkeys(["SP_L", "L", "SP", "PV", "OP"], 0.5))
    t = np.arange(900.0)
    SP = np.where(t < 50.0, 0.5, np.where(t < 400.0, 0.51, 0.495))
    names, acting = ["L", "PV", "SP", "OP"], ["level_controller", "controller"]
    run = ensemble(changed, t[-1], times=t, inputs=Log(t, {"SP_L": SP}), seeds=[1], signals=names, progress=False)
    seen = {"SP_L": 0.5, "L": 0.5, "SP": 0.5, "PV": 0.5, "OP": 0.5}
    one = scanned(changed.blocks, (), acting, names, ["SP_L"], operating(changed, seen, ["SP_L"], acting), 1.0)
    found = walked(one, SP)
    for j, s in enumerate(names):
        assert np.abs(found[:, j] - run.values[s][0]).max() < 1e-7, s


def test_a_block_that_bends_has_no_matrices():
    curved = effect("valve_characteristic").insert(silenced(site_flow(rest=1.5)), "valve", rangeability=9.0)
    law = curved["valve:valve_characteristic/law"]
    with pytest.raises(NotAffine, match="not linear"):
        affine(law, np.array([0.5]))


def test_a_block_that_bends_away_from_the_middle_of_a_log_is_not_linear_in_it():
    # a ramp of the set point is a line where the set point moves little, and none where it jumps
    ramped = effect("setpoint_ramp").insert(silenced(site_flow(rest=1.5)), "controller", rate=0.02)
    (ramp,) = (b for b in ramped.blocks if b.name.startswith("controller:setpoint_ramp"))
    ramp = ramp.starting_at(**dict.fromkeys(ramp.seen_states(), 1.5))
    t = np.arange(100.0)
    straight_between(ramp, np.array([1.5]), [np.array([1.501])], t)
    with pytest.raises(NotAffine, match="bends within what the log visits"):
        straight_between(ramp, np.array([1.5]), [np.array([1.9])], t)


@pytest.mark.parametrize("middle", [52.243630308076604, 49.1, 3.7])
def test_a_line_is_one_where_it_gives_nothing_too(middle):
    # its slope is a difference of values about the middle, whose rounding is more than 0 has
    straight_between(IdealValve(), np.array([middle]), [np.array([0.0]), np.array([100.0])], np.arange(3.0))


def test_a_slow_block_that_multiplies_is_not_affine():
    # a zone of a dryer, in 1/s: the product is 2.5e-10 over the step, where 1e-9 passed for rounding
    def zone(der):
        return Equations("zone", der=der, states={"X": 10.0}, inputs="T", outputs="X")

    with pytest.raises(NotAffine, match="multiplies"):
        affine(zone(lambda X, T: (40.0 - X - 0.02 * (T - 40.0) * X) / 80.0), np.array([86.0]))
    moved = affine(zone(lambda X, T: (40.0 - 1.92 * X + 1e-3 * T) / 80.0), np.array([86.0])).moved
    np.testing.assert_allclose(moved, [[-0.024, 1.25e-5, 0.0, 0.5]], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("missing", [False, True])
def test_the_likelihood_is_that_of_the_whole_covariance(missing):
    # oracle: all values at once, mean and covariance multiplied out scan by scan; rows come every 5 scans
    model = site_flow(rest=1.5)
    one = matrices(silenced(model), nuisances(model))
    n, rows, every = one.n, 40, 5
    rng, scans = np.random.default_rng(0), 39 * 5 + 1
    u = np.column_stack([np.full(scans, 1.5), np.arange(float(scans)), np.ones(scans)])
    F, H = one.closed(0)
    P0, r = (
        1e-4 * np.eye(n),
        np.outer(np.where(np.arange(rows) // 15 % 2, 50.0, 1.0), [2e-7, 8e-8]),
    )  # rounding goes by decades
    mean, covariances, powers, means = one.start.copy(), [P0], [np.eye(n)], []
    for k in range(scans):
        means.append(H @ np.concatenate([mean, u[k]]))
        mean = F @ np.concatenate([mean, u[k]])
        covariances.append(F[:, :n] @ covariances[-1] @ F[:, :n].T + one.Q)
        powers.append(F[:, :n] @ powers[-1])
    C = np.zeros((2 * rows, 2 * rows))
    for i in range(rows):
        for j in range(i, rows):
            block = H[:, :n] @ powers[(j - i) * every] @ covariances[i * every] @ H[:, :n].T
            C[2 * j : 2 * j + 2, 2 * i : 2 * i + 2] = block
            C[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] = block.T
    C += np.diag(r.ravel())
    m = np.concatenate([means[i * every] for i in range(rows)])
    y = m + np.linalg.cholesky(C) @ rng.normal(size=len(m))
    kept = np.ones(len(y), dtype=bool)
    if missing:
        kept[20:30] = kept[51] = False
    off, own = (y - m)[kept], C[np.ix_(kept, kept)]
    whole = 0.5 * float(off @ np.linalg.solve(own, off) + np.linalg.slogdet(own)[1])
    steps = by_rows(one, every, P0)
    kind = steps.kinds(rows, every)
    Y = np.where(kept, y, np.nan).reshape(rows, 2)
    e, S, shown = (np.empty((rows, 2)) for _ in range(3))
    filtered(kind, steps.A, steps.Q, steps.H, steps.added(u, every, kind), np.zeros((rows, n)), Y, r,
             one.start.copy(), P0.copy(), e, S, shown)  # fmt: skip
    assert 0.5 * np.nansum(e**2 + np.log(S)) == pytest.approx(whole, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "values"),
    [("", {}), ("process_gain", {"factor": 0.97}), ("second_lag", {"tau": 0.6}), ("controller_filter", {"tau": 0.7}),
     ("scan_time", {"period": 3.0, "offset": 1.0, "present": 1.0})],
)  # fmt: skip
def test_it_leaves_what_the_filter_across_runs_leaves(site_record, name, values):
    # oracle: differences across runs of the engine, another program; set points switch between rows
    f = frame(site_flow(rest=1.5), site_record())
    place = {"": "", "controller_filter": "controller", "scan_time": "controller"}.get(name, "process")
    one = Hypothesis(f, effect(name) if name else None, place)
    exact, other = one.filtered(values), one.filtered(values, joined=True)
    assert exact.gains is None and other.gains is not None
    assert np.abs(exact.losses - other.losses)[f.skipped :].max() < 1e-3
    assert exact.nll == pytest.approx(other.nll, abs=1e-6 * len(f.Y))


def test_rows_behind_which_a_controller_may_be_at_its_limit_do_not_count():
    f = frame_of(*read(site_flow(rest=2.5), limited_log()))
    limited = f.scans.limited[0]
    assert 0 < limited.sum() < 0.05 * len(limited)
    assert limited[np.flatnonzero(f.record.log["OP"] >= 1.0)].all()
    assert not f.counted[limited].any() and not f.counted[np.flatnonzero(limited) + 1].any()
    left = Hypothesis(f).filtered({})
    assert left.gains is None and np.isnan(left.e[limited, f.signals.index("OP")]).all()


def limited_log():
    """Return a log of the flow loop in which OP reaches its upper limit at one switch of the set point."""
    model, t = site_flow(rest=2.5), np.arange(0.0, 3601.0, 5.0)
    SP = np.where((t > 600.0) & (t < 1200.0), 2.85, 2.5)
    run = ensemble(model, t[-1], times=t, inputs=Log(t, {"SP": SP}), seeds=[3], signals=["PV", "OP"], progress=False)
    PV, OP = np.round(run.values["PV"][0] / 0.0015) * 0.0015, run.values["OP"][0].round(3)
    return Log(t, {"SP": SP, "PV": PV, "OP": OP})


def test_a_fit_finds_gain_and_time_constant_and_leaves_white_innovations(site_record):
    f = frame(site_flow(rest=1.5), site_record())
    found = refined(Hypothesis(f).filtered({"process.K": 2.88, "process.tau": 10.8}), tuple(f.free))
    assert found.best.values["process.K"] == pytest.approx(3.0, rel=0.01)
    assert found.best.values["process.tau"] == pytest.approx(10.0, rel=0.05)
    assert np.nanstd(found.best.judged, axis=0) == pytest.approx([1.0, 1.0], abs=0.08)
    assert max(map(abs, checks(found.best).values())) < 5.0


def test_checks_see_innovations_that_remember(site_record):
    f = frame(site_flow(rest=1.5), site_record())
    wrong = checks(Hypothesis(f).filtered({"process.K": 2.85, "process.tau": 11.0}))
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


def test_what_an_exact_filter_follows(site_record):
    log, level = site_record(), site_record(middle=0.5, reach=0.1, digit=0.0005, loop=level_loop)
    assert frame_of(*read(site_flow(), log)).scans is not None
    assert frame_of(*read(second_order_flow(rest=1.5), log)).scans is not None
    assert frame_of(*read(level_loop(), level)).scans is not None
    cascade = Log(level.t, {"SP_L": level["SP"], "L": level["PV"], "SP": level["OP"], "PV": level["OP"],
                            "OP": level["OP"]})  # fmt: skip
    assert frame_of(*read(level_cascade(), cascade)).scans.controllers == ("level_controller", "controller")
    between = Log(log.t * 1.1, {s: log[s] for s in log.names})  # rows between scans
    assert frame_of(*read(site_flow(), between)).scans is None
