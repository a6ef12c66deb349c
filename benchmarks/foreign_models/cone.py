"""A cone drained through its control valve: the model of ``benchmarks/foreign/cone.py``, OP and MV in %.

At a limit the integral of the sheet stands still whatever the error; the one of the block goes on if the error points
inwards.
"""

import math

from stickslip.blocks import Equations, Historian, IdealValve, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _cone(h: float, MV: float, load: float, K: float, tau: float) -> float:
    level = max(h, 0.01)
    return (0.02 + load - K * 0.01 * MV * math.sqrt(level)) / (tau * level * level)


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [m] is open.

    The process calls the outflow of the open valve at 1 m ``K`` [m3/s] and the area at 1 m ``tau`` [m2].
    """
    diagram = wire(
        [
            SampledPI(
                40.0,
                300.0,
                dt=2.0,
                low=0.0,
                high=100.0,
                action="direct",
                anti_windup="conditional",
                integral="present",
                start_op=51.0,
            ),
            IdealValve(),
            Noise("load", sd=0.0006 * load_factor, dt=1.0, correlation_time=400.0, name="feed"),  # [m3/s]
            Equations(
                "process",
                der=_cone,
                states={"h": 1.7},
                inputs=["MV", "load"],
                params={"K": 0.03, "tau": math.pi * 0.16},
            ),
            SampledSensor(2.0, sd=0.004 * noise_factor, low=0.0, high=3.0, start=1.7, inputs="h", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="cone",
    )
    return as_logged(diagram)
