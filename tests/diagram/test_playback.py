"""A log or a table as inputs of a run: what is played back between the samples, in which unit, from when to when."""

import numpy as np
import polars as pl
import pytest
from stickslip.blocks import PI, FirstOrder, Gain, IdealValve, StickSlip
from stickslip.diagram import drive, ensemble, held, interpolated, simulate, wire
from stickslip.diagram.reference import simulate_reference
from stickslip.logs import Log
from stickslip.logs.from_table import from_table

LOG = Log(t=[0.0, 10.0, 20.0], signals={"SP": [0.2, 0.6, 0.4], "PV": [0.1, 0.3, 0.5], "TAG": [1.0, 2.0, 3.0]})
READERS = wire([Gain("a", "SP", 1.0), Gain("b", "PV", 1.0)], inputs=["SP", "PV"], name="readers")
HELD = {"a": [0.2, 0.2, 0.6, 0.6, 0.4], "b": [0.1, 0.1, 0.3, 0.3, 0.5]}  # analytic, at 0, 5, ..., 20 s
LINES = {"a": [0.2, 0.4, 0.6, 0.5, 0.4], "b": [0.1, 0.2, 0.3, 0.4, 0.5]}


def table():
    return {"time": LOG.t, **LOG.signals}


def pandas_frame():
    return pytest.importorskip("pandas").DataFrame(table())


ALONE = {
    "log": lambda: LOG,
    "mapping": table,
    "lists": lambda: {name: values.tolist() for name, values in table().items()},
    "polars": lambda: pl.DataFrame(table()),
    "polars with words and gaps": lambda: pl.DataFrame({**table(), "remark": ["", "x", None]}),
    "pandas": pandas_frame,
    "pandas by index": lambda: pandas_frame().set_index("time"),
    "held": lambda: held(LOG),
}


@pytest.mark.parametrize("kind", ALONE)
def test_a_log_or_table_alone_drives_every_open_input_that_it_has_and_is_held(kind):
    log = simulate(READERS, 20.0, every=5.0, inputs=ALONE[kind]()).log
    for signal, expected in HELD.items():
        np.testing.assert_allclose(log[signal], expected, rtol=1e-12)


def test_each_signal_says_how_it_goes_between_samples():
    log = simulate(READERS, 20.0, every=5.0, inputs={"SP": LOG, "PV": interpolated(LOG)}).log
    np.testing.assert_allclose(log["a"], HELD["a"], rtol=1e-12)
    np.testing.assert_allclose(log["b"], LINES["b"], rtol=1e-12)
    log = simulate(READERS, 20.0, every=5.0, inputs=interpolated(table())).log
    np.testing.assert_allclose(log["a"], LINES["a"], rtol=1e-12)
    log = simulate(READERS, 20.0, every=5.0, inputs={"SP": held(LOG, "PV"), "PV": 7.0}).log
    np.testing.assert_allclose([log["a"], log["b"]], [HELD["b"], [7.0] * 5], rtol=1e-12)


def test_missing_samples_are_left_out():
    gappy = Log(t=[0.0, 10.0, 20.0], signals={"SP": [0.2, np.nan, 0.4], "PV": [0.1, 0.9, 0.5]},
                quality={"PV": [True, False, True]})  # fmt: skip
    kept = simulate(READERS, 20.0, every=5.0, inputs=gappy).log
    assert kept["a"].tolist() == [0.2, 0.2, 0.2, 0.2, 0.4] and kept["b"].tolist() == [0.1, 0.1, 0.1, 0.1, 0.5]
    straight = simulate(READERS, 20.0, every=5.0, inputs=interpolated(gappy)).log
    np.testing.assert_allclose(straight["a"], [0.2, 0.25, 0.3, 0.35, 0.4], rtol=1e-12)


def test_a_window_of_a_log_is_replayed_at_its_own_time():
    log = simulate(READERS, 10.0, t0=10.0, every=5.0, inputs=LOG).log
    assert log.t.tolist() == [10.0, 15.0, 20.0] and log["a"].tolist() == [0.6, 0.6, 0.4]


def test_one_sampling_interval_beyond_the_log_is_within_it():
    """What was logged last holds until the next sample would have come; so does a row at the very start."""
    assert simulate(READERS, 30.0, every=30.0, inputs=LOG).log["a"][-1] == 0.4


def test_the_same_in_an_ensemble_in_the_reference_and_alone():
    loop = wire([PI(0.4, 10.0), IdealValve(), FirstOrder(3.0, 10.0)], inputs=["SP"])
    run = simulate(loop, 20.0, every=5.0, inputs=LOG, rtol=1e-10, atol=1e-12).log
    many = ensemble(loop, 20.0, params={"process.K": [3.0]}, every=5.0, inputs=LOG, rtol=1e-10, atol=1e-12)
    assert many.values["PV"][0].tolist() == run["PV"].tolist()
    slow = simulate_reference(loop, 20.0, every=5.0, inputs=LOG).log
    np.testing.assert_allclose(slow["PV"], run["PV"], atol=1e-8)
    alone = drive(Gain("a", "SP", 2.0), 20.0, every=5.0, SP=LOG).log
    np.testing.assert_allclose(alone["a"], 2.0 * np.array(HELD["a"]), rtol=1e-12)


