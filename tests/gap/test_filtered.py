"""Large diagrams by a filter: how a log cuts them, what jumps between rows, and what is named in a separator."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.cases.plant_models import LOGGED_SECTION
from stickslip.diagram import simulate
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.fit import unfitted
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.left import judged_by_loss
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.linearised.between import jumps
from stickslip.gap.linearised.filtered import filter_of
from stickslip.gap.linearised.parts import parts
from stickslip.gap.null_model.null_model import NullModel
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import read, silenced

from benchmarks.gap.plant import MODELS, PlantRun


@pytest.fixture(scope="module")
def healthy():
    return PlantRun("separator_section", seed=41).made()


def seen(log, name="separator_section"):
    model, record = read(MODELS[name][0](), log)
    return model, silenced(model), record


def test_logged_outputs_of_controllers_cut_a_plant(healthy):
    _, quiet, record = seen(healthy)
    found = parts(quiet, record)
    assert found.ruled == ("LCS11", "PCS11") and found.measured == ("p_1", "V_1")
    assert {"VLCS1", "VPCS1"} <= set(found.fed) and "S1" in found.rest and not set(found.fed) & set(found.rest)


def test_a_plant_with_an_unmeasured_feed_has_a_filter_that_knows_the_feed_as_a_load(healthy):
    model, quiet, record = seen(healthy)
    found = filter_of(model, quiet, record)
    assert found is not None
    assert list(found.filter.loads) == ["F_in"] and "F_in" in found.filter.parts.rest


@pytest.mark.parametrize("spread", [1.0, 100.0])
def test_a_large_diagram_alarms_at_three_and_a_half_standard_deviations_of_its_runs(healthy, spread):
    # expected: F + 3.5 sd, analytic, F and sd of the runs without a gap; a loop's own limit is wider
    model, quiet, record = seen(healthy)
    found = filter_of(model, quiet, record)
    rows, signals = len(record.log) - 20, len(found.pinned)
    scores = 4000.0 + spread * np.array([-1.0, 0.0, 1.0])
    null_model = NullModel(
        np.zeros(signals, dtype=bool), np.zeros((0, signals, signals)), np.eye(signals), 20, scores, rows
    )
    for kind, limit in ((found, 3.5), (record, 4.5)):
        one = Hypothesis(Replays(Given(model), replace(kind, pinned=found.pinned), null_model=null_model))
        e = np.where(np.arange(len(record.log))[:, None] < 20, np.nan, 0.0) * np.ones(signals)
        as_usual = unfitted(Innovations(one, {}, e, np.ones_like(e), None, np.zeros(len(e), bool), np.zeros((0, 0))))
        verdict = judged_by_loss(as_usual)
        assert verdict.limit == pytest.approx(limit) and verdict.size == pytest.approx(-4000.0 / spread, rel=1e-3)


def test_the_true_characteristic_leaves_next_to_nothing_on_a_record_that_starts_away_from_its_rest():
    # the record starts where the model without the effect rests: half of the flow is missing, p_1 and V_1 move away
    one, values = effect("valve_characteristic"), {"rangeability": 2.53, "flow": 1.0}
    plant = MODELS["separator_section"][0]()
    for name in ("SP_PCS11", "SP_LCS11"):
        rest = plant[name].params["value"]
        levels = (rest, 1.015 * rest, 0.985 * rest, 1.01 * rest, 0.98 * rest)
        plant = plant.replace(name, Staircase(name, levels, dwell=360.0))
    log = simulate(one.insert(plant, "VPCS1", **values), 1800.0, every=2.0, signals=list(LOGGED_SECTION)).log
    _, quiet, record = seen(log)
    found = filter_of(plant, quiet, record)
    changed = one.put(quiet, "VPCS1")
    missed = found.filter.residuals(quiet, found, None, None)[0]
    left = found.filter.residuals(changed, found, one.settings(quiet, "VPCS1", **values), None)[0]
    for k, s in enumerate(found.pinned):
        if s in found.filter.parts.measured:
            before, after = (float(np.sqrt(np.nanmean(e[200:, k] ** 2))) for e in (missed, left))
            assert after < 4.0 < 50.0 < before, s  # in units of innovations without a gap


def test_a_gain_of_one_in_the_path_of_a_signal_changes_its_name_and_nothing_else(healthy):
    model, quiet, record = seen(healthy)
    found, one = filter_of(model, quiet, record), effect("valve_gain")
    same = found.filter.residuals(one.put(quiet, "VPCS1"), found, one.settings(quiet, "VPCS1", factor=1.0), None)
    np.testing.assert_allclose(same, found.filter.residuals(quiet, found, None, None), atol=1e-6)


def test_an_output_jumps_where_its_set_point_does(healthy):
    _, quiet, record = seen(healthy)
    moved = np.flatnonzero(np.diff(healthy["SP_PCS11"])) + 1
    np.testing.assert_array_equal(np.flatnonzero(jumps(quiet, record, healthy, "OP_VPCS1")), moved)
    assert not jumps(quiet, record, healthy, "p_1").any()


def test_scanning_loops_are_replayed_instead():
    from stickslip.cases.models import site_flow
    from stickslip.logs import Log

    from benchmarks.gap.generator import record as made

    one = made("site", hours=0.1)
    log = Log(one.signals["time"], {s: one.signals[s] for s in ("SP", "PV", "OP")})
    model, record = read(site_flow(), log)
    assert filter_of(model, silenced(model), record) is None


def test_nothing_is_named_where_there_is_nothing(healthy):
    assert not diagnose(MODELS["separator_section"][0](), healthy, catalogue=[effect("valve_gain")]).gap


NAMED = [
    ("controller_gain", "LCS11"), ("boil_off_rate", "S1"), ("horizontal_separator", "S1"), ("valve_gain", "VPCS1"),
    ("valve_leak", "VPCS1"), ("valve_characteristic", "VPCS1"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "place"), NAMED)
def test_an_effect_is_named_at_its_place(name, place):
    log = PlantRun("separator_section", name, place, seed=42).made(hours=0.5)
    known = [effect(one) for one in ("vapour_pressure", *dict(NAMED))]
    report = diagnose(MODELS["separator_section"][0](), log, catalogue=known)
    assert (report.causes[0].effect, report.where.confidence_set) == (name, (place,))
    assert not report.causes[0].ambiguous_with


def test_a_process_that_runs_away_explains_nothing(healthy):
    model, quiet, record = seen(healthy)
    found = filter_of(model, quiet, record)
    one = effect("vapour_pressure")
    far = found.filter.residuals(quiet, found, one.settings(quiet, "S1", factor=np.array([1.0, 1e15])), None)
    assert np.nanmedian(np.abs(far[0, 200:, :2])) < 3.0 and np.abs(far[1, -1, :2]).min() > 100.0


def test_without_a_gap_rows_behind_a_jump_leave_what_others_leave():
    plant = MODELS["full_plant"][0]()
    for name in ("SP_PCS11", "SP_PCS21"):
        rest = plant[name].params["value"]
        plant = plant.replace(name, Staircase(name, [rest, 1.015 * rest, 0.985 * rest, 1.01 * rest], dwell=300.0))
    quiet = silenced(plant)
    logged = MODELS["full_plant"][1]
    log = simulate(quiet, 1200.0, every=2.0, signals=list(logged), method="stiff").log
    _, quiet, record = seen(log, "full_plant")
    found = filter_of(plant, quiet, record)
    left = np.abs(found.filter.residuals(quiet, found, None, None)[0])
    which = found.filter.gains(found).which
    behind = np.flatnonzero((which > 0) & (np.arange(len(log)) > 100))
    for k, s in enumerate(found.pinned):
        if s in found.filter.parts.measured:  # with straight lines between rows these were thousands
            assert np.quantile(left[behind, k], 0.9) < 60.0, s
