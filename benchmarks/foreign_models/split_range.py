"""Cooling with one half of OP and heating with the other: the model of ``benchmarks/foreign/split_range.py``, in %."""

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Lookup1D, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def _vessel(T: float, heating: float, cooling: float, load: float, tau: float) -> float:
    return (0.9 * heating - 0.012 * cooling * (T - 15.0) - 0.5 * (T - 25.0) + 20.0 + load) / tau


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [degC] is open.  The process calls its heat capacity ``tau``."""
    diagram = wire(
        [
            SampledPI(4.0, 250.0, dt=1.0, low=0.0, high=100.0, integral="present", T_t=1.0, start_op=50.0),
            Lookup1D("to_cooling", "OP", [0.0, 50.0], [100.0, 0.0]),
            Lookup1D("to_heating", "OP", [50.0, 100.0], [0.0, 100.0]),
            IdealValve(name="cooling_valve", inputs="to_cooling", outputs="cooling"),
            IdealValve(name="heating_valve", inputs="to_heating", outputs="heating"),
            Noise("load", sd=1.5 * load_factor, dt=1.0, correlation_time=300.0, name="feed"),  # unit of heat
            Equations(
                "process",
                der=_vessel,
                states={"T": 65.0},
                inputs=["heating", "cooling", "load"],
                params={"tau": 400.0},
            ),
            LeadLag("felt", "T", 0.0, 15.0, start=65.0, name="element"),
            SampledSensor(1.0, sd=0.05 * noise_factor, low=0.0, high=150.0, start=65.0, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="split_range",
    )
    return as_logged(diagram, element="sensor")
