"""Where the production plant rests: in closed form but for one root, so that nothing drifts.

Design point (constant feed 8000 mol/s, Z_I = 0.37): the drop D over VPCS1 fixes the suction of C2, and with it the
head scales h_d of both compressors and the resistances of the pipes.  Any other feed: the speed w is found at which
the pressure that C3 hands to C2 fits; recycle valves open where the flow would fall below the anti-surge set point.

Separators: z solves C_4 (p_metV z - p) = methane in - oil in z/(1 - z), a quadratic.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from stickslip.blocks.compressor_map import head_for, pressure_ratio
from stickslip.blocks.control_valve_flow import drop_for, root
from stickslip.blocks.ports import number
from stickslip.plant.parameters import CompressorData, Fluids, Production, SeparatorData


class InfeasibleFeed(ValueError):
    """The plant cannot rest at what was asked for; the message gives the numbers."""


@dataclass(frozen=True)
class SeparatorRest:
    """A separator at rest: contents [mol], methane fraction, flows [mol/s], pressure [Pa], volume [m3]."""

    N_oil: float
    N_metL: float
    N_metG: float
    z: float
    F_L: float
    F_G: float
    p: float
    V: float


@dataclass(frozen=True)
class CompressorRest:
    """A compressor at rest: pressures [Pa], flow [kg/s], corrected flow [-], torque [N m], recycle opening."""

    p_in: float
    p_out: float
    m: float
    q: float
    tau: float
    recycle: float


@dataclass(frozen=True)
class Design:
    """Numbers that follow from the design point: head scales [J/kg] and resistances [kg/s/sqrt(Pa)]."""

    h_d2: float
    h_d3: float
    K_link: float
    K_out: float


@dataclass(frozen=True)
class Rest:
    """The plant at rest; openings are fractions of travel, ``w`` [rad/s], ``tau_d`` [N m]."""

    F_in: float
    Z_I: float
    S1: SeparatorRest
    S2: SeparatorRest
    C2: CompressorRest
    C3: CompressorRest
    VLCS1: float
    VLCS2: float
    VPCS1: float
    VPCS2: float
    w: float
    tau_d: float
    design: Design

    @property
    def power(self) -> float:
        """Power of the turbine [W]."""
        return self.tau_d * self.w


def separator_rest(data: SeparatorData, fluids: Fluids, F_in: float, Z_I: float) -> SeparatorRest:
    """Return a separator at its set points for a feed [mol/s] with methane fraction ``Z_I``.

    Raises ``InfeasibleFeed`` if no gas boils off.

    >>> from stickslip.plant.parameters import SET_B
    >>> S1 = separator_rest(SET_B.S1, SET_B.fluids, 8000.0, 0.37)
    >>> round(S1.z, 5), round(S1.F_G, 1), round(S1.N_oil)
    (0.11831, 2283.7, 302017)
    """
    if not (0.0 < F_in < math.inf and 0.0 < Z_I < 1.0):
        raise InfeasibleFeed(
            f"feed F_in = {F_in!r} mol/s, Z_I = {Z_I!r}, but a steady feed is positive and finite, and 0 < Z_I < 1"
        )
    oil, methane = (1.0 - Z_I) * F_in, Z_I * F_in
    a, b = data.C_4 * fluids.p_metV, data.C_4 * data.p_SP
    # (a z - b)(1 - z) = methane (1 - z) - oil z   <=>   a z^2 - B z + C = 0
    B, C = a + b + methane + oil, b + methane
    z = 2.0 * C / (B + math.sqrt(B * B - 4.0 * a * C))
    F_L = oil / (1.0 - z)
    F_G = methane - z * F_L
    if F_G <= 0.0:
        raise InfeasibleFeed(
            f"Z_I = {Z_I!r} is below the {z:.4g} that stays dissolved at {data.p_SP / 1e5:g} bar: no gas boils off; "
            "raise Z_I or lower the pressure set point"
        )
    v_oil, v_met = fluids.W_oil / fluids.rho_oil, fluids.W_met / fluids.rho_met
    N = data.V_SP / ((1.0 - z) * v_oil + z * v_met)
    N_metG = data.p_SP * (data.V_sep - data.V_SP) / (fluids.R * fluids.T_sep)
    return SeparatorRest((1.0 - z) * N, z * N, N_metG, z, F_L, F_G, data.p_SP, data.V_SP)


def steady_state(plant: Production, F_in: float | None = None, Z_I: float | None = None) -> Rest:
    """Return where the plant rests with the feed ``F_in`` [mol/s] of methane fraction ``Z_I`` (default: design).

    Raises ``InfeasibleFeed`` with the numbers if a valve would have to open beyond its travel, or no speed fits.

    >>> from stickslip.plant.parameters import SET_A
    >>> rest = steady_state(SET_A)
    >>> round(rest.VPCS1, 4), round(rest.C2.q, 3), round(rest.power / 1e6, 2)
    (0.1076, 0.769, 13.44)
    """
    F_in = plant.F_in if F_in is None else number("feed", "F_in", F_in)
    Z_I = plant.Z_I if Z_I is None else number("feed", "Z_I", Z_I)
    return _solved(plant, F_in, Z_I)


@lru_cache(maxsize=256)
def _solved(plant: Production, F_in: float, Z_I: float) -> Rest:
    _check_set_points(plant)
    design = designed(plant)
    S1, S2, p_in3 = _separators(plant, F_in, Z_I)
    if p_in3 <= 0.2 * plant.S2.p_SP:
        raise InfeasibleFeed(
            f"VPCS2 at {plant.OP_VPCS2:g} passes the {S2.F_G:.5g} mol/s of gas of F_in = {F_in:g} mol/s only with a "
            f"suction of C3 of {p_in3 / 1e5:.3g} bar; lower the feed"
        )
    m_3 = plant.fluids.W_met * S2.F_G + plant.m_C4
    m_2 = m_3 + plant.fluids.W_met * S1.F_G
    p_out2 = plant.p_C1 + drop_for(m_2 / design.K_out, plant.p_lam)

    def stages(n: float) -> tuple[float, float, float, float, float]:
        """Return the flows through both compressors, p_out3, p_in2 and the pressure error of C2 at speed ``n``."""
        c_3 = max(m_3, _least_flow(plant.C3, plant, p_in3, n))
        p_out3 = p_in3 * _ratio(plant.C3, plant, design.h_d3, c_3, p_in3, n)
        p_in2 = p_out3 - drop_for(m_3 / design.K_link, plant.p_lam)
        if p_in2 <= 1e5:
            return c_3, m_2, p_out3, p_in2, -p_out2
        c_2 = max(m_2, _least_flow(plant.C2, plant, p_in2, n))
        return c_3, c_2, p_out3, p_in2, p_in2 * _ratio(plant.C2, plant, design.h_d2, c_2, p_in2, n) - p_out2

    n = _root(lambda n: stages(n)[4], 0.5, 1.6)
    if n is None:
        raise InfeasibleFeed(
            f"no speed between 50 and 160 % of design lifts {m_2:.4g} kg/s from {p_in3 / 1e5:.4g} to "
            f"{p_out2 / 1e5:.4g} bar with both compressors; change the feed F_in = {F_in:g} mol/s, Z_I = {Z_I:g}"
        )
    c_3, c_2, p_out3, p_in2, _ = stages(n)
    w = n * plant.w_d
    C2 = _compressor(plant.C2, plant, design.h_d2, c_2, c_2 - m_2, p_in2, p_out2, n)
    C3 = _compressor(plant.C3, plant, design.h_d3, c_3, c_3 - m_3, p_in3, p_out3, n)
    p_gas = plant.S1.p_SP - plant.dp_scrubber
    if p_in2 >= p_gas:
        raise InfeasibleFeed(
            f"C2 sucks at {p_in2 / 1e5:.4g} bar, above the {p_gas / 1e5:.4g} bar of gas behind the scrubber: no valve "
            f"can pass {S1.F_G:.5g} mol/s there; lower the feed F_in = {F_in:g} mol/s or its Z_I = {Z_I:g}"
        )
    rest = Rest(
        F_in, Z_I, S1, S2, C2, C3,
        VLCS1=S1.F_L / (plant.S1.C_v_oil * root(S1.p - S2.p, plant.p_lam)),
        VLCS2=S2.F_L / (plant.S2.C_v_oil * root(S2.p - plant.fluids.p_atm, plant.p_lam)),
        VPCS1=S1.F_G / (plant.S1.C_v_gas * root(p_gas - p_in2, plant.p_lam)),
        VPCS2=plant.OP_VPCS2,
        w=w, tau_d=C2.tau + C3.tau, design=design,
    )  # fmt: skip
    _check_valves(plant, rest)
    return rest


@lru_cache(maxsize=64)
def designed(plant: Production) -> Design:
    """Return head scales and resistances with which the plant rests at its design feed with D over VPCS1.

    Raises ``InfeasibleFeed`` if a compressor would have to do what none can.

    >>> from stickslip.plant.parameters import SET_B
    >>> design = designed(SET_B)
    >>> round(design.h_d2 / 1e3, 2), round(design.h_d3 / 1e3, 2), round(design.K_link, 6), round(design.K_out, 6)
    (235.59, 99.69, 0.060688, 0.087371)
    """
    S1, S2, p_in3 = _separators(plant, plant.F_in, plant.Z_I)
    m_3 = plant.fluids.W_met * S2.F_G + plant.m_C4
    m_2 = m_3 + plant.fluids.W_met * S1.F_G
    p_in2 = plant.S1.p_SP - plant.dp_scrubber - plant.D
    p_out3, p_out2 = p_in2 + plant.dp_link, plant.p_C1 + plant.dp_out
    c, gamma = plant.fluids.c_01, plant.fluids.gamma
    heads = []
    for name, data, m, p_in, p_out in (
        ("C2", plant.C2, m_2, p_in2, p_out2), ("C3", plant.C3, m_3, p_in3, p_out3),
    ):  # fmt: skip
        q = m * data.p_ref / (p_in * data.m_d)
        psi = data.map.psi(q, 1.0)
        if not psi > 0.0 or not p_out > p_in > 0.0:
            raise InfeasibleFeed(
                f"at the design feed F_in = {plant.F_in:g} mol/s, Z_I = {plant.Z_I:g} {name} would have to lift "
                f"{m:.4g} kg/s from {p_in / 1e5:.4g} to {p_out / 1e5:.4g} bar, at a corrected flow of {q:.3g} where "
                f"its map gives a head of {psi:.3g}; lower the feed, or change m_d or the drop D = "
                f"{plant.D / 1e5:g} bar"
            )
        heads.append(head_for(p_out / p_in, c, gamma) / psi)
    K_link = m_3 / root(plant.dp_link, plant.p_lam)
    return Design(heads[0], heads[1], K_link, m_2 / root(plant.dp_out, plant.p_lam))


def _separators(plant: Production, F_in: float, Z_I: float) -> tuple[SeparatorRest, SeparatorRest, float]:
    """Return both separators at rest and the suction pressure of C3 [Pa]."""
    S1 = separator_rest(plant.S1, plant.fluids, F_in, Z_I)
    S2 = separator_rest(plant.S2, plant.fluids, S1.F_L, S1.z)
    drop = drop_for(S2.F_G / (plant.S2.C_v_gas * plant.OP_VPCS2), plant.p_lam)
    return S1, S2, plant.S2.p_SP - plant.dp_scrubber - drop


def _least_flow(data: CompressorData, plant: Production, p_in: float, n: float) -> float:
    """Return the flow [kg/s] at the set point of the anti-surge controller."""
    return plant.margin * data.map.surge(n) * data.m_d * n * p_in / data.p_ref


def _ratio(data: CompressorData, plant: Production, h_d: float, m: float, p_in: float, n: float) -> float:
    head = h_d * n * n * data.map.psi(m * data.p_ref / (p_in * data.m_d * n), n)
    return pressure_ratio(head, plant.fluids.c_01, plant.fluids.gamma)


def _compressor(
    data: CompressorData, plant: Production, h_d: float, m: float, back: float, p_in: float, p_out: float, n: float
) -> CompressorRest:
    q = m * data.p_ref / (p_in * data.m_d * n)
    tau = m * h_d * n * data.map.work(q, n) / plant.w_d
    recycle = back / (data.C_v_recycle * root(p_out - p_in, plant.p_lam)) if back > 1e-12 * m else 0.0
    return CompressorRest(p_in, p_out, m, q, tau, recycle)


def _root(f: Callable[[float], float], low: float, high: float) -> float | None:
    """Return where ``f`` changes sign from below between ``low`` and ``high``, or None."""
    from scipy.optimize import brentq

    grid = [low + (high - low) * i / 60 for i in range(61)]
    values = [f(n) for n in grid]
    for i in range(60):
        if values[i] <= 0.0 < values[i + 1]:
            return float(brentq(f, grid[i], grid[i + 1], xtol=1e-15, rtol=8.9e-16))
    return None


def _check_set_points(plant: Production) -> None:
    """Refuse set points and gas data that contradict each other."""
    S1, S2, gamma = plant.S1, plant.S2, plant.fluids.gamma
    bar = 1e5
    for i, data, below, what in ((1, S1, S2.p_SP, "p_SP of S2"), (2, S2, plant.fluids.p_atm, "the atmosphere")):
        if not data.p_SP < data.p_safe:
            raise InfeasibleFeed(
                f"S{i}: p_SP = {data.p_SP / bar:.4g} bar lies above p_safe = {data.p_safe / bar:.4g} bar, so gas would "
                "go to the flare for ever; lower p_SP or raise p_safe"
            )
        if not data.p_SP > below:
            raise InfeasibleFeed(
                f"S{i}: p_SP = {data.p_SP / bar:.4g} bar does not lie above {what}, {below / bar:.4g} bar, so no oil "
                "would flow; raise it"
            )
        if not 0.0 < data.V_SP < data.V_sep:
            raise InfeasibleFeed(
                f"S{i}: the level set point V_SP = {data.V_SP:.4g} m3 does not lie within the vessel of "
                f"{data.V_sep:.4g} m3; change one of them"
            )
    if not 0.0 < plant.OP_VPCS2 <= 1.0:
        raise InfeasibleFeed(
            f"VPCS2 is to stand at OP_VPCS2 = {plant.OP_VPCS2:.4g}, but its travel ends at 0 and 1; give about 0.9"
        )
    if not gamma > 1.0:
        raise InfeasibleFeed(
            f"c_01, W_met, R and T_c give a heat capacity ratio of {gamma:.4g}, but it exceeds 1; methane has 1.3"
        )


def _check_valves(plant: Production, rest: Rest) -> None:
    """Refuse openings beyond the travel of a valve."""
    flows = {
        "VLCS1": (rest.VLCS1, rest.S1.F_L, "mol/s", "oil"),
        "VLCS2": (rest.VLCS2, rest.S2.F_L, "mol/s", "oil"),
        "VPCS1": (rest.VPCS1, rest.S1.F_G, "mol/s", "gas"),
        "VRVC2": (rest.C2.recycle, rest.C2.recycle, "of travel", "recycle"),
        "VRVC3": (rest.C3.recycle, rest.C3.recycle, "of travel", "recycle"),
    }
    for valve, (opening, flow, unit, what) in flows.items():
        if not opening <= 1.0:
            raise InfeasibleFeed(
                f"{valve} cannot pass {flow:.5g} {unit} of {what}: it would have to open to {opening:.3g} of its "
                f"travel; lower the feed F_in = {rest.F_in:g} mol/s (Z_I = {rest.Z_I:g}) or give a larger valve"
            )
