"""Steam heats the air of a belt dryer: the model of ``benchmarks/foreign/belt_dryer.py``."""

from stickslip.blocks import (
    DeadTime,
    Equations,
    FirstOrder,
    Historian,
    IdealValve,
    LeadLag,
    Noise,
    SampledPI,
    SampledSensor,
    Sum,
)
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _zones(X1: float, X2: float, X3: float, T: float, load: float, K: float, tau: float) -> tuple[float, float, float]:
    r = K * max(0.0, T - 40.0)
    return (40.0 + load - X1 - r * X1) / tau, (X1 - X2 - r * X2) / tau, (X2 - X3 - r * X3) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [%] is open.

    The belt calls what dries per degree ``K`` [1/K] and the time in a zone ``tau`` [s].
    """
    diagram = wire(
        [
            SampledPI(
                0.02, 240.0, dt=6.0, low=0.1, high=0.9, action="direct", integral="present", T_t=6.0, start_op=0.455
            ),
            IdealValve(),
            FirstOrder(130.0, 120.0, start=59.1, name="coil", outputs="rise"),
            Sum("T", {"rise": 1.0}, offset=25.0, name="inlet"),
            Noise("load", sd=0.8 * load_factor, dt=1.0, correlation_time=400.0, name="feed"),  # [%]
            Equations(
                "belt",
                der=_zones,
                out=lambda X3: X3,
                states={"X1": 21.25, "X2": 11.29, "X3": 6.0},
                inputs=["T", "load"],
                outputs="dried",
                params={"K": 0.02, "tau": 80.0},
            ),
            DeadTime(60.0, start=6.0, name="transport", inputs="dried", outputs="X"),
            LeadLag("felt", "X", 0.0, 15.0, start=6.0, name="element"),
            SampledSensor(6.0, sd=0.05 * noise_factor, low=0.0, high=20.0, start=6.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="belt_dryer",
    )
    return as_logged(diagram, inlet="coil", transport="belt", element="sensor")
