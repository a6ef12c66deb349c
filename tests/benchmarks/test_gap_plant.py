"""Records of the plant for the gap's benchmark: they run, differ from one without an effect, and say what they are."""

import numpy as np
import pytest
from stickslip.gap.effects import effect

from benchmarks.gap import plant
from benchmarks.gap.plant import PlantRun, runs


def test_every_effect_is_at_a_place_where_it_can_be():
    for model, sizes in (("separator_section", plant.SIZES), ("full_plant", plant.SIZES_OF_PLANT)):
        built = plant.MODELS[model][0]()
        for name, (places, values) in sizes.items():
            assert set(places) <= set(effect(name).places(built)), name
            effect(name).checked(built, places[0], values)


def test_there_are_enough_and_none_twice():
    keys = [run.key for family in ("tuning", "report") for run in runs(family)]
    assert len(set(keys)) == len(keys)


@pytest.mark.parametrize("name", ["stiction", "valve_gain", "boil_off_rate", "step_disturbance"])
def test_a_section_feels_its_effect(name):
    place = plant.SIZES[name][0][0]
    one = PlantRun("separator_section", name, place).made(hours=0.5)
    assert set(one.names) == set(plant.LOGGED_SECTION) and len(one) == 901
    steady = plant.MODELS["separator_section"][0]()["S1"]
    assert np.isfinite(one["p_1"]).all() and steady.role == "process"
    np.testing.assert_allclose(one["p_1"], 100.0 * np.round(one["p_1"] / 100.0), atol=1e-6)


def test_the_plant_runs_with_the_effects_of_its_own():
    for name in ("compressor_fouling", "recycle_leak"):
        log = PlantRun("full_plant", name, plant.SIZES_OF_PLANT[name][0][0]).made(hours=0.2)
        assert all(np.isfinite(log[s]).all() for s in log.names) and set(log.names) == set(plant.LOGGED_PLANT)
    assert (log["SP_PCS11"] == PlantRun("full_plant", name, "VRVC2_body").made(hours=0.2)["SP_PCS11"]).all()
