"""The survey on the production plant, where the sticky valve is known, and on logs built by hand."""

import json
from dataclasses import replace

import numpy as np
import pytest
from stickslip.detect.plantwide.survey import survey
from stickslip.logs import Log, LogError, LoopSignals

LOOP_OF = {"VPCS1": "PCS11", "VLCS1": "LCS11", "VLCS2": "LCS21"}


def plant_log(sticky, F_s="high", case=1, kick=(1.02, 1.02), stems=False):
    from stickslip.diagram import simulate
    from stickslip.plant import kicked, production_plant

    plant = kicked(production_plant(F_s=F_s, case=case, sticky=sticky), *kick)
    log = simulate(plant, 2000.0, every=1.0, method="stiff").log.between(200.0, 2000.0)
    return log if stems else without_stems(log)


def without_stems(log):
    names = {name: x for name, x in log.signals.items() if not name.startswith("MV_")}
    loops = {tag: replace(loop, mv=None) for tag, loop in log.loops.items()}
    kept = {"units": log.units, "spans": log.spans}
    return Log(log.t, names, **{k: {n: v for n, v in m.items() if n in names} for k, m in kept.items()}, loops=loops)


@pytest.mark.parametrize("valve", LOOP_OF)
def test_the_one_sticky_valve_of_the_plant_comes_first_without_its_stem(valve):
    found = survey(plant_log([valve]))
    assert found.suspects[0].loop == LOOP_OF[valve]
    assert 3.0 < found.suspects[0].S < 10.0  # S = 6.7 % of OP by (F_s + F_c) / k, analytic; read off other tags
    if found.groups:  # a level takes 400 to 800 s a cycle: too few for a group in 1800 s
        assert found.groups[0].suspects[0].loop == LOOP_OF[valve]


def test_two_sticky_valves_two_groups():
    found = survey(plant_log(["VLCS1", "VPCS1"]))
    assert {s.loop for s in found.suspects[:2]} == {"LCS11", "PCS11"}
    first = [group.suspects[0].loop for group in found.groups if group.suspects]
    assert set(first) == {"LCS11", "PCS11"} and len(found.groups) == 2
    fast = min(found.groups, key=lambda group: group.period)
    assert fast.suspects[0].loop == "PCS11" and "p_out2" in fast.shares  # it reaches the compressor


def test_a_logged_stem_settles_it():
    found = survey(plant_log(["VPCS1"], stems=True))
    first, *others = found.suspects
    assert (first.loop, first.seen_in) == ("PCS11", "MV_VPCS1")
    assert pytest.approx(6.7, rel=0.1) == first.S  # (F_s + F_c) / k = 3500 / 52500 = 6.67 %, analytic
    assert all(other.gain == 0.0 and other.follows for other in others)


def test_of_a_logged_stem_that_stands_still_no_other_tag_says_that_it_answers(pair):
    op = pair.loops["FC2"].op
    named = Log(
        pair.t, {**{name: pair[name] for name in pair.names}, "stem": 0.0 * pair.t + 50.0}, spans=pair.spans,
        loops={**pair.loops, "FC2": replace(pair.loops["FC2"], mv="stem")},
    )  # fmt: skip
    (suspect,) = (one for one in survey(named).suspects if one.loop == "FC2")
    assert suspect.follows is None and "stem stands still all the while" in suspect.reason
    assert suspect.S == suspect.travel == pytest.approx(np.ptp(pair[op]), rel=0.01)


def test_no_stiction_at_rest_is_no_group():
    found = survey(plant_log(["VPCS1"], F_s="none", kick=(1.0, 1.0)))
    assert found.suspects == () and "PCS11" in found.still


@pytest.fixture
def pair():
    t = np.arange(1500.0)
    wave, rng = np.sin(t / 12), np.random.default_rng(0)
    return Log(
        t, {"u": 50 + 4 * wave, "p": 3 * np.cos(t / 12), "v": 50 + 9 * wave, "q": np.cos(t / 12),
            "f": 2 * (50 + 9 * wave) + 0.01 * rng.normal(size=1500)},
        spans={"u": (0, 100), "v": (0, 100)}, loops={"PC1": LoopSignals("p", "u"), "FC2": LoopSignals("q", "v")},
    )  # fmt: skip


def test_a_verdict_of_its_own_goes_first(pair):
    assert survey(pair, {"FC2": "stiction"}).suspects[0].loop == "FC2"
    assert survey(pair, {"PC1": "stiction"}).suspects[0].loop == "PC1"


def test_when_no_valve_sticks_it_says_so(pair):
    found = survey(pair)
    assert all(suspect.follows == "f" for suspect in found.suspects)  # the same wave: f follows both
    assert "No valve of the group is seen to stick; the source may lie outside" in found.words


def test_lag_and_harmonics():
    t = np.arange(4000.0)
    wave = np.sin(2 * np.pi * t / 100)
    late = np.sin(2 * np.pi * (t - 7) / 100)
    square = np.sign(wave + 1e-9)
    log = Log(
        t, {"u": 50 + wave, "p": late, "square": square}, spans={"u": (0, 100)}, loops={"C": LoopSignals("p", "u")}
    )
    (group,) = survey(log).groups
    assert group.lags["p"] == pytest.approx(7.0, abs=1.0)  # analytic
    assert group.harmonics["square"] == pytest.approx(np.sqrt(1 / 9 + 1 / 25), rel=0.02)  # of a square wave, analytic
    assert group.harmonics["u"] < 0.01


def test_result_is_json_picture_and_words(pair):
    found = survey(pair)
    document = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert document["schema"] == "stickslip.survey/1" and document["groups"][0]["loops"] == ["PC1", "FC2"]
    figure = found.plot()
    figure.canvas.draw()
    assert found.groups[0].period == pytest.approx(24 * np.pi, rel=1e-4)  # analytic
    assert len(figure.axes) == 2 and found.words.startswith("5 tags share an oscillation of 75.4 s")


def test_gaps_and_missing_tags(pair):
    f = pair["f"].copy()
    f[200:300] = np.nan
    found = survey(pair.with_signals(f=f, gone=np.full(1500, np.nan)))
    assert "gone" not in found.groups[0].shares and "f" in found.groups[0].shares


def test_a_log_without_loops():
    with pytest.raises(LogError, match="the log notes no loop"):
        survey(Log([0.0, 1.0], {"a": [1.0, 2.0]}))
