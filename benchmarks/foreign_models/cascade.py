"""A temperature controller sets the flow of hot oil: the model of ``benchmarks/foreign/cascade.py``.

The sensor of the temperature is read every 2 s here: of the values that the sheet has every 0.5 s, its controller uses
and logs only these.  The load of the vessel enters behind its dead time in the sheet and before it here.
"""

import math

from stickslip.blocks import Equations, FirstOrder, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _pipe(q: float, MV: float, load_p: float, K: float, tau: float) -> float:
    return (K * MV * math.sqrt(max(0.0, 1.0 + load_p - (q / 14.0) ** 2)) - q) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the cascade; the set point ``SP_T`` [degC] of its outer loop is open."""
    diagram = wire(
        [
            SampledPI(
                0.25,
                110.0,
                dt=2.0,
                low=0.0,
                high=10.0,
                integral="present",
                T_t=2.0,
                start_op=5.0,
                name="temperature_controller",
                inputs=["SP_T", "PV_T"],
                outputs="SP_F",
            ),
            SampledPI(
                0.05,
                2.0,
                dt=0.5,
                low=0.0,
                high=1.0,
                integral="present",
                T_t=0.5,
                start_op=0.54,
                name="flow_controller",
                inputs=["SP_F", "PV_F"],
            ),
            IdealValve(),
            Noise("load_p", sd=0.03 * load_factor, dt=1.0, correlation_time=40.0, name="feed_pipe"),
            Equations("pipe", der=_pipe, states={"q": 5.0}, inputs=["MV", "load_p"], params={"K": 10.0, "tau": 1.5}),
            LeadLag("felt_F", "q", 0.0, 0.2, start=5.0, name="flow_element"),
            SampledSensor(0.5, sd=0.04 * noise_factor, start=5.0, name="flow_sensor", inputs="felt_F", outputs="PV_F"),
            Noise("load_T", sd=0.5 * load_factor, dt=1.0, correlation_time=200.0, name="feed_vessel"),  # [degC]
            Sum("heat", {"q": 1.0, "load_T": 1.0 / 7.0}),
            FirstOrder(7.0, 120.0, 10.0, start=35.0, name="vessel", inputs="heat", outputs="rise"),
            Sum("T", {"rise": 1.0}, offset=25.0, name="inlet"),
            LeadLag("felt_T", "T", 0.0, 4.0, start=60.0, name="temperature_element"),
            SampledSensor(
                2.0, sd=0.05 * noise_factor, start=60.0, name="temperature_sensor", inputs="felt_T", outputs="PV_T"
            ),
            Historian(["SP_T", "PV_T", "SP_F", "PV_F", "OP"]),
        ],
        inputs=["SP_T"],
        name="cascade",
    )
    return as_logged(diagram, inlet="vessel", flow_element="flow_sensor", temperature_element="temperature_sensor")
