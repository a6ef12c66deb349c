"""Ensembles: every variant is the simulation it claims to be, and no failure of one spoils the others."""

import json
import threading

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks import Constant, FirstOrder, Noise, Recorded, SampledPI, Sine, Step
from stickslip.diagram import simulate, wire
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.ensembles.variants import reseeded
from stickslip.engine.status import Status
from stickslip.logs import Log
from stickslip.plant.loops import self_regulating_loop

LOOP = self_regulating_loop()
LAG = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)], name="lag")


def same(result, i, run):
    """Tell whether variant i is this run, to the last bit."""
    return all(np.array_equal(result.values[s][i], run.log[s], equal_nan=True) for s in result.values)


def test_variants_equal_single_simulations_to_the_last_bit():
    values = {"valve.F_s": np.linspace(1500.0, 2300.0, 9), "process.K": np.linspace(2.0, 4.0, 9)}
    result = ensemble(LOOP, 300.0, params=values, start={"process.PV": np.linspace(0.0, 0.5, 9)}, every=0.1, workers=2)
    assert result.ok.all()
    for i in range(9):
        run = simulate(
            LOOP, 300.0, every=0.1,
            params={key: float(column[i]) for key, column in values.items()},
            start={"process.PV": float(result.start["process.PV"][i])},
        )  # fmt: skip
        assert same(result, i, run)
        assert result.events(i) == run.events
        assert result.event_counts[i] == run.statistics.events
        assert same(result, i, result.run(i))
        assert np.array_equal(result.log(i)["PV"], run.log["PV"])


def test_variants_follow_the_closed_form():
    # analytic: step response of a first-order lag, PV = K (1 - exp(-t / tau))
    gain, tau = np.array([0.5, 1.0, 2.0, 3.0]), np.array([1.0, 5.0, 10.0, 20.0])
    result = ensemble(LAG, 50.0, params={"process.K": gain, "process.tau": tau}, every=0.5, rtol=1e-9, atol=1e-12)
    exact = gain[:, None] * (1.0 - np.exp(-result.t / tau[:, None]))
    assert np.abs(result.values["PV"] - exact).max() < 1e-7


@settings(max_examples=15)
@given(
    st.lists(st.tuples(st.floats(0.5, 5.0), st.just(0.0) | st.floats(0.1, 3.0)), min_size=1, max_size=6),
    st.integers(1, 3),
)
def test_dead_times_vary_and_may_vanish(rows, workers):
    tau, theta = (np.array(column) for column in zip(*rows, strict=True))
    result = ensemble(LAG, 20.0, params={"process.tau": tau, "process.theta": theta}, every=0.25, workers=workers)
    for i in range(len(rows)):
        run = simulate(LAG, 20.0, every=0.25, params={"process.tau": tau[i], "process.theta": theta[i]})
        assert same(result, i, run)


def test_a_full_delay_line_is_made_longer():
    # 6000 steps of the source's staircase lie in the dead time, more than the first delay line holds
    t = np.arange(0.0, 700.0, 0.1)
    plant = wire([Recorded("MV", t, np.sin(t), hold="previous"), FirstOrder(K=1.0, tau=5.0, theta=10.0)])
    result = ensemble(plant, 650.0, params={"process.theta": [20.0, 600.0, 5.0]}, every=1.0, signals=["PV"], workers=2)
    assert result.ok.all()
    for i, theta in enumerate((20.0, 600.0, 5.0)):
        assert same(result, i, simulate(plant, 650.0, every=1.0, params={"process.theta": theta}))


def test_runs_have_start_times_log_times_and_inputs_of_their_own():
    plant = wire([FirstOrder(K=2.0, tau=5.0)], inputs=["MV"], name="lag")
    tables = [([0.0, 4.0], [0.0, 1.0]), ([0.0, 1.0, 20.0], [1.0, -1.0, 3.0]), ([5.0], [0.5])]
    times = np.array([[0.0, 2.0, 9.5], [3.0, 3.5, 12.0], [5.0, 6.0, 7.0]])
    result = ensemble(plant, 10.0, t0=[0.0, 3.0, 5.0], times=times, inputs={"MV": tables}, workers=2)
    for i, table in enumerate(tables):
        run = simulate(plant, 10.0, t0=float(times[i, 0]), times=times[i], inputs={"MV": table})
        assert same(result, i, run)
        assert same(result, i, result.run(i))
        assert result.log(i).t.tolist() == times[i].tolist()


def test_start_times_alone_make_runs_and_every_counts_from_each():
    result = ensemble(wire([Sine("F")], outputs=["F"]), 2.0, t0=[0.0, 0.25], every=1.0)
    assert result.t.tolist() == [[0.0, 1.0, 2.0], [0.25, 1.25, 2.25]]
    np.testing.assert_allclose(result.values["F"], np.sin(2.0 * np.pi * result.t), atol=1e-12)
    assert result.plot("F").axes


