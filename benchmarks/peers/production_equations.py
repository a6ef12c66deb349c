"""The production plant written out flat: one function of 23 states and two stem positions, independent of ``blocks``.

Sources: the balances of thesis chapters 3 and 4 as corrected in docs/evidence/errata.md; a cubic compressor map; the
controllers of thesis table 5.1.  Plain scalars and tuples throughout, so that the same text runs interpreted (for
python-control) and compiled by numba (for LSODA and CVODE).

    s   3 N_oil, N_metL, N_metG of S1 [mol], 3 of S2, p_in3, m_3, p_out3, p_in2, m_2, p_out2 [Pa, kg/s], w [rad/s],
        the integral parts of LCS11, LCS21, PCS11, PCS21, PCS12, PCS22, ASC2, ASC3, SC002, SC001
    c   h_d2, h_d3 [J/kg], K_link, K_out [kg/s/sqrt(Pa)]: what differs between the parameter sets
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from numba.extending import register_jitable

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram

ORDER = (
    "S1.N_oil", "S1.N_metL", "S1.N_metG", "S2.N_oil", "S2.N_metL", "S2.N_metG",
    "C3_inlet.p", "C3.m", "C3_outlet.p", "C2_inlet.p", "C2.m", "C2_outlet.p", "shaft.w",
    "LCS11.z", "LCS21.z", "PCS11.z", "PCS21.z", "PCS12.z", "PCS22.z", "ASC2.z", "ASC3.z", "SC002.z", "SC001.z",
)  # fmt: skip

F_IN, Z_I = 8000.0, 0.37
V_OIL, V_MET = 0.086 / 659.0, 0.016 / 422.0  # m3/mol
R_T = 8.31 * 308.15  # J/mol
V_SEP_1, V_SEP_2, V_SP_1, V_SP_2 = 81.9, 100.07, 40.95, 50.04
P_SP_1, P_SP_2, P_SAFE_1, P_SAFE_2 = 30e5, 12e5, 40e5, 15e5
K_LEVEL, T_LEVEL, K_GAS_1, K_GAS_2, T_GAS = 0.1, 200.0, 8.8e-7, 3e-7, 8.0
C_01 = 453.43
GAMMA = C_01**2 * 0.016 / (8.31 * 302.95)
CP_T, EXPONENT = C_01**2 / (GAMMA - 1.0), GAMMA / (GAMMA - 1.0)
FILLING, DUCT = C_01**2 / 0.6, 0.00956 / 1.8
W_D, ETA = 994.838, 0.78


@register_jitable
def root(d):
    """Return the signed square root, laminar below 100 Pa."""
    return d / math.sqrt(math.sqrt(d * d + 1e4))


@register_jitable
def clip(v):
    """Return v limited to 0 ... 1."""
    return min(max(v, 0.0), 1.0)


@register_jitable
def openings(s):
    """Return OP of VLCS1 and VPCS1 before they are limited to 0 ... 1."""
    V = V_OIL * s[0] + V_MET * s[1]
    p = s[2] * R_T / (V_SEP_1 - V)
    return K_LEVEL * (V - V_SP_1) + s[13], K_GAS_1 * (p - P_SP_1) + s[15]


@register_jitable
def slopes(s, r):
    """Return dOP/dt of VLCS1 and VPCS1 [1/s] from the rates r of the states; zero at a limit."""
    V, dV = V_OIL * s[0] + V_MET * s[1], V_OIL * r[0] + V_MET * r[1]
    dp = R_T * (r[2] + s[2] * dV / (V_SEP_1 - V)) / (V_SEP_1 - V)
    v_oil, v_gas = openings(s)
    d_oil = K_LEVEL * dV + r[13] if 0.0 <= v_oil <= 1.0 else 0.0
    d_gas = K_GAS_1 * dp + r[15] if 0.0 <= v_gas <= 1.0 else 0.0
    return d_oil, d_gas


@register_jitable
def integral(v, e, drive):
    """Return the rate of an integral part that is held while OP is at a limit and the error pushes it further."""
    return 0.0 if (v > 1.0 and e > 0.0) or (v < 0.0 and e < 0.0) else drive


@register_jitable
def one_sided(v, e, drive):
    """Return the same for an output that is limited below only."""
    return 0.0 if v < 0.0 and e < 0.0 else drive


@register_jitable
def psi(q):
    """Return the head coefficient of the map."""
    if q < 0.0:
        return 0.93 + 0.24 * (q / 0.28) ** 2
    x = q / 0.28 - 1.0
    return 0.93 + 0.12 * (1.0 + 1.5 * x - 0.5 * x * x * x)


@register_jitable
def ratio(h):
    """Return the pressure ratio that a head [J/kg] gives."""
    return max(0.2, 1.0 + h / CP_T) ** EXPONENT


@register_jitable
def rates(s, x_oil, x_gas, c):
    """Return ds/dt with the stems of VLCS1 and VPCS1 at x_oil and x_gas [fraction of travel]."""
    N_oil1, N_met1, N_gas1, N_oil2, N_met2, N_gas2, p_in3, m_3, p_out3, p_in2, m_2, p_out2, w = s[:13]
    z_level1, z_level2, z_gas1, z_gas2, z_flare1, z_flare2, z_asc2, z_asc3, z_outer, z_inner = s[13:]
    h_d2, h_d3, K_link, K_out = c

    V_1 = V_OIL * N_oil1 + V_MET * N_met1
    V_2 = V_OIL * N_oil2 + V_MET * N_met2
    p_1, p_2 = N_gas1 * R_T / (V_SEP_1 - V_1), N_gas2 * R_T / (V_SEP_2 - V_2)
    z_1, z_2 = N_met1 / (N_oil1 + N_met1), N_met2 / (N_oil2 + N_met2)
    boil_1, boil_2 = 0.026 * (261e5 * z_1 - p_1), 0.02 * (261e5 * z_2 - p_2)

    e_l1, e_l2, e_p1, e_p2 = V_1 - V_SP_1, V_2 - V_SP_2, p_1 - P_SP_1, p_2 - P_SP_2
    v_l1, v_l2 = K_LEVEL * e_l1 + z_level1, K_LEVEL * e_l2 + z_level2
    v_p1, v_p2 = K_GAS_1 * e_p1 + z_gas1, K_GAS_2 * e_p2 + z_gas2
    OP_VPCS2 = clip(v_p2)
    e_f1, e_f2 = p_1 - P_SAFE_1, p_2 - P_SAFE_2
    v_f1, v_f2 = 0.01 * e_f1 + z_flare1, 0.01 * e_f2 + z_flare2

    F_L1 = 6.1 * x_oil * root(p_1 - p_2)
    F_L2 = 8.7 * clip(v_l2) * root(p_2 - 1.01325e5)
    F_G1 = 27.4 * x_gas * root(max(0.0, p_1 - 0.1e5 - p_in2))
    F_G2 = 3.8 * OP_VPCS2 * root(max(0.0, p_2 - 0.1e5 - p_in3))

    n = w / W_D
    q_2, q_3 = m_2 * 29.7e5 / (p_in2 * 76.0 * n), m_3 * 11.7e5 / (p_in3 * 14.56 * n)
    load = (abs(m_2) * h_d2 + abs(m_3) * h_d3) * n / (ETA * W_D)
    short_2, short_3 = 1.18 * 0.56 - q_2, 1.18 * 0.56 - q_3
    E_2, E_3 = (1.0 + 10.0 * max(0.0, short_2)) * short_2, (1.0 + 10.0 * max(0.0, short_3)) * short_3
    v_a2, v_a3 = 0.22 * E_2 + z_asc2, 0.53 * E_3 + z_asc3
    x_a2, x_a3 = clip(v_a2), clip(v_a3)
    m_rv2, m_rv3 = 0.020 * x_a2 * root(p_out2 - p_in2), 0.025 * x_a3 * root(p_out3 - p_in3)
    m_link, m_out = K_link * root(p_out3 - p_in2), K_out * root(p_out2 - 72.1e5)

    open_error = OP_VPCS2 - 0.9
    speed_error = 3.0 * open_error + z_outer - w
    v_inner = 40000.0 * speed_error + z_inner
    oil_1, oil_2 = (1.0 - z_1) * F_L1, (1.0 - z_2) * F_L2
    return (
        (1.0 - Z_I) * F_IN - oil_1,
        Z_I * F_IN - z_1 * F_L1 - boil_1,
        boil_1 - F_G1 - max(0.0, v_f1),
        oil_1 - oil_2,
        z_1 * F_L1 - z_2 * F_L2 - boil_2,
        boil_2 - F_G2 - max(0.0, v_f2),
        FILLING * (0.016 * F_G2 + 3.650 + m_rv3 - m_3),
        DUCT * (ratio(h_d3 * n * n * psi(q_3)) * p_in3 - p_out3),
        FILLING * (m_3 - m_rv3 - m_link),
        FILLING * (0.016 * F_G1 + m_link + m_rv2 - m_2),
        DUCT * (ratio(h_d2 * n * n * psi(q_2)) * p_in2 - p_out2),
        FILLING * (m_2 - m_rv2 - m_out),
        (max(0.0, v_inner) - load) / 20.0,
        integral(v_l1, e_l1, K_LEVEL * e_l1 / T_LEVEL),
        integral(v_l2, e_l2, K_LEVEL * e_l2 / T_LEVEL),
        integral(v_p1, e_p1, K_GAS_1 * e_p1 / T_GAS),
        integral(v_p2, e_p2, K_GAS_2 * e_p2 / T_GAS),
        one_sided(v_f1, e_f1, 0.01 * e_f1 / 0.8),
        one_sided(v_f2, e_f2, 0.01 * e_f2 / 0.8),
        (0.22 * E_2 + x_a2 - v_a2) / 3.0,
        (0.53 * E_3 + x_a3 - v_a3) / 12.0,
        3.0 * open_error / 600.0,
        one_sided(v_inner, speed_error, 40000.0 * speed_error / 6.0),
    )


# --- compiled, for solvers that call y -> dy/dt -------------------------------------------------------------

# valves = mode and stem of VLCS1, mode and stem of VPCS1, f_c, f_s;  modes: 0 stuck, +1 and -1 the way it slides
FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz"}}


@register_jitable
def states(y):
    """Return an array of 23 states as a tuple."""
    return (
        y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], y[8], y[9], y[10], y[11],
        y[12], y[13], y[14], y[15], y[16], y[17], y[18], y[19], y[20], y[21], y[22],
    )  # fmt: skip


@register_jitable
def rates_at(y, valves, c):
    """Return the rates with the stems where their modes put them."""
    s = states(y)
    x_oil, x_gas = valves[1], valves[3]
    if valves[0] != 0.0 or valves[2] != 0.0:
        v_oil, v_gas = openings(s)
        if valves[0] != 0.0:
            x_oil = clip(clip(v_oil) - valves[0] * valves[4])
        if valves[2] != 0.0:
            x_gas = clip(clip(v_gas) - valves[2] * valves[4])
    return rates(s, x_oil, x_gas, (c[0], c[1], c[2], c[3]))


@njit(**FAST)
def write_rates(y, valves, c, dy):
    """Write dy/dt into ``dy``."""
    r = rates_at(y, valves, c)
    for i in range(23):
        dy[i] = r[i]


@njit(**FAST)
def compiled_rates(y, valves, c):
    """Return dy/dt."""
    dy = np.empty(23)
    write_rates(y, valves, c, dy)
    return dy


@njit(**FAST)
def compiled_jacobian(y, valves, c):
    """Return d(dy/dt)/dy by forward differences, all columns in compiled code."""
    base, moved, J, at = np.empty(23), np.empty(23), np.empty((23, 23)), y.copy()
    write_rates(y, valves, c, base)
    for j in range(23):
        step = 1.5e-8 * max(abs(y[j]), 1e-4)
        at[j] = y[j] + step
        write_rates(at, valves, c, moved)
        step = at[j] - y[j]
        at[j] = y[j]
        for i in range(23):
            J[i, j] = (moved[i] - base[i]) / step
    return J


@register_jitable
def pull(y, valves, c, which):
    """Return what turns positive when the mode of valve 0 (VLCS1) or 1 (VPCS1) ends."""
    mode, x = valves[2 * which], valves[2 * which + 1]
    s = states(y)
    if mode == 0.0:
        return abs(clip(openings(s)[which]) - x) - valves[5] - 1e-12
    return -mode * slopes(s, rates_at(y, valves, c))[which]


@njit(**FAST)
def compiled_event(y, valves, c):
    """Return what turns positive when the first of both modes ends: one event function is half the cost of two."""
    return max(pull(y, valves, c, 0), pull(y, valves, c, 1))


@njit(**FAST)
def switch(y, valves, c, band):
    """Change the modes that have ended, at first within ``band`` of their ends, until none has."""
    changed = False
    for _ in range(8):
        more = False
        for which in range(2):
            if pull(y, valves, c, which) <= (-band if not changed else 0.0):
                continue
            k = 2 * which
            opening = clip(openings(states(y))[which])
            if valves[k] == 0.0:
                valves[k] = 1.0 if opening > valves[k + 1] else -1.0
            else:
                valves[k + 1] = clip(opening - valves[k] * valves[4])
                valves[k] = 0.0
            more = changed = True
        if not more:
            break


# --- to and from the wired plant ------------------------------------------------------------------------------


def start(plant: "Diagram") -> np.ndarray:
    """Return the states of the wired plant in the order used here, shape (23,)."""
    found = []
    for key in ORDER:
        block, state = key.split(".")
        found.append(float(plant[block].x0[plant[block].state_names.index(state)]))
    return np.array(found)


def pressure_and_level(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return p_1 [Pa] and V_1 [m3] of states of shape (23, ...)."""
    V_1 = V_OIL * y[0] + V_MET * y[1]
    return y[2] * R_T / (V_SEP_1 - V_1), V_1


def constants(design: object) -> Sequence[float]:
    """Return c for the design point of a parameter set."""
    return tuple(float(getattr(design, name)) for name in ("h_d2", "h_d3", "K_link", "K_out"))
