"""The rival of every effect, a load at the feed that nobody measures: where it is right, and where it is not."""

import numpy as np
import pytest
from stickslip.blocks import Noise
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.left import left
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.likelihood.unmeasured import forgotten, octaves, unmeasured_load

SD, TIME = 0.006, 120.0  # of the load that the model lacks: standard deviation, correlation time [s]
FEW = [effect(name) for name in ("sensor_bias", "process_gain", "dead_time", "controller_gain", "sine_disturbance")]


@pytest.fixture(scope="module")
def wandering(recorded, logged):
    """A record of the loop with a load that wanders, of which the model knows nothing."""
    plain = recorded(seed=4)
    load = Noise("load", sd=SD, dt=1.0, correlation_time=TIME, name="feed").with_role("disturbance")
    model = ideal_flow(rest=1.5).replace("feed", load)
    return logged(model, plain, 4)


def load_of(log):
    null = model_alone(held_against(ideal_flow(), log))
    return null, unmeasured_load(null)


@pytest.mark.usefixtures("without_hints")
def test_a_wandering_load_is_no_effect_of_the_catalogue_and_said_to_explain_everything(wandering):
    report = diagnose(ideal_flow(), wandering, catalogue=FEW, progress=False)
    assert [(cause.effect, cause.place) for cause in report.causes] == [("unknown", "feed")]
    assert any(word.startswith("A disturbance alone may explain it: a load at feed") for word in report.words)


def test_the_size_of_the_load_is_found(wandering):
    null, load = load_of(wandering)
    assert load.explains and load.left < load.limit < left(null.best)
    assert load.sd == pytest.approx(SD, rel=0.4)  # half an hour has some fifteen correlation times
    assert load.period > TIME  # half of the power of an autoregression is slower than 2 pi times its time


@pytest.mark.parametrize(
    ("name", "place", "values"),
    [
        ("controller_gain", "controller", {"factor": 1.15}),  # OP does not follow PV as the controller would
        ("sensor_noise", "sensor", {"factor": 3.0}),  # PV jumps at every row, which no process does
    ],
)
def test_a_load_does_not_explain_what_lies_elsewhere(recorded, name, place, values):
    _, load = load_of(recorded(name, place, **values))
    assert not load.explains and load.part < 0.8


def test_an_effect_of_one_size_is_likelier_than_a_load_that_is_free(recorded):
    report = diagnose(ideal_flow(), recorded("dead_time", "process", theta=0.8), catalogue=FEW, progress=False)
    assert report.causes[0].effect == "dead_time"
    assert any(word.startswith("A disturbance alone is excluded: a load at feed") for word in report.words)


def test_without_a_gap_a_load_gains_nothing(recorded):
    _, load = load_of(recorded(seed=6))
    assert load.explains and load.gained == pytest.approx(0.0, abs=30.0)
    assert load.sd < 0.1 * SD


def test_octaves_hold_every_frequency_once():
    for n in (1, 2, 3, 100, 3551):
        assert np.concatenate(octaves(n)).tolist() == list(range(n))


def test_a_response_that_stays_has_no_fourier_series():
    rows = np.arange(1000.0)
    assert forgotten(np.exp(-rows / 50.0)[:, None]) and not forgotten(np.ones((1000, 1)))
