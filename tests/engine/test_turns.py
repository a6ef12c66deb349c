"""Nothing that samples, latches or limits rates sees a mode that the inputs do not call for, at any instant."""

import math

import numpy as np
import pytest
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference
from stickslip.engine.turns import turns

from stickslip import blocks

SWITCHING = {  # behind a = 5, b = 1: the block, and its output (analytic); as built it gives another
    "min": (lambda: blocks.MinSelect("m", ["a", "b"]), 1.0),
    "max": (lambda: blocks.MaxSelect("m", ["b", "a"]), 5.0),
    "dead_zone": (lambda: blocks.DeadZone("m", "a", -1.0, 2.0), 3.0),
    "lookup": (lambda: blocks.Lookup1D("m", "a", [0.0, 1.0, 4.0, 6.0], [0.0, 9.0, 3.0, 1.0]), 2.0),
    "quantiser": (lambda: blocks.Quantiser("m", "a", 2.0), 6.0),
    "switch": (lambda: blocks.Switch("m", "a", above="b", below="a_2", switch_on=2.0), 1.0),
    "relay": (lambda: blocks.Relay("m", "a", 2.0, high=1.0, low=9.0), 1.0),
}
TAKING = {  # what is behind it, and its output at 0 and 1 s if it has seen nothing but the constant v
    "hold": (lambda: blocks.ZeroOrderHold("y", "m", 0.5), lambda v: (v, v)),
    "filter": (lambda: blocks.SampledFilter("y", "m", 2.0, 0.5), None),
    "biquad": (lambda: blocks.Biquad("y", "m", [0.5, 0.5, 0.0], [0.0, 0.0], 0.5), None),
    "delay": (lambda: blocks.VariableDelay("y", "m", "b", dt=0.5, longest=3.0), None),
    "rates": (lambda: blocks.RateLimiter("y", "m", 0.1), lambda v: (v, v)),
    "latch": (lambda: blocks.Relay("y", "m", 4.0, -99.0), lambda v: (float(v > 4.0), float(v > 4.0))),
    "chain": (lambda: blocks.Relay("y", "m", 1.5, -99.0), lambda v: (float(v > 1.5), float(v > 1.5))),
    "reset": (
        lambda: blocks.ResetIntegrator("y", "b", "m", threshold=1.5, to=-7.0),
        lambda v: (-7.0, -6.0) if v > 1.5 else (0.0, 1.0),
    ),
}


def sources():
    a, b = blocks.Constant("a", 5.0), blocks.Constant("b", 1.0)
    return [a, b, blocks.Gain("a_2", "a", 1.0), blocks.Gain("b_2", "b", 1.0)]  # all sources are read


@pytest.mark.parametrize("run", [simulate, simulate_reference])
@pytest.mark.parametrize("taking", TAKING)
@pytest.mark.parametrize("switching", SWITCHING)
def test_what_follows_sees_the_mode_that_the_inputs_call_for(switching, taking, run):
    make, value = SWITCHING[switching]
    behind, expected = TAKING[taking]
    found = run(wire([*sources(), make(), behind()]), 1.0, times=[0.0, 1.0]).log
    assert found["m"] == pytest.approx([value, value])
    if expected is None:  # the same behind a constant: analytic in that nothing switches there
        alone = wire([*sources(), blocks.Constant("m", value), behind()])
        want = simulate(alone, 1.0, times=[0.0, 1.0]).log["y"].tolist()
    else:
        want = list(expected(value))
    assert found["y"] == pytest.approx(want, abs=1e-9)


BEFORE = {  # where a = 0
    "min": 0.0, "max": 1.0, "dead_zone": 0.0, "lookup": 0.0, "quantiser": 0.0, "switch": 0.0, "relay": 9.0,
}  # fmt: skip


def expected_later(taking, old, new):
    """Return the output at 1 and 2 s of what is behind a signal that is ``old`` until 1 s, then ``new`` (analytic)."""
    if taking == "hold":
        return [new, new]
    if taking == "filter":  # samples at 0 and 0.5 s, then at 1, 1.5 and 2 s
        left, here = math.exp(-0.5 / 2.0), 0.0
        found = []
        for u in (old, old, new, new, new):
            here = left * here + (1.0 - left) * u
            found.append(here)
        return [found[2], found[4]]
    if taking == "biquad":
        return [0.5 * (old + new), new]
    if taking == "delay":
        return [old, new]
    if taking == "rates":
        return [old, old + 0.1 * np.sign(new - old)]
    if taking in ("latch", "chain"):
        return [float(max(old, new) > (4.0 if taking == "latch" else 1.5))] * 2
    return [-6.0, -5.0] if old > 1.5 else [-7.0, -6.0] if new > 1.5 else [1.0, 2.0]


