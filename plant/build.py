"""The whole production plant, wired by names, at rest at its set points.

crude -> S1 -oil VLCS1-> S2 -oil VLCS2-> S3 (outside, atmospheric)
S1 -gas VPCS1-> C2 -> C1 (outside)          S2 -gas VPCS2-> C3 -> C2          C2, C3 on one shaft, turbine M2
"""

from collections.abc import Mapping, Sequence

from stickslip.blocks.block import Block
from stickslip.blocks.ports import nearest
from stickslip.blocks.sources import Constant
from stickslip.diagram import Diagram, wire
from stickslip.diagram.wiring import WiringError
from stickslip.plant import feed as feeds
from stickslip.plant import parts
from stickslip.plant.parameters import DEFAULT, SETS, Production
from stickslip.plant.rest import Rest, steady_state


def production_plant(
    set: str | Production = DEFAULT,
    sticky: Sequence[str] = ("VLCS1", "VPCS1"),
    F_s: float | str | Mapping[str, float | str] = "high",
    case: int = 1,
    *,
    feed: Sequence[Block] | None = None,
    stem: str = "quasi_static",
    anti_surge: bool | str = True,
    turbine: str = "direct",
    F_in: float | None = None,
    Z_I: float | None = None,
    name: str = "production_plant",
) -> Diagram:
    """Return the plant at rest; it stays there until a kick, a slug or another set point moves it.

    Parameters: ``set`` "A", "B", "C", "E" (default, as in the cases) or a ``Production``; ``sticky`` the valves that
    stick; ``F_s`` their static friction [N], or "none", "normal", "high"; ``case`` 1 constant feed, 2 sinusoidal
    methane fraction about 0.25;
    ``feed`` other blocks that give F_in and Z_I; ``stem`` "quasi_static" or "full" (with mass); ``turbine`` "direct"
    (torque at once, as in the thesis) or "lag" (a GasTurbine); ``anti_surge`` True, False (recycle valves stay as they
    are) or "gradient" (opens faster when the flow falls fast: sets A and C then stand a feed trip); ``F_in`` [mol/s]
    and ``Z_I`` where the plant rests at first (default: what ``feed`` gives at the start, else the design feed, with
    Z_I = 0.25 in case 2).

    Raises ``InfeasibleFeed`` with the numbers if the plant cannot rest there, ``WiringError`` for unknown names.

    >>> from stickslip.diagram import simulate
    >>> run = simulate(production_plant(F_s="high"), 20.0, every=10.0)
    >>> (run.log["p_1"] / 1e5).round(6).tolist(), run.log["V_1"].round(6).tolist()
    ([30.0, 30.0, 30.0], [40.95, 40.95, 40.95])
    """
    plant = _set(set)
    if case not in (1, 2):
        raise WiringError(
            f"case = {case!r}, but there are case 1 (constant feed) and case 2 (sine); give feed= for others"
        )
    at_first = feeds.start(feed or ())
    F_0 = at_first.get("F_in", plant.F_in) if F_in is None else F_in
    Z_0 = at_first.get("Z_I", plant.Z_I if case == 1 else 0.25) if Z_I is None else Z_I
    rest = steady_state(plant, F_0, Z_0)
    if feed is None:
        feed = feeds.constant(F_0, Z_0) if case == 1 else feeds.sine(F_0, Z_0)
    blocks = plant_blocks(plant, rest, parts.friction(plant, sticky, F_s), stem, anti_surge, turbine)
    return wire([*feed, *blocks], name=name)


def plant_blocks(
    plant: Production, rest: Rest, F_s: Mapping[str, float], stem: str = "quasi_static",
    anti_surge: bool | str = True, turbine: str = "direct",
) -> list[Block]:  # fmt: skip
    """Return all blocks of the plant but its feed."""
    return [
        *parts.boundaries(plant),
        *parts.separator(plant, rest, 1, F_s, stem),
        *parts.separator(plant, rest, 2, F_s, stem),
        *parts.compressor(plant, rest, 3, F_s, stem, anti_surge=anti_surge),
        *parts.compressor(plant, rest, 2, F_s, stem, anti_surge=anti_surge),
        *parts.shaft(plant, rest, turbine=turbine),
    ]


def separator_1(set: str | Production = DEFAULT, F_s: float | str | Mapping[str, float | str] = "high") -> Diagram:
    """Return separator 1 alone with its loops; its surroundings stand still at their pressures.

    >>> separator_1().signals[:4]
    ('F_in', 'Z_I', 'p_2', 'p_in2')
    """
    plant = _set(set)
    rest = steady_state(plant)
    around = [Constant("p_2", rest.S2.p, unit="Pa"), Constant("p_in2", rest.C2.p_in, unit="Pa")]
    sticky = parts.friction(plant, ("VLCS1", "VPCS1"), F_s)
    crude = feeds.constant(plant.F_in, plant.Z_I)
    return wire([*crude, *around, *parts.separator(plant, rest, 1, sticky)], name="separator_1")


def compressor_2(set: str | Production = DEFAULT, *, anti_surge: bool | str = True) -> Diagram:
    """Return compressor 2 alone with anti-surge control, at constant speed; inputs open: ``m_G1`` [kg/s].

    >>> compressor_2().open_inputs
    ('m_G1',)
    """
    plant = _set(set)
    rest = steady_state(plant)
    around = [
        Constant("m_link", plant.fluids.W_met * rest.S2.F_G + plant.m_C4, unit="kg/s"),
        Constant("p_C1", plant.p_C1, unit="Pa"),
        Constant("w", rest.w, unit="rad/s"),
    ]
    blocks = parts.compressor(plant, rest, 2, {}, anti_surge=anti_surge)
    return wire([*around, *blocks], inputs=["m_G1"], name="compressor_2")


def turbine_and_shaft(set: str | Production = DEFAULT, *, turbine: str = "direct") -> Diagram:
    """Return the shaft alone with its speed control; inputs open: ``OP_VPCS2``, ``tau_2``, ``tau_3`` [N m].

    >>> turbine_and_shaft().open_inputs
    ('OP_VPCS2', 'tau_2', 'tau_3')
    """
    plant = _set(set)
    blocks = parts.shaft(plant, steady_state(plant), turbine=turbine)
    return wire(blocks, inputs=["OP_VPCS2", "tau_2", "tau_3"], name="shaft")


def kicked(plant: Diagram, gas: float = 1.019, liquid: float = 1.006) -> Diagram:
    """Return the plant with the gas and the liquid of separator 1 multiplied (default: the kick of the tables).

    >>> plant = production_plant()
    >>> round(float(kicked(plant)["S1"].x0[2] / plant["S1"].x0[2]), 3)
    1.019
    """
    N_oil, N_metL, N_metG = plant["S1"].x0
    return plant.starting_at({"S1.N_oil": liquid * N_oil, "S1.N_metL": liquid * N_metL, "S1.N_metG": gas * N_metG})


def _set(given: str | Production) -> Production:
    if isinstance(given, Production):
        return given
    if given not in SETS:
        raise WiringError(f"no parameter set '{given}'; {nearest(given, list(SETS))}; or give a Production")
    return SETS[given]
