"""Parameters of the production plant, with units and where each number comes from.

Marks: [T] printed in the thesis (tables 5.1, 5.3, A.1, A.2), [T*] printed but corrected (unit, index or misprint),
[E] engineering choice, the thesis gives none, [C] calibrated against thesis table 5.4.

Set B fits tables 5.4 and 6.1 (constant feed), set A case 2 (sine); they differ in the pressure drop over VPCS1 only.
About a dozen unknowns were fitted to the sixteen numbers of table 5.4, so agreement there is a fit, not a
prediction.  Set C serves both cases with one number fitted: it reads both pressure gains as printed times one thousand
(5e-7 and 3e-7 /Pa: table 5.1 then is in kmol or kPa), which leaves the drop D over VPCS1.  Set E serves both cases
best, with five numbers found by search; ``stickslip.cases.choice`` shows the search and its sensitivity.  Set E is the
``DEFAULT``.  The thesis prints q = 1 as the design flow of C2.  The map of set E gives no head there (psi = -0.03), as
no real compressor would.  The plant works at q = 0.49 to 0.78 and rests at 0.68; only that was
fitted.  Limit cycles of this plant depend on where they start: compare bands over many starts, not one run.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

from stickslip.blocks.compressor_map import CompressorMap, CubicMap
from stickslip.blocks.ports import number, require


@dataclass(frozen=True)
class Fluids:
    """Oil (hexane) and methane, and the temperatures at which they are handled."""

    rho_oil: float = 659.0  # [T] kg/m3
    rho_met: float = 422.0  # [T] kg/m3, dissolved
    W_oil: float = 0.086  # [T*] kg/mol, printed in g/mol
    W_met: float = 0.016  # [T*] kg/mol, printed in g/mol
    R: float = 8.31  # [T] J/(mol K)
    T_sep: float = 308.15  # [T] K
    T_c: float = 302.95  # [T] K
    p_metV: float = 261e5  # [T] Pa
    c_01: float = 453.43  # [T] m/s
    p_atm: float = 1.01325e5  # [E] Pa

    @property
    def gamma(self) -> float:
        """Heat capacity ratio c_01^2 W_met / (R T_c) [-], which the speed of sound fixes."""
        return self.c_01**2 * self.W_met / (self.R * self.T_c)


@dataclass(frozen=True)
class SeparatorData:
    """One separator with its valves, and the tuning and set points of its loops."""

    V_sep: float  # m3
    V_SP: float  # m3, set point of the level controller
    C_4: float  # mol/s/Pa
    p_SP: float  # Pa, main pressure controller
    p_safe: float  # Pa, safety controller
    C_v_oil: float  # mol/s/sqrt(Pa), VLCS
    C_v_gas: float  # mol/s/sqrt(Pa), VPCS
    K_p_level: float  # 1/m3
    T_i_level: float  # s
    K_p_pressure: float  # 1/Pa
    T_i_pressure: float  # s


@dataclass(frozen=True)
class CompressorData:
    """One compressor with its recycle valve and anti-surge controller."""

    m_d: float  # kg/s
    p_ref: float  # Pa
    C_v_recycle: float  # kg/s/sqrt(Pa), VRVC
    K_p: float  # anti-surge gain [-]
    T_i: float  # s
    map: CompressorMap = field(default_factory=CubicMap)  # [E] shape


@dataclass(frozen=True)
class Stem:
    """The stem of a sticky valve (table A.1)."""

    k: float = 52500.0  # [T] N per travel
    M: float = 1.36  # [T] kg
    F_v: float = 612.0  # [T] N s per travel
    F_c: float = 1250.0  # [T] N


@dataclass(frozen=True)
class Turbine:
    """The gas turbine, where it is more than the torque that SC001 asks (see stickslip.blocks.gas_turbine)."""

    T: float = 0.2  # [E] s, lag
    tau_max: float = 25e3  # [E] N m
    P_max: float = 22e6  # [E] W; the plant takes 13 to 16 MW


STICTION: Mapping[str, float] = {"none": 1250.0, "normal": 1750.0, "high": 2250.0}  # [T] F_s [N], table 5.3


@dataclass(frozen=True)
class Production:
    """Everything the plant needs; change a value with ``dataclasses.replace``.

    >>> from stickslip.plant.parameters import SET_B
    >>> round(SET_B.fluids.gamma, 4), SET_B.S1.V_SP
    (1.3067, 40.95)
    """

    name: str
    D: float  # [C] Pa, pressure drop over VPCS1 at the design point
    K_p_speed: float = 40000.0  # [C] N m s/rad, SC001; 80000 halves the noise of the speed
    T_i_speed: float = 6.0  # [C] s
    fluids: Fluids = field(default_factory=Fluids)
    S1: SeparatorData = field(
        default_factory=lambda: SeparatorData(
            V_sep=81.9,  # [T*] twice the set point
            V_SP=40.95,  # [T]
            C_4=0.026,  # [C]
            p_SP=30e5,  # [T*] set points of PCS12 and PCS21 are swapped in table 5.1
            p_safe=40e5,  # [T*]
            C_v_oil=6.1,  # [T]
            C_v_gas=27.4,  # [T]
            K_p_level=0.1,  # [T]
            T_i_level=200.0,  # [T]
            K_p_pressure=8.8e-7,  # [C] printed 5E-10: a thousand times too small to move the valve
            T_i_pressure=8.0,  # [T]
        )
    )
    S2: SeparatorData = field(
        default_factory=lambda: SeparatorData(
            V_sep=100.07,  # [T]
            V_SP=50.04,  # [T]
            C_4=0.02,  # [E]
            p_SP=12e5,  # [T*]
            p_safe=15e5,  # [T]
            C_v_oil=8.7,  # [T]
            C_v_gas=3.8,  # [T]
            K_p_level=0.1,  # [T]
            T_i_level=200.0,  # [T]
            K_p_pressure=3e-7,  # [T*] printed 3E-10
            T_i_pressure=8.0,  # [T]
        )
    )
    C2: CompressorData = field(
        default_factory=lambda: CompressorData(
            m_d=76.0,  # [T] 4750 mol/s
            p_ref=29.7e5,  # [E]
            C_v_recycle=0.020,  # [T*] unit inferred
            K_p=0.22,  # [T]
            T_i=3.0,  # [T]
        )
    )
    C3: CompressorData = field(
        default_factory=lambda: CompressorData(
            m_d=14.56,  # [E] 670 mol/s [T] from S2 and about 240 from C4
            p_ref=11.7e5,  # [E]
            C_v_recycle=0.025,  # [T*] unit inferred
            K_p=0.53,  # [T]
            T_i=12.0,  # [T]
        )
    )
    stem: Stem = field(default_factory=Stem)
    turbine: Turbine = field(default_factory=Turbine)
    F_in: float = 8000.0  # [E] mol/s, feed of the design point
    Z_I: float = 0.37  # [T] methane fraction of the feed
    dp_scrubber: float = 0.1e5  # [E] Pa
    p_lam: float = 100.0  # [E] Pa, drop below which flows are laminar
    V_plenum: float = 0.6  # [T] m3
    A_c: float = 0.00956  # [T] m2
    L_c: float = 1.8  # [T] m
    w_d: float = 994.838  # [E] rad/s, 9500 RPM
    J: float = 20.0  # [C] kg m2
    dp_link: float = 0.3e5  # [E] Pa from C3 to C2 at the design point
    dp_out: float = 2.9e5  # [C] Pa from C2 to C1 at the design point
    p_C1: float = 72.1e5  # [E] Pa, suction of C1
    m_C4: float = 3.650  # [E] kg/s, methane that flashes off at 1 bar
    OP_VPCS2: float = 0.9  # [E] opening of VPCS2 that the speed is chosen for
    K_p_outer: float = 3.0  # [C] rad/s per unit
    T_i_outer: float = 600.0  # [C] s
    margin: float = 1.18  # [E] anti-surge set point over surge flow
    boost: float = 10.0  # [E] nonlinear gain 1 + boost max(0, e)
    gradient: float = 1500.0  # [E] s, growth of that gain with the rate at which the flow falls, if asked for
    gradient_limit: float = 0.005  # [E] 1/s, rate of fall from which on it grows
    T_gradient: float = 2.0  # [E] s, time over which the rate is taken; at 0.5 the loop through C2 rings at 100 Hz
    K_p_flare: float = 0.01  # [T*] mol/s/Pa, unit inferred
    T_i_flare: float = 0.8  # [T] s

    def __post_init__(self) -> None:
        """Raise ``BlockError`` for a number that is not positive and finite, in nested data too.

        Some may be 0 (``MAY_BE_ZERO``), and integral times infinite.
        """
        _check(self, self.name)

    def changed(self, **values: object) -> "Production":
        """Return the set with other values and a name that says so."""
        return replace(self, **{"name": f"{self.name}*", **values})  # type: ignore[arg-type]


MAY_BE_ZERO = ("m_C4", "dp_scrubber", "p_lam", "boost", "gradient", "gradient_limit")


def _check(data: Any, name: str, prefix: str = "") -> None:
    for item in fields(data):
        value, key = getattr(data, item.name), prefix + item.name
        if is_dataclass(value):
            _check(value, name, f"{key}.")
        elif item.type is float:
            size = number(name, key, value)
            possible = size > 0.0 or (size == 0.0 and item.name in MAY_BE_ZERO)
            finite = size < math.inf or item.name.startswith("T_i")
            require(possible and finite, name, key, value, "it must be positive and finite", "give SI units")


SET_A = Production(name="A", D=6.0e5)  # case 2
SET_B = Production(name="B", D=7.8e5)  # case 1
SET_C = replace(  # both cases
    SET_B, name="C",
    D=4.1e5,  # [C], the one number fitted
    S1=replace(SET_B.S1, K_p_pressure=5e-7),  # [T*] printed 5E-10
)  # fmt: skip
SET_E = replace(  # both cases, searched: what differs from set B
    SET_B, name="E",
    D=4.1e5,  # [C]
    F_in=7600.0,  # [C] the thesis prints only that 9500 is the most, with a margin
    dp_out=3.25e5,  # [C]
    S1=replace(SET_B.S1, K_p_pressure=7e-7),  # [C]
    C2=replace(SET_B.C2, map=CubicMap(W_q=0.25)),  # [C] surge at a corrected flow of 0.50
    C3=replace(SET_B.C3, map=CubicMap(W_q=0.25)),
)  # fmt: skip
SETS: Mapping[str, Production] = {"A": SET_A, "B": SET_B, "C": SET_C, "E": SET_E}
DEFAULT = "E"  # behind ``production_plant``, the cases and their studies, unless another set is asked for
