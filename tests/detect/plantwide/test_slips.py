"""Slips of a valve in another tag: found with their size where there are any, and called nowhere else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.detect.plantwide.slips import Jumps, Slips, jumps_of, larger, owners, slips_of
from stickslip.detect.plantwide.survey import survey
from stickslip.detect.stem.stick import stick
from stickslip.logs import Log, LoopSignals

T = np.arange(3000.0)


def walk(seed: int) -> np.ndarray:
    """OP that turns at no even beat [% of span]: about 10 % of travel, 0.1 % a sample."""
    r = np.random.default_rng(seed)
    waves = zip((4, 2, 1), r.uniform(150, 500, 3), r.uniform(0, 6, 3), strict=True)
    return 50 + sum(size * np.sin(2 * np.pi * T / period + phase) for size, period, phase in waves)


def seen(u, y):
    return slips_of(u, y, jumps_of(y), "FI1")


@given(st.integers(0, 200), st.floats(2.0, 5.0), st.floats(0.25, 0.6), st.sampled_from([-3.0, 0.02]))
@settings(max_examples=25, deadline=None)
def test_S_of_a_slipping_stem_is_read_off_the_flow_behind_it(seed, S, share, gain):
    """Analytic: the flow is a straight line of the stem, beside a pressure that wanders and a little noise."""
    u = walk(seed)
    flow = gain * (
        stick(u, S, share * S) + 0.5 * np.sin(T / 200) + 0.002 * np.random.default_rng(seed).normal(size=3000)
    )
    found = seen(u, flow)
    if found is not None:  # OP may turn too seldom
        assert pytest.approx(S, rel=0.1) == found.S and found.low <= found.S <= found.high
    assert found is not None or np.ptp(u) < 2.5 * S or len(jumps_of(flow).at) < 6


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("S", [0.0, 2.0, 4.0])
def test_a_valve_with_a_deadband_alone_does_not_slip(seed, S):
    u = walk(seed)
    assert seen(u, stick(u, S, 0.0) + 0.5 * np.sin(T / 200)) is None


@pytest.mark.parametrize("period", [150, 400])
@pytest.mark.parametrize("gain", [0.5, 2.0])
def test_a_square_wave_from_outside_that_integral_action_takes_back_is_no_slip(period, gain):
    """A flow that something outside steps up and down, and a valve that answers: regular, but it follows OP."""
    outside = np.where(T % period < period / 2, 1.0, -1.0)
    u, y = np.zeros(3000), np.zeros(3000)
    for k in range(1, 3000):
        u[k] = u[k - 1] - 0.1 * y[k - 1] / gain  # integral action on the flow
        y[k] = gain * u[k] + outside[k]
    u = 50 + 8 * u / np.ptp(u)
    assert len(jumps_of(y).at) > 6 and seen(u, y) is None


@pytest.mark.parametrize("seed", range(20))
def test_noise_steps_of_rounding_and_steps_at_any_time_are_no_slips(seed):
    r = np.random.default_rng(seed)
    u = walk(seed)
    steps = np.cumsum((r.random(3000) < 0.01) * r.normal(size=3000))
    for y in (
        r.normal(size=3000),
        np.round(u),
        np.round(np.cumsum(r.normal(size=3000)), -1),
        steps,
        np.full(3000, 7.0),
    ):
        assert seen(u, y) is None


def lines(*turns: float) -> np.ndarray:
    """OP in straight lines between its turns, from the first to the last, 100 samples each."""
    return np.interp(np.arange(100.0 * (len(turns) - 1)), 100.0 * np.arange(len(turns)), turns)


@pytest.mark.parametrize("middle", [0.0, 6.0])
def test_a_stem_that_only_slips_to_and_fro_is_told_wherever_it_starts(middle):
    """S = 4, J = 1 (analytic): OP travels by 4.4, less than S + J: a stem in the middle of its band never slips."""
    u = middle + lines(*np.tile([-2.2, 2.2], 9))
    found = seen(u, stick(u, 4.0, 1.0, start=1.0))
    assert found is not None and pytest.approx(4.0, rel=0.02) == found.S


def test_S_is_read_from_where_OP_first_turned_back_if_the_stem_stood_since():
    """S = 4, J = 1.5 (analytic). OP turns back by 0.5 and comes again by less than 0.5 + J: the stem stands."""
    tops = [turn for more in (0.2, 1.2, 0.6, 1.0, 0.3, 1.3, 0.8) for turn in (3.0, 2.5, 3.0 + more, -4.0)]
    u = lines(-4.0, *tops)
    found = seen(u, stick(u, 4.0, 1.5))
    assert found is not None and pytest.approx(4.0, rel=0.02) == found.S


def test_smaller_jumps_of_another_source_do_not_hide_the_slips():
    """Steps of 0.4 J from outside, as often with OP as against it; S = 4 (analytic)."""
    u = walk(3)
    steps = np.random.default_rng(3).permutation(np.repeat([0.6, -0.6], 24))
    outside = np.zeros(3000)
    outside[60::60] = np.append(steps, 0.6)
    y = stick(u, 4.0, 1.5) + np.cumsum(outside)
    assert seen(u, y) is None
    found = slips_of(u, y, larger(jumps_of(y)), "FI1")
    assert found is not None and pytest.approx(4.0, rel=0.03) == found.S


@given(st.integers(0, 50), st.floats(0.01, 100.0), st.floats(-1e3, 1e3))
@settings(max_examples=20, deadline=None)
def test_the_unit_of_the_tag_does_not_matter(seed, scale, offset):
    u = walk(seed)
    flow = stick(u, 4.0, 1.5) + 0.3 * np.sin(T / 150)
    one, other = seen(u, flow), seen(u, offset - scale * flow)
    assert (one is None) == (other is None)
    if one is not None:
        assert pytest.approx(one.S, rel=1e-6) == other.S and other.reversals == one.reversals


def test_a_jump_has_one_source():
    best, other, third = (Slips(4.0, 3.9, 4.1, tag, 9, r) for tag, r in (("A", 0.9), ("B", 0.6), ("C", 0.5)))
    at = np.arange(0, 900, 90)
    jumps = {"A": Jumps(at, np.ones(10)), "B": Jumps(at + 1, np.ones(10)), "C": Jumps(at + 40, np.ones(10))}
    assert owners({"X": {"A": best}, "Y": {"B": other}, "Z": {"C": third}}, jumps) == {"X": best, "Z": third}


def two_loops(slip: float) -> Log:
    u, v = walk(3), walk(4)
    f = 2 * stick(u, 4.0, slip) + 0.3 * np.sin(T / 99)
    return Log(
        T, {"u": u, "p": np.cos(T / 90), "v": v, "q": np.sin(T / 70), "f": f},
        spans={"u": (0, 100), "v": (0, 100)}, loops={"PC1": LoopSignals("p", "u"), "FC2": LoopSignals("q", "v")},
    )  # fmt: skip


def test_the_survey_calls_the_loop_whose_valve_slips():
    first, other = survey(two_loops(1.5)).suspects
    assert (first.loop, first.suspected, first.slips.tag) == ("PC1", True, "f")
    assert pytest.approx(4.0, rel=0.02) == first.slips.S  # analytic
    assert "f jumps when OP has come back by 4 %" in first.reason
    assert not other.suspected and other.slips is None


@pytest.mark.parametrize(
    "own, suspected", [("inconclusive", True), ("not_applicable", True), ("stiction", True), ("no_stiction", False)]
)
def test_what_other_tags_show_makes_a_suspect_and_no_verdict(own, suspected):
    found = {s.loop: s for s in survey(two_loops(1.5), {"PC1": own}).suspects}
    assert found["PC1"].suspected == suspected and found["PC1"].verdict == own


def test_a_deadband_is_not_called_by_the_survey():
    assert all(suspect.slips is None for suspect in survey(two_loops(0.0)).suspects)


@pytest.mark.parametrize("size, S", [("high", 6.67), ("none", None)])
def test_valves_of_the_production_plant_under_slugs(size, S):
    """S = (F_s + F_c) / k of the stem, analytic; the stems are not logged."""
    from benchmarks.thesis_cases import logs_of, without_stems

    log = without_stems(next(logs_of("slugs", size, 1)))
    slips = {suspect.loop: suspect.slips for suspect in survey(log).suspects if suspect.slips is not None}
    assert set(slips) == (set() if S is None else {"LCS11", "PCS11"})
    for loop, one in slips.items():
        assert pytest.approx(S, rel=0.08) == one.S, loop
