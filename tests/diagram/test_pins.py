"""Pins: offsets against an independent recursion, against the reference, and none where nothing differs."""

import numpy as np
import pytest
from scipy.linalg import expm
from stickslip.blocks import (
    PI,
    BlockError,
    FirstOrder,
    IdealValve,
    Noise,
    QuasiStaticStem,
    SampledSensor,
    Sensor,
    Staircase,
    Step,
    StickSlip,
    Sum,
)
from stickslip.blocks.pin import Pin
from stickslip.diagram import WiringError, simulate, wire
from stickslip.diagram.pins import pinned, replay, replays, residuals
from stickslip.diagram.reference import simulate_reference
from stickslip.logs import Log

from tests.diagram.random_diagrams import random_diagram

TIGHT = {"rtol": 1e-10, "atol": 1e-13}
LEVELS = [0.3, 0.5, 0.35, 0.6]


def loop(valve=None, *, K=3.0, tau=10.0, noisy=False):
    """Return a flow loop: PI, valve, first-order process, sensor with noise held between samples."""
    seen = [Sum("seen", {"PV": 1.0, "D": 1.0}), Noise("D", sd=0.004, dt=1.0)] if noisy else []
    return wire(
        [
            Staircase("SP", LEVELS, dwell=75.0),
            PI(0.4, 10.0, anti_windup="conditional", inputs={"PV": "PV_m"}, start_op=0.1),
            valve or IdealValve(),
            FirstOrder(K, tau, start=0.3),
            *seen,
            Sensor(inputs="seen" if noisy else "PV", outputs="PV_m"),
        ]
    )


def jittered(rng, n, dt=1.0):
    """Return increasing stamps that are not periodic."""
    return np.cumsum(rng.uniform(0.3 * dt, 1.7 * dt, n)) - 0.3 * dt


def test_offsets_are_those_of_an_exact_recursion_at_irregular_times():
    """Between samples the loop z' = A z is linear, so expm carries it exactly (analytic)."""
    rng = np.random.default_rng(3)
    K_p, T_i, K, tau, SP = 0.5, 8.0, 1.5, 6.0, 0.4
    t = jittered(rng, 60)
    values = {"PV": 0.4 + 0.05 * rng.normal(size=60), "OP": 0.3 + 0.05 * rng.normal(size=60)}
    model = wire(
        [Step("SP", SP), PI(K_p, T_i, low=-9.0, high=9.0, start_op=0.2, start_error=0.1), IdealValve(),
         FirstOrder(K, tau, start=0.3)]
    )  # fmt: skip
    run = replay(model, Log(t=t, signals=values), **TIGHT)

    pv, z, o_pv, o_op = 0.3, 0.2 - K_p * 0.1, 0.0, 0.0
    expected = {"PV": [], "OP": []}
    for k in range(60):
        if k:
            # with s = pv + o_pv: op = K_p (SP - s) + z + o_op; pv' = (K op - pv)/tau; z' = K_p (SP - s)/T_i
            A = np.zeros((3, 3))
            A[0] = [(-K * K_p - 1.0) / tau, K / tau, (K * (K_p * (SP - o_pv) + o_op)) / tau]
            A[1] = [-K_p / T_i, 0.0, K_p * (SP - o_pv) / T_i]
            pv, z, _ = expm(A * (t[k] - t[k - 1])) @ [pv, z, 1.0]
        o_pv = values["PV"][k] - pv
        o_op = values["OP"][k] - (K_p * (SP - values["PV"][k]) + z)
        expected["PV"].append(o_pv)
        expected["OP"].append(o_op)
    for signal, offsets in residuals(run).items():
        np.testing.assert_allclose(offsets, expected[signal], atol=1e-8)


@pytest.mark.parametrize(
    "valve", [IdealValve(), QuasiStaticStem(0.06, 0.02), StickSlip.high()], ids=["ideal", "massless", "mass"]
)
def test_a_diagram_pinned_to_its_own_log_moves_nothing(valve):
    model = loop(valve, noisy=True)
    log = simulate(model, 300.0, every=1.0, **TIGHT).log
    for signal, offsets in residuals(replay(model, log, **TIGHT)).items():
        assert np.abs(offsets).max() < 1e-9, signal


def test_noise_comes_back_and_the_controller_shows_no_error():
    """The sensor's pin gives the noise itself, the controller's only rounding (analytic)."""
    truth, model = loop(noisy=True), loop()
    run = simulate(truth, 300.0, every=1.0, **TIGHT)
    found = residuals(replay(model, Log(run.log.t, {s: run.log[s] for s in ("OP", "PV_m")}), **TIGHT))
    np.testing.assert_allclose(found["PV_m"], run.log["D"], atol=1e-9)
    assert np.abs(np.diff(found["OP"])).max() < 1e-9


