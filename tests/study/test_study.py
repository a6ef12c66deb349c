"""Studies: right numbers, random points, refused requests."""

import numpy as np
import polars as pl
import pytest
from stickslip.diagram import simulate
from stickslip.logs.oscillation import oscillation
from stickslip.plant.loops import integrating_loop, self_regulating_loop
from stickslip.study import StudyError, Subject, study, uniform

from tests.study.small_study import GRID, OPTIONS, small


def test_amplitude_follows_the_bands_and_the_gain():
    gains, sizes = [0.1, 0.2, 0.4], [1750.0, 2250.0]
    found = study(
        integrating_loop(), {"controller.K_p": gains, "valve.F_s": sizes}, start={"process.PV": 0.5},
        duration=12000.0, every=1.0, progress=False,
    )  # fmt: skip
    # analytic: amplitude of PV = S/(2 K_p), S = (F_s + F_c)/k; integral action (T_i = 400 s) takes a few percent
    expected = [(F_s + 1250.0) / 52500.0 / (2.0 * K_p) for K_p in gains for F_s in sizes]
    assert found.column("PV.amplitude") == pytest.approx(expected, rel=0.08)
    # analytic: the stem jumps by J = (F_s - F_c)/k and follows OP a little before it sticks, more at a high gain
    jumps = [0.5 * (F_s - 1250.0) / 52500.0 for _ in gains for F_s in sizes]
    assert found.column("MV.amplitude") == pytest.approx(jumps, rel=0.15)
    assert (found.column("valve.slips") >= 2).all()


def test_a_row_is_what_a_plain_run_gives(whole):
    start = 0.5 * np.random.default_rng(2009).uniform(0.97, 1.03, (2, 1))[1, 0]
    run = simulate(
        integrating_loop().with_params({"valve.F_s": 2000.0, "controller.K_p": 0.4}), 400.0, every=1.0,
        start={"process.PV": start},
    )  # fmt: skip
    late = run.log.t >= 200.0
    row = whole.table.filter(pl.col("point") == 5, pl.col("kick") == 1)
    cycle = oscillation(run.log.t[late], run.log["PV"][late])
    assert row["PV.amplitude"][0] == cycle.amplitude  # bit for bit: the same numbers went through the same engine
    assert row["PV.sd"][0] == pytest.approx(run.log["PV"][late].std(), rel=1e-12)
    assert row["valve.F_s"][0] == 2000.0 and row["controller.K_p"][0] == 0.4


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"vary": {"valve.F_S": [1.0]}}, "did you mean 'valve.F_s'"),
        ({"vary": {"vlave.F_s": [1.0]}}, "did you mean 'valve.F_s'"),
        ({"plant": {"F_in": [1.0]}}, "no quantity 'F_in'"),
        ({"start": {"process.pv": [1.0]}}, "did you mean 'process.PV'"),
        ({"signals": ["OPP"]}, "did you mean 'OP'"),
        ({"signals": []}, "no signal to measure"),
        ({"kick_size": 1.5}, "0 < kick_size < 1"),
        ({"kicks": 1.5}, "kicks = 1.5, but it is a whole number"),
        ({"random": "3"}, "random = '3', but it is a whole number"),
        ({"seed": None}, "seed = None, but it is a whole number"),
        ({"workers": 1.5}, "workers = 1.5, but it is a whole number"),
        ({"longest": 0.0}, "longest = 0.0, but a study takes some time"),
        ({"longest": float("nan")}, "longest = nan"),
        ({"vary": {"valve.F_s": None}}, "'valve.F_s' = None is no list of numbers"),
        ({"vary": {"valve.F_s": [[2000.0]]}}, "is no list of numbers; give some, or a law"),
        ({"seed": -1}, "0 or more"),
        ({"workers": 0}, "at least one thread"),
        ({"measure_from": 400.0}, "must lie within the run"),
        ({"measure_from": 399.0}, "leaves 2 rows of the log, but an amplitude needs at least 3"),
        ({"start": {"process.PV": [float("inf")]}}, "none of the .* runs is possible.*to start at inf"),
        ({"every": 1e-7}, "give a longer every"),
        ({"duration": -1.0}, "positive number of seconds"),
        ({"vary": {"valve.F_s": [-5.0, -6.0]}}, "none of the 4 runs is possible.*F_s"),
    ],
)
def test_requests_that_make_no_sense_are_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        study(integrating_loop(), **{"vary": GRID, **OPTIONS, **changes})


