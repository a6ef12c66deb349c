"""Where a filter begins: as the model is stated, or where the plant of a hypothesis rests; and sizes in any unit.

A cooled room holds goods that follow its air over five hours and that nobody measures.
"""

import numpy as np
import pytest
from stickslip.blocks import Equations, IdealValve, Noise, SampledPI, SampledSensor
from stickslip.diagram import ensemble, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.start import start_values
from stickslip.logs import Log

SP, OP, BIAS = 4.0, 50.0, 1.0  # [degC, %, degC]


def _room(T, goods, MV, load):
    cooled = 0.02 * 30.0 ** (MV / 100.0) * (T + 8.0)
    return (8.0 + load + 1.5 * (goods - T) - cooled * 8.0 / (0.02 * 30.0**0.5 * 12.0)) / 900.0, (T - goods) / 18000.0


def cold_room(goods=SP, T=SP):
    """Return a room whose air and goods start at these temperatures [degC]; at ``SP`` both rest."""
    return wire(
        [
            SampledPI(12.0, 1500.0, dt=10.0, low=0.0, high=100.0, action="direct", start_op=OP),
            IdealValve(),
            Noise("load", sd=0.6, dt=10.0, correlation_time=600.0, name="heat"),
            Equations("room", der=_room, states={"T": T, "goods": goods}, inputs=["MV", "load"], outputs="T"),
            SampledSensor(10.0, sd=0.03, start=SP, inputs="T", outputs="PV"),
        ],
        inputs=["SP"],
    )


def logged(plant, seed, rows=1500):
    """Return the log of a plant whose SP goes up half way, each 30 s."""
    t = 30.0 * np.arange(rows)
    inputs = Log(t, {"SP": np.where(t < t[rows // 2], SP, SP + 0.5)})
    run = ensemble(plant, t[-1], times=t, inputs=inputs, seeds=[seed], signals=["OP", "PV"], progress=False)
    return Log(t, {"SP": inputs["SP"], **{s: run.values[s][0] for s in ("OP", "PV")}})


@pytest.fixture(scope="module")
def read_high():
    # the plant has read high for long: its air and goods are colder by the bias
    plant = effect("sensor_bias").insert(cold_room(SP - BIAS, SP - BIAS), "sensor", offset=BIAS)
    return logged(plant, 3)


def test_first_rows_do_not_say_where_a_hidden_store_starts():
    # expected before: goods at whatever temperature explains the load of the first half hour
    model, record = read(cold_room(), logged(cold_room(), 1))
    assert abs(start_values(silenced(model), record)["room.goods"] - SP) > 0.3
    frame = frame_of(model, record)
    assert frame.given.model["room"].x0.tolist() == [SP, SP] and np.isfinite(frame.rests)


def test_a_model_that_starts_elsewhere_than_its_log_begins_where_the_first_rows_say():
    model, record = read(cold_room(SP + 6.0, SP + 6.0), logged(cold_room(), 1))
    frame = frame_of(model, record)
    assert frame.given.model["room"].x0[0] == pytest.approx(SP, abs=0.5) and np.isnan(frame.rests)


def test_a_sensor_that_reads_high_has_moved_the_plant_hidden_store_included(read_high):
    frame = frame_of(*read(cold_room(), read_high))
    one = Hypothesis(frame, effect("sensor_bias"), "sensor")
    blocks = one.blocks_with({**one.nominal, "offset": BIAS})
    rest = dict(zip(one.names, one.at_rest(blocks, frame.rests), strict=True))
    assert [rest["room.T"], rest["room.goods"]] == pytest.approx([SP - BIAS, SP - BIAS], abs=1e-3)  # analytic


def test_a_bias_beyond_half_a_degree_is_named_where_no_span_is_stated(read_high):
    # expected before: no gap, since no bias was looked for beyond 0.5 in any unit, and the goods were at SP
    known = [effect(name) for name in ("sensor_bias", "sensor_span", "process_gain", "controller_gain")]
    report = diagnose(cold_room(), read_high, catalogue=known, limits=False)
    (cause,) = report.causes
    assert (cause.effect, cause.place) == ("sensor_bias", "sensor")
    assert cause.parameters["offset"].value == pytest.approx(BIAS, rel=0.2)
