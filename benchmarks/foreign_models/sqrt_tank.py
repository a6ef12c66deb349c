"""A tank with a hole under an analogue PI: the model of ``benchmarks/foreign/sqrt_tank.py``, OP and MV in %."""

from blocks import PI, Historian, IdealValve, Noise, SampledSensor, Sum, Tank
from diagram import Diagram, wire


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Diagram:
    """Return the loop; its set point ``SP`` [m] is open."""
    return wire(
        [
            PI(120.0, 80.0, low=0.0, high=100.0, start_op=50.0),
            IdealValve(),
            Noise("load", sd=0.0008 * load_factor, dt=1.0, correlation_time=120.0, name="feed"),  # [m3/s]
            Sum("inflow", {"MV": 0.0004, "load": 1.0}),
            Tank(2.0, 0.02, start=1.0, name="process", inputs="inflow", outputs={"h": "h"}),
            SampledSensor(0.5, sd=0.003 * noise_factor, low=0.0, high=2.0, start=1.0, inputs="h", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="sqrt_tank",
    )
