"""A small study of the integrating loop, which several tests look at from different sides."""

from stickslip.plant.loops import integrating_loop
from stickslip.study import study

GRID = {"valve.F_s": [1750.0, 2000.0, 2250.0], "controller.K_p": [0.1, 0.2, 0.4]}
OPTIONS = {"start": {"process.PV": [0.5]}, "kicks": 2, "duration": 400.0, "every": 1.0, "progress": False}


def small(**changes):
    return study(integrating_loop(), GRID, **{**OPTIONS, **changes})