def test_constant_inputs_as_an_array_and_one_for_all():
    plant = wire([FirstOrder(K=2.0, tau=5.0)], inputs=["MV"])
    result = ensemble(plant, 5.0, inputs={"MV": np.array([1.0, 2.0])}, times=[0.0, 5.0])
    assert result.values["PV"][1].tolist() == pytest.approx((2.0 * result.values["PV"][0]).tolist())


def test_many_branches_go_on_from_where_a_run_ended():
    plant = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0, theta=4.0)])
    first = simulate(plant, 10.0)
    gains = [1.0, 2.0, 3.0]
    result = ensemble(first.final, 5.0, t0=10.0, params={"process.K": gains}, every=1.0)
    for i, K in enumerate(gains):
        assert same(result, i, simulate(first.final, 5.0, t0=10.0, params={"process.K": K}, every=1.0))


def test_inputs_of_two_kinds_and_numbers_of_runs_that_disagree_are_refused():
    plant = wire([FirstOrder(K=2.0, tau=5.0)], inputs=["MV"])
    with pytest.raises(ValueError, match=r"variant 1 has .*differ in numbers only"):
        ensemble(plant, 5.0, inputs={"MV": [1.0, ([0.0], [1.0])]})
    with pytest.raises(ValueError, match="'t0' 3"):
        ensemble(plant, 5.0, inputs={"MV": [1.0, 2.0]}, t0=[0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match="strictly"):
        ensemble(plant, 5.0, inputs={"MV": 1.0}, times=[[0.0, 1.0], [1.0, 0.0]])


def test_seeds_name_streams():
    noisy = wire(
        [Noise("MV", sd=1.0, dt=1.0), Noise("D", sd=1.0, dt=1.0), FirstOrder(K=2.0, tau=5.0)], outputs=["D", "PV"]
    )
    result = ensemble(noisy, 50.0, seeds=[3, 4, 3], every=1.0)
    assert np.array_equal(result.values["MV"][0], result.values["MV"][2])
    assert not np.array_equal(result.values["MV"][0], result.values["MV"][1])
    assert not np.array_equal(result.values["MV"][0], result.values["D"][0]), "blocks draw streams of their own"
    for i, seed in enumerate((3, 4, 3)):
        assert same(result, i, simulate(reseeded(noisy, seed), 50.0, every=1.0))
    assert noisy["MV"].reseeded((3, 0)).d0.tolist() == reseeded(noisy, 3)["MV"].d0.tolist()


def test_parts_that_share_a_source_all_see_its_parameters():
    loops = wire([Step("MV", 1.0), *(FirstOrder(K=1.0, tau=5.0, name=f"p{k}", outputs=f"y{k}") for k in range(3))])
    result = ensemble(loops, 10.0, params={"MV.after": [1.0, 2.0]}, every=1.0)
    assert result.statistics.components == 3
    for k in range(3):
        assert np.allclose(result.values[f"y{k}"][1], 2.0 * result.values[f"y{k}"][0], rtol=1e-5)  # linear


def test_only_the_wanted_is_kept_and_summaries_are_made():
    gains = np.array([1.0, 2.0, 3.0])

    def last(t, signals):
        return {"end": signals["PV"][-1], "rows": len(t), "signals": len(signals)}

    result = ensemble(LAG, 100.0, params={"process.K": gains}, signals=["PV"], keep_logs=False, summary=last, every=1.0)
    assert np.allclose(result.summary["end"], gains, rtol=1e-5)  # analytic: the gain, e^-20 away
    assert result.summary["rows"].tolist() == [101.0] * 3 and result.summary["signals"].tolist() == [1.0] * 3
    assert not result.values and result.events(0) == ()
    with pytest.raises(ValueError, match="keep_logs=True"):
        result.log(0)
    kept = ensemble(LAG, 100.0, params={"process.K": gains}, signals=["PV"])
    assert list(kept.values) == ["PV"] and kept.values["PV"].shape == (3, 1001)
    with pytest.raises(ValueError, match="read-only"):
        kept.values["PV"][0] = 0.0


def test_ctrl_c_returns_what_is_finished():
    pressed = threading.Event()

    def wait_for_key(t, signals):
        assert pressed.wait(30.0)
        return {"end": signals["PV"][-1]}

    def press(done, variants):
        pressed.set()
        raise KeyboardInterrupt

    result = ensemble(LAG, 10.0, params={"process.K": np.ones(20_000)}, workers=1, summary=wait_for_key, progress=press)
    assert result.status[0] == Status.OK and result.status[-1] == Status.INTERRUPTED
    assert np.isnan(result.values["PV"][-1]).all() and not np.isnan(result.values["PV"][0]).any()
    assert np.isnan(result.summary["end"][-1])
    assert "interrupted" in result.hint(19_999)


def test_ctrl_c_does_not_wait_for_a_long_variant():
    def press(done, variants):
        raise KeyboardInterrupt

    # a sampled loop of 1e9 samples, hours long: the test ends because the variant is stopped on its way
    sampled = wire([Sine("SP", 1.0, 10.0), SampledPI(1.0, 10.0, dt=0.01), Constant("PV", 0.0)])
    params = {"controller.K_p": [1.0]}
    result = ensemble(sampled, 1e7, params=params, every=1e6, max_steps=10**12, workers=1, progress=press)
    assert result.status.tolist() == [Status.INTERRUPTED] and np.isnan(result.values["OP"]).all()


def test_progress_is_told_to_the_end():
    progress = []
    ensemble(
        LAG, 10.0, params={"process.K": np.ones(7)}, progress=lambda done, variants: progress.append((done, variants))
    )
    assert progress[-1] == (7, 7)
    assert [done for done, _ in progress] == sorted(done for done, _ in progress)


def test_a_bar_is_drawn_on_standard_error_only(capsys):
    ensemble(LAG, 10.0, params={"process.K": np.ones(3)}, progress=True)
    ensemble(LAG, 10.0, params={"process.K": np.ones(3)}, progress=False)
    assert capsys.readouterr().out == ""


def test_parquet_holds_one_row_a_variant(tmp_path):
    result = ensemble(
        LAG, 10.0, params={"process.K": [1.0, 2.0]}, start={"process.PV": [0.0, 0.5]}, seeds=[5, 6], every=1.0,
        summary=lambda t, s: {"end": s["PV"][-1]},
    )  # fmt: skip
    path = tmp_path / "variants.parquet"
    result.to_parquet(path)
    frame = pl.read_parquet(path)
    assert frame.columns == [
        "variant", "status", "process.K", "process.PV(0)", "seed", "events", "summary.end", "MV", "PV"
    ]  # fmt: skip
    assert np.array_equal(frame["PV"].to_numpy(), result.values["PV"])
    assert frame["status"].to_list() == ["OK", "OK"] and frame["seed"].to_list() == [5, 6]
    heading = json.loads(pl.read_parquet_metadata(path)["stickslip"])
    assert heading["time [s]"] == result.t.tolist()
    assert [p.name for p in tmp_path.iterdir()] == ["variants.parquet"]


def test_a_failing_write_leaves_nothing(tmp_path):
    result = ensemble(LAG, 10.0, params={"process.K": [1.0]})
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError):
        result.to_parquet(tmp_path / "taken")
    assert [p.name for p in tmp_path.iterdir()] == ["taken"]


