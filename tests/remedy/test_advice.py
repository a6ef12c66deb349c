"""Remedies on fitted loops: what helps helps on the loop itself, and nothing is recommended that does not."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import GapPI, HeValve
from stickslip.detect.likelihood.pooled import evidence_of
from stickslip.detect.likelihood.stems import stems_of
from stickslip.diagram import drive, simulate
from stickslip.logs import LoopRecord
from stickslip.remedy import FitError, cost, fit, python_of, remedies
from stickslip.remedy.advice import LONG, SURE, TRAVEL, Cost
from stickslip.remedy.controller import controller_of
from stickslip.remedy.example import sticky
from stickslip.remedy.measures import REMEDIES, half_gain
from stickslip.remedy.measures.setting import Setting, Situation
from stickslip.remedy.size import Size
from stickslip.remedy.trial import NOTHING, UNSTABLE, diagram_of, outcomes


@pytest.fixture(scope="module")
def record():
    return sticky(hours=2.5, seed=3)


@pytest.fixture(scope="module")
def found(record):
    return fit(record)


@pytest.fixture(scope="module")
def advice(found):
    return remedies(found)


def test_results_have_one_line_and_a_picture(found, advice):
    for result in (found, advice):
        assert "\n" not in repr(result) and len(repr(result)) < 300
        assert "data:image/png" in result._repr_html_()


def test_the_fit_has_found_what_made_the_record(found):
    assert found.sticks and found.gain > 50.0
    assert found.controller.K_p == pytest.approx(0.8, rel=1e-3)
    assert found.controller.T_i == pytest.approx(30.0, rel=1e-2)
    assert found.S.value == pytest.approx(5.0, rel=0.1)
    assert found.KJ.low < 1.8 < found.KJ.high or found.KJ.value == pytest.approx(1.8, rel=0.3)


def test_settings_hold_for_either_form_of_the_integral(found):
    K_p, T_i = found.controller.present
    assert found.K_p.low <= K_p < 0.8 * 1.001 < found.K_p.high * 1.001
    assert found.T_i.low <= T_i < 30.0 < found.T_i.high * 1.01
    assert any("integral takes in the error of the row before" in note for note in found.notes)


def test_doing_nothing_gives_what_the_record_shows(record, advice):
    assert float(np.median(advice.none.outcome.pv_sd)) == pytest.approx(float(np.std(record.e[900:])), rel=0.25)


def test_a_trial_meets_the_whole_load_of_the_record(found):
    late = [
        (np.where(np.arange(len(own)) < 3000, own, own + np.sin(np.arange(len(own)) / 40.0)),) for (own,) in found.lefts
    ]
    as_it_is, more = (outcomes(one, [NOTHING], 2)[0].pv_sd for one in (found, replace(found, lefts=tuple(late))))
    assert len(found.lefts[0][0]) == 4501 and np.all(more > 1.1 * as_it_is)  # the load of the last third was left out


def test_what_is_recommended_swings_less_in_its_own_simulation(advice):
    for name in (advice.until_shutdown, advice.at_shutdown):
        assert name is not None
        better = advice[name].outcome.pv_sd < advice.none.outcome.pv_sd
        assert np.mean(better) >= SURE
    assert not advice[advice.until_shutdown].at_shutdown


def test_a_tuning_without_end_is_no_number_and_says_so(found, monkeypatch):
    # was NaN in the table and in JSON; seed 9323 of benchmarks.remedy --apart
    far = Setting("K_p far", {}, factors={"controller.K_p": 100.0})
    monkeypatch.setattr(half_gain, "settings", lambda at: [far])
    endless = replace(found, controller=replace(found.controller, low=-math.inf, high=math.inf))
    advice = remedies(endless)
    one = json.loads(json.dumps(advice.to_dict(), allow_nan=False))["remedies"][5]
    assert one["name"] == half_gain.TITLE and one["score"] is None and one["better_in"] == 0.0
    assert one["pv_sd"]["value"] is None and one["pv_sd"]["reason"] == UNSTABLE
    assert one["sp_settling_s"]["reason"] == LONG
    table = [cell for row in advice.rows() for cell in row]
    assert "not stable" in table and not any("nan" in cell or cell.startswith("inf") for cell in table)
    assert half_gain.TITLE in advice.words()[2] and "nan" not in " ".join(advice.words())
    assert "data:image/png" in advice._repr_html_()


def test_rows_that_are_not_fitted_or_not_logged_are_said():
    whole = sticky(hours=0.7, seed=3)
    kept = (np.arange(len(whole)) < 1100) & ((np.arange(len(whole)) < 700) | (np.arange(len(whole)) % 5 == 0))
    kept[200:400] = False  # a gap of 400 s: 700 s and more are left behind it
    t, pv, op, sp = (each[kept] for each in (whole.t, whole.pv, whole.op, whole.sp))
    one = fit(LoopRecord.from_arrays(t, pv=pv, op=op, sp=sp))
    assert any("longest stretch without a gap" in note for note in one.notes)
    assert any("of the rows are not logged" in note for note in one.notes)


def test_loops_that_do_not_swing_as_the_log_does_are_not_tried(found):
    # seed 9423 of benchmarks.remedy --apart swung 1.9 times as far as its log, and what was recommended did harm
    wild = [replace(one, S=4.0 * one.S, J=4.0 * one.J) for one in found.loops]
    mixed = replace(found, loops=(*wild[:5], *found.loops[5:]))
    as_it_is, none = (outcomes(one, [NOTHING], 24)[0].pv_sd for one in (found, mixed))
    assert len(as_it_is) == 24 and set(as_it_is[5:]) <= set(none) and len(none) < 24
    # was "swing 1.2 times as far as the log" where 1.25 was allowed: the median, with most loops beyond on both sides
    with pytest.raises(
        FitError, match=r"[0-5] of 24 fitted loops swing 0.8 to 1.25 times as far as the log, and 6 are"
    ):
        outcomes(replace(found, loops=tuple(wild)), [NOTHING])


def test_a_trial_begins_where_the_log_does(found):
    # the stem stood at OP at the start, so that PV began K S / 2 beside the log and OP followed
    (as_it_is,) = outcomes(found, [NOTHING], 24)
    assert np.max(np.abs(found.begun)) > 0.1
    np.testing.assert_allclose(as_it_is.pv[0], found.days[0].pv[0], atol=1e-6)
    np.testing.assert_allclose(as_it_is.op[0], found.days[0].op[0], atol=1e-6)


def test_a_filter_of_pv_begins_where_pv_does(found):
    # it began at 0, so that OP ran to its limit where PV stands at 50
    law, day = replace(found.controller, T_f=20.0), found.days[0]
    far = replace(day, pv=day.pv + 1000.0, sp=day.sp + 1000.0)
    lefts = tuple((own + 1000.0,) for (own,) in found.lefts)
    near, high = (
        outcomes(replace(found, controller=law, sticks=False, days=(one,), lefts=own), [NOTHING], 3)[0].pv[:50]
        for one, own in ((day, found.lefts), (far, lefts))
    )
    np.testing.assert_allclose(high - 1000.0, near, atol=1e-3)


def test_a_stem_that_travels_less_for_the_stick_is_said_so():
    # was "travels -167 more": a free stem follows the noise in OP
    words = Cost(Size(2.0, 1.0, 3.0), Size(-167.0, -197.0, -141.0)).words("%")
    assert words.endswith("travels 167 (141 to 197) %/h less.")
    assert Cost(Size(2.0, 1.0, 3.0), Size(16.0, 14.0, 20.0)).words("%").endswith("16 (14 to 20) %/h more.")


def test_a_repaired_valve_swings_least(advice):
    # invariant: under the same load no stick is better than any stick here
    least = np.median(advice["valve repaired"].outcome.pv_sd)
    assert all(np.median(one.outcome.pv_sd) >= 0.98 * least for one in advice.tried)
    assert advice.cost.ratio.low > 1.0 and advice.cost.travel.value is not None
    assert cost(replace(advice.fit, sticks=False)).ratio.value == 1.0


def test_the_trial_loop_is_the_plain_loop_where_nothing_is_set(found):
    diagram = diagram_of(found)
    assert {type(b) for b in diagram.blocks} >= {GapPI, HeValve} or found.best.follows
    n = 400
    t = np.arange(n) * found.controller.dt
    quiet = simulate(diagram, float(t[-1]), times=t, inputs={"SP": 0.0, "v": 0.0})
    np.testing.assert_allclose(quiet.log["PV"], 0.0, atol=1e-9)


def test_a_filter_of_pv_stands_in_the_trial_loop(found):
    law = replace(found.controller, T_f=20.0)  # ten scans
    (smooth,) = (one for one in diagram_of(replace(found, controller=law)).blocks if one.name == "filter")
    out = drive(smooth, 200.0, every=2.0, PV=1.0).log["PV_f"]
    np.testing.assert_allclose(out[9], 1.0 - np.exp(-1.0), rtol=1e-9)  # analytic, ten scans after the step
    assert not any(one.name == "filter" for one in diagram_of(found).blocks)


def test_the_weight_of_travel_is_said(advice):
    assert advice.to_dict()["travel_weight"] == TRAVEL
    assert any("travel" in sentence and f"{TRAVEL:g}" in sentence for sentence in advice.words())
    assert advice.none.score == pytest.approx(1.0 + TRAVEL)


def test_a_loop_without_stick_gets_a_fit_and_no_remedy():
    sound = remedies(fit(sticky(hours=1.0, S=0.0, J=0.0)))
    assert not sound.fit.sticks
    assert sound.until_shutdown is None and sound.at_shutdown is None
    assert sound.fit.verdict == "inconclusive" and sound.words()[1:] == [sound.fit.doubt]  # OP travels 1.9 %
    json.dumps(sound.to_dict(), allow_nan=False)
    rng, u = np.random.default_rng(1), 5.0 * np.sin(np.arange(2000.0) / 25.0) + np.sin(np.arange(2000.0) / 80.0)
    plain = evidence_of([stems_of(u, np.roll(u, 1) + 0.1 * rng.normal(size=2000))])
    clear = replace(sound, fit=replace(sound.fit, evidence=plain))
    assert not remedies(clear.fit).tried  # there is nothing to make up for
    assert clear.fit.verdict == "no_stiction" and clear.fit.S.value == 0.0 < clear.fit.S.high < 2.0
    assert "shows no stick" in clear.words()[0] and "shows no stick, S = 0" in clear.fit.headline


def test_of_a_stem_that_stands_still_all_along_the_record_tells_nothing():
    # was "No stick is seen in this loop, so there is nothing to make up for", with S = 0 (0 to 0.4 %)
    still = fit(sticky(hours=1.0, S=20.0, J=3.0, sp=48.0))
    assert still.verdict == "inconclusive" and not still.sticks
    assert still.S.value is None and still.S.high is None and still.to_dict()["valve"]["S"]["value"] is None
    advice = remedies(still)
    first, said = advice.words()
    assert first.startswith("Nothing is recommended, since")
    assert not advice.tried and advice.until_shutdown is None  # a lambda tuning of K_p 11.7 stood in the table
    assert "does not tell" in said and "PV shows no answer" in said and "move OP by" in said and "nothing" not in said


def test_the_json_is_of_the_agreed_form(advice):
    document = json.loads(json.dumps(advice.to_dict(), allow_nan=False))
    assert {"pv_sd", "travel_per_h", "reversals_per_h"} <= set(document["none"])
    for one in document["remedies"]:
        assert {"name", "settings", "pv_sd", "travel_per_h"} <= set(one)
        assert set(one["pv_sd"]) >= {"value", "low", "high"}
    fitted = document["fit"]
    assert {"valve", "controller", "process", "load_sd", "noise_sd", "one_step_error", "free_error"} <= set(fitted)
    assert {"S", "J", "unit"} <= set(fitted["valve"]) and {"K", "tau", "theta", "integrating"} <= set(fitted["process"])


def test_pictures_are_drawn(found, advice):
    assert len(found.plot().axes) == 2
    assert len(advice.plot().axes) >= 3


def test_the_python_file_runs_and_swings_as_the_record(record, found):
    space = {"__name__": "loop"}
    exec(compile(python_of(found), "loop.py", "exec"), space)
    run = simulate(space["loop"], 14400.0, every=2.0)
    assert float(np.std(run.log["PV"][900:])) == pytest.approx(float(np.std(record.e[900:])), rel=0.4)


def test_the_python_file_has_the_derivative_of_the_controller(found):
    space, law = {"__name__": "loop"}, replace(found.controller, T_d=7.0)
    exec(compile(python_of(replace(found, controller=law)), "loop.py", "exec"), space)
    rng = np.random.default_rng(4)
    pv = 0.1 * rng.normal(size=500).cumsum()
    t = law.dt * np.arange(500)
    free = space["loop"]["controller"].with_params(low=-1e9, high=1e9)
    read = controller_of(
        drive(free, t[-1], every=law.dt, SP=0.0, PV=(t, pv)).log["OP"], pv, 0.0 * pv, law.dt, (-1e9, 1e9)
    )
    assert (read.K_p, read.T_i, read.T_d) == pytest.approx((law.K_p, law.T_i, 7.0), rel=1e-4)


def test_a_process_that_does_not_answer_has_no_gain_and_no_tuning_by_it(found):
    loops, left = tuple(replace(one, K=0.0) for one in found.loops), (found.days[0].pv,)
    still = replace(found, loops=loops, lefts=(left,) * len(loops))
    assert still.K.value is None
    assert "lambda tuning" not in [one.name for one in remedies(still).tried]  # this divided by zero


def test_a_dead_travel_of_no_size_is_not_told(found):
    sizes = np.geomspace(1.0, 8.0, len(found.loops))
    wide = replace(found, loops=tuple(replace(one, S=S) for one, S in zip(found.loops, sizes, strict=True)))
    assert found.S.value is not None
    assert wide.S.value is None and "factor of three" in wide.S.reason and wide.S.low < wide.S.high


def test_settings_follow_their_rules():
    at = Situation(0.8, 30.0, 2.0, 5.0, 2.0, 1.2, 30.0, 4.0, 0.1, 0.8, False, True, "%", "m3/h")
    by = {one.TITLE: one.settings(at) for one in REMEDIES}
    assert [one.values["a"] for one in by["knocker"]] == [1.75, 2.75]
    assert [one.values["a"] for one in by["constant reinforcement"]] == [1.5, 2.5]
    # published: K_p = tau / (K (lambda + theta)), T_i = tau (Rivera et al. 1986), with half a scan of dead time
    assert by["lambda tuning"][0].values["K_p"] == pytest.approx(30.0 / (1.2 * 35.0))
    assert by["half the gain"][0].factors == {"controller.K_p": 0.5}
    none = Situation(0.8, math.inf, 2.0, 0.0, 0.0, 1.2, 30.0, 4.0, 0.1, 0.8, False, False, "%", "m3/h")
    assert all(not one.settings(none) for one in REMEDIES if one.TITLE in ("longer T_i", "lambda tuning"))


def test_more_gain_of_the_load_gives_more_swing(found):
    # invariant: half the load, half the swing, in a loop without stick
    half = [tuple(0.5 * (one - one[0]) + one[0] for one in own) for own in found.lefts]
    free = [replace(one, S=0.0, J=0.0) for one in found.loops]
    day = replace(found.days[0], sp=np.full(len(found.days[0].op), found.days[0].pv[0]))
    full, less = (
        outcomes(replace(found, sticks=False, loops=tuple(free), lefts=tuple(lefts), days=(day,)), [NOTHING], 2)[
            0
        ].pv_sd
        for lefts in (found.lefts, half)
    )
    np.testing.assert_allclose(less, 0.5 * full, rtol=0.05)


@pytest.mark.parametrize(
    ("record", "said"),
    [
        (LoopRecord.from_arrays(np.arange(300.0), pv=np.ones(300), op=np.arange(300.0) % 7), "stands still"),
        (
            LoopRecord.from_arrays(
                np.arange(600.0), pv=np.random.default_rng(1).normal(size=600).cumsum(),
                op=50.0 + np.random.default_rng(2).normal(size=600).cumsum(), sp=np.zeros(600),
            ),
            "a PI law tells",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_said(record, said):
    with pytest.raises(FitError, match=said):
        fit(record)
