"""A tank with a hole under an analogue PI: the model of ``benchmarks/foreign/sqrt_tank.py``, OP and MV in %.

The tank is written as ``Equations``: a block ``Tank`` gives its overflow, which follows the inflow at once, and is
refused in a level loop as an algebraic loop.
"""

import math

from stickslip.blocks import PI, Equations, Historian, IdealValve, Noise, SampledSensor, Sum
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _tank(h: float, inflow: float, outlet: float, tau: float) -> float:
    return (inflow - outlet * math.sqrt(max(h, 0.0))) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [m] is open.  The process calls its area ``tau`` [m2]."""
    diagram = wire(
        [
            PI(120.0, 80.0, low=0.0, high=100.0, T_t=0.05, start_op=50.0),  # the integral follows at once
            IdealValve(),
            Noise("load", sd=0.0008 * load_factor, dt=1.0, correlation_time=120.0, name="feed"),  # [m3/s]
            Sum("inflow", {"MV": 0.0004, "load": 1.0}),
            Equations("process", der=_tank, states={"h": 1.0}, inputs=["inflow"], params={"outlet": 0.02, "tau": 2.0}),
            SampledSensor(0.5, sd=0.003 * noise_factor, low=0.0, high=2.0, start=1.0, inputs="h", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="sqrt_tank",
    )
    return as_logged(diagram)
