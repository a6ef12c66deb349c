"""Models of the plant whose logs are to be compared with reality: all valves ideal, an unmeasured swing of the feed.

    separator_section   separator 1 with its level and pressure loops, surroundings standing still
    full_plant          two separators, two compressors, shaft and turbine

The feed's flow is a first-order autoregression about its design value that nobody measures; set points are sources,
which a log may know.
"""

from typing import TYPE_CHECKING

from stickslip.cases.case import Case

if TYPE_CHECKING:
    from collections.abc import Callable

    from stickslip.diagram.diagram import Diagram

FEED_SD, FEED_TIME, FEED_DT = 30.0, 120.0, 5.0  # mol/s, s, s
LOGGED_SECTION = ("SP_LCS11", "SP_PCS11", "p_1", "V_1", "OP_VLCS1", "OP_VPCS1")
LOGGED_PLANT = (
    *LOGGED_SECTION, "SP_LCS21", "SP_PCS21", "p_2", "V_2", "OP_VLCS2", "OP_VPCS2", "p_in2", "p_out2", "p_in3", "p_out3",
    "OP_VRVC2", "OP_VRVC3", "w", "tau_d",
)  # fmt: skip


def separator_section() -> "Diagram":
    """Return separator 1 with its loops and ideal valves, its feed swinging unmeasured.

    >>> separator_section()["F_in"].role, separator_section()["VPCS1"].modes
    (<Role.DISTURBANCE: 'disturbance'>, {})
    """
    from stickslip.plant.build import separator_1

    return _with_swing(_freed(separator_1()))


def full_plant() -> "Diagram":
    """Return the whole plant with ideal valves, its feed swinging unmeasured.

    >>> set(LOGGED_PLANT) <= set(full_plant().signals)
    True
    """
    from stickslip.plant import production_plant

    return _with_swing(_freed(production_plant(sticky=())))


def _freed(plant: "Diagram") -> "Diagram":
    """Return the plant with ideal valves in place of those that stick."""
    from stickslip.blocks import IdealValve

    for block in plant.blocks:
        if block.can_stick:
            plant = plant.replace(block.name, IdealValve.instead_of(block))
    return plant


def _with_swing(plant: "Diagram") -> "Diagram":
    from stickslip.blocks import Noise

    mean = plant["F_in"].params["value"]
    swing = Noise("F_in", FEED_SD, FEED_DT, correlation_time=FEED_TIME, mean=mean, unit="mol/s")
    return plant.replace("F_in", swing)


def _case(name: str, title: str, model: "Callable[[], Diagram]", signals: tuple[str, ...]) -> Case:
    about = "All valves ideal; the feed swings by 30 mol/s (standard deviation) with a time constant of 120 s."
    return Case(name, title, about, model, 3600.0, 2.0, tuple, signals)


CASES_BY_NAME = {
    case.name: case
    for case in (
        _case("separator_section", "Model of separator 1 with its loops", separator_section, LOGGED_SECTION),
        _case("full_plant", "Model of the whole plant", full_plant, LOGGED_PLANT),
    )
}
