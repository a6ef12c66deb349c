"""Between two rows behind a switch: what a run of the model adds, and when a set point switched."""

import numpy as np
import pytest
from stickslip.blocks import FirstOrder, Staircase, Sum
from stickslip.cases.plant_models import LOGGED_SECTION
from stickslip.diagram import ensemble, simulate, wire
from stickslip.engine.run import Settings
from stickslip.gap.diagnosis import diagnose, held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.left import judged_by_loss
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.linearised.behind import NOTHING, Behind, behind
from stickslip.gap.linearised.driving import driven
from stickslip.gap.linearised.filtered import filter_of
from stickslip.gap.linearised.instants import with_switches
from stickslip.gap.linearised.observer import observer
from stickslip.gap.null_model.null_model import undisturbed
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.record import switch_rows
from stickslip.logs import Log

from benchmarks.gap.plant import MODELS, ROUNDING, PlantRun

SWITCHES = (300.0, 600.7, 901.3, 1200.0)  # [s]: two at rows, two between them


def record_of(plant, duration=1500.0, at=SWITCHES, **settings):
    """Return the record of a separator section whose pressure set point switches."""
    rest = plant["SP_PCS11"].params["value"]
    levels = rest * np.array([1.0, 1.015, 0.985, 1.01, 0.99])[: len(at) + 1]
    moving = plant.replace("SP_PCS11", Staircase("SP_PCS11", levels, at=(0.0, *at)))
    log = simulate(moving, duration, every=2.0, signals=list(LOGGED_SECTION), **settings).log
    log = log.with_signals(**{s: np.round(log[s] / ROUNDING[s[0]]) * ROUNDING[s[0]] for s in log.names if s[0] != "S"})
    model, record = read(plant, log)
    return model, silenced(model), filter_of(model, silenced(model), record)


def test_an_instant_between_rows_is_found_and_one_at_a_row_stays_there():
    _, quiet, record = record_of(MODELS["separator_section"][0]())
    found = with_switches(quiet, record, record.filter).leads.get("SP_PCS11", {})
    rows = {int(np.ceil(at / 2.0 - 1e-9)): 2.0 * np.ceil(at / 2.0 - 1e-9) - at for at in SWITCHES}
    assert set(found) == {row for row, lead in rows.items() if lead > 1e-6}
    for row, lead in found.items():
        assert lead == pytest.approx(rows[row], abs=0.15)  # [s], of an interval of 2 s


def test_what_a_gain_does_between_rows_is_foretold_by_a_run_with_that_gain():
    # without what the run adds, the changes of OP that the model's own gain leaves behind a switch are far larger
    gain = effect("controller_gain")
    plant = MODELS["separator_section"][0]()
    _, quiet, record = record_of(gain.insert(plant, "PCS11", factor=1.4), at=(300.0, 600.0, 900.0, 1200.0))
    _, nominal, _ = record_of(plant, at=(300.0, 600.0, 900.0, 1200.0))
    k = record.pinned.index("OP_VPCS1")
    left = [np.diff(record.filter.residuals(one, record, None, None)[0][:, k]) for one in (nominal, quiet)]
    rows = np.array([150, 300, 450, 600])
    assert np.abs(left[1][rows]).max() < 0.1 * np.abs(left[0][rows - 1]).max()


def test_a_run_adds_nothing_at_rows_and_nothing_away_from_switches():
    _, quiet, record = record_of(MODELS["separator_section"][0](), at=(300.0, 600.0))
    found = behind(quiet, record, ["p_1", "OP_VPCS1"], {})
    assert np.isclose(found.t, 302.0 - 2e-6, rtol=0.0, atol=1e-9).any()  # just before a row, where its line has a point
    assert np.abs(found.more["OP_VPCS1"][:, np.isin(found.t, record.log.t)]).max() < 1e-9
    assert found.t.min() >= 300.0 and ((found.t < 340.0) | (found.t >= 600.0)).all()
    size = np.abs(found.more["OP_VPCS1"][0])
    assert size[found.t < 302.0].max() > 100.0 * size[(found.t > 328.0) & (found.t < 332.0)].max()  # a step settles


def seen_plant(seed, hours):
    """Return the full plant, silent, and a record of it without a gap, whose set points switch at rows."""
    model, record = read(MODELS["full_plant"][0](), PlantRun("full_plant", seed=seed).made(hours=hours))
    return silenced(model), filter_of(model, silenced(model), record)


def test_rows_inside_long_steps_of_a_run_are_as_exact_as_its_steps():
    # expected: the same run stopped at each row, analytic; at the usual tolerance the torque was 300 N m off
    quiet, record = seen_plant(1092, 0.25)
    t = record.log.t
    many = ensemble(
        quiet, record.log.duration, t0=np.zeros(1), times=t, signals=["tau_d", "p_in3"], progress=False,
        inputs=Log(t, {s: record.log[s] for s in record.played}), settings=Settings(rtol=1e-9, atol=1e-12),
    )  # fmt: skip
    run = undisturbed(quiet, record)
    for s, close in (("tau_d", 2.0), ("p_in3", 1.0)):  # [N m], [Pa]: what a log shows is 1 and 100
        jump = np.flatnonzero(np.diff(record.log["SP_PCS21"]) != 0.0) + 1  # there it has two values
        away = np.setdiff1d(np.arange(len(t)), jump)
        assert np.abs(run[s] - many.values[s][0])[away].max() < close