def test_one_variant_is_told_from_the_others():
    result = ensemble(LAG, 10.0, params={"process.K": [1.0, 2.0]}, seeds=[5, 6])
    assert result.described(1) == "process.K = 2, seed 6"
    assert "variant 1: process.K = 2, seed 6" in result.log(1).origin
    with pytest.raises(IndexError, match="no variant 2"):
        result.variant(2)
    with pytest.raises(IndexError, match="no variant 2"):
        result.log(2)


def held_lag(SP, PV):
    """A lag that is held to a log of three rows."""
    lag = wire([FirstOrder(K=2.0, tau=5.0, inputs="SP")], inputs=["SP"])
    return lag.pinned(Log([0.0, 1.0, 2.0], {"SP": SP, "PV": PV}))


def test_ensembles_of_one_diagram_that_follow_each_other_are_as_they_would_be_alone():
    """They share what the diagram is laid out as; values, starts and tables are each one's own."""
    used, other = held_lag([0.0, 1.0, 0.5], [0.0, 0.3, 0.4]), held_lag([1.0, 1.0, 1.0], [0.0, 0.9, 0.8])
    asked = [
        {"params": {"process.K": [1.0, 3.0]}},
        {"params": {"process.K": [2.5]}, "start": {"process.PV": [0.2]}},
        {"params": {"process.K": [2.0]}, "blocks": {"PV pin": [other["PV pin"]]}},
        {"params": {"process.K": [2.0]}},
        {"params": {"process.K": [0.5]}, "start": {"process.PV": [0.1]}},
    ]
    for request in asked:
        fresh = held_lag([0.0, 1.0, 0.5], [0.0, 0.3, 0.4])
        found, alone = (ensemble(one, 3.0, every=0.5, progress=False, **request) for one in (used, fresh))
        assert all((found.values[s] == alone.values[s]).all() for s in found.values)
    assert not (found.values["PV"] == 0.0).all()
