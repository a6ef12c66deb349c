"""The whole plant against a right-hand side written again in plain numpy, integrated by scipy's LSODA.

Smooth stretch: ideal valves, the kick of the tables, set point and feed constant.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from stickslip.diagram import simulate
from stickslip.plant import SETS, kicked, production_plant, steady_state

ORDER = (
    "S1.N_oil", "S1.N_metL", "S1.N_metG", "S2.N_oil", "S2.N_metL", "S2.N_metG",
    "C3_inlet.p", "C3.m", "C3_outlet.p", "C2_inlet.p", "C2.m", "C2_outlet.p", "shaft.w",
    "LCS11.z", "LCS21.z", "PCS11.z", "PCS21.z", "ASC2.z", "ASC3.z", "SC002.z", "SC001.z",
)  # fmt: skip


def root(d):
    return d / (d * d + 1e4) ** 0.25


def pi(K_p, T_i, e, z):
    """Return output and integral rate: limited to 0 ... 1, held while beyond a limit and pushing out."""
    v = K_p * e + z
    held = (v > 1.0 and e > 0.0) or (v < 0.0 and e < 0.0)
    return min(max(v, 0.0), 1.0), 0.0 if held else K_p * e / T_i


def separator(N, F_in, Z, V_sep, C_4):
    V = 0.086 / 659 * N[0] + 0.016 / 422 * N[1]
    p = N[2] * 8.31 * 308.15 / (V_sep - V)
    z = N[1] / (N[0] + N[1])
    return p, V, z, C_4 * (261e5 * z - p)


def compressor(p_in, m, w, m_d, p_ref, h_d):
    n = w / 994.838
    q = m * (p_ref / p_in) / (m_d * n)
    s = q / 0.28
    psi = 0.93 + (0.24 * s * s if s < 0 else 0.12 * (1 + 1.5 * (s - 1) - 0.5 * (s - 1) ** 3))
    gamma = 453.43**2 * 0.016 / (8.31 * 302.95)
    ratio = max(0.2, 1 + h_d * n * n * psi * (gamma - 1) / 453.43**2) ** (gamma / (gamma - 1))
    return ratio, q, abs(m) * h_d / 0.78 * w / 994.838**2


def rates(t, y, design):
    S1, S2 = y[0:3], y[3:6]
    p_in3, m_3, p_out3, p_in2, m_2, p_out2, w = y[6:13]
    z_l1, z_l2, z_p1, z_p2, z_a2, z_a3, z_out, z_in = y[13:21]
    p_1, V_1, x_1, sep_1 = separator(S1, 0, 0, 81.9, 0.026)
    p_2, V_2, x_2, sep_2 = separator(S2, 0, 0, 100.07, 0.02)
    VLCS1, dz_l1 = pi(0.1, 200.0, V_1 - 40.95, z_l1)
    VLCS2, dz_l2 = pi(0.1, 200.0, V_2 - 50.04, z_l2)
    VPCS1, dz_p1 = pi(8.8e-7, 8.0, p_1 - 30e5, z_p1)
    VPCS2, dz_p2 = pi(3e-7, 8.0, p_2 - 12e5, z_p2)
    F_L1 = 6.1 * VLCS1 * root(p_1 - p_2)
    F_L2 = 8.7 * VLCS2 * root(p_2 - 1.01325e5)
    F_G1 = 27.4 * VPCS1 * max(0.0, root(p_1 - 0.1e5 - p_in2))
    F_G2 = 3.8 * VPCS2 * max(0.0, root(p_2 - 0.1e5 - p_in3))
    ratio_2, q_2, tau_2 = compressor(p_in2, m_2, w, 76.0, 29.7e5, design.h_d2)
    ratio_3, q_3, tau_3 = compressor(p_in3, m_3, w, 14.56, 11.7e5, design.h_d3)
    recycle, dz_a = [], []
    for K_p, T_i, q, z in ((0.22, 3.0, q_2, z_a2), (0.53, 12.0, q_3, z_a3)):
        e = 1.18 * 0.56 - q
        e *= 1 + 10 * max(0.0, e)
        v = K_p * e + z
        x = min(max(v, 0.0), 1.0)
        recycle.append(x)
        dz_a.append(K_p * e / T_i + (x - v) / T_i)
    m_rv2, m_rv3 = 0.020 * recycle[0] * root(p_out2 - p_in2), 0.025 * recycle[1] * root(p_out3 - p_in3)
    m_link, m_out = design.K_link * root(p_out3 - p_in2), design.K_out * root(p_out2 - 72.1e5)
    w_SP = 3.0 * (VPCS2 - 0.9) + z_out
    tau_d = 40000.0 * (w_SP - w) + z_in
    c = 453.43**2 / 0.6
    duct = 0.00956 / 1.8
    return [
        0.63 * 8000 - (1 - x_1) * F_L1, 0.37 * 8000 - x_1 * F_L1 - sep_1, sep_1 - F_G1,
        (1 - x_1) * F_L1 - (1 - x_2) * F_L2, x_1 * F_L1 - x_2 * F_L2 - sep_2, sep_2 - F_G2,
        c * (0.016 * F_G2 + 3.650 + m_rv3 - m_3), duct * (ratio_3 * p_in3 - p_out3), c * (m_3 - m_rv3 - m_link),
        c * (0.016 * F_G1 + m_link + m_rv2 - m_2), duct * (ratio_2 * p_in2 - p_out2), c * (m_2 - m_rv2 - m_out),
        (tau_d - tau_2 - tau_3) / 20.0,
        dz_l1, dz_l2, dz_p1, dz_p2, dz_a[0], dz_a[1], 3.0 * (VPCS2 - 0.9) / 600.0, 40000.0 * (w_SP - w) / 6.0,
    ]  # fmt: skip


def start(plant):
    values = []
    for key in ORDER:
        block, state = key.split(".")
        values.append(plant[block].x0[plant[block].state_names.index(state)])
    return np.array(values)


@pytest.mark.parametrize("name", ["A", "B"])
def test_same_rates(name):
    """Python-control's view of the wired plant gives the rates of the equations written again."""
    plant = production_plant(name, sticky=())
    labels = [f"{b}[{s}]" for b, s in (key.split(".") for key in ORDER)]
    at = [list(plant.state_labels).index(label) for label in labels]
    rng = np.random.default_rng(7)
    for _ in range(5):
        x = plant.x0 * (1.0 + 2e-3 * rng.standard_normal(len(plant.x0)))
        x[at[12]] = plant.x0[at[12]] + 0.1 * rng.standard_normal()  # a faster shaft would ask for negative torque
        x[at[19]] = plant.x0[at[19]]
        expected = np.array(rates(0.0, x[at], steady_state(SETS[name]).design))
        np.testing.assert_allclose(plant.dynamics(0.0, x, [])[at], expected, rtol=1e-8, atol=1e-7)


@pytest.mark.parametrize("name", ["A", "B"])
def test_same_trajectory_as_lsoda(name):
    plant = kicked(production_plant(name, sticky=()))
    times = np.linspace(0.0, 60.0, 121)
    design = steady_state(SETS[name]).design
    peer = solve_ivp(rates, (0.0, 60.0), start(plant), "LSODA", times, args=(design,), rtol=1e-9, atol=1e-9)
    run = simulate(plant, 60.0, times=times, rtol=1e-8, method="stiff")
    assert peer.success and run.ok
    signals = {"p_in3": 6, "m_3": 7, "p_out3": 8, "p_in2": 9, "m_2": 10, "p_out2": 11, "w": 12}
    for signal, i in signals.items():
        np.testing.assert_allclose(run.log[signal], peer.y[i], rtol=1e-5)
    V_1 = 0.086 / 659 * peer.y[0] + 0.016 / 422 * peer.y[1]
    np.testing.assert_allclose(run.log["V_1"], V_1, rtol=1e-6)
    np.testing.assert_allclose(run.log["p_1"], peer.y[2] * 8.31 * 308.15 / (81.9 - V_1), rtol=1e-6)