def test_a_study_that_takes_too_long_says_how_long(short_parts):
    with pytest.raises(StudyError, match=r"runs of .* ms on 1 threads would take about .* raise longest"):
        small(workers=1, longest=1e-9)


def test_values_that_a_block_rejects_are_rows_with_the_reason():
    found = study(integrating_loop(), {"valve.F_s": [1000.0, 2250.0]}, **OPTIONS)
    assert found.table["status"].to_list() == ["REFUSED", "REFUSED", "OK", "OK"]
    assert "F_s = 1000.0" in found.table["reason"][0] and found.table["PV.amplitude"][0] is None
    assert found.counts() == {"ok": 2, "infeasible": 0, "refused": 2, "failed": 0}


def test_infinity_is_a_value_and_noise_differs_between_kicks(tmp_path):
    found = study(
        integrating_loop(),
        {"controller.high": [0.02, float("inf")], "controller.low": [-0.02]},
        out=tmp_path,
        **OPTIONS,
    )
    row = study(
        integrating_loop().with_params({"controller.high": 0.02}), {"controller.high": [0.02, float("inf")]}, **OPTIONS
    )
    assert found.complete and row.table["OP.saturated"][0] > 0.0 and row.table["OP.saturated"][2] is None
    from stickslip.blocks import PI, Integrator, SampledSensor, Step
    from stickslip.diagram import wire

    loop = wire(
        [
            Step("SP", after=0.0),
            PI(K_p=0.2, T_i=400.0, inputs=["SP", "y"], outputs="MV", low=-1.0, high=1.0),
            Integrator(K=3.0, T=10.0),
            SampledSensor(dt=1.0, sd=0.1, inputs="PV", outputs="y"),
        ]
    )
    noisy = study(loop, kicks=3, duration=50.0, every=1.0, signals=["y"], kick_size=1e-12)
    assert noisy.table["y.sd"].n_unique() == 3


def test_random_points_follow_the_seed():
    def drawn(seed):
        laws = {"valve.F_s": uniform(1750, 2250)}
        return study(integrating_loop(), laws, random=4, seed=seed, duration=50.0, every=1.0).table["valve.F_s"]

    assert drawn(1).equals(drawn(1)) and not drawn(1).equals(drawn(2))
    assert drawn(1).is_between(1750.0, 2250.0).all()


def test_progress_ends_at_all_runs():
    progress = []
    small(progress=lambda done, runs: progress.append((done, runs)))
    assert progress[-1] == (18, 18) and sorted(progress) == progress


def test_a_builder_of_ones_own():
    subject = Subject(
        "loop", lambda values: self_regulating_loop(**values), {"tau": 10.0, "setpoint": 0.5}, stages={"x": ("PV",)}
    )
    found = study(subject, plant={"tau": [5.0, 20.0]}, duration=300.0, every=1.0)
    run = simulate(self_regulating_loop(tau=20.0), 300.0, every=1.0)
    late = run.log.t >= 150.0
    assert found.table["PV.mean"][1] == pytest.approx(run.log["PV"][late].mean(), rel=1e-13)
    assert found.table["plant.tau"].to_list() == [5.0, 20.0]


def test_the_table_can_be_written_and_read(whole, tmp_path):
    whole.to_parquet(tmp_path / "rows.parquet")
    assert pl.read_parquet(tmp_path / "rows.parquet").equals(whole.table)
    assert "1" in str(len(whole)) and "valve.F_s" in repr(whole)
    with pytest.raises(StudyError, match=r"did you mean 'PV\.amplitude'"):
        whole.column("PV.amplitud")


def test_one_signal_may_be_named_without_a_list():
    found = study(integrating_loop(), {"valve.F_s": [2250.0]}, signals="PV", duration=20.0, every=1.0)
    assert found.signals == ("PV",)
