"""Flow of B in a ratio to a wild flow: the model of ``benchmarks/foreign/ratio_feedforward.py``.

No block has a feedforward within its limits and its anti-windup, so the sum is limited behind the controller here, and
the integral does not follow it there.  SP, which the ratio station gives, is an open input; what SP did between two
rows (the noise of A's meter is in it) nobody knows.
"""

import math

from stickslip.blocks import (
    Equations,
    Gain,
    Historian,
    IdealValve,
    LeadLag,
    Noise,
    SampledPI,
    SampledSensor,
    Saturation,
    Sum,
)
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _pipe(q: float, MV: float, load: float, K: float, tau: float) -> float:
    return (K * MV * math.sqrt(max(0.0, 1.0 + load - (q / 90.0) ** 2)) - q) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [kg/s] is open."""
    diagram = wire(
        [
            SampledPI(
                0.006,
                3.0,
                dt=1.0,
                low=-1.0,
                high=1.0,
                integral="present",
                T_t=1.0,
                start_op=0.08,
                outputs="trim",
            ),
            Gain("forward", "SP", 0.9 / 60.0),
            Sum("wanted", {"trim": 1.0, "forward": 1.0}),
            Saturation("OP", "wanted", 0.0, 1.0),
            IdealValve(),
            Noise("load", sd=0.02 * load_factor, dt=1.0, correlation_time=30.0, name="feed"),
            Equations("process", der=_pipe, states={"q": 30.0}, inputs=["MV", "load"], params={"K": 60.0, "tau": 3.0}),
            LeadLag("felt", "q", 0.0, 0.5, start=30.0, name="element"),
            SampledSensor(1.0, sd=0.15 * noise_factor, low=0.0, high=80.0, start=30.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="ratio_feedforward",
    )
    return as_logged(diagram, forward="controller", wanted="controller", element="sensor")
