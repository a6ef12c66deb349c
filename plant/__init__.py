"""The offshore production plant of the thesis: two separators, two compressors on one shaft, sticky valves.

production_plant   the whole plant, wired by names, at rest       parts        what it is made of, to use alone
SETS               the parameter sets A, B, C and E                steady_state where it rests for a given feed
"""

from stickslip.plant.build import kicked, production_plant
from stickslip.plant.parameters import SET_A, SET_B, SET_C, SET_E, SETS, Production
from stickslip.plant.rest import InfeasibleFeed, Rest, steady_state

__all__ = [
    "SETS",
    "SET_A",
    "SET_B",
    "SET_C",
    "SET_E",
    "InfeasibleFeed",
    "Production",
    "Rest",
    "kicked",
    "production_plant",
    "steady_state",
]
