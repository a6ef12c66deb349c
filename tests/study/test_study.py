"""Studies: right numbers, equal bytes however interrupted, refused requests."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from diagram import simulate
from logs.files.resumable import RowsFolder, parquet
from logs.oscillation import oscillation
from plant import kicked, production_plant
from plant.loops import integrating_loop, self_regulating_loop
from study import StudyError, Subject, production_subject, study, uniform
from study import run as running
from study.groups import groups
from study.request import fingerprint

ROOT = Path(__file__).resolve().parents[2]
GRID = {"valve.F_s": [1750.0, 2000.0, 2250.0], "controller.K_p": [0.1, 0.2, 0.4]}
OPTIONS = {"start": {"process.PV": [0.5]}, "kicks": 2, "duration": 400.0, "every": 1.0, "progress": False}


def small(**changes):
    return study(integrating_loop(), GRID, **{**OPTIONS, **changes})


@pytest.fixture(scope="module")
def whole():
    """The small study made in one go."""
    return small(workers=1)


@pytest.fixture
def short_parts(monkeypatch):
    """Parts of a few runs, so that a small study has several."""
    monkeypatch.setattr(running, "PART_SECONDS", 1e-9)
    monkeypatch.setattr(running, "FIRST_PART", 1)


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


def test_workers_do_not_change_a_byte(whole, short_parts):
    assert parquet(small(workers=3).table) == parquet(whole.table)


def test_an_interrupted_study_goes_on_and_gives_the_same_bytes(whole, tmp_path, monkeypatch, short_parts):
    small(out=tmp_path / "one", workers=1)
    kept, add = [], RowsFolder.add

    def breaks_down(self, table):
        if len(kept) == 3:
            raise RuntimeError("the machine is gone")
        kept.append(table)
        add(self, table)

    monkeypatch.setattr(RowsFolder, "add", breaks_down)
    with pytest.raises(RuntimeError, match="gone"):
        small(out=tmp_path / "two", workers=2)
    monkeypatch.setattr(RowsFolder, "add", add)
    assert not (tmp_path / "two" / "study.parquet").exists()
    made = []
    split = running.Points.split
    monkeypatch.setattr(running.Points, "split", lambda self, runs: made.extend(runs) or split(self, runs))
    small(out=tmp_path / "two", workers=1)
    assert len(made) == len(whole) - sum(map(len, kept))  # nothing is made twice
    one, two = ((tmp_path / name / "study.parquet").read_bytes() for name in ("one", "two"))
    assert one == two
    assert not (tmp_path / "two" / "parts").exists()
    assert pl.read_parquet(tmp_path / "two" / "study.parquet").equals(whole.table)


def test_ctrl_c_keeps_what_is_finished(whole, tmp_path, monkeypatch, short_parts):
    calls, ensemble = [], running.ensemble

    def stopped(*arguments, **keywords):
        calls.append(1)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return ensemble(*arguments, **keywords)

    monkeypatch.setattr(running, "ensemble", stopped)
    part = small(out=tmp_path, workers=1)
    assert not part.complete and 0 < len(part) < len(whole)
    assert '"interrupted"' in (tmp_path / "study.json").read_text()
    again = small(out=tmp_path, workers=1)
    assert again.complete and again.table.equals(whole.table)


def test_kill_9_loses_nothing_but_the_last_part(tmp_path):
    code = (
        "from tests.study import test_study as t\n"
        "t.running.PART_SECONDS, t.running.FIRST_PART = 1e-9, 1\n"
        f"t.small(out={str(tmp_path / 'killed')!r}, workers=1, kicks=60, duration=2000.0)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT)
    parts, deadline = tmp_path / "killed" / "parts", time.monotonic() + 90.0
    while time.monotonic() < deadline and process.poll() is None and len(list(parts.glob("0*.parquet"))) < 5:
        time.sleep(0.01)
    assert process.poll() is None, "the study ended before it could be killed"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert len(list(parts.glob("0*.parquet"))) >= 5
    small(out=tmp_path / "killed", workers=2, kicks=60, duration=2000.0)
    small(out=tmp_path / "quiet", workers=1, kicks=60, duration=2000.0)
    killed, quiet = ((tmp_path / name / "study.parquet").read_bytes() for name in ("killed", "quiet"))
    assert killed == quiet


def test_a_part_that_cannot_be_read_is_made_again(whole, tmp_path, monkeypatch, short_parts):
    monkeypatch.setattr(RowsFolder, "finish", lambda *_: pytest.fail("stop here"))
    with pytest.raises(pytest.fail.Exception):
        small(out=tmp_path)
    monkeypatch.undo()
    first = sorted((tmp_path / "parts").glob("*.parquet"))[0]
    first.write_bytes(first.read_bytes()[:50])
    assert small(out=tmp_path).table.equals(whole.table)


def test_another_request_in_the_same_folder_is_refused(tmp_path):
    small(out=tmp_path)
    before = (tmp_path / "study.parquet").read_bytes()
    for changes, words in (
        ({"seed": 7}, "seed: there 2009, now 7"),
        ({"duration": 500.0}, "duration: there 400.0, now 500.0"),
        ({"start": {"process.PV": [0.6]}}, r"start process.PV: there \[0.5\], now \[0.6\]"),
    ):
        with pytest.raises(StudyError, match=words):
            small(out=tmp_path, **changes)
    with pytest.raises(StudyError, match="diagram itself"):
        study(integrating_loop(K=2.9), GRID, out=tmp_path, **OPTIONS)
    with pytest.raises(StudyError, match="order of the axes"):
        study(integrating_loop(), dict(reversed(GRID.items())), out=tmp_path, **OPTIONS)
    assert (tmp_path / "study.parquet").read_bytes() == before
    assert small(out=tmp_path).complete  # the same request still answers
    assert len(small(out=tmp_path, kicks=1, fresh=True)) == 9


def test_two_studies_do_not_share_a_folder(tmp_path):
    from filelock import FileLock

    with FileLock(tmp_path / ".lock"), pytest.raises(StudyError, match="another study is at work"):
        small(out=tmp_path)


def test_a_folder_that_cannot_be_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot be a study's folder"):
        small(out=tmp_path / "file")
    for content in ("{}", "{", "[]", '{"request": 3}', '{"request": {"vary": 3}}'):
        (tmp_path / "study.json").write_text(content)
        with pytest.raises(StudyError, match=r"cannot be read as a study|holds another study"):
            small(out=tmp_path)


@pytest.mark.parametrize("content", [b"", b"PAR1", b"PAR1" + bytes(100)])
def test_a_damaged_table_is_named(content, tmp_path):
    small(out=tmp_path)
    (tmp_path / "study.parquet").write_bytes(content)
    with pytest.raises(StudyError, match=r"study.parquet' is damaged; fresh starts anew \(--fresh\)"):
        small(out=tmp_path)
    assert small(out=tmp_path, fresh=True).complete


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
    from blocks import PI, Integrator, SampledSensor, Step
    from diagram import wire

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
    told = []
    small(progress=lambda done, runs: told.append((done, runs)))
    assert told[-1] == (18, 18) and sorted(told) == told


def test_a_builder_of_ones_own():
    subject = Subject(
        "loop", lambda values: self_regulating_loop(**values), {"tau": 10.0, "setpoint": 0.5}, stages={"x": ("PV",)}
    )
    found = study(subject, plant={"tau": [5.0, 20.0]}, duration=300.0, every=1.0)
    run = simulate(self_regulating_loop(tau=20.0), 300.0, every=1.0)
    late = run.log.t >= 150.0
    assert found.table["PV.mean"][1] == pytest.approx(run.log["PV"][late].mean(), rel=1e-13)
    assert found.table["plant.tau"].to_list() == [5.0, 20.0]


# --- the production plant -----------------------------------------------------------------------------------
PLANT = {"duration": 60.0, "every": 0.5, "measure_from": 20.0, "progress": False}


@pytest.fixture(scope="module")
def feeds():
    """The plant at three feeds, the last beyond its valves, from two kicks."""
    return study(
        production_subject("B", F_s="high"), {"VPCS1.F_s": [1250.0, 2250.0]}, plant={"F_in": [7000.0, 8000.0, 20000.0]},
        kicks=2, **PLANT,
    )  # fmt: skip


def test_a_feed_that_cannot_be_is_a_row_with_the_numbers(feeds):
    lost = feeds.table.filter(pl.col("plant.F_in") == 20000.0)
    assert (lost["status"] == "INFEASIBLE").all() and lost["reason"].str.contains("20000").all()
    assert feeds.counts() == {"ok": 8, "infeasible": 4, "refused": 0, "failed": 0}


@pytest.mark.parametrize(("run", "F_s", "F_in"), [(1, 1250.0, 7000.0), (3, 1250.0, 8000.0), (9, 2250.0, 8000.0)])
def test_a_point_is_the_plant_built_at_its_own_rest(feeds, run, F_s, F_in):
    plant = production_plant("B", F_s={"VLCS1": "high", "VPCS1": F_s}, F_in=F_in)
    factors = np.random.default_rng(2009).uniform(0.97, 1.03, (2, 3))[1]
    start = {f"S1.{name}": plant["S1"].x0[i] * factors[i] for i, name in enumerate(("N_oil", "N_metL", "N_metG"))}
    alone = simulate(plant, 60.0, every=0.5, method="stiff", start=start)
    row = feeds.table.row(run, named=True)
    late = alone.log.t >= 20.0
    assert row["plant.F_in"] == F_in and row["VPCS1.F_s"] == F_s and row["kick"] == 1
    for name in ("p_1", "w", "OP_VPCS1", "p_out2"):
        assert row[f"{name}.amplitude"] == 0.5 * np.ptp(alone.log[name][late])  # bit for bit, as above
    assert row["VPCS1.slips"] == sum(e.block == "VPCS1" and e.before == "stuck" and e.t >= 20.0 for e in alone.events)


def test_at_rest_nothing_moves_at_any_feed():
    found = study(production_subject("B"), plant={"F_in": [7000.0, 8000.0]}, kicks=0, **PLANT)
    for name in found.signals:
        assert (found.percent(name) < 1e-6).all()  # issue 3: drift below 1e-6 relative
        assert np.isnan(found.column(f"{name}.period")).all() or (found.percent(name) > 1e-10).any()


def test_without_kicks_it_starts_as_the_tables_do():
    found = study(production_subject("B"), {"LCS11.K_p": [0.1]}, **PLANT)
    run = simulate(kicked(production_plant("B")), 60.0, every=0.5, method="stiff")
    assert found.table["p_1.amplitude"][0] == 0.5 * np.ptp(run.log["p_1"][run.log.t >= 20.0])


def test_words_change_the_shape_of_the_plant():
    quantities = {"sticky": ["VPCS1", "VLCS1+VPCS1"], "anti_surge": ["on", "off"]}
    found = study(production_subject("B"), plant=quantities, kicks=1, **PLANT)
    assert found.counts()["ok"] == 4
    assert found.table["plant.sticky"].to_list() == ["VPCS1", "VPCS1", "VLCS1+VPCS1", "VLCS1+VPCS1"]
    assert found.table["VLCS1.slips"].is_null().to_list() == [True, True, False, False]
    assert [group.label for group in groups(found, found.axes[0])] == ["VPCS1", "VLCS1+VPCS1"]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"F_s": ["hihg"]}, "did you mean 'high'"),
        ({"stem": ["half"]}, "quasi_static or full"),
        ({"D": ["wide"]}, "is a number"),
        ({"slug.flow": [100.0], "sine.period": [50.0]}, "exclude each other"),
        ({"S1.K_p_presure": [1.0]}, "did you mean 'S1.K_p_pressure'"),
    ],
)
def test_quantities_of_the_plant_are_checked(values, words):
    with pytest.raises(StudyError, match=words):
        study(production_subject("B"), plant=values, **PLANT)


def test_quantities_reach_the_plant():
    build = production_subject("B").build
    assert fingerprint(build({})) == fingerprint(production_plant("B", name="production_plant_1"))
    assert build({"S1.K_p_pressure": 5e-7})["PCS11"].params["K_p"] == 5e-7
    assert build({"stem.F_c": 1000.0})["VPCS1"].params["S"] == pytest.approx(3250.0 / 52500.0)
    assert type(build({"slug.flow": 300.0})["F_in"]).__name__ == "Slug"
    assert build({"sine.period": 250.0})["Z_I"].params["period"] == 250.0
    # the design feed resizes the plant, the feed does not
    assert build({"F_in": 7000.0})["C2"].params["h_d"] == build({})["C2"].params["h_d"]
    assert build({"design.F_in": 7000.0})["C2"].params["h_d"] != build({})["C2"].params["h_d"]


def test_every_picture_is_drawn(feeds, whole):
    assert set(whole.figures()) == {"spread", "growth", "map"}
    ticks = [[text.get_text() for text in ax.get_xticklabels()] for ax in feeds.plot().axes]
    assert list(feeds.signals) in ticks
    for figure in (*feeds.figures().values(), *whole.figures().values()):
        figure.canvas.draw()  # a fault in a locator or a label shows only now
    assert feeds.plot_growth() is not None  # F_in has three values
    alone = study(integrating_loop(), {"valve.F_s": [2250.0]}, duration=50.0, every=1.0)
    assert set(alone.figures()) == {"spread"}


def test_the_table_can_be_written_and_read(whole, tmp_path):
    whole.to_parquet(tmp_path / "rows.parquet")
    assert pl.read_parquet(tmp_path / "rows.parquet").equals(whole.table)
    assert "1" in str(len(whole)) and "valve.F_s" in repr(whole)
    with pytest.raises(StudyError, match=r"did you mean 'PV\.amplitude'"):
        whole.column("PV.amplitud")


def test_one_quantity_by_two_roads_is_refused():
    subject = production_subject("B", F_s="high")
    with pytest.raises(StudyError, match=r"'VPCS1.F_s' is varied twice"):
        study(subject, {"VPCS1.F_s": [2000.0]}, plant={"VPCS1.F_s": [1800.0]}, duration=20.0, every=1.0)


def test_one_signal_may_be_named_without_a_list():
    found = study(integrating_loop(), {"valve.F_s": [2250.0]}, signals="PV", duration=20.0, every=1.0)
    assert found.signals == ("PV",)
