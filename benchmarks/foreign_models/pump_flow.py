"""A pump and an equal-percentage valve: the model of ``benchmarks/foreign/pump_flow.py``, OP and MV in %."""

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _pipe(Q: float, MV: float, load: float, K: float, tau: float) -> float:
    f = 40.0 ** (0.01 * MV - 1.0)
    return (60.0 - 0.002 * Q * Q - (15.0 + load) - (Q / (K * f)) ** 2) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [m3/h] is open.

    The process calls the flow coefficient ``K`` [m3/h per root m] and the inertia ``tau`` [m s h/m3]; it has the body
    of the valve in it, so a factor of ``K`` is one of f.
    """
    diagram = wire(
        [
            SampledPI(0.2, 3.0, dt=1.0, low=0.0, high=100.0, integral="present", T_t=1.0, start_op=74.0),
            LeadLag("p", "OP", 0.0, 1.2, start=74.0, name="positioner"),
            IdealValve(inputs="p"),
            Noise("load", sd=0.5 * load_factor, dt=1.0, correlation_time=60.0, name="feed"),  # [m]
            Equations("process", der=_pipe, states={"Q": 48.0}, inputs=["MV", "load"], params={"K": 20.0, "tau": 3.0}),
            LeadLag("felt", "Q", 0.0, 0.5, start=48.0, name="element"),
            SampledSensor(1.0, sd=0.25 * noise_factor, low=0.0, high=120.0, start=48.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="pump_flow",
    )
    return as_logged(diagram, positioner="valve", element="sensor")
