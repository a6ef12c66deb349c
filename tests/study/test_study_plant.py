"""Studies of the production plant: its quantities, its rest at any feed, its pictures."""

import numpy as np
import polars as pl
import pytest
from stickslip.diagram import simulate
from stickslip.plant import kicked, production_plant
from stickslip.plant.loops import integrating_loop
from stickslip.study import StudyError, production_subject, study
from stickslip.study.groups import groups
from stickslip.study.request import fingerprint

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


def test_one_quantity_by_two_roads_is_refused():
    subject = production_subject("B", F_s="high")
    with pytest.raises(StudyError, match=r"'VPCS1.F_s' is varied twice"):
        study(subject, {"VPCS1.F_s": [2000.0]}, plant={"VPCS1.F_s": [1800.0]}, duration=20.0, every=1.0)
