"""The figures of both stages: counted apart where the calibrated answer leaves a record open."""

from benchmarks.detect.posterior import NOTES, Pair, summed_up
from calibration import draw
from calibration.spec import Truth


def pair(sticky, p, unsure):
    spec = draw(1, seed=1)[0]
    truth = Truth(
        cause="stiction" if sticky else "healthy", group="cycling" if sticky else "healthy", S=5.0, J=3.0,
        process="self_regulating", cycling=True, travel=2.0, op_range=10.0, period=50.0, defects=(),
    )  # fmt: skip
    return Pair(spec, truth, None, (p, 5.0, 3.0), 1.0, unsure)


def test_the_unsure_are_counted_apart():
    found = summed_up(
        [pair(True, 0.9, False), pair(False, 0.1, False), pair(True, 0.4, True), pair(False, 0.6, True)], loops=10
    )
    assert found["unsure_records"] == 2 and found["unsure_model_auc"] == 0.0 and found["unsure_model_right"] == 0.0
    assert found["model_auc"] == 0.75  # analytic: three of the four pairs of a sticky and another loop stand in order
    assert set(found) == set(NOTES)


def test_one_side_alone_has_no_area():
    found = summed_up([pair(True, 0.4, True), pair(False, 0.2, False)], 10)
    assert found["unsure_model_auc"] is None and found["unsure_simulate_right"] == 0.0
