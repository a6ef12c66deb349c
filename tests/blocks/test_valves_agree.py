"""The sticky valves against one another: where their definitions coincide, and where two of them must differ."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.block import Block
from stickslip.blocks.chen_valve import ChenValve
from stickslip.blocks.choudhury_valve import ChoudhuryValve
from stickslip.blocks.he_valve import HeValve
from stickslip.blocks.kano_valve import KanoValve
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.stenman_valve import StenmanValve
from stickslip.blocks.stick_slip import StickSlip
from stickslip.diagram import drive

PERCENT = {"low": 0.0, "high": 100.0}
TWO_BANDS = (KanoValve, ChoudhuryValve, ChenValve, HeValve.from_bands)


def sampled(valve: Block, op):
    """Feed samples one by one to the interpreted kernel, as python-control would."""
    memory, mv = valve.d0, []
    for u in op:
        mv.append(float(valve.output(0.0, memory, [u])[0]))
        memory = valve.dynamics(0.0, memory, [u])
    return np.array(mv)


def triangle(cycles, low, high, step):
    up = np.arange(low, high, step)
    return np.concatenate([np.concatenate([up, high - (up - low)]) for _ in range(cycles)] + [[low]])


@pytest.mark.parametrize("step", [0.08, 0.3, 1.1])
@pytest.mark.parametrize(("S", "J"), [(6.0, 2.0), (6.0, 0.0), (6.0, 6.0), (3.1, 1.7)])
def test_kano_choudhury_and_chen_agree_on_triangles(S, J, step):
    op = triangle(3, 20.0, 20.0 + 80 * step, step) + 0.013
    kano, choudhury, chen = (sampled(valve(S, J, 1.0, start=50.0, **PERCENT), op) for valve in TWO_BANDS[:3])
    later = slice(len(op) // 3, None)
    np.testing.assert_allclose(choudhury[later], kano[later], atol=1e-9)  # published: equal after the first cycle
    np.testing.assert_allclose(chen[later], kano[later], atol=1e-9)


def test_triangle_jumps_by_J_and_one_step():
    # published (design facts): S = 6, J = 2, jump 2.08 with a step of 0.08, OP - MV within +-4 = (S + J)/2
    op = triangle(3, 30.0, 60.0, 0.08) + 0.013
    for valve in TWO_BANDS[:3]:
        mv = sampled(valve(6.0, 2.0, 1.0, start=50.0, **PERCENT), op)
        moves = np.abs(np.diff(mv))[len(op) // 3 :]
        assert 2.0 < moves.max() <= 2.08 + 1e-9
        assert np.sum(moves > 1.0) == 4  # one jump per half cycle
        assert np.abs(op - mv)[len(op) // 3 :].max() == pytest.approx(4.0, abs=0.081)


def test_all_agree_with_the_physical_stem_on_triangles():
    step, S, J = 0.01, 0.06, 0.02
    corners = ([0.0, 40.0, 120.0, 200.0, 240.0], [0.5, 0.7, 0.3, 0.7, 0.5])
    mass = StickSlip.from_bands(S, J, start=0.5)
    runs = {
        "mass": drive(mass, 240.0, every=0.5, OP=corners),
        "massless": drive(QuasiStaticStem(S, J, start=0.5), 240.0, every=0.5, OP=corners),
    }
    for valve in TWO_BANDS[:3]:
        runs[valve.__name__] = drive(valve(S, J, 0.5, start=0.5), 240.0, every=0.5, OP=corners)
    reference = runs["massless"].log["MV"]
    for name, run in runs.items():
        assert run.ok
        apart = np.abs(run.log["MV"] - reference)
        assert np.sum(apart > 1e-3) <= 3, name  # at most the sample of each jump
        assert apart.max() <= J + step, name


@settings(max_examples=50)
@given(st.lists(st.floats(0.01, 0.99), min_size=1, max_size=60))
def test_zero_bands_pass_op_unchanged(op):
    for valve in TWO_BANDS:
        np.testing.assert_allclose(sampled(valve(0.0, 0.0, 1.0), op), op, atol=1e-15)  # analytic: identity
    np.testing.assert_allclose(sampled(StenmanValve(0.0, 1.0), op), op, atol=0)


@settings(max_examples=50)
@given(
    op=st.lists(st.floats(-0.2, 1.2), min_size=1, max_size=60),
    S=st.floats(0.0, 0.3),
    share=st.floats(0.0, 1.0),
)
def test_any_walk_keeps_the_laws(op, S, share):
    J = share * S
    for valve in TWO_BANDS:
        mv = sampled(valve(S, J, 1.0), op)
        held = np.clip(op, 0.0, 1.0)
        assert np.all(np.diff(mv)[np.diff(held) == 0.0] == 0.0)  # analytic: it moves only when OP does
        assert np.all(mv[held == 1.0] == 1.0) and np.all(mv[held == 0.0] == 0.0)  # the stops
        if valve is not ChoudhuryValve:  # whose S begins anew at every turn of OP
            assert np.all(np.abs(held - mv) <= (S + J) / 2 + 1e-12)  # analytic: no larger force exists
    np.testing.assert_allclose(
        sampled(StenmanValve(S, 1.0), op), sampled(HeValve(S, 0.0, 1.0), op), atol=1e-15
    )  # analytic: He without kinetic friction is Stenman


@pytest.mark.parametrize("valve", TWO_BANDS)
def test_small_sine_never_moves_it(valve):
    op = 50.0 + 0.499 * 6.0 * np.sin(np.arange(500) * 0.1)
    assert np.all(sampled(valve(6.0, 2.0, 1.0, start=50.0, **PERCENT), op) == 50.0)  # published acceptance test


@pytest.mark.parametrize("valve", TWO_BANDS)
def test_staircases(valve):
    S, J = 6.0, 2.0
    first = [50.0, 55.0]  # 5 > (S + J)/2: moves to 55 - 2 = 53
    small = [55.0 + 0.9 * k for k in (1, 2, 3)] + [57.7]  # J frees a stuck stem; He's needs f_s - f_d = J as well
    large = [60.5, 63.5]  # steps > J: it follows each
    back = [63.5 - 5.9, 63.5 - 6.1]  # S frees it after a reversal
    mv = sampled(valve(S, J, 1.0, start=50.0, **PERCENT), [*first, 55.0, *small, *large, *back])
    kinetic = (S - J) / 2
    #        moved  held  0.9   1.8   2.7 > J: moves       held
    expected = [50.0, 53.0, 53.0, 53.0, 53.0, 57.7 - kinetic, 57.7 - kinetic, 58.5, 61.5, 61.5, 57.4 + kinetic]
    np.testing.assert_allclose(mv, expected, atol=1e-9)  # analytic: the definitions, by hand


def test_sampled_valves_run_compiled_as_interpreted():
    rng = np.random.default_rng(7)
    op = np.clip(0.5 + np.cumsum(rng.normal(0.0, 0.03, 300)), -0.1, 1.1)
    valves = [valve(0.06, 0.02, 1.0, start=0.5) for valve in TWO_BANDS] + [StenmanValve(0.04, 1.0, start=0.5)]
    for valve in valves:
        compiled = drive(valve, 299.0, every=1.0, OP=(np.arange(300.0), op)).log["MV"]
        np.testing.assert_array_equal(compiled, sampled(valve, op))


def test_python_control_sees_an_ideal_valve_with_the_same_labels():
    for valve in TWO_BANDS:
        smooth = valve(0.06, 0.02, 1.0, name="VLCS1", inputs="OP1", outputs="x1", units={"MV": "%"}).smooth()
        assert (smooth.name, list(smooth.input_labels), list(smooth.output_labels)) == ("VLCS1", ["OP1"], ["x1"])
        assert smooth.units["MV"] == "%" and not smooth.sampled
        assert float(smooth.output(0.0, [], [0.3])[0]) == 0.3
