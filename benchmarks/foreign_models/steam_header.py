"""A steam header whose let-down valve chokes: the model of ``benchmarks/foreign/steam_header.py``, OP and MV in %."""

import math

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _header(p: float, Tw: float, MV: float, load: float, K: float, tau: float) -> tuple[float, float]:
    x = max(0.0, p - 6.0) / 6.0  # beyond the pressure below which the valve chokes
    g = math.sqrt(max(0.0, 1.0 - x * x))
    Ts = 100.0 * max(p, 0.0) ** 0.25
    q = 0.09 * (Ts - Tw)
    return (K * MV * g - q - load) / tau, (Ts - Tw - 0.5 * (Tw - 60.0)) / 20.0


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [bar] is open.

    The process calls the choked flow of the valve per % ``K`` [kg/s] and the capacity of the header ``tau`` [kg/bar].
    """
    diagram = wire(
        [
            SampledPI(12.0, 8.0, dt=0.2, low=0.0, high=100.0, integral="present", T_t=0.2, start_op=62.5),
            LeadLag("positioned", "OP", 0.0, 0.4, start=62.5, name="positioner"),
            IdealValve(inputs="positioned"),
            Noise("load", sd=0.12 * load_factor, dt=1.0, correlation_time=15.0, name="feed"),  # [kg/s]
            Equations(
                "process",
                der=_header,
                out=lambda p: p,
                states={"p": 7.0, "Tw": 128.4},
                inputs=["MV", "load"],
                outputs="p_header",
                params={"K": 0.05, "tau": 3.0},
            ),
            LeadLag("felt", "p_header", 0.0, 0.3, start=7.0, name="element"),
            SampledSensor(0.2, sd=0.012 * noise_factor, low=0.0, high=12.0, start=7.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="steam_header",
    )
    return as_logged(diagram, positioner="valve", element="sensor")
