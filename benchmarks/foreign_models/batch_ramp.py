"""A reactor heated along a programme: the model of ``benchmarks/foreign/batch_ramp.py``."""

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _reactor(T: float, MV: float, load: float, K: float, tau: float) -> float:
    return K * MV * (140.0 - T) - (T - 20.0) / tau + load


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [degC] is open.

    The process calls what steam gives ``K`` [1/s], and the time constant of what is lost ``tau`` [s].
    """
    diagram = wire(
        [
            SampledPI(0.05, 900.0, dt=5.0, low=0.0, high=1.0, integral="present", T_t=5.0, start_op=0.05),
            IdealValve(),
            Noise("load", sd=0.0006 * load_factor, dt=1.0, correlation_time=600.0, name="feed"),  # [degC/s]
            Equations(
                "process",
                der=_reactor,
                states={"T": 50.0},
                inputs=["MV", "load"],
                params={"K": 1.0 / 900.0, "tau": 6000.0},
            ),
            LeadLag("felt", "T", 0.0, 30.0, start=50.0, name="element"),
            SampledSensor(5.0, sd=0.05 * noise_factor, low=0.0, high=150.0, start=50.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="batch_ramp",
    )
    return as_logged(diagram, element="sensor")
