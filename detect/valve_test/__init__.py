"""Step tests of control valves after ANSI/ISA-75.25.01: deadband, resolution and step response."""

from stickslip.detect.valve_test.analysis import Size, StepResponse, ValveTest, analyse

__all__ = ["Size", "StepResponse", "ValveTest", "analyse"]
