"""The remedies, one a file: what is set, by which rule, when not.

knocker  reinforcement  two_moves      between controller and valve
integral_zone  error_gap               in the controller
half_gain  slower_integral  detuned    by its tuning
positioner  repair                     at the valve, at a shutdown
"""

from stickslip.remedy.measures import (
    detuned,
    error_gap,
    half_gain,
    integral_zone,
    knocker,
    positioner,
    reinforcement,
    repair,
    slower_integral,
    two_moves,
)  # fmt: skip

REMEDIES = (
    knocker, reinforcement, two_moves, integral_zone, error_gap, half_gain, slower_integral, detuned, positioner, repair
)  # fmt: skip

__all__ = ["REMEDIES"]