@pytest.mark.parametrize("run", [simulate, simulate_reference])
@pytest.mark.parametrize("taking", TAKING)
@pytest.mark.parametrize("switching", SWITCHING)
def test_what_follows_sees_the_new_mode_where_a_step_meets_a_sample(switching, taking, run):
    make, new = SWITCHING[switching]
    step = [blocks.Step("a", 5.0, at=1.0), *sources()[1:]]
    found = run(wire([*step, make(), TAKING[taking][0]()]), 2.0, times=[0.75, 1.0, 2.0]).log
    assert found["m"] == pytest.approx([BEFORE[switching], new, new])
    assert found["y"][1:] == pytest.approx(expected_later(taking, BEFORE[switching], new), abs=1e-6)


@pytest.mark.parametrize("run", [simulate, simulate_reference])
@pytest.mark.parametrize("taking", ["rates", "latch", "chain", "reset"])
@pytest.mark.parametrize("switching", ["min", "max", "dead_zone", "lookup", "quantiser", "switch"])
def test_what_latches_sees_the_new_mode_where_a_relay_lets_its_input_jump(switching, taking, run):
    # a jumps where a ramp passes 1, which no clock announces
    make, new = SWITCHING[switching]
    relay = [blocks.Ramp("r", 1.0), blocks.Relay("a", "r", 1.0, -99.0, high=5.0), *sources()[1:]]
    found = run(wire([*relay, make(), TAKING[taking][0]()]), 2.0, times=[0.75, 1.0 + 1e-9, 2.0]).log
    assert found["m"] == pytest.approx([BEFORE[switching], new, new])
    assert found["y"][1:] == pytest.approx(expected_later(taking, BEFORE[switching], new), abs=1e-6)


@pytest.mark.parametrize("run", [simulate, simulate_reference])
@pytest.mark.parametrize(
    ("block", "behind"),
    [
        (lambda: blocks.QuasiStaticStem(0.06, 0.02, inputs="OP", outputs="MV"), 0.02),
        (lambda: blocks.Deadband(0.06, inputs="OP", outputs="MV"), 0.03),
        (lambda: blocks.RateLimiter("MV", "OP", 0.2), 0.0),
    ],
)
def test_a_hand_over_without_a_jump_is_none_for_what_looks_at_slopes(block, behind, run):
    # analytic: the lower signal jumps away and the other one takes over where it was, so OP = 0.2 + 0.1 t all the time
    up = blocks.Recorded("a", [0.0, 2.0, 4.0], [0.2, 0.4, 0.6])
    away, back = blocks.Step("j", 0.03, at=2.0), blocks.Step("k", 0.0, before=0.03, at=2.0)
    made = [up, away, back, blocks.Sum("p", {"a": 1.0, "j": -1.0}), blocks.Sum("q", {"a": 1.0, "k": -1.0})]
    log = run(wire([*made, blocks.MaxSelect("OP", ["p", "q"]), block()]), 4.0, times=[1.9, 2.0, 2.1, 4.0]).log
    assert log["OP"] == pytest.approx([0.39, 0.4, 0.41, 0.6])
    assert log["MV"] == pytest.approx(log["OP"] - behind, abs=1e-6)


@pytest.mark.parametrize("run", [simulate, simulate_reference])
def test_a_sample_sees_a_massless_stem_that_slips_at_that_instant(run):
    # analytic: f_s = 0.04, f_c = 0.02: OP steps to 0.5 at 1 s, the stem slips to 0.48, and that is what is held
    stem = blocks.QuasiStaticStem(0.06, 0.02, inputs="OP", outputs="MV")
    loop = wire([blocks.Step("OP", 0.5, at=1.0), stem, blocks.ZeroOrderHold("y", "MV", 0.5)])
    log = run(loop, 1.25, times=[0.75, 1.0, 1.25]).log
    assert log["MV"] == pytest.approx([0.0, 0.48, 0.48]) and log["y"] == pytest.approx([0.0, 0.48, 0.48])


