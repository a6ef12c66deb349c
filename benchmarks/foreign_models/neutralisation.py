"""Base holds the pH of an acid stream: the model of ``benchmarks/foreign/neutralisation.py``."""

import math

from stickslip.blocks import Equations, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged

_K_A, _K_W = 10.0**-6.35, 1e-14


def _mixed(W: float, B: float, MV: float, load: float, tau: float) -> tuple[float, float]:
    base = 2.4 * MV
    return (6.0 * (load - 0.02) + 0.1 * base - (6.0 + base) * W) / tau, (0.03 - (6.0 + base) * B) / tau


def _pH(W: float, B: float) -> float:
    """Return the pH at which charges balance: Newton's method, at most 1 a step."""
    pH = 7.0
    for _ in range(30):
        H = 10.0**-pH
        excess = W + H - _K_W / H - B * _K_A / (_K_A + H)
        slope = math.log(10.0) * (H + _K_W / H + B * _K_A * H / (_K_A + H) ** 2)
        pH += min(1.0, max(-1.0, excess / slope))
    return pH


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return the loop; its set point ``SP`` [pH] is open.  The process calls the tank's volume ``tau`` [L]."""
    diagram = wire(
        [
            SampledPI(0.04, 60.0, dt=2.0, low=0.0, high=1.0, integral="present", T_t=2.0, start_op=0.56),
            IdealValve(),
            Noise("load", sd=0.0002 * load_factor, dt=1.0, correlation_time=240.0, name="feed"),  # [mol/L]
            Equations(
                "process",
                der=_mixed,
                out=_pH,
                states={"W": 0.00204, "B": 0.00408},
                inputs=["MV", "load"],
                outputs="pH",
                params={"tau": 600.0},
            ),
            LeadLag("felt", "pH", 0.0, 5.0, start=6.35, name="element"),
            SampledSensor(2.0, sd=0.01 * noise_factor, low=0.0, high=14.0, start=6.35, inputs="felt", outputs="PV"),
            Historian(["SP", "PV", "OP"]),
        ],
        inputs=["SP"],
        name="neutralisation",
    )
    return as_logged(diagram, element="sensor")
