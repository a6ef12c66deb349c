"""A run begins with the modes that the inputs call for: nothing that samples, latches or limits rates sees others."""

import pytest

import blocks
from diagram import simulate, wire
from diagram.reference import simulate_reference

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


@pytest.mark.parametrize("run", [simulate, simulate_reference])
def test_a_massless_stem_that_slips_at_the_start_still_feels_its_op_turn(run):
    # analytic: f_s = 0.04, f_c = 0.02; it slips to 0.35 at once, which a sample of that instant sees; OP turns at 0.777
    stem = blocks.QuasiStaticStem(0.06, 0.02, inputs="OP", outputs="MV")
    loop = wire([blocks.Sine("OP", 0.407, 8.0, mean=0.37), stem, blocks.ZeroOrderHold("y", "MV", 10.0)])
    log = run(loop, 2.5, times=[0.0, 1.0, 2.5]).log
    assert log["MV"] == pytest.approx([0.35, 0.35 + 0.407 * 0.5**0.5, 0.757], abs=1e-6)
    assert log["y"] == pytest.approx([0.35] * 3)