def test_a_slip_at_the_instant_of_a_sample_is_no_error_of_the_stem():
    """OP jumps with the held noise, the massless stem slips at once, and its logged MV is the one after the slip."""
    model = loop(QuasiStaticStem(0.06, 0.02), noisy=True)
    run = simulate(model, 300.0, every=1.0, **TIGHT)
    at_samples = [e for e in run.events if e.t == round(e.t) > 0.0]
    assert len(at_samples) > 3
    found = residuals(
        replay(loop(QuasiStaticStem(0.06, 0.02)), Log(run.log.t, {s: run.log[s] for s in ("OP", "MV", "PV_m")}))
    )
    assert np.abs(found["MV"]).max() < 1e-6


def test_a_wrong_gain_shows_behind_the_process_and_not_in_the_controller():
    run = simulate(loop(K=3.3), 300.0, every=1.0, **TIGHT)
    found = residuals(replay(loop(), Log(run.log.t, {s: run.log[s] for s in ("OP", "PV_m")}), **TIGHT))
    assert np.abs(found["PV_m"][20:]).max() > 1e-2
    assert np.abs(np.diff(found["OP"]))[20:].max() < 1e-3


def test_what_is_not_logged_is_not_pinned_there_and_says_nothing():
    log = Log([0.0, 1.0, 2.0, 3.0], {"PV": [0.0, np.nan, 0.2, 0.3]}, quality={"PV": [True, True, True, False]})
    run = replay(wire([Step("MV", 1.0), FirstOrder(1.0, 5.0)]), log)
    assert np.isnan(residuals(run)["PV"]).tolist() == [False, True, False, True]
    assert run.log["PV:offset"][1] == run.log["PV:offset"][0] == 0.0
    assert run.log["PV:offset"][3] == run.log["PV:offset"][2]


def test_an_open_input_that_is_logged_is_driven_by_the_log_and_held():
    log = Log([0.0, 1.0, 2.0], {"MV": [1.0, 0.0, 1.0], "PV": [0.0, 0.0, 0.0]})
    model = wire([FirstOrder(1.0, 5.0)], inputs=["MV"])
    run = simulate(model.pinned(log), 2.0, times=[0.0, 0.5, 1.0, 1.5, 2.0])
    assert run.log["MV"].tolist() == [1.0, 1.0, 0.0, 0.0, 1.0]


def test_a_continued_replay_equals_one_in_one_piece():
    rng = np.random.default_rng(7)
    t = jittered(rng, 80)
    log = Log(t, {"OP": 0.3 + 0.02 * rng.normal(size=80), "PV_m": 0.4 + 0.02 * rng.normal(size=80)})
    held = loop().pinned(log)
    whole = simulate(held, 60.0, every=0.5)
    first = simulate(held, 30.0, every=0.5)
    rest = simulate(first.final, 30.0, every=0.5, t0=30.0)
    for signal in whole.log.names:
        joined = np.concatenate([first.log[signal], rest.log[signal][1:]])
        np.testing.assert_allclose(joined, whole.log[signal], rtol=0, atol=1e-6)


def test_a_run_may_be_pinned_from_where_another_ended():
    first = simulate(loop(), 40.0, every=1.0)
    log = Log([40.0, 41.0], {"PV_m": [0.9, 0.8]})
    run = simulate(first.final.pinned(log), 2.0, t0=40.0, every=1.0)
    assert run.log["PV_m"][:2].tolist() == pytest.approx([0.9, 0.8])


def test_many_replays_equal_single_ones_with_parameters_windows_and_starts_of_their_own():
    run = simulate(loop(noisy=True), 300.0, every=1.0)
    log = Log(run.log.t, {s: run.log[s] for s in ("OP", "PV_m")})
    windows = [log.samples(first, first + 60) for first in (0, 40, 100, 200)]
    gains, starts = [2.9, 3.0, 3.1, 3.0], [0.3, 0.4, 0.4, 0.5]
    many = replays(loop(), windows, params={"process.K": gains}, start={"process.PV": starts}, workers=2)
    assert many.ok.all()
    for i, window in enumerate(windows):
        alone = replay(loop(), window, params={"process.K": gains[i]}, start={"process.PV": starts[i]})
        for signal, offsets in residuals(alone).items():
            np.testing.assert_array_equal(many.values[f"{signal}:offset"][i], offsets)
        assert many.log(i).t.tolist() == window.t.tolist()
        np.testing.assert_array_equal(many.run(i).log["OP:offset"], alone.log["OP:offset"])


