"""Recycle of a compressor: the model of ``benchmarks/foreign/recycle.py``, OP and MV in %."""

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _compressor(p: float, m: float, MV: float, load: float, K: float, tau: float) -> tuple[float, float]:
    return (11.0 + load + K * MV - m) / tau, (p * (3.6 - 0.004 * m * m) - 8.0) / 0.2


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [kg/s] is open.

    The process calls the flow of the recycle valve per % ``K`` [kg/s] and the capacity of the drum ``tau`` [kg/bar].
    """
    diagram = wire(
        [
            SampledPI(5.0, 4.0, dt=0.25, low=0.0, high=100.0, integral="present", T_t=0.25, start_op=50.0),
            LeadLag("positioned", "OP", 0.0, 0.6, start=50.0, name="positioner"),
            IdealValve(inputs="positioned"),
            Noise("load", sd=0.15 * load_factor, dt=1.0, correlation_time=60.0, name="feed"),  # [kg/s]
            Equations(
                "process",
                der=_compressor,
                states={"p": 2.963, "m": 15.0},
                inputs=["MV", "load"],
                params={"K": 0.08, "tau": 40.0},
            ),
            LeadLag("felt", "m", 0.0, 0.4, start=15.0, name="element"),
            SampledSensor(0.25, sd=0.08 * noise_factor, start=15.0, inputs="felt", outputs="PV"),
            LeadLag("felt_p", "p", 0.0, 0.2, start=2.963, name="suction_element"),
            SampledSensor(
                0.25, sd=0.004 * noise_factor, start=2.963, name="suction_sensor", inputs="felt_p", outputs="PS"
            ),
            Historian(["SP", "PV", "PS", "OP"]),
        ],
        inputs=["SP"],
        name="recycle",
    )
    return as_logged(diagram, positioner="valve", element="sensor", suction_element="suction_sensor")
