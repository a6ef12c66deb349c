"""Tolerances travel with the diagram, whatever is changed in it, and change no run."""

import numpy as np
import pytest
from stickslip.blocks import PI, BlockError, FirstOrder, Gain, SampledPI, SecondOrder
from stickslip.diagram import simulate, wire
from stickslip.diagram.wiring import WiringError
from stickslip.plant.loops import self_regulating_loop

GIVEN = {"controller.K_p": 0.02, "process.K": 0.05, "process.tau": 0.1}


def loop():
    return self_regulating_loop().with_tolerances(GIVEN)


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d.insert("PV", Gain("bias", "x", 1.0)),
        lambda d: d.cut(["PV", "OP"]),
        lambda d: d.rewire("controller", "PV", "MV"),
        lambda d: d.with_params({"process.K": 4.0}),
        lambda d: d.starting_at({"process.PV": 0.5}),
        lambda d: d.in_mode("ideal"),
        lambda d: d.replace("controller", SampledPI(0.4, 10.0, dt=1.0)),
        lambda d: d.replace("process", FirstOrder(2.0, 5.0)),
        lambda d: simulate(d, 10.0).final,
        lambda d: d.without("valve"),
        lambda d: d.with_tolerances({}),
    ],
)
def test_a_change_keeps_them(change):
    assert change(loop()).tolerances == GIVEN


def test_a_nested_diagram_keeps_them():
    assert wire([loop().named("a")]).tolerances == {f"a/{key}": share for key, share in GIVEN.items()}
    assert loop().part(["process"]).tolerances == {"process.K": 0.05, "process.tau": 0.1}


def test_what_replaces_a_block_keeps_what_it_has_too_and_may_know_better():
    assert loop().replace("process", SecondOrder(3.0, 0.1, 1.0)).tolerances == {
        "controller.K_p": 0.02,
        "process.K": 0.05,
    }
    known = PI(0.4, 10.0).with_tolerances(K_p=0.001)
    assert loop().replace("controller", known).tolerances["controller.K_p"] == 0.001


def test_they_change_no_run_and_the_old_diagram_has_none():
    plain = self_regulating_loop()
    one, other = simulate(plain, 60.0, every=1.0).log, simulate(loop(), 60.0, every=1.0).log
    np.testing.assert_array_equal(one["PV"], other["PV"])
    assert plain.tolerances == {} and loop().with_tolerances(dict.fromkeys(GIVEN, 0.0)).tolerances == {}


@pytest.mark.parametrize(
    ("shares", "error", "said"),
    [
        ({"process.K": -0.1}, BlockError, "tolerance of K = -0.1, but a tolerance is a share .* give 0.05 for 5 %"),
        ({"process.K": 1.0}, BlockError, "from 0 to below 1"),
        ({"process.theta": 0.1}, BlockError, "theta = 0.0, but it has no share"),
        ({"controller.high": 0.1}, BlockError, "high = inf, but it has no share"),
        ({"process.k": 0.1}, BlockError, "no parameter 'k'"),
        ({"proces.K": 0.1}, WiringError, "no block 'proces'"),
    ],
)
def test_nonsense_is_refused(shares, error, said):
    with pytest.raises(error, match=said):
        self_regulating_loop().with_tolerances(shares)
