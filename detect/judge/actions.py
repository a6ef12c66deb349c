"""The action for each cause, who takes it, and the test that confirms the cause; its steps follow from the size."""

from collections.abc import Mapping
from dataclasses import dataclass

from stickslip.logs.two_digits import rounded


@dataclass(frozen=True)
class Doing:
    """One cause in words: how it is called, what is done, by whom, and what confirms it, empty if nothing is needed."""

    spoken: str
    action: str
    owner: str
    test: str


STEPS = (
    "put the loop in manual, move OP by {start:g} {unit} one way, or less if PV follows, then back in {count} steps "
    "of {step:g} {unit}. After each wait until PV, or the slope of a level, is steady, and move OP back before PV "
    "leaves its limits. A sticky valve answers none of the first steps and then jumps"
)
MANUAL = (
    "put the loop in manual for a few periods: a wave that goes was the loop's own, one that stays comes from outside"
)

CAUSES: Mapping[str, Doing] = {
    "stiction": Doing(
        "a sticky valve",
        "Look at packing, actuator, air supply and positioner of the valve; half the gain or twice the integral time "
        "can make the wave larger", "valve maintenance", STEPS,
    ),
    "tight_tuning": Doing(
        "tight tuning", "Lower the gain of the controller by a third, or double its integral time",
        "control engineer",
        "halve the gain for ten periods: a wave of tight tuning dies out, that of a sticky valve stays or grows",
    ),
    "external_oscillation": Doing(
        "an oscillation from outside", "Look for the wave upstream: which loop has it first, and with most harmonics",
        "process engineer", MANUAL,
    ),
    "sensor": Doing(
        "a coarse or faulty measurement", "Look at resolution, range and filter of the transmitter and its input card",
        "instrument technician", "compare with the local reading, and log raw values",
    ),
    "saturation": Doing(
        "OP at a limit", "Look at the size of the valve, at bypasses, and at the limits of OP", "process engineer",
        "log a stretch with OP away from its limits",
    ),
    "deadband": Doing(
        "a deadband without jump", "Look at linkage, gear and positioner of the valve for play", "valve maintenance",
        STEPS,
    ),
    "dead_loop": Doing(
        "a PV that does not answer OP", "Look for a closed block valve, a bypass, or the wrong tags", "operations",
        "move OP in manual by 5 % and see whether PV answers at all",
    ),
    "cascade_slave": Doing(
        "a master that moves the set point", "Judge and tune the master loop; this one follows it", "control engineer",
        "open the cascade for ten periods: the wave stops if the master makes it",
    ),
    "drift": Doing(
        "a load that drifts", "Nothing at the valve: OP goes one way with the load", "operations",
        "log until OP has turned back several times",
    ),
    "healthy": Doing("a loop that does its work", "Nothing needs to be done", "", ""),
}  # fmt: skip
"""By cause, as in ``calibration.CAUSES``; a test holds one list to the other."""


def confirming_steps(cause: str, S: float, unit: str) -> str:
    """The confirming test for a cause, with steps of a quarter of S, up to 1.5 S; empty if none is needed.

    >>> confirming_steps("stiction", 4.0, "% of OP")[:60]
    'put the loop in manual, move OP by 8 % one way, or less if P'
    """
    unit = unit.removesuffix(" of OP")  # it is OP that is moved
    return CAUSES[cause].test.format(start=rounded(2.0 * S), step=rounded(0.25 * S), count=6, unit=unit)