def test_a_run_played_back_goes_on_with_what_comes_next():
    first, second = LOG.samples(0, 2), LOG.samples(1, 3)
    loop = wire([PI(0.4, 10.0), StickSlip(), FirstOrder(3.0, 10.0)], inputs=["SP"])
    settings = {"rtol": 1e-10, "atol": 1e-12}
    whole = simulate(loop, 20.0, every=20.0, inputs=LOG, **settings).log
    half = simulate(loop, 10.0, inputs=first, **settings).final
    with pytest.raises(ValueError, match="the log of 'SP' runs from 0 to 10 s"):
        simulate(half, 10.1, t0=10.0)
    rest = simulate(half.without("SP"), 10.0, t0=10.0, every=10.0, inputs=second, **settings).log
    np.testing.assert_allclose(rest["PV"][-1], whole["PV"][-1], atol=1e-7)


def test_a_table_becomes_a_log_exactly_as_it_stands():
    t = [0.0, 0.1, 0.25, 1000.0]
    frame = pl.DataFrame({"time": t, "n": [1, None, 3, 4], "word": ["a", "b", "c", "d"]})
    log = from_table(frame)
    assert log.t.tolist() == t and log.names == ("n",)
    np.testing.assert_array_equal(log["n"], [1.0, np.nan, 3.0, 4.0])
    pytest.importorskip("pandas")
    kept = Log(t=t, signals={"n": [1.0, 2.0, 3.0, 4.0]}, units={"n": "%"})
    back = from_table(kept.to_pandas())
    assert back.t.tolist() == t and back.units == {"n": "%"}


def test_units_are_those_of_the_diagram():
    valve = wire([FirstOrder(1.0, 1.0, units={"MV": "bar"})], inputs=["MV"])
    same = Log(t=[0.0, 10.0], signals={"MV": [1.0, 2.0]}, units={"MV": "bar"})
    assert simulate(valve, 10.0, inputs=same).log.units["MV"] == "bar"
    unstated = Log(t=[0.0, 10.0], signals={"MV": [1.0, 2.0]})
    assert simulate(valve, 10.0, inputs=unstated).ok
    with pytest.raises(ValueError, match=r"input 'MV' is in \[bar\], but the log has 'MV' in \[kPa\]; convert it: log"):
        simulate(valve, 10.0, inputs=Log(t=[0.0, 10.0], signals={"MV": [1.0, 2.0]}, units={"MV": "kPa"}))


REFUSED = {
    "no column": (lambda: {"SP": LOG, "PV": held(LOG, "PVV")}, "no signal 'PVV'; did you mean 'PV'"),
    "no column of the name": (lambda: {"SP": LOG, "PV": LOG.renamed({"PV": "FIC1"})}, "no signal 'PV'"),
    "no time": (lambda: {"SP": {"t": [0.0, 1.0], "SP": [1.0, 2.0]}, "PV": 0.0}, "no column 'time', only 't', 'SP'"),
    "a frame without time": (lambda: pl.DataFrame({"t": [0.0, 1.0], "SP": [1.0, 2.0]}), "no column 'time'"),
    "times that fall": (lambda: {"time": [1.0, 0.0], "SP": [1.0, 2.0]}, "time must increase strictly"),
    "lengths": (lambda: {"time": [0.0, 1.0], "SP": [1.0]}, "'SP' has 1 samples and time has 2"),
    "words": (lambda: {"time": [0.0, 1.0], "SP": ["a", "b"]}, "'SP' is not an array of numbers"),
    "nothing that fits": (lambda: LOG.renamed({"SP": "r", "PV": "y"}), "log has r, y, TAG, but .* are SP, PV; log.ren"),
    "half": (lambda: LOG.renamed({"SP": "r"}), "input 'SP' is open"),
    "one signal for all": (lambda: held(LOG, "PV"), r"'PV' alone .*give e.g. inputs=.'SP': held\(log, 'PV'\)"),
    "nothing good": (lambda: LOG.with_signals(SP=[np.nan] * 3), "none of the log's 3 samples of 'SP' is good"),
    "no such thing": (lambda: {"SP": "log.csv", "PV": 0.0}, "'SP' was given str; give a number, a pair .* a log, or"),
    "no names": (lambda: [0.5, 0.5], "values are given by name"),
    "too short": (lambda: LOG.samples(0, 2), "the log of 'SP' runs from 0 to 10 s, one value every 10 s, but the run "),
    "too late": (lambda: LOG.samples(1, 3), "runs from 10 to 20 s.* run from 0 to 30 s; give t0= and a duration"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_played_back_is_refused_with_the_remedy(what):
    given, words = REFUSED[what]
    with pytest.raises(ValueError, match=words):
        simulate(READERS, 30.0, inputs=given())
