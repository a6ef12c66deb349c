"""Loops that can be solved exactly, without a simulator: what the engine is checked against."""

from stickslip.cases.exact.closed_form import (
    closed_form_R,
    cycle_period,
    oscillating_references,
    symmetric_error,
    symmetric_start,
)
from stickslip.cases.exact.ideal_loop import ExactRun, StemEvent, exact_run
from stickslip.cases.exact.parameters import (
    IDEAL_HALF_GAIN,
    IDEAL_HIGH,
    IDEAL_NORMAL,
    INTEGRATOR_HIGH,
    ExactLoop,
    ExactLoopError,
)

__all__ = [
    "IDEAL_HALF_GAIN",
    "IDEAL_HIGH",
    "IDEAL_NORMAL",
    "INTEGRATOR_HIGH",
    "ExactLoop",
    "ExactLoopError",
    "ExactRun",
    "StemEvent",
    "closed_form_R",
    "cycle_period",
    "exact_run",
    "oscillating_references",
    "symmetric_error",
    "symmetric_start",
]
