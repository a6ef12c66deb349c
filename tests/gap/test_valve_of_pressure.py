"""A valve block that reads pressures beside OP, as a user writes it: every effect of the stem has its place there."""

import math

import numpy as np
import pytest
from stickslip.blocks import Equations, HeValve, Noise, SampledPI, SampledSensor, Sine, Staircase
from stickslip.blocks.ports import BlockError
from stickslip.diagram import Diagram, simulate, wire
from stickslip.diagram.ensembles.variants import reseeded
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.insertion.effect import EffectError
from stickslip.logs import Log

STEMS = ("stiction", "deadband", "valve_saturation", "valve_rate_limit", "positioner_lag", "valve_gain")


def flow(OP, P, h):
    """Flow [m3/h] of a linear trim under the pressure of gas and liquid, and its pressure drop [bar]."""
    drop = P - 1.2 + 0.08 * (h + 2.0)
    return 0.5 * OP * math.sqrt(max(drop, 0.0)), drop


def level(h, q_in, q_out):
    return (q_in - q_out) / 3600.0 / 2.0


def loop(role=True, stem=None) -> Diagram:
    valve = Equations(
        "valve", out=flow, inputs=["OP", "P", "h"], outputs=["q_out", "drop"], labels={"OP": "x" if stem else "OP"}
    )
    return wire(
        [
            SampledPI(2.0, 120.0, dt=2.0, action="direct", low=0.0, high=100.0, integral="present", start_op=46.5,
                      start_error=0.0),
            *([stem] if stem else []),
            valve.with_role("valve", OP="OP", MV="q_out") if role else valve.with_role("valve"),
            Noise("q_in", sd=0.2, dt=2.0, correlation_time=120.0, mean=35.0, name="feed"),
            Equations("drum", der=level, states={"h": 0.8}, inputs=["q_in", "q_out"], outputs="h"),
            SampledSensor(2.0, sd=0.05, factor=70.0, start=0.8, name="sensor", inputs="h", outputs="PV"),
        ],
        inputs=["SP", "P"],
    )  # fmt: skip


def test_effects_of_a_stem_have_their_place_at_a_valve_that_reads_a_pressure():
    model = loop()
    assert {name: effect(name).places(model) for name in STEMS} == dict.fromkeys(STEMS, ("valve",))
    assert effect("valve_leak").places(model) == effect("valve_characteristic").places(model) == ()
    stuck = effect("stiction").insert(model, "valve", S=4.0, J=1.0)
    assert stuck["valve:stiction"].input_labels == ["OP"] and stuck["valve:stiction"].params["S"] == 4.0


def test_a_valve_that_says_not_what_moves_it_is_named_with_the_remedy():
    with pytest.raises(EffectError, match=r"not clear what moves 'valve'; say \.with_role\(\"valve\", OP="):
        effect("stiction").insert(loop(role=False), "valve", S=4.0)
    with pytest.raises(
        EffectError, match="has no valve where it could be"
    ):  # what moves it is said; its full flow is not
        effect("valve_leak").insert(loop(), "valve", flow=4.0)


def test_a_stick_before_such_a_valve_is_named():
    sp = Staircase("SP", [60.0, 57.0], at=[1000.0, 2300.0], start=56.0)
    stem = HeValve.from_bands(4.0, 1.5, 2.0, start=46.5, low=0.0, high=100.0, inputs="OP", outputs="x", name="stem")
    P = Sine("P", 0.2, 4400.0, mean=3.5)
    run = simulate(reseeded(loop(stem=stem), 7), 3600.0, every=2.0, inputs={"SP": sp, "P": P})
    rows = {s: run.log[s] for s in ("SP", "P", "OP", "PV")}
    log = Log(run.log.t, {**rows, "OP": np.round(rows["OP"], 3), "PV": np.round(rows["PV"], 3)})
    (cause,) = diagnose(loop(), log, catalogue=[effect(n) for n in ("stiction", "deadband", "valve_gain")]).causes
    assert (cause.effect, cause.place) == ("stiction", "valve")
    assert cause.parameters["S"].value == pytest.approx(4.0, rel=0.05)


def test_a_dot_in_the_name_of_a_signal_is_refused_with_what_to_write():
    with pytest.raises(
        BlockError, match=r"input 'FIC\.PV' has a dot.*call it 'FIC_PV', and say --signal FIC_PV=FIC\.PV"
    ):
        SampledPI(1.0, 9.0, dt=1.0, inputs=["FIC_SP", "FIC.PV"])
