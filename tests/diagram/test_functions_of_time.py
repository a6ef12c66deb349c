"""Users' functions of the time: no step goes over what they do, in any method, alone or in an ensemble.

Expected numbers are analytic: crossings of a sine, the lag behind a relay, the mean 2/pi of a rectified sine.
"""

import math
import os
from typing import Any

import control as ct
import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, Relay, Sine
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role
from stickslip.diagram import Diagram, drive, simulate, wire
from stickslip.diagram.ensembles import ensemble

ON = 1.0 / 12.0 + np.arange(200.0)  # sin(2 pi t) rises through 0.5, and falls through -0.5 half a period later
RELAY = Relay("on", "u", 0.5, -0.5)


def source(out: Any, **more: Any) -> Equations:
    return Equations("source", out=out, outputs=["u"], **more)


def swing(t: float) -> float:
    return math.sin(2.0 * math.pi * t)


class Swing(Block):
    """A block of the user's that says nothing of its steps."""

    role = Role.SOURCE
    ports_in = ()
    ports_out = (Port("u"),)

    def __init__(self) -> None:
        self.kernels = Kernels(out=lambda t: math.sin(2.0 * math.pi * t))
        super().__init__(name="source", params={}, states={})


def from_control() -> Any:
    return ct.nlsys(None, lambda t, x, u, params: np.sin(2 * np.pi * t), inputs=[], outputs=["u"], name="source")


def in_python(t: float) -> float:
    return math.sin(2.0 * math.pi * t) + 0.0 * os.getpid()


@pytest.mark.parametrize("block", [lambda: source(swing), lambda: source(in_python), from_control, Swing])
def test_all_crossings_of_a_sine_are_found(block: Any) -> None:
    run = simulate(wire([block(), RELAY]), 200.0)
    assert run.ok and len(run.events) == 400
    assert np.allclose([e.t for e in run.events], np.sort([*ON, *(ON + 0.5)]), atol=1e-9)
    assert "source" in run.notes[0] and "max_step" in run.notes[0]


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
def test_a_lag_behind_the_relay_follows_the_closed_form(method: str) -> None:
    run = simulate(
        wire([source(swing), RELAY, FirstOrder(K=1.0, tau=1.0, inputs="on")]), 200.0, every=0.25, method=method
    )
    t = run.log.t[:, None]
    exact = (np.exp(-np.maximum(t - ON - 0.5, 0.0)) - np.exp(-np.maximum(t - ON, 0.0))).sum(axis=1)
    assert len(run.events) == 400 and np.abs(run.log["PV"] - exact).max() < 1e-4


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
def test_a_rectified_sine_keeps_its_mean(method: str) -> None:
    total = Equations("total", der=lambda u: u, states={"x": 0.0}, inputs=["u"])
    run = simulate(wire([source(lambda t: abs(math.sin(200.0 * math.pi * t))), total]), 2.0, method=method)
    assert abs(run.log["x"][-1] - 4.0 / math.pi) < 1e-4


def test_a_rate_that_follows_the_time_is_bounded_too() -> None:
    stored = Equations("stored", der=lambda t: math.cos(2.0 * math.pi * t), states={"x": 0.0}, outputs=["x"])
    relay = Relay("on", "x", 0.5 / (2.0 * math.pi), -0.5 / (2.0 * math.pi))
    run = simulate(wire([stored, relay]), 200.0)
    assert len(run.events) == 400 and "stored" in run.notes[0]


def test_a_burst_and_a_jump_between_long_rests_are_met() -> None:
    burst = source(lambda t: math.sin(40.0 * math.pi * t) if 77.0 < t < 78.7 else 0.0)  # 34 periods
    assert len(simulate(wire([burst, RELAY]), 200.0).events) == 68
    pulse = simulate(wire([source(lambda t: 1.0 if 77.0 < t < 78.0 else -1.0), RELAY]), 200.0)
    assert np.allclose([e.t for e in pulse.events], [77.0, 78.0], atol=1e-6)
    assert pulse.statistics.steps < 2000


def test_what_is_straight_or_stands_still_costs_nothing_and_is_not_noted() -> None:
    for out in (lambda t: 2.0 * t - 7.0, lambda t: 3.0 + 0.0 * t):
        run = simulate(wire([source(out), RELAY]), 200.0)
        assert not run.notes and run.statistics.steps <= 2
    known = simulate(wire([Sine("u", amplitude=1.0, period=1.0), RELAY]), 200.0)
    assert len(known.events) == 400 and not known.notes  # a block that announces its steps


def test_the_scale_is_that_of_the_parameters_in_force() -> None:
    waves = source(lambda t, f: math.sin(2.0 * math.pi * f * t), params={"f": 0.01})
    run = simulate(wire([waves, RELAY]), 100.0, params={"source.f": 3.0})
    assert len(run.events) == 600


def test_each_variant_of_an_ensemble_is_bounded_by_its_own_parameters() -> None:
    loop = wire([source(lambda t, f: math.sin(2.0 * math.pi * f * t), params={"f": 1.0}), RELAY,
                 FirstOrder(K=1.0, tau=1.0, inputs="on")])  # fmt: skip
    some = ensemble(loop, 50.0, params={"source.f": [0.1, 1.0, 4.0]}, every=0.5)
    assert some.event_counts.tolist() == [10, 100, 400]
    assert len(some.notes) == 1 and "source" in some.notes[0]
    for i, f in enumerate([0.1, 1.0, 4.0]):
        alone = simulate(loop, 50.0, params={"source.f": f}, every=0.5)
        assert np.array_equal(alone.log["PV"], some.values["PV"][i])
    assert alone.notes == some.notes  # the shortest of all
    assert not ensemble(loop, 50.0, params={"source.f": [1.0]}, max_step=0.01, every=0.5).notes


def test_what_gives_no_numbers_at_the_start_is_guessed_and_said() -> None:
    inverse = Equations("source", out=lambda t, PV: math.sin(2.0 * math.pi * t) / (PV - 3.0) / (PV - 2.0),
                        inputs=["PV"], outputs=["u"])  # fmt: skip
    lag = Equations("lag", der=lambda PV, on: 0.01 * on, states={"PV": 4.0}, inputs=["on"])
    assert not any("guess" in note for note in simulate(wire([inverse, RELAY, lag]), 10.0).notes)
    nowhere = source(lambda t: 1.0 if t < 5.0 else math.nan)
    run = simulate(wire([nowhere, RELAY]), 10.0)
    assert not run.ok and "a guess" in run.notes[0] and "0.01 s" in run.notes[0]


def test_a_number_replaces_the_search_and_infinity_lifts_the_bound() -> None:
    loop = wire([source(swing), RELAY])
    given = simulate(loop, 200.0, max_step=0.04)
    assert len(given.events) == 400 and not given.notes and given.statistics.steps >= 5000
    assert simulate(loop, 200.0, max_step=math.inf).statistics.steps == 1
    assert len(drive(source(swing), 1.0, max_step=0.1).log.t) == 1001
    plain = Diagram([FirstOrder(K=1.0, tau=1.0)], inputs=["MV"])
    assert simulate(plain, 10.0, inputs={"MV": 1.0}, max_step=0.01).statistics.steps >= 1000  # any diagram


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan, "fast"])
def test_a_step_that_makes_no_sense_is_refused(wrong: Any) -> None:
    with pytest.raises(ValueError, match="max_step"):
        drive(source(swing), 1.0, max_step=wrong)
