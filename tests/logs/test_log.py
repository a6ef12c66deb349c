"""The log: what it accepts, what it refuses, what it gives back."""

import pickle
from datetime import datetime

import numpy as np
import pytest
from stickslip.logs import Log, LogError, LoopSignals


def small() -> Log:
    return Log(
        t=[10.0, 11.0, 12.0, 30.0],
        signals={"OP": [50, 51, 52, 53], "PV": [4.0, np.nan, 4.2, np.inf]},
        units={"OP": "%", "PV": "m3/h"},
        spans={"OP": (0, 100)},
        quality={"OP": [True, True, False, True]},
        origin="made by hand",
        start=datetime(2024, 6, 13),
        notes=("One.",),
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"t": []}, ["empty", "at least one"]),
        ({"t": [0, 1, 1, 2]}, ["t[2] = 1.0", "strictly"]),
        ({"t": [0, 2, 1, 3]}, ["t[2] = 1.0", "sort"]),
        ({"t": [0, np.nan, 1, 3]}, ["t[1] = nan", "finite"]),
        ({"t": [0, 1, 2, np.inf]}, ["t[3] = inf", "finite"]),
        ({"t": [[0, 1], [2, 3]]}, ["shape (2, 2)", "one dimension"]),
        ({"t": ["a", "b", "c", "d"]}, ["time", "numbers"]),
        ({"signals": {"OP": [1, 2, 3]}}, ["'OP' has 3 samples", "4"]),
        ({"signals": {"OP": [[1, 2, 3, 4]]}}, ["'OP'", "shape (1, 4)"]),
        ({"signals": {"time": [1, 2, 3, 4]}}, ["'time'", "rename"]),
        ({"signals": {"": [1, 2, 3, 4]}}, ["''", "rename"]),
        ({"units": {"Op": "%"}}, ["units name a signal 'Op'", "did you mean 'OP'"]),
        ({"spans": {"OP": (100, 0)}}, ["span of 'OP'", "low < high"]),
        ({"spans": {"OP": (0, np.inf)}}, ["span of 'OP'", "finite"]),
        ({"spans": {"OP": 100}}, ["span of 'OP'", "pair"]),
        ({"quality": {"OP": [1, 1, 0, 1]}}, ["quality of 'OP'", "True"]),
        ({"quality": {"OP": [True]}}, ["quality of 'OP'", "(4,)"]),
    ],
)
def test_refused_with_reason(change, words):
    fields = {"t": [0, 1, 2, 3], "signals": {"OP": [50, 51, 52, 53]}} | change
    with pytest.raises(LogError) as caught:
        Log(**fields)
    for word in words:
        assert word in str(caught.value)


def test_the_log_cannot_be_changed():
    given = np.array([0.0, 1.0])
    log = Log(t=given, signals={"OP": given})
    given[0] = -7.0
    assert log.t[0] == 0.0
    assert log["OP"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        log["OP"][0] = 1.0
    with pytest.raises(TypeError):
        log.signals["PV"] = given
    with pytest.raises(AttributeError):
        log.origin = "elsewhere"


def test_good_joins_finite_and_quality():
    assert small().good("OP").tolist() == [True, True, False, True]
    assert small().good("PV").tolist() == [True, False, True, False]


def test_unknown_signal_offers_the_nearest():
    with pytest.raises(LogError, match=r"no signal 'pv'; did you mean 'PV'\? known: OP, PV"):
        small()["pv"]


def test_gaps():
    # Median step of 1, 1, 18 s is 1 s.
    assert small().gaps() == [(12.0, 30.0)]
    assert small().gaps(factor=20.0) == []
    assert Log(t=[5.0], signals={}).gaps() == []
    with pytest.raises(LogError, match="factor"):
        small().gaps(factor=0.0)


def test_between_keeps_time_and_all_that_belongs_to_the_signals():
    part = small().between(11.0, 12.5)
    assert part.t.tolist() == [11.0, 12.0]
    assert part.quality["OP"].tolist() == [True, False]
    assert (part.units, part.spans, part.start) == (small().units, small().spans, small().start)
    with pytest.raises(LogError, match=r"no sample between 13 s and 14 s; the log runs from 10.0 s to 30.0 s"):
        small().between(13, 14)


def test_replacing_a_signal_drops_its_quality_only():
    log = small().with_signals(OP=[1, 2, 3, 4])
    assert log["OP"].tolist() == [1, 2, 3, 4]
    assert "OP" not in log.quality
    assert log.units["OP"] == "%"
    assert log.spans["OP"] == (0, 100)
    with pytest.raises(LogError, match="3 samples"):
        small().with_signals(OP=[1, 2, 3])


def test_renaming_moves_everything():
    log = small().renamed({"OP": "FIC1.OP"})
    assert log.names == ("FIC1.OP", "PV")
    assert log.units["FIC1.OP"] == "%"
    assert log.spans["FIC1.OP"] == (0, 100)
    assert log.good("FIC1.OP").tolist() == [True, True, False, True]
    with pytest.raises(LogError, match="two signals would be called 'PV'"):
        small().renamed({"OP": "PV"})
    with pytest.raises(LogError, match="no signal 'SP'"):
        small().renamed({"SP": "X"})


def test_swapping_names():
    log = small().renamed({"OP": "PV", "PV": "OP"})
    assert np.array_equal(log["PV"], small()["OP"])


def test_clock():
    assert small().clock()[0] == datetime(2024, 6, 13, 0, 0, 10)
    with pytest.raises(LogError, match="not known"):
        Log(t=[0], signals={}).clock()


def test_pickle_for_process_pools():
    log = pickle.loads(pickle.dumps(small()))
    assert log.names == small().names
    assert np.array_equal(log["PV"], small()["PV"], equal_nan=True)
    assert log.quality["OP"].tolist() == small().quality["OP"].tolist()
    assert (log.units, log.spans, log.start, log.notes) == (
        small().units,
        small().spans,
        small().start,
        small().notes,
    )
    assert not log.t.flags.writeable


def test_text_of_a_log():
    assert repr(small()) == "<Log of 4 samples over 20 s: OP [%], PV [m3/h]>"


def test_dt_of_one_sample_is_unknown():
    assert np.isnan(Log(t=[3.0], signals={}).dt)


def test_a_loop_asked_for_by_its_signals_keeps_what_is_noted_of_it():
    noted = LoopSignals("PV", "OP", process="integrating", measurement="level")
    log = Log(t=[0, 1], signals={"PV": [4, 5], "OP": [50, 51]}, loops={"LC1": noted})
    assert (log.loop().process, log.loop().measurement) == ("integrating", "level")
    assert log.loop(process="self_regulating").process == "self_regulating"
    assert log.loop(name="LC1", process="self_regulating").process == "self_regulating"
