"""A tank whose outflow goes with the root of its level, under a controller that scans or does not, and its records."""

import numpy as np
from stickslip.blocks import PI, Equations, IdealValve, Noise, SampledPI, SampledSensor, Staircase, Sum
from stickslip.diagram import Diagram, simulate, wire
from stickslip.diagram.inputs import close
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.start import start_values
from stickslip.logs import Log

LEVELS = (1.0, 1.06, 0.97, 1.1, 1.05, 0.95, 1.02)
DIGIT = 1e-4


def tank(scanned: bool = True, sd: float = 0.01, time: float = 100.0, noise: float = 0.004) -> Diagram:
    """Return the loop; its set point SP is open.  ``sd``, ``time`` [s] of the load, ``noise`` of the sensor."""
    if scanned:
        controller = SampledPI(2.0, 120.0, dt=2.0, start_op=0.5, inputs=["SP", "PV"])
    else:
        controller = PI(2.0, 120.0, start_op=0.5, inputs=["SP", "PV"])
    return wire(
        [
            controller,
            IdealValve(inputs="OP", outputs="MV"),
            Noise("load", sd=sd, dt=1.0, correlation_time=time, name="feed"),
            Sum("F", {"MV": 1.0, "load": 1.0}, name="inflow"),
            Equations(
                "tank", der=lambda h, F, A, k: (F - k * max(h, 1e-9) ** 0.5) / A, states={"h": 1.0},
                params={"A": 60.0, "k": 0.5}, inputs="F",
            ),
            SampledSensor(dt=1.0, sd=noise, start=1.0, inputs="h", outputs="PV"),
        ],
        inputs=["SP"],
    )  # fmt: skip


def logged(model: Diagram, seed: int, every: float = 5.0, duration: float = 5400.0) -> Log:
    """Return a log of the model's own run, its noise drawn by a seed."""
    at = np.linspace(0.0, duration, len(LEVELS), endpoint=False)
    closed = close(model, {"SP": Staircase("SP", at=at, levels=LEVELS)})
    for k, name in enumerate(("feed", "sensor")):
        closed = closed.replace(name, closed[name].reseeded([seed, k]))
    run = simulate(closed, duration, every=every)
    return Log(run.log.t, {s: np.round(run.log[s] / DIGIT) * DIGIT for s in ("SP", "PV", "OP")})


def framed(model: Diagram, log: Log) -> Frame:
    """Return what hypotheses of a log share."""
    opened, record = read(model, log)
    return Frame(Given(opened.starting_at(start_values(silenced(opened), record))), record)
