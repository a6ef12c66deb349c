"""Gas in a drum behind a choked vent valve: the model of ``benchmarks/foreign/gas_pressure.py``."""

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _drum(p: float, MV: float, load: float, K: float, tau: float) -> float:
    return (3.0 + load - K * p * MV) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [bar] is open.

    The process calls the valve's coefficient ``K`` [kg/(s bar)] and the drum's capacity ``tau`` [kg/bar].
    """
    diagram = wire(
        [
            SampledPI(
                0.25, 12.0, dt=0.5, low=0.0, high=1.0, action="direct", integral="present", T_t=0.5, start_op=0.5
            ),
            IdealValve(),
            Noise("load", sd=0.06 * load_factor, dt=1.0, correlation_time=40.0, name="feed"),  # [kg/s]
            Equations("process", der=_drum, states={"p": 10.0}, inputs=["MV", "load"], params={"K": 0.6, "tau": 4.0}),
            LeadLag("felt", "p", 0.0, 0.3, start=10.0, name="element"),
            SampledSensor(0.5, sd=0.008 * noise_factor, low=0.0, high=20.0, start=10.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="gas_pressure",
    )
    return as_logged(diagram, element="sensor")
