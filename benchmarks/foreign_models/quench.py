"""A spray quenches hot gas: the model of ``benchmarks/foreign/quench.py``, OP and MV in %, MV is the opening.

The filter of the error stands before the controller: ``heard`` is the PV that a controller without it would see.
"""

import math

from stickslip.blocks import (
    DeadTime,
    Equations,
    Historian,
    IdealValve,
    LeadLag,
    Noise,
    SampledFilter,
    SampledPI,
    SampledSensor,
    Sum,
)
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged

_FILTER_S = -1.0 / math.log(1.0 - 1.0 / (3.0 + 1.0))  # 1 - exp(-h/tau) of the block is h/(T_f + h) of the sheet


def _gas(T: float, late: float, load: float, K: float, tau: float) -> float:
    u = min(1.0, max(0.0, (T - 60.0) / 200.0))
    E = 1.0 - (1.0 - u) ** 1.5
    return (400.0 + load - T - K * late * E) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [degC] is open.

    The process calls what 1 % of the water cools if all of it evaporates ``K`` [degC], and its time constant ``tau``.
    """
    diagram = wire(
        [
            Sum("e", {"SP": 1.0, "PV": -1.0}, name="comparator"),
            SampledFilter("e_f", "e", _FILTER_S, 1.0, name="filter"),
            Sum("heard", {"SP": 1.0, "e_f": -1.0}, name="filtered"),
            SampledPI(
                0.2,
                10.0,
                dt=1.0,
                low=0.0,
                high=100.0,
                integral="present",
                T_t=1.0,
                start_op=46.8,
                inputs=["SP", "heard"],
            ),
            Sum("wanted", {"OP": -1.0}, offset=100.0, name="air_to_close"),
            LeadLag("positioned", "wanted", 0.0, 1.0, start=53.2, name="positioner"),
            IdealValve(inputs="positioned"),
            DeadTime(3.0, start=53.2, name="lance", inputs="MV", outputs="late"),
            Noise("load", sd=5.0 * load_factor, dt=1.0, correlation_time=60.0, name="feed"),  # [degC]
            Equations("process", der=_gas, states={"T": 200.0}, inputs=["late", "load"], params={"K": 4.5, "tau": 8.0}),
            LeadLag("felt", "T", 0.0, 4.0, start=200.0, name="element"),
            SampledSensor(1.0, sd=0.6 * noise_factor, low=0.0, high=500.0, start=200.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="quench",
    )
    return as_logged(
        diagram,
        comparator="controller",
        filter="controller",
        filtered="controller",
        air_to_close="valve",
        positioner="valve",
        lance="process",
        element="sensor",
    )
