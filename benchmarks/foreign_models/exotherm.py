"""A reaction that gives heat in a cooled tank: the model of ``benchmarks/foreign/exotherm.py``, OP and MV in %."""

import math

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _reactor(c: float, T: float, MV: float, load: float, K: float, tau: float) -> tuple[float, float]:
    r = c * math.exp(8000.0 * (1.0 / 350.0 - 1.0 / T))
    return (1.0 - c - r) / tau, (340.0 + load - T + 50.0 * r - K * 0.01 * MV * (T - 290.0)) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [K] is open.

    The process calls the residence time ``tau`` [s] and the cooling of the open valve ``K`` [-].
    """
    diagram = wire(
        [
            SampledPI(
                15.0, 500.0, dt=1.0, low=0.0, high=100.0, action="direct", integral="present", T_t=1.0, start_op=41.7
            ),
            IdealValve(),
            Noise("load", sd=0.7 * load_factor, dt=1.0, correlation_time=300.0, name="feed"),  # [K]
            Equations(
                "process",
                der=_reactor,
                out=lambda T: T,
                states={"c": 0.5, "T": 350.0},
                inputs=["MV", "load"],
                outputs="T_out",
                params={"K": 0.6, "tau": 600.0},
            ),
            LeadLag("felt", "T_out", 0.0, 8.0, start=350.0, name="element"),
            SampledSensor(1.0, sd=0.06 * noise_factor, low=300.0, high=400.0, start=350.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="exotherm",
    )
    return as_logged(diagram, element="sensor")
