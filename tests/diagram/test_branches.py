"""Branches of a replay: a stem whose mode and place are unknown at the start is found; a right model is left alone."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import PI, DeadTime, FirstOrder, Noise, QuasiStaticStem, Sensor, Staircase, StickSlip, Sum
from stickslip.diagram import WiringError, simulate, wire
from stickslip.diagram.branches import Branches
from stickslip.diagram.pins import pinned, replay, residuals
from stickslip.logs import Log

LEVELS = [0.3, 0.5, 0.35, 0.6]
ONE_STEP = 1e-5  # of OP: the one-step error of the controller without a gap is below 1e-9 here
FITTING = Branches("valve", changes={"OP": ONE_STEP})


def sticky_loop(noisy, valve=None, behind=None):
    """Return a flow loop with a sticky stem: S = 6 %, J = 2 %, noise on the measurement held between samples.

    ``behind``: a block between stem and process.
    """
    noise = [Noise("D", sd=0.004, dt=1.0), Sum("seen", {"PV": 1.0, "D": 1.0})] if noisy else []
    return wire(
        [
            Staircase("SP", LEVELS, dwell=300.0),
            PI(0.4, 10.0, inputs={"PV": "PV_m"}, start_op=0.1),
            valve or QuasiStaticStem(0.06, 0.02),
            *([behind] if behind else []),
            FirstOrder(3.0, 10.0, start=0.3, inputs="late" if behind else "MV"),
            *noise,
            Sensor(inputs="seen" if noisy else "PV", outputs="PV_m"),
        ]
    )


def window(valve=None, t0=200.0, behind=None):
    """Return the log of a loop from ``t0`` on, the truth there, and the start of a model with the right stem."""
    truth = simulate(sticky_loop(True, valve, behind), 1200.0, every=1.0)
    log = truth.log.between(t0, 1200.0)
    start = {"process.PV": log["PV"][0], "controller.z": log["OP"][0] - 0.4 * (log["SP"][0] - log["PV_m"][0])}
    return Log(t=log.t, signals={s: log[s] for s in ("OP", "PV_m")}), log, {k: float(v) for k, v in start.items()}


@pytest.mark.parametrize("off", [-0.04, -0.02, 0.015, 0.03])
def test_a_stem_unknown_at_the_start_is_found(off):
    """The model's stem starts stuck at a wrong place; it finds the true one's sooner than in a plain replay."""
    seen, truth, start = window()
    start["valve.x"] = float(truth["MV"][0]) + off

    def wrong(branches):
        run = replay(sticky_loop(False), seen, start=start, branches=branches)
        assert run.ok and bool(run.taken) == (branches is not None)
        last = np.flatnonzero(np.abs(run.log["MV"] - truth["MV"]) > 1e-3).max()
        assert np.abs(residuals(run)["PV_m"] - truth["D"])[last + 100 :].max() < 3e-3  # K times what MV may differ by
        return int(last)

    assert wrong(FITTING) < 0.6 * wrong(None)
    assert wrong(replace(FITTING, patience=4)) < wrong(None)  # later than without patience, sooner than without modes


def test_what_shows_late_is_undone_where_it_began():
    """A stem that sticks once where the model's slides: rows later that shows, and one mode of the past explains it."""
    behind = DeadTime(1.6, inputs="MV", outputs="late", start=0.1)
    loop = sticky_loop(True, behind=behind)
    sliding = (t for t in range(302, 330) if simulate(loop, float(t), every=1.0).final["valve"].d0[0] in (1.0, -1.0))
    t1 = next(sliding)
    begin = simulate(loop, float(t1), every=1.0)
    stuck = {"valve.mode": 0.0, "valve.x": float(begin.log["MV"][-1])}
    rest = simulate(begin.final.starting_at(stuck), 300.0, t0=float(t1), every=1.0)
    t = np.concatenate([begin.log.t, rest.log.t[1:]])
    seen, MV = (
        {s: np.concatenate([begin.log[s], rest.log[s][1:]]) for s in names} for names in (("OP", "PV_m"), ("MV",))
    )
    wrong = []
    for back in (0, 3):
        run = replay(sticky_loop(False, behind=behind), Log(t, seen), branches=replace(FITTING, back=back))
        assert run.ok and len(run.log.t) == len(t)
        wrong.append(int((np.abs(run.log["MV"] - MV["MV"]) > 1e-6).sum()))
    assert wrong[1] <= 2 < 10 < wrong[0]
    assert (run.taken[0].t, run.taken[0].mode) == (float(t1), "stuck")


