"""A right model leaves nothing unusual, whatever the log leaves out: digits of SP, what lies between two rows."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import SampledFunction, SampledPI, SampledSensor, Staircase
from stickslip.diagram import simulate
from stickslip.diagram.inputs import close
from stickslip.gap.insertion.scales import span
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.framing import frame_of, when_switched
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read
from stickslip.logs import Log

from tests.gap.plain_tank import SCAN, T_I, K, logged, model

USUAL = 5.0  # standard deviations of the largest of about 130 figures


def largest(diagram, log):
    """Return the largest figure of what the model leaves, and its name."""
    frame = frame_of(*read(diagram, log))
    assert frame is not None
    found = checks(Hypothesis(when_switched(frame)).filtered({}))
    return max((abs(float(size)), name) for name, size in found.items())


def engine_log(diagram, seed, every, duration=7200.0, levels=(1.0, 1.05, 0.95, 1.1, 1.0, 0.9)):
    at = np.linspace(0.0, duration, len(levels), endpoint=False)
    closed = close(diagram, {"SP": Staircase("SP", at=at, levels=levels)})
    for k, name in enumerate(("feed", "sensor")):
        closed = closed.replace(name, closed[name].reseeded([seed, k]))
    run = simulate(closed, duration, every=every).log
    return Log(run.t, {"SP": run["SP"], **{s: np.round(run[s], 3) for s in ("PV", "OP")}})


def slowly(scan, K_p, T):
    """Return the model with a sensor and a controller that scan more slowly."""
    controller = SampledPI(K_p, T, dt=scan, start_op=0.5, inputs=["SP", "PV"], name="controller")
    sensor = SampledSensor(dt=scan, sd=0.004, start=1.0, inputs="h", outputs="PV", name="sensor")
    return model().replace("controller", controller).replace("sensor", sensor)


def test_a_set_point_has_digits_that_the_log_has_not():
    slow = slowly(6.0, 8.0, 60.0)
    log = engine_log(slow, 6, every=6.0, levels=(1.00045, 1.0606, 0.9703, 1.10044, 1.0496, 0.9497))
    size, name = largest(slow, log.with_signals(SP=np.round(log["SP"], 3)))
    assert size < USUAL, name


def test_a_set_point_moves_between_rows():
    wander = np.cumsum(0.12 * np.random.default_rng(3).standard_normal(5401))
    log = logged(levels=1.0 + 0.1 * np.sin(wander))
    size, name = largest(model(), log)
    assert size < 8.0, name  # 88 if it were held to its rows: it is no random walk quite
    frame = when_switched(frame_of(*read(model(), log)))
    lines, bridges = (Hypothesis(one).filtered({}).nll for one in (replace(frame, doubts={}), frame))
    assert bridges < lines - 100.0


def test_an_output_that_is_logged_again_says_nothing_new():
    slow = slowly(18.0, K, T_I)
    size, name = largest(slow, engine_log(slow, 4, every=6.0))
    assert size < USUAL, name


def test_noise_that_changes_between_rows_is_not_held():
    sloshing = model().replace("sensor", SampledSensor(dt=1.0, sd=0.02, correlation_time=3.0, start=1.0, inputs="h",
                                                       outputs="PV", name="sensor"))  # fmt: skip
    size, name = largest(sloshing, engine_log(sloshing, 5, every=20.0, duration=14400.0))
    assert size < USUAL, name


def test_rows_lie_anywhere_between_scans():
    log = logged()
    late = Log(log.t - 0.75, {s: log[s] for s in log.names})  # the clock of a log does not say when a controller scans
    size, name = largest(model(), late)
    assert size < USUAL, name


def program(state, SP, PV, K_p=K, T_i=T_I, h=SCAN):
    """A controller as its user has it: positional, kept between its limits."""
    z, _ = state
    e = SP - PV
    v = K_p * e + z
    op = min(max(v, 0.0), 1.0)
    return (z + K_p * h / T_i * e + op - v, v), op


def test_a_controller_that_is_a_program_is_followed():
    own = SampledFunction("controller", program, dt=SCAN, inputs=["SP", "PV"], outputs="OP", state=(0.5, 0.5),
                          start_output=0.5).with_role("controller", SP="SP", PV="PV", OP="OP")  # fmt: skip
    log = logged()
    size, name = largest(model().replace("controller", own), log)
    assert size < USUAL, name
    left = [Hypothesis(when_switched(frame_of(*read(one, log)))).filtered({}).nll
            for one in (model(), model().replace("controller", own))]  # fmt: skip
    assert left[1] == pytest.approx(left[0], abs=1e-3)


def test_an_output_in_percent_has_that_span_though_its_program_states_none():
    own = SampledFunction("controller", program, dt=SCAN, inputs=["SP", "PV"], outputs="OP", state=(0.5, 0.5),
                          params={"K_p": 100.0 * K}).with_role("controller", SP="SP", PV="PV", OP="OP")  # fmt: skip
    log = logged(duration=600.0)
    diagram, record = read(model().replace("controller", own), log.with_signals(OP=100.0 * log["OP"]))
    assert span(diagram, "OP") == 100.0 and "OP is taken to go from 0 to 100" in record.log.notes[0]
    assert span(read(model(), log)[0], "OP") == 1.0
