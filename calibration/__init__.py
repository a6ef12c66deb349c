"""Simulated loop records whose cause is known, to calibrate and to test the verdict on.

draw       plain numbers that make a loop and its data (``LoopSpec``), reproducible by seed
simulate   the records of such specs and what is true of them (``Truth``), many at once
at_record  simulates under the conditions of one record, and says what that tells of its valve
"""

from stickslip.calibration.by_simulation import AtRecord, at_record
from stickslip.calibration.drawing import draw
from stickslip.calibration.simulation import simulate
from stickslip.calibration.spec import CAUSES, LoopSpec, Truth

__all__ = ["CAUSES", "AtRecord", "LoopSpec", "Truth", "at_record", "draw", "simulate"]
