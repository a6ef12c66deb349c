"""Stems by a bank: without a stick it is the filter itself; a stem of another law is named, with its sizes."""

import numpy as np
import pytest
from scipy.stats import norm
from stickslip.blocks import Equations, HeValve, IdealValve, Noise, SampledPI, SampledSensor, Square, StickSlip
from stickslip.diagram import simulate, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.effects.deadband import Deadband
from stickslip.gap.effects.stiction import RestingStiction
from stickslip.gap.likelihood.bank import drawn_evenly, left_by_bank
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.known_stem import KnownStem
from stickslip.gap.records.model import read
from stickslip.logs import Log

ROWS = 600


def tank(valve):
    """Return a tank whose outflow goes by the root of its level, under a controller that scans each 2 s; OP in %."""
    return wire(
        [
            SampledPI(60.0, 60.0, dt=2.0, low=0.0, high=100.0, start_op=50.0),
            valve,
            Noise("load", sd=0.005, dt=1.0, correlation_time=80.0, name="feed"),
            Equations("process", der=_level, states={"h": 1.0}, inputs=["MV", "load"], params={"K": 2.0, "tau": 20.0}),
            SampledSensor(2.0, sd=0.003, start=1.0, inputs="h", outputs="PV"),
        ],
        inputs=["SP"],
    )


def _level(h, MV, load, K, tau):
    return (K * 0.01 * MV + load - max(h, 0.01) ** 0.5) / tau


def logged(valve, rows=ROWS):
    """Return the rounded log of SP, OP and PV of a tank with a valve, each 4 s."""
    source = Square("SP", 0.15, 700.0, mean=1.0)
    run = simulate(wire([source, *tank(valve).blocks]), 4.0 * rows, every=4.0)
    assert run.ok
    return Log(run.log.t, {"SP": run.log["SP"], "OP": run.log["OP"].round(2), "PV": run.log["PV"].round(4)})


@pytest.fixture(scope="module")
def frame():
    model, record = read(tank(IdealValve()), logged(HeValve(4.0, 2.5, 0.5, high=100.0, start=50.0), 900))
    found = frame_of(model, record)
    assert found is not None
    return found


def test_stems_draw_one_number_in_each_of_as_many_equal_parts():
    drawn = drawn_evenly(np.random.default_rng(1), 500, 2, 8)
    assert drawn.shape == (500, 8, 2)
    parts = np.sort(np.floor(8.0 * norm.cdf(drawn)), axis=1)
    assert np.array_equal(parts, np.broadcast_to(np.arange(8.0)[:, None], parts.shape))
    assert np.mean(drawn) == pytest.approx(0.0, abs=0.01) and np.std(drawn) == pytest.approx(1.0, abs=0.02)
    assert abs(np.corrcoef(drawn[:-1, 0, 0], drawn[1:, 0, 0])[0, 1]) < 0.15  # three standard deviations of 500


def test_a_bank_that_does_not_stick_is_the_filter(frame):
    near = Hypothesis(frame).filtered({}, joined=True)
    bank = left_by_bank(Hypothesis(frame, Deadband(), "valve"), {"width": 1e-4}, near, 3)
    assert bank.nll == pytest.approx(near.nll, abs=1.0)  # nats of some hundred rows


def test_the_true_stem_leaves_less_than_another(frame):
    one = Hypothesis(frame, RestingStiction(), "valve")
    times, _ = frame.stops
    path = np.interp(times, frame.record.log.t, frame.record.log["OP"])
    near = Hypothesis(frame, KnownStem(times, path), "valve").filtered({}, joined=True)
    true, *others = (
        left_by_bank(one, {"S": S, "J": J}, near, 12).nll for S, J in ((6.5, 1.5), (3.5, 0.8), (10.0, 2.3), (6.5, 4.0))
    )
    assert true + 10.0 < min(others)


def test_the_stem_with_mass_of_a_tank_is_named():
    """The log is that of a law of its own: mass, viscous and Coulomb friction."""
    valve = StickSlip(k=1.0, M=1e-6, F_v=5e-3, F_c=2.5, F_s=4.0, high=100.0, start=50.0)
    catalogue = [one for one in CATALOGUE if one.name in ("stiction", "deadband", "valve_gain")]
    cause = diagnose(tank(IdealValve()), logged(valve, 450), catalogue=catalogue, limits=False).causes[0]
    assert (cause.effect, cause.place) == ("stiction", "valve")
    assert cause.parameters["S"].value == pytest.approx(6.5, rel=0.05)
    assert cause.parameters["S"].low < cause.parameters["S"].value < cause.parameters["S"].high
