"""Gas packed in a pipeline of two halves: the model of ``benchmarks/foreign/pipeline_pack.py``."""

import math

from stickslip.blocks import Equations, Historian, IdealValve, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _parabolic(MV: float) -> float:
    return MV * MV


def _pipeline(p1: float, p2: float, f: float, load: float, K: float, tau: float) -> tuple[float, float]:
    w_in = K * f * math.sqrt(max(0.0, 3600.0 - p1 * p1))
    w = 0.6 * math.sqrt(max(0.0, p1 * p1 - p2 * p2))
    return (w_in - w) / (0.4 * tau), (w - 12.0 - load) / (0.6 * tau)


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [bar] is open.

    The process calls the coefficient of the inlet valve ``K`` [kg/(s bar)] and the capacity of both halves ``tau``
    [kg/bar], of which two fifths are the first half's.
    """
    diagram = wire(
        [
            SampledPI(0.05, 1200.0, dt=8.0, low=0.0, high=1.0, integral="present", T_t=8.0, start_op=0.707),
            IdealValve(),
            Equations("trim", out=_parabolic, inputs=["MV"], outputs="f"),
            Noise("load", sd=0.6 * load_factor, dt=1.0, correlation_time=600.0, name="feed"),  # [kg/s]
            Equations(
                "process",
                der=_pipeline,
                out=lambda p2: p2,
                states={"p1": 44.72, "p2": 40.0},
                inputs=["f", "load"],
                outputs="p",
                params={"K": 0.6, "tau": 500.0},
            ),
            SampledSensor(8.0, sd=0.03 * noise_factor, low=0.0, high=80.0, start=40.0, inputs="p", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="pipeline_pack",
    )
    return as_logged(diagram, trim="valve")