def test_with_patience_fewer_samples_are_tried_where_no_mode_helps():
    seen, _, start = window(t0=0.0)
    wide = sticky_loop(False, QuasiStaticStem(0.09, 0.01))  # wrong sizes: wrong again and again, in any mode
    every, patient = (replay(wide, seen, start=start, branches=replace(FITTING, patience=n)).taken for n in (1, 64))
    assert 0 < len(patient) < len(every)


@pytest.mark.parametrize("valve", [None, StickSlip.high()], ids=["massless", "mass"])
def test_a_right_model_is_left_alone(valve):
    seen, _, _ = window(valve, 0.0)
    plain, run = (replay(sticky_loop(False, valve), seen, branches=given) for given in (None, FITTING))
    assert run.taken == () and run.events == plain.events
    for signal in plain.log.names:
        np.testing.assert_array_equal(run.log[signal], plain.log[signal])


def test_a_branch_is_what_a_run_from_there_in_that_mode_gives():
    """The first branch kept, done again by hand: a run up to it, the stem's mode changed, a run of one interval."""
    seen, truth, start = window()
    start["valve.x"] = float(truth["MV"][0]) - 0.04
    run = replay(sticky_loop(False), seen, start=start, branches=FITTING)
    first = run.taken[0]
    assert not first.held and first.after < 0.2 * first.before
    model = pinned(sticky_loop(False), seen).starting_at(start)
    before = simulate(model, first.t - seen.t[0], times=[first.t], t0=float(seen.t[0])).final
    offset = float(before["OP pin"].d0[0])
    for mode, expected in (("stuck", first.before), (first.mode, first.after)):
        after = simulate(before.starting_at({"valve.mode": before["valve"].modes[mode]}), 1.0, t0=first.t, every=1.0)
        change = after.log["OP:offset"][-1] - offset
        assert abs(change) / ONE_STEP == pytest.approx(expected, rel=1e-5)
    k = int(first.t - seen.t[0])
    assert run.log["MV"][k + 1] == pytest.approx(after.log["MV"][-1], abs=1e-9)


def test_rows_and_events_of_branches_that_were_not_kept_leave_no_trace():
    seen, truth, start = window()
    start["valve.x"] = float(truth["MV"][0]) + 0.03
    run = replay(sticky_loop(False), seen, start=start, branches=FITTING)
    assert run.taken and np.isfinite(run.log["MV"]).all() and len(run.log.t) == len(seen.t)
    times = [event.t for event in run.events]
    assert times == sorted(times)
    modes = {}
    for event in run.events:  # each change of a block's mode starts from the one before
        assert modes.get(event.block, event.before) == event.before
        modes[event.block] = event.after


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (Branches("valv", changes={"OP": 1e-5}), "no block 'valv'"),
        (Branches("process", changes={"OP": 1e-5}), "has no modes to try"),
        (Branches("valve", modes=("sticky",), changes={"OP": 1e-5}), "has no mode 'sticky'"),
        (Branches("valve", changes={"MV": 1e-5}), "'MV' is not pinned"),
        (Branches("valve"), "no pin tells"),
        (Branches("valve", changes={"OP": 0.0}), "limits are positive"),
        (Branches("valve", changes={"OP": 1e-5}, share=1.5), "share = 1.5"),
        (Branches("valve", changes={"OP": 1e-5}, patience=0), "patience = 0"),
        (Branches("valve", changes={"OP": 1e-5}, back=-1), "back = -1"),
    ],
)
def test_misuse_is_explained(given, words):
    seen, _, _ = window()
    with pytest.raises((WiringError, ValueError), match=words):
        replay(sticky_loop(False), seen, branches=given)
