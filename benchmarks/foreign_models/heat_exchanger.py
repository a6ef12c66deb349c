"""Steam heats a stream: the model of ``benchmarks/foreign/heat_exchanger.py``, OP and MV in %.

The load enters behind the dead time in the sheet and before it here: for a load that nobody measures both are the same.
"""

from stickslip.blocks import FirstOrder, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [degC] is open."""
    diagram = wire(
        [
            SampledPI(0.8, 45.0, dt=1.0, low=0.0, high=100.0, integral="present", T_t=1.0, start_op=50.0),
            IdealValve(),  # OP -> MV [%]
            Noise("load", sd=0.6 * load_factor, dt=1.0, correlation_time=180.0, name="feed"),  # [degC]
            Sum("heat", {"MV": 1.0, "load": 1.0 / 0.8}),
            FirstOrder(0.8, 40.0, 12.0, start=40.0, inputs="heat", outputs="rise"),
            Sum("T", {"rise": 1.0}, offset=20.0, name="inlet"),
            LeadLag("felt", "T", 0.0, 6.0, start=60.0, name="element"),
            SampledSensor(1.0, sd=0.08 * noise_factor, low=0.0, high=120.0, start=60.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="heat_exchanger",
    )
    return as_logged(diagram, inlet="process", element="sensor")
