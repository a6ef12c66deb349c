"""The models of the foreign plants, wired from data sheets by another hand, follow the records of these plants."""

from functools import cache

import numpy as np
import pytest

from benchmarks.foreign.record import record
from benchmarks.foreign_models.following import MODELS, behind_switches, following, model, played, silent


@cache
def signals_of(plant: str) -> dict[str, np.ndarray]:
    """Return the signals of a record without an effect, with noise and loads as stated; made once for all tests."""
    return dict(record(plant, "none", 0.0, 0, 1.0, 1.0).signals)


@pytest.mark.parametrize("plant", MODELS)
def test_a_model_has_the_signals_of_the_log(plant: str) -> None:
    logged = set(signals_of(plant)) - {"time"}
    diagram = model(plant)
    assert set(diagram.open_inputs) <= logged
    # FA and RATIO are what the ratio station makes SP of, which is the model's input
    assert logged - set(diagram.signals) - set(diagram.open_inputs) == (
        {"FA", "RATIO"} if plant == "ratio_feedforward" else set()
    )


@pytest.mark.parametrize("plant", MODELS)
def test_factors_multiply_what_is_stated(plant: str) -> None:
    stated, other = model(plant), model(plant, noise_factor=2.0, load_factor=0.5)
    for block in stated.blocks:
        if "sd" in block.params:  # analytic: 2 for a sensor's noise, 0.5 for a load
            factor = 0.5 if str(block.role) == "disturbance" else 2.0
            assert other[block.name].params["sd"] == pytest.approx(factor * block.params["sd"])


@pytest.mark.parametrize("plant", MODELS)
def test_a_record_is_as_far_from_its_model_as_the_model_s_own_records(plant: str) -> None:
    for name, (distance, own) in following(model(plant), signals_of(plant)).items():
        assert 0.6 < distance / own < 1.5, name  # analytic: 1 but for luck


@pytest.mark.parametrize("plant", ["gas_pressure", "exotherm", "two_by_two"])
def test_a_wrong_controller_does_not_follow(plant: str) -> None:
    wrong = model(plant)
    controller = next(block for block in wrong.blocks if str(block.role) == "controller")
    wrong = wrong.with_params({f"{controller.name}.T_i": 3.0 * controller.params["T_i"]})
    found = following(wrong, signals_of(plant))
    assert max(distance / own for distance, own in found.values()) > 1.5


STEPPED = sorted({*MODELS} - {"batch_ramp", "ratio_feedforward", "two_by_two", "sqrt_tank"})


@pytest.mark.parametrize("plant", STEPPED)
def test_without_noise_and_load_a_plant_is_its_model_to_the_digits_of_its_log(plant: str) -> None:
    # analytic: half a step of the log, and what the steps of time of the plant leave (snapshot: 4.6 in cascade)
    assert max(behind_switches(plant).values()) < 5.0


def test_without_noise_and_loads_a_model_repeats_itself() -> None:
    signals = signals_of("gas_pressure")
    still = silent(model("gas_pressure"))
    first, again = played(still, signals), played(still, signals)
    assert all((first[name] == again[name]).all() for name in first)


def test_a_plant_without_a_model_is_refused() -> None:
    with pytest.raises(ValueError, match="there is no model of 'mill'"):
        model("mill")
