"""A limit that no signal meets is no candidate: it leaves what the model leaves, and costs no filter of its own."""

from dataclasses import replace

from stickslip.gap.effects import effect
from stickslip.gap.likelihood.candidates import Candidate, by_score
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.likelihood.settling import settled
from stickslip.logs import Log

from tests.gap.root_tank import framed, logged, tank

LIMITED = effect("sensor_saturation")


def looked_at(log: Log) -> list[Candidate]:
    """Return the limits of the sensor that are candidates."""
    null = settled(model_alone(replace(framed(tank(), log), apart=True)))
    return by_score(null, [Hypothesis(null.hypothesis.frame, LIMITED, "sensor")])


def test_a_limit_that_is_never_met_is_no_candidate() -> None:
    assert looked_at(logged(tank(), 5)) == []


def test_a_limit_that_is_met_is_one() -> None:
    top = float(logged(tank(), 5)["PV"].max())
    assert len(looked_at(logged(LIMITED.insert(tank(), "sensor", high=top - 0.05), 5))) == 1
