"""What a simulated record is said to be, against what its own MV-OP figure shows."""

import math
from dataclasses import replace

import numpy as np
import pytest
from stickslip.calibration import draw, simulate
from stickslip.calibration.drawing import one
from stickslip.calibration.spec import LoopSpec, Truth
from stickslip.logs import LoopRecord

CLEAN = {"noise": 0.0, "walk": 0.0, "sp_move": 0.0, "door": 0.0, "stale": 0.0, "step_pv": 0.0, "step_op": 0.0}


def clean(spec: LoopSpec, **changes: object) -> LoopSpec:
    values: dict[str, object] = {**CLEAN, "points": 50.0, "samples": 800, "span_known": True, **changes}
    return replace(spec, **values)  # type: ignore[arg-type]


def bands(loop: LoopRecord) -> tuple[float, float]:
    """Return S and J [% of OP] from the figure of MV over OP.

    A stem about to break away upwards stands (S + J)/2 below OP, downwards above it: OP - MV covers S + J.  Where it
    slips, MV jumps by J, or more by what OP moves meanwhile.
    """
    assert loop.mv is not None
    behind = loop.op - loop.mv
    jump = float(np.abs(np.diff(loop.mv)).max())
    both = float(behind.max() - behind.min())
    return both - jump, jump


@pytest.mark.parametrize("law", ["kano", "chen", "he", "stick_slip", "stribeck", "lugre"])
def test_S_and_J_are_those_of_the_MV_OP_figure(law: str) -> None:
    setting = "other_physics" if law in ("stribeck", "lugre") else "training"
    drawn = (one("cycling", (5, i), setting) for i in range(400))
    own = [spec for spec in drawn if spec.valve == law and spec.process == "integrating"][:8]  # which always cycle
    specs = [clean(spec, J=0.6 * spec.S, valve_lag=spec.natural / 300.0) for spec in own]  # it slips within a sample
    seen = [(bands(loop), truth) for loop, truth in simulate(specs, mv=True) if truth.travel > 1.2]
    assert len(seen) >= 3  # where OP went far enough for the valve to move both ways
    # analytic (definition of S and J); what OP moves between two samples blurs it
    S = np.array([found[0] / truth.S for found, truth in seen])
    J = np.array([found[1] / truth.J for found, truth in seen])
    assert np.median(S) == pytest.approx(1.0, abs=0.1)
    assert np.median(J) == pytest.approx(1.0, abs=0.2)


def test_deadband_has_no_jump_and_healthy_valves_no_band() -> None:
    drawn = [one("deadband", (6, i)) for i in range(20)]
    # a stem with mass takes its time, and a continuous controller moves OP between the samples of a valve
    deadband = [clean(spec) for spec in drawn if spec.valve != "stick_slip" and spec.controller != "pid_weighted"]
    for loop, truth in simulate(deadband, mv=True):
        assert loop.mv is not None
        assert truth.J == 0.0 and truth.process == "self_regulating"
        between = float((loop.op - loop.mv).max() - (loop.op - loop.mv).min())
        assert between <= truth.S + 1e-9  # analytic: the figure is a band of width S
        slack = np.abs(np.diff(loop.mv)).max() - np.abs(np.diff(loop.op)).max()
        assert slack <= 1e-9  # MV never moves more than OP
    for (loop, truth), spec in zip(
        simulate(healthy := [clean(one("external_sine", (7, i))) for i in range(8)], mv=True), healthy, strict=True
    ):
        assert loop.mv is not None
        assert math.isnan(truth.S) and math.isnan(truth.J) and math.isnan(truth.travel)
        if spec.valve != "stick_slip" and spec.controller != "pid_weighted":
            assert loop.mv.tolist() == loop.op.tolist()


def test_travel_and_range_are_those_of_the_record() -> None:
    for loop, truth in simulate([clean(one("excited", (8, i))) for i in range(8)]):
        whole = float(loop.op.max() - loop.op.min())
        assert truth.op_range <= whole and truth.op_range == pytest.approx(whole, rel=0.25)
        assert truth.travel == pytest.approx(truth.op_range / truth.S, rel=1e-12)


def test_a_driven_loop_swings_as_far_and_as_fast_as_asked() -> None:
    specs = [clean(one("external_sine", (9, i))) for i in range(30)]
    found = simulate(specs)
    swing = [truth.op_range / spec.swing for spec, (_, truth) in zip(specs, found, strict=True)]
    points = [truth.period / spec.dt / spec.points for spec, (_, truth) in zip(specs, found, strict=True)]
    assert np.median(swing) == pytest.approx(1.0, abs=0.03) and np.mean(np.abs(np.array(swing) - 1.0) < 0.1) >= 0.8
    assert np.median(points) == pytest.approx(1.0, abs=0.03)


def lag(loop: LoopRecord) -> float:
    """Return by how many degrees PV and OP are apart at the strongest frequency, 0 (alike or opposite) to 90."""
    pv, op = (np.fft.rfft((x - x.mean()) * np.hanning(len(x))) for x in (loop.pv, loop.op))
    k = int(np.argmax(np.abs(op[2:]))) + 2
    turned = abs(math.degrees(np.angle(pv[k] * np.conj(op[k]))))
    return min(turned, 180.0 - turned)


def test_external_oscillations_have_lags_of_60_to_120_degrees_among_them() -> None:
    found = [lag(loop) for loop, _ in simulate([clean(one("external_sine", (10, i))) for i in range(40)])]
    assert sum(degrees >= 60.0 for degrees in found) >= 5  # 60 to 120 degrees, folded about 90
    assert sum(degrees < 60.0 for degrees in found) >= 5


def test_a_dead_loop_does_not_answer_its_valve() -> None:
    spec = clean(one("dead_loop", (11, 0)))
    other = replace(spec, K_p=0.5 * spec.K_p)
    (a, truth), (b, _) = simulate([spec, other])
    ratio = np.corrcoef(a.pv, b.pv)[0, 1]
    assert truth.cause == "dead_loop" and ratio == pytest.approx(1.0, abs=1e-6)  # PV comes from outside alone


def test_a_saturated_loop_stands_at_its_limit() -> None:
    found = simulate([clean(one("saturation", (12, i))) for i in range(12)])
    at = [np.mean((loop.op <= 1e-9) | (loop.op >= 100.0 - 1e-9)) for loop, _ in found]
    assert np.median(at) > 0.1


def test_causes_are_spread_as_asked() -> None:
    specs = draw(2600, seed=13)
    sticky = [spec for spec in specs if spec.cause == "stiction"]
    assert len(sticky) == 1300
    assert np.mean([spec.group == "excited" for spec in sticky]) == pytest.approx(0.2, abs=0.001)
    assert all(2.0 <= spec.S <= 15.0 and 0.3 <= spec.J / spec.S <= 1.0 for spec in sticky)
    counts = {group: sum(spec.group == group for spec in specs) for group in {s.group for s in specs} - {"cycling"}}
    counts.pop("excited")
    assert set(counts.values()) == {100}
    assert np.mean([spec.process == "integrating" for spec in sticky]) == pytest.approx(0.25, abs=0.04)


def test_most_of_the_cycling_group_cycles_without_noise() -> None:
    found: list[Truth] = [truth for _, truth in simulate([clean(one("cycling", (14, i))) for i in range(40)])]
    assert np.mean([truth.cycling for truth in found]) > 0.7
