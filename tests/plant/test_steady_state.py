"""Where the plant rests: the numbers of the notes, the balances, and feeds it cannot take."""

from itertools import pairwise

import numpy as np
import pytest
from stickslip.plant import SET_A, SET_B, SETS, InfeasibleFeed, steady_state
from stickslip.plant.parameters import Fluids
from stickslip.plant.rest import designed, separator_rest

# Published beside the plant's description (notes 1.8), from a program of its own.
COMMON = {
    "z_1": (0.11831, 5e-6), "F_G1": (2283.7, 0.06), "F_L1": (5716.3, 0.06), "z_2": (0.046799, 1e-6),
    "F_G2": (428.8, 0.06), "F_L2": (5287.4, 0.06), "VLCS1": (0.6985, 6e-5), "VLCS2": (0.5798, 6e-5),
    "VPCS2": (0.9, 1e-12), "m_3": (10.51, 0.006), "m_2": (47.05, 0.006), "p_in3": (11.743e5, 60.0),
    "p_out2": (75.0e5, 600.0), "q_3": (0.719, 6e-4),
}  # fmt: skip
OF_SET = {
    "A": {"VPCS1": (0.1076, 6e-5), "p_out3": (24.20e5, 600.0), "p_in2": (23.90e5, 600.0), "q_2": (0.769, 6e-4),
          "power": (13.44e6, 6e3), "tau_d": (13510.0, 1.0), "h_d2": (197640.0, 6.0), "h_d3": (112660.0, 6.0)},
    "B": {"VPCS1": (0.0944, 6e-5), "p_out3": (22.40e5, 600.0), "p_in2": (22.10e5, 600.0), "q_2": (0.832, 6e-4),
          "power": (15.55e6, 6e3), "tau_d": (15635.0, 1.0), "h_d2": (235590.0, 6.0), "h_d3": (99690.0, 6.0)},
}  # fmt: skip


def numbers(rest):
    return {
        "z_1": rest.S1.z, "F_G1": rest.S1.F_G, "F_L1": rest.S1.F_L, "z_2": rest.S2.z, "F_G2": rest.S2.F_G,
        "F_L2": rest.S2.F_L, "VLCS1": rest.VLCS1, "VLCS2": rest.VLCS2, "VPCS1": rest.VPCS1, "VPCS2": rest.VPCS2,
        "m_3": rest.C3.m, "m_2": rest.C2.m, "p_in3": rest.C3.p_in, "p_out3": rest.C3.p_out, "p_in2": rest.C2.p_in,
        "p_out2": rest.C2.p_out, "q_2": rest.C2.q, "q_3": rest.C3.q, "power": rest.power, "tau_d": rest.tau_d,
        "h_d2": rest.design.h_d2, "h_d3": rest.design.h_d3,
    }  # fmt: skip


@pytest.mark.parametrize("name", OF_SET)
def test_numbers_of_the_notes(name):
    found = numbers(steady_state(SETS[name]))
    for key, (value, tolerance) in {**COMMON, **OF_SET[name]}.items():
        assert found[key] == pytest.approx(value, abs=tolerance), key


def test_contents_of_the_notes():
    rest = steady_state(SET_A)
    found = [rest.S1.N_oil, rest.S1.N_metL, rest.S1.N_metG, rest.S2.N_oil, rest.S2.N_metL, rest.S2.N_metG]
    # Published: notes 1.8.
    np.testing.assert_allclose(found, [302017.0, 40525.5, 47974.7, 378053.0, 18561.0, 23444.9], atol=0.6)


@pytest.mark.parametrize("name", ["A", "B", "C"])
def test_pipes_are_the_same_in_the_sets_of_the_notes(name):
    design = designed(SETS[name])
    assert design.K_link == pytest.approx(0.060688, abs=6e-7)  # published: notes 1.6
    assert design.K_out == pytest.approx(0.087372, abs=1.5e-6)


def test_heat_capacity_ratio_follows_from_the_speed_of_sound():
    assert round(Fluids().gamma, 4) == 1.3067  # published: notes 1.2


def test_energy_balance():
    """The turbine's power is the Euler work on both gas streams."""
    for plant in SETS.values():
        rest = steady_state(plant)
        work = (rest.C2.m * rest.design.h_d2 + rest.C3.m * rest.design.h_d3) / 0.78
        assert rest.power == pytest.approx(work, rel=1e-12)  # analytic at n = 1


def test_moles_balance_at_rest():
    rest = steady_state(SET_B, 7600.0, 0.33)
    assert pytest.approx(7600.0, rel=1e-13) == rest.S1.F_L + rest.S1.F_G  # analytic
    assert rest.S1.z * rest.S1.F_L + rest.S1.F_G == pytest.approx(0.33 * 7600.0, rel=1e-12)
    assert pytest.approx(rest.S1.F_L, rel=1e-13) == rest.S2.F_L + rest.S2.F_G


def test_faster_boil_off_comes_closer_to_raoult():
    gaps = []
    for C_4 in (0.01, 0.1, 1.0, 10.0):
        data = SET_B.S1.__class__(**{**SET_B.S1.__dict__, "C_4": C_4})
        gaps.append(separator_rest(data, SET_B.fluids, 8000.0, 0.37).z - 30.0 / 261.0)
    assert all(a > b > 0.0 for a, b in pairwise(gaps))
    assert gaps[-1] < 2e-5  # analytic: z = p/p_metV as C_4 grows


def test_recycle_opens_in_case_2():
    rest = steady_state(SET_A, Z_I=0.25)
    assert rest.C2.recycle == pytest.approx(0.11, abs=0.015)  # published: notes 1.8, "about 0.11"
    assert rest.C2.q == pytest.approx(1.18 * 0.56, rel=1e-12)  # at the set point of the anti-surge controller
    assert rest.C3.recycle == 0.0


@pytest.mark.parametrize(
    ("F_in", "Z_I", "says"),
    [
        (10500.0, 0.30, r"VLCS1 cannot pass [\d.]+ mol/s of oil"),
        (12000.0, 0.3, r"VLCS1 cannot pass [\d.]+ mol/s of oil: it would have to open to 1\.\d+ of its travel"),
        (8000.0, 0.05, r"Z_I = 0.05 is below the .* no gas boils off"),
        (-1.0, 0.37, r"F_in = -1.0 mol/s"),
        (8000.0, 1.2, r"0 < Z_I < 1"),
        (8000.0, 0.9, r"C2 sucks at 34.86 bar, above the 29.9 bar of gas behind the scrubber"),
    ],
)
def test_infeasible_feeds_are_refused_with_numbers(F_in, Z_I, says):
    with pytest.raises(InfeasibleFeed, match=says):
        steady_state(SET_B, F_in, Z_I)


def test_set_point_above_supply_is_refused():
    low = SET_B.changed(S1=SET_B.S1.__class__(**{**SET_B.S1.__dict__, "p_SP": 120e5}))
    with pytest.raises(InfeasibleFeed):
        steady_state(low, 8000.0, 0.37)


def test_other_design_points_rest_too():
    """At its own design feed a plant rests at n = 1 with the drop it was designed for."""
    for D in (4.2e5, 7.0e5, 8.2e5):
        plant = SET_B.changed(D=D)
        rest = steady_state(plant)
        assert rest.w == pytest.approx(plant.w_d, rel=1e-12)
        assert rest.C2.p_in == pytest.approx(30e5 - 0.1e5 - D, rel=1e-12)
