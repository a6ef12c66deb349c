"""
A step test of a valve
======================

Deadband, resolution and response times from steps of OP in manual.
"""

import numpy as np
from stickslip.blocks import Recorded, StickSlip
from stickslip.detect.valve_test import analyse
from stickslip.diagram import drive
from stickslip.logs import LoopRecord

t = np.arange(960.0)
op = np.repeat(0.5 + 0.01 * np.cumsum([0, 2, 2, -1, -1, -2, 5, 5, -1, -2, -3, 2, 2, 5, -5, -8]), 60)
stem = drive(StickSlip(F_s=1000.0, F_c=600.0, start=0.5), 959.0, every=1.0, OP=Recorded("OP", t, op)).log["MV"]
test = analyse(LoopRecord.from_arrays(t, pv=100 * stem, op=100 * op, mv=100 * stem))
print(*test.words, sep="\n")
test.plot()
