"""Whether an effect matters: how far it moves the signals of runs."""

from stickslip.blocks import Equations
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.relevance import ALL, RELEVANT, moved

from tests.gap.root_tank import framed, logged, tank


def test_an_effect_with_which_no_run_ends_moves_all() -> None:
    # the root of a level below 0 is no number: such runs had no rows, and the effect had moved nothing
    dry = Equations(
        "tank", der=lambda h, F, A, k: (F - k * h**0.5) / A, states={"h": 1.0}, params={"A": 60.0, "k": 0.5},
        inputs="F",
    )  # fmt: skip
    frame = framed(tank().replace("tank", dry), logged(tank(), 8, duration=1200.0))
    null, biased = Hypothesis(frame).filtered({}), Hypothesis(frame, effect("sensor_bias"), "sensor")
    for offset, least in ((1.5, ALL), (0.1, RELEVANT)):
        assert moved(biased, {**null.values, "offset": offset}) >= least
    assert moved(biased, {**null.values, "offset": 0.0}) == 0.0