def test_replays_of_one_log_share_its_table_and_may_keep_a_summary_only():
    run = simulate(loop(noisy=True), 100.0, every=1.0)
    log = Log(run.log.t, {s: run.log[s] for s in ("OP", "PV_m")})

    def rms(t, kept):
        return {"rms": float(np.sqrt(np.mean(kept["PV_m:offset"][20:] ** 2)))}

    many = replays(loop(), log, params={"process.K": [2.7, 3.0, 3.3]}, keep_logs=False, summary=rms)
    assert not many.values
    assert int(np.argmin(many.summary["rms"])) == 1
    assert many.variant(0)["PV_m pin"].timetable is many.variant(2)["PV_m pin"].timetable


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5])
def test_random_diagrams_agree_with_the_reference(seed):
    model = random_diagram(seed)
    rng = np.random.default_rng(seed)
    t = jittered(rng, 6, 0.4)
    wanted = [s for s in model.signals if s.rpartition("/")[2] in ("PV", "OP", "MV", "PV_m")]
    truth = simulate(model, float(t[-1]), times=t)
    log = Log(t, {s: truth.log[s] + 0.01 * rng.normal(size=len(t)) for s in wanted})
    held = pinned(model, log)
    ours = residuals(simulate(held, float(t[-1]), times=t, rtol=1e-9, atol=1e-11))
    other = residuals(simulate_reference(held, float(t[-1]), times=t, method="LSODA", rtol=1e-8, atol=1e-10))
    assert set(ours) == set(wanted)
    for signal, offsets in ours.items():
        np.testing.assert_allclose(offsets, other[signal], atol=2e-6, err_msg=f"{model.name} {signal}")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: loop().pinned(Log([0.0], {"FIC": [1.0]})), ["none of the diagram's signals", "FIC", "renamed"]),
        (lambda: loop().pinned(Log([0.0], {"PV": [1.0]}), ["PVm"]), ["no signal 'PVm'", "did you mean 'PV_m'"]),
        (lambda: loop().pinned({"PV": 3}), ["give a Log"]),
        (lambda: loop().pinned(Log([0.0], {"PV": [np.nan], "OP": [1.0]}), ["PV"]), ["no good sample of 'PV'"]),
    ],
)  # fmt: skip
def test_misuse_is_refused_with_value_rule_and_remedy(make, words):
    with pytest.raises(WiringError) as error:
        make()
    for word in words:
        assert word in str(error.value)


def scanned(sd=0.0):
    return wire(
        [Step("MV", 1.0), FirstOrder(2.0, 5.0, outputs="y"), SampledSensor(1.0, sd=sd, inputs="y", outputs="PV")]
    )


def test_noise_that_is_drawn_anew_holds_no_longer_than_its_scan():
    log = Log([0.0, 2.0, 4.5], {"PV": [0.1, 0.9, 1.3]})
    held = scanned().pinned(log, ["PV"], {"PV": (1.0, 0.0)})
    run = simulate(held, 5.0, every=0.5, **TIGHT)
    y = 2.0 * (1.0 - np.exp(-np.floor(run.log.t) / 5.0))  # analytic: the sensor holds what it saw at the last second
    off = np.zeros(11)  # each offset holds over the scan that its row shows, 4.5 s that of 4 s
    off[:2], off[4:6], off[8:] = 0.1, 0.9 - y[4], 1.3 - y[9]  # the last is held
    np.testing.assert_allclose(run.log["PV:offset"], off, atol=1e-9)
    np.testing.assert_allclose(run.log["PV"], y + off, atol=1e-9)
    np.testing.assert_allclose(simulate_reference(held, 5.0, every=0.5).log["PV:offset"], off, atol=1e-6)


def test_rows_as_frequent_as_scans_are_pinned_as_ever():
    log = Log(np.arange(6.0), {"PV": np.linspace(0.0, 1.0, 6)})
    plain, fresh = (scanned().pinned(log, ["PV"], one) for one in (None, {"PV": (1.0, 0.0)}))
    assert np.array_equal(plain["PV pin"].timetable, fresh["PV pin"].timetable)


def test_an_offset_that_ends_before_its_row_is_refused():
    with pytest.raises(BlockError, match="until"):
        Pin([0.0, 1.0], [0.5, 0.7], until=[1.0, 0.5])