def test_set_points_that_switch_at_rows_are_told_to():
    # curves that were drawn badly behind a switch made three of these 13 switches lie between rows
    quiet, record = seen_plant(1091, 0.35)
    assert sum(len(switch_rows(record.log, s)) for s in record.played) > 8
    assert not with_switches(quiet, record, record.filter).leads


def test_a_process_starts_where_the_log_shows_it_whatever_its_parameters():
    piece = wire([FirstOrder(inputs="u", outputs="x", K=2.0, tau=5.0), Sum("y", {"x": 2.0}, name="twice")], ["u"])
    made = observer(piece, ["u"], ["y"], {})
    y = np.full((4, 1), 12.0)
    u = np.zeros((4, 1))
    table = np.stack([u + 3.0, u + 3.0, u])[None]
    K, which = np.zeros((1, 1, 1)), np.zeros(4, dtype=np.int64)
    e = made.residuals({}, table, y[None], K, which, {"process[PV]": 0.0}, {"process[PV]": np.array([0.5])}, 2.0)[
        0, :, 0
    ]
    np.testing.assert_allclose(e, 0.0, atol=1e-9)  # y = 2 x rests at 12 with u = 3; x started at 0


def moving_section(seed):
    """Return a record of the section without a gap whose two set points switch at any time."""
    rng = np.random.default_rng([91, seed])
    plant = MODELS["separator_section"][0]()
    for name in ("SP_PCS11", "SP_LCS11"):
        rest = plant[name].params["value"]
        times = np.concatenate([[0.0], np.cumsum(rng.uniform(150.0, 400.0, 12))])
        levels = rest * (1.0 + 0.02 * rng.uniform(-1.0, 1.0, len(times)))
        levels[0] = rest
        plant = plant.replace(name, Staircase(name, levels, at=times))
    plant = plant.replace("F_in", plant["F_in"].reseeded([91, seed]))
    log = simulate(plant, 2400.0, every=2.0, signals=list(LOGGED_SECTION), rtol=1e-5, atol=1e-8).log
    return log.with_signals(**{s: np.round(log[s] / ROUNDING[s[0]]) * ROUNDING[s[0]] for s in log.names if s[0] != "S"})


@pytest.mark.parametrize("seed", [0, 1])
def test_set_points_that_switch_between_rows_are_no_gap(seed):
    # with means over an interval from eight points of it, and pressures that told no instant, these were 7 sd and more
    frame = held_against(MODELS["separator_section"][0](), moving_section(seed))
    assert not judged_by_loss(model_alone(frame)).unusual


def test_the_mean_of_an_input_that_jumps_between_rows_is_that_of_its_jump():
    _, quiet, record = record_of(MODELS["separator_section"][0](), at=(300.0,))
    found = record.filter.parts
    for lead in (0.13, 0.77, 1.71):  # [s] before the row at 300 s
        t = np.array([298.0, 300.0 - lead - 1e-6, 300.0 - lead, 300.0 - 2e-6, 300.0])
        jump = Behind(t, {"OP_VPCS1": np.array([[0.0, 0.0, 0.01, 0.01, 0.0]])})
        plain = driven(quiet, found, record, [record.log], {}, 1, NOTHING)[0]
        there = driven(quiet, found, record, [record.log], {}, 1, jump)[0]
        j = found.given.index("MV_VPCS1")
        mean = (there - plain)[2, 150, j] + 0.5 * ((there - plain)[0, 149, j] + (there - plain)[1, 150, j])
        assert mean == pytest.approx(0.01 * lead / 2.0, rel=0.01)  # analytic: the valve is ideal, its MV is its OP


def test_an_explanation_is_named_by_runs_of_its_own():
    # what the gain itself does between rows is in its own runs only
    gain = effect("controller_gain")
    plant = MODELS["separator_section"][0]()
    log = simulate(
        gain.insert(plant.replace("SP_PCS11", moved(plant)), "PCS11", factor=1.4), 900.0, every=2.0,
        signals=list(LOGGED_SECTION),
    ).log  # fmt: skip
    (cause,) = diagnose(plant, log, catalogue=[gain, effect("controller_integral_time")], limits=False).causes
    assert (cause.effect, cause.place) == ("controller_gain", "PCS11")
    assert cause.parameters["factor"].value == pytest.approx(1.4, rel=0.01)


def test_one_value_after_another_leaves_what_all_at_once_leave():
    _, quiet, record = record_of(MODELS["separator_section"][0](), at=(300.0, 600.0))
    gain = effect("controller_gain")
    changed, sizes = gain.put(quiet, "PCS11"), (0.8, 1.1, 1.25, 1.4)
    given = gain.settings(quiet, "PCS11", factor=np.array(sizes))
    together = record.filter.residuals(changed, record, given, None)
    for k in range(len(sizes)):
        alone = record.filter.residuals(changed, record, {key: np.asarray(v)[[k]] for key, v in given.items()}, None)
        np.testing.assert_array_equal(alone[0], together[k])


def moved(plant):
    """Return the pressure's set point of a plant as a staircase."""
    rest = plant["SP_PCS11"].params["value"]
    return Staircase("SP_PCS11", rest * np.array([1.0, 1.015, 0.985]), at=(0.0, 300.0, 600.0))
