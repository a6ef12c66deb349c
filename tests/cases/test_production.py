"""The plant's cases: from rest, kicked, under the sine; few starts, so bands are wide."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from stickslip.blocks import CubicMap
from stickslip.cases import find, names
from stickslip.cases.choice import gain_from, scan
from stickslip.cases.kicks import SIGNALS, SIZE, Studies, case_1_numbers, rest_amplitudes, study_of
from stickslip.diagram import simulate
from stickslip.engine.status import Status
from stickslip.plant import SET_B, SET_C, SET_E, kicked, production_plant
from stickslip.study import production_subject
from stickslip.study.subject import start_kicks

J = {"normal": 500.0 / 52500.0, "high": 1000.0 / 52500.0}  # analytic: (F_s - F_c)/k
S = {"normal": 3000.0 / 52500.0, "high": 3500.0 / 52500.0}  # analytic: (F_s + F_c)/k


@pytest.fixture(scope="module")
def studies():
    return Studies("E", kicks=6)


def test_six_cases_are_registered():
    expected = {f"plant_{case}_{size}" for case in (1, 2) for size in ("none", "normal", "high")}
    assert expected <= set(names())
    assert find("plant_2_high").duration == 2000.0 and find("plant_2_high").every == 0.1  # published: section 5.1


@pytest.mark.parametrize(
    ("name", "size", "jumps"), [("plant_1_normal", "normal", 1), ("plant_1_high", "high", 1),
                                ("plant_1_high_two_jumps", "high", 2)],
)  # fmt: skip
def test_the_stem_of_a_case_jumps_once_or_twice_a_half_cycle(name, size, jumps):
    """Published: figure 5.2, a rectangle of the stickband and one jump; the variant has two."""
    log = find(name).run(method="stiff").log
    late = log.t >= 1000.0
    assert np.ptp(log["MV_VPCS1"][late]) == pytest.approx(jumps * J[size], rel=0.02)  # analytic
    assert name in names()


@pytest.mark.parametrize("size", ["none", "normal", "high"])
def test_at_rest_nothing_moves_whatever_the_stiction(size):
    log = simulate(production_plant("E", F_s=size), 2000.0, every=10.0, method="stiff").log
    for signal in ("p_1", "V_1", "p_out2", "w", "MV_VPCS1", "MV_VLCS1"):
        assert np.ptp(log[signal]) <= 1e-6 * abs(log[signal][0]), signal


def test_no_stiction_from_rest_has_no_oscillation():
    assert max(rest_amplitudes(SET_E)) < 1e-3  # published: table 5.4, amplitude 0


def test_set_c_changes_two_numbers_of_set_b():
    assert replace(SET_C, name="B", D=SET_B.D, S1=SET_B.S1) == SET_B
    assert replace(SET_C.S1, K_p_pressure=SET_B.S1.K_p_pressure) == SET_B.S1
    gains = (SET_C.S1.K_p_pressure, SET_C.S2.K_p_pressure)
    assert gains == pytest.approx((1000 * 5e-10, 1000 * 3e-10))  # published: table 5.1, misprinted


def test_set_e_changes_five_numbers_of_set_b():
    map_E = CubicMap(W_q=0.25)
    assert replace(
        SET_B, name="E", D=4.1e5, F_in=7600.0, dp_out=3.25e5,
        S1=replace(SET_B.S1, K_p_pressure=7e-7), C2=replace(SET_B.C2, map=map_E), C3=replace(SET_B.C3, map=map_E),
    ) == SET_E  # fmt: skip


def test_kicks_are_independent_bounded_and_repeatable():
    plant = production_plant("E")
    starts = start_kicks(plant["S1"].x0, 400, 3, SIZE)
    factors = (starts / plant["S1"].x0).T
    assert production_subject("E").kicked == ("S1.N_oil", "S1.N_metL", "S1.N_metG")
    assert np.abs(factors - 1.0).max() <= SIZE
    assert factors.std(axis=1) == pytest.approx(SIZE / np.sqrt(3.0), rel=0.1)  # analytic: uniform
    assert np.abs(np.corrcoef(factors) - np.eye(3)).max() < 0.2
    assert np.array_equal(start_kicks(plant["S1"].x0, 400, 3, SIZE), starts)
    assert not np.array_equal(start_kicks(plant["S1"].x0, 400, 4, SIZE), starts)


def test_many_starts_are_single_runs_from_the_same_starts():
    """The oracle draws the starts itself and simulates them one by one; every number agrees to the last bit."""
    found = study_of("A", "normal", kicks=2, seed=9003)
    plant = production_plant("A", F_s="normal")
    factors = np.random.default_rng(9003).uniform(0.97, 1.03, (2, 3))
    for i in range(2):
        start = dict(zip(("S1.N_oil", "S1.N_metL", "S1.N_metG"), plant["S1"].x0 * factors[i], strict=True))
        log = simulate(plant, 2000.0, start=start, every=0.1, signals=SIGNALS, method="stiff").log
        one = case_1_numbers(log.t, log.signals)
        assert {name: values[i] for name, values in found.numbers.items()} == pytest.approx(one, rel=0.0, nan_ok=True)


@pytest.mark.parametrize("size", ["normal", "high"])
def test_constant_feed(studies, size):
    found = studies(size, 1)
    assert found.failed == 0
    assert found.band("level A").median == pytest.approx(0.30, rel=0.15)  # published: table 5.4
    assert found.band("level A").median == pytest.approx(
        S[size] / 2.0 / 0.1, rel=0.10
    )  # analytic: S/(2 K_p), and the pressure moves it a little
    jumps = found.numbers["stem travel"] / J[size]
    assert np.abs(jumps - np.round(jumps)).max() < 0.02  # analytic: the stem stands on whole jumps
    assert set(np.round(jumps)) <= {0.0, 1.0, 2.0} and jumps.max() > 0.5


def test_a_jump_a_half_cycle_carries_the_controller_through_the_stick_band():
    run = simulate(kicked(production_plant("C", F_s="normal")), 2000.0, every=0.1, method="stiff")  # one jump
    late = run.log.t >= 1000.0
    assert np.ptp(run.log["MV_VPCS1"][late]) == pytest.approx(J["normal"], rel=0.02)
    assert np.ptp(run.log["OP_VPCS1"][late]) == pytest.approx(S["normal"], rel=0.02)
    assert 0.5 * np.ptp(run.log["p_1"][late]) / 1e5 == pytest.approx(0.26, rel=0.25)  # published: table 5.4


def test_the_sine(studies):
    """Published, in words: OP at zero about 40 % of the time, ripples with high stiction only, no flare."""
    found = {size: studies(size, 2) for size in ("none", "normal", "high")}
    for size, one in found.items():
        assert one.failed == 0 and one.band("flare").high == 0.0 and one.band("turns shut").high == 0.0
        assert 0.30 <= one.band("shut").median <= 0.45, size
        assert one.band("p lowest").median < -1.5
    assert max(found[size].band("turns open").median for size in ("none", "normal")) < 10
    assert found["high"].band("turns open").low > 15
    R = [found[size].band("pressure R").median for size in ("none", "normal", "high")]
    assert R[0] < R[1] < R[2]  # published: ordering of table 6.2


def test_set_a_holds_the_valve_at_zero_as_long_as_published():
    assert 0.30 <= study_of("A", "high", 2, kicks=2).band("shut").median <= 0.45  # published: about 40 %


def test_gain_needed_for_the_published_cycle():
    """Oracle: a triangle of error through a PI, integrated numerically, carries OP through S in half a period."""
    T, A, K_p, T_i = 40.0, 0.3e5, gain_from(2250.0, 40.0, 0.3e5), 8.0
    t = np.linspace(0.0, 0.5 * T, 20001)
    rising = -A + 2.0 * A * t / t[-1]
    push = np.trapezoid(np.abs(rising), t) / T_i  # the error has one sign while it matters
    assert K_p * (2.0 * A + push) == pytest.approx(S["high"], rel=1e-3)
    for F_s, period, amplitude in ((1750.0, 101.0, 0.26e5), (2250.0, 37.0, 0.44e5)):  # published: table 5.4
        assert gain_from(F_s, period, amplitude) == pytest.approx(SET_C.S1.K_p_pressure, rel=0.2)


def test_scan_covers_both_ways_and_skips_what_cannot_rest():
    done = []
    points = scan(kicks=1, drops=(4.1e5, 29.0e5), gains=(7e-7, 8.8e-7), progress=lambda i, n: done.append((i, n)))
    assert [(p.D, p.K_p, p.size) for p in points] == [
        (4.1e5, 7e-7, "normal"), (4.1e5, 7e-7, "high"), (4.1e5, 8.8e-7, "normal"), (4.1e5, 8.8e-7, "high"),
    ]  # fmt: skip
    assert done == [(1, 3), (2, 3), (3, 3)]


def test_numbers_of_a_case(monkeypatch):
    import stickslip.cases.production

    monkeypatch.setattr(stickslip.cases.production, "KICKS_OF_A_CASE", 2)
    found = {n.quantity: n for n in find("plant_1_none").numbers()}
    assert found["pressure amplitude, none"].published == 0.0
    assert found["pressure amplitude, none"].reproduced == pytest.approx(0.0, abs=1e-6)
    assert "kicked" in found["level amplitude, none, kicked"].note


def test_an_interrupted_study_is_no_study(monkeypatch):
    module = import_module("stickslip.study.run")
    whole = module.ensemble

    def stopped(*arguments, **options):
        result = whole(*arguments, **options)
        return replace(result, status=np.full(len(result), Status.INTERRUPTED))

    monkeypatch.setattr(module, "ensemble", stopped)
    with pytest.raises(KeyboardInterrupt):
        study_of("A", "normal", kicks=1)