@pytest.mark.parametrize("run", [simulate, simulate_reference])
def test_a_ring_of_a_ramp_and_a_relay_swings(run):
    # analytic: the ramp goes on at 1/s until the relay turns it at 0.5 and at -0.5: period 2 s, each turn an event
    ring = [blocks.RateLimiter("y", "way", 1.0, start=0.0), blocks.Relay("off", "y", 0.5, -0.5, high=-9.0, low=9.0),
            blocks.Gain("way", "off", 1.0)]  # fmt: skip
    log = run(wire(ring), 5.0, times=[0.25, 1.0, 1.5, 2.0, 3.25]).log
    assert log["y"] == pytest.approx([0.25, 0.0, -0.5, 0.0, -0.25], abs=1e-5)


def test_nothing_takes_turns_but_samples_where_nothing_switches_before_them():
    def taking(*made):
        flat = wire(list(made)).plan().flat
        return [flat[i].name for i in turns(flat)]

    loop = [blocks.Step("SP", 0.5), blocks.PI(0.4, 10.0), blocks.StickSlip(), blocks.FirstOrder(3.0, 10.0)]
    assert taking(*loop) == []  # a limit of PI shows in no output but by its inputs
    held = [blocks.ZeroOrderHold("OP", "o", 0.5), *loop[2:]]
    assert taking(loop[0], blocks.PI(0.4, 10.0, outputs="o"), *held) == ["OP"]
    selected = [blocks.PI(0.4, 10.0, outputs="p"), blocks.MinSelect("o", ["p", "SP"])]
    assert {"o", "OP"} <= set(taking(loop[0], *selected, *held))


@pytest.mark.parametrize("run", [simulate, simulate_reference])
@pytest.mark.parametrize("turned", [False, True])
def test_a_chain_of_switches_and_latches_settles_from_its_source_on(run, turned):
    # analytic: min(5, 1) = 1 leaves the first latch off, so the switch gives b = 1 and the second latch stays off
    chain = [
        blocks.MinSelect("m", ["a", "b"]), blocks.Relay("r", "m", 3.0, -1.0),
        blocks.Switch("s", "r", above="a", below="b"), blocks.Relay("last", "s", 3.0, -1.0),
        blocks.ZeroOrderHold("z", "last", 1.0),
    ]  # fmt: skip
    log = run(wire([*sources(), *(chain[::-1] if turned else chain)]), 1.0, times=[0.0, 1.0]).log
    assert [log[s].tolist() for s in ("m", "r", "s", "last", "z")] == [[1.0] * 2, [0.0] * 2, [1.0] * 2, [0.0] * 2,
                                                                      [0.0] * 2]  # fmt: skip


def test_a_run_that_goes_on_stays_where_it_is():
    loop = wire([*sources(), blocks.MinSelect("m", ["a", "b"]), blocks.Relay("r", "m", 3.0, -1.0)])
    half = simulate(loop, 1.0, times=[1.0])
    rest = simulate(half.final, 1.0, t0=1.0, times=[1.0, 2.0])
    assert rest.log["r"].tolist() == [0.0, 0.0] and not rest.events


def test_a_block_in_python_samples_the_mode_that_is_right():
    seen = blocks.SampledFunction("f", lambda m: m, dt=0.5, inputs="m", outputs="y")
    log = simulate(wire([*sources(), blocks.MinSelect("m", ["a", "b"]), seen]), 1.0, times=[0.0, 1.0]).log
    assert log["y"].tolist() == [1.0, 1.0]
    step = [blocks.Step("a", 5.0, at=0.5), *sources()[1:]]
    log = simulate(wire([*step, blocks.MinSelect("m", ["a", "b"]), seen]), 1.0, times=[0.0, 0.5]).log
    assert log["y"].tolist() == [0.0, 1.0]


@pytest.mark.parametrize("run", [simulate, simulate_reference])
def test_a_massless_stem_that_slips_at_the_start_still_feels_its_op_turn(run):
    # analytic: f_s = 0.04, f_c = 0.02; it slips to 0.35 at once, which a sample of that instant sees; OP turns at 0.777
    stem = blocks.QuasiStaticStem(0.06, 0.02, inputs="OP", outputs="MV")
    loop = wire([blocks.Sine("OP", 0.407, 8.0, mean=0.37), stem, blocks.ZeroOrderHold("y", "MV", 10.0)])
    log = run(loop, 2.5, times=[0.0, 1.0, 2.5]).log
    assert log["MV"] == pytest.approx([0.35, 0.35 + 0.407 * 0.5**0.5, 0.757], abs=1e-6)
    assert log["y"] == pytest.approx([0.35] * 3)
