"""Logs of so many significant digits, as many programs write them, and logs that keep all digits."""

import math

import numpy as np
import pytest
from stickslip.blocks import Equations, Historian, IdealValve, Noise, Product, SampledPI, SampledSensor
from stickslip.diagram import simulate, wire
from stickslip.gap.diagnosis import held_against
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.record import Digits, rounding, significant
from stickslip.logs import Log

ROWS = 1500


def rate(F, MV, p):
    return (12.0 * 40.0 ** (MV - 0.7) * math.sqrt(max(p, 0.0)) - F) / 1.5


def ratio():
    """A flow in ratio to one that is measured; the supply wanders."""
    return wire(
        [
            Product("SP", ["RATIO", "F_A"], name="ratio"),
            SampledPI(0.012, 6.0, dt=1.0, start_op=0.7, name="FC", inputs=["SP", "F_B"], outputs="OP"), IdealValve(),
            Noise("p", sd=0.06, dt=2.0, correlation_time=400.0, mean=1.0, name="supply"),
            Equations("line", der=rate, states={"F": 9.0}, inputs=["MV", "p"], outputs="F"),
            SampledSensor(1.0, sd=0.06, tau=1.0, start=9.0, name="FT", inputs="F", outputs="F_B"), Historian(["F_B"]),
        ],
        inputs=["RATIO", "F_A"],
    )  # fmt: skip


@pytest.fixture(scope="module")
def run():
    """What the loop did, while the measured flow went about the decade of ten."""
    t, rng = np.arange(float(ROWS)), np.random.default_rng(7)
    F_A = 10.0 + 0.8 * np.sin(2.0 * np.pi * t / 300.0) + 0.1 * rng.standard_normal(ROWS)
    log = simulate(ratio(), t[-1], every=1.0, inputs={"RATIO": 0.9, "F_A": Log(t, {"F_A": F_A})}).log
    return {"t": t, "RATIO": np.full(ROWS, 0.9), "F_A": F_A, "F_B": log["F_B"], "OP": log["OP"]}


def written(run, digits):
    """Return the log as a program writes it."""
    return Log(run["t"], {s: np.array([float(f"{v:.{digits}g}") for v in run[s]]) for s in run if s != "t"})


def test_the_digits_of_a_log_are_read_off_it(run):
    log = written(run, 6)
    assert significant(log["F_A"]) == 6 and rounding(log["F_A"]) == pytest.approx(1e-5)
    steps = Digits(1e-5, 6).steps(log["F_A"])
    assert set(np.round(steps, 9)) == {1e-5, 1e-4} and np.all((steps > 5e-5) == (log["F_A"] >= 10.0))
    assert significant(run["F_A"]) == 0, "all digits"


def test_decimals_are_no_significant_digits():
    values = np.array([0.01, 0.5, 9.87, 12.34])
    np.testing.assert_allclose(Digits.of(values).steps(values), 0.01)
    opening = np.append(np.arange(123, 1000) / 1000.0, 1.0)  # of 1.000 alone nobody knows how it was rounded
    np.testing.assert_allclose(Digits.of(opening).steps(opening), 0.001)


@pytest.mark.parametrize("digits", [5, 6, 12])
def test_a_right_model_of_such_a_log_leaves_what_it_should(run, digits):
    # of six digits, of which the input had been taken as exact, OP left 107 standard deviations; of twelve 38 and more,
    # in runs of the model as well: the last digits of what a run computes had been judged
    frame = held_against(ratio(), written(run, digits))
    found = checks(Hypothesis(frame).filtered({}))
    assert max(map(abs, found.values())) < 4.5
    assert any(name.startswith("size of F_B") for name in found), "the measurement is judged"
    assert ("size of OP" in found) == (digits < 12), "OP only where its digits are the log's own"
