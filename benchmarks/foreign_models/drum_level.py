"""The level of a drum, which answers the wrong way first: the model of ``benchmarks/foreign/drum_level.py``.

hold = integral of 0.25 (w - 0.5 - load);    20 d collapse/dt = 6 w - collapse;    L = hold - collapse
"""

from stickslip.blocks import (
    FirstOrder,
    Historian,
    IdealValve,
    Integrator,
    LeadLag,
    Noise,
    SampledPI,
    SampledSensor,
    Sum,
)
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [%] is open."""
    diagram = wire(
        [
            SampledPI(0.03, 250.0, dt=1.0, low=0.0, high=1.0, integral="present", T_t=1.0, start_op=0.5),
            IdealValve(),
            Noise("load", sd=0.03 * load_factor, dt=1.0, correlation_time=120.0, name="feed"),  # of full feedwater
            Sum("net", {"MV": 1.0, "load": -1.0}),
            Integrator(0.25, u_0=0.5, start=53.0, inputs="net", outputs="hold"),
            FirstOrder(6.0, 20.0, start=3.0, name="bubbles", outputs="collapse"),
            Sum("L", {"hold": 1.0, "collapse": -1.0}, name="drum"),
            LeadLag("felt", "L", 0.0, 3.0, start=50.0, name="element"),
            SampledSensor(1.0, sd=0.1 * noise_factor, low=0.0, high=100.0, start=50.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="drum_level",
    )
    return as_logged(diagram, bubbles="process", drum="process", element="sensor")
