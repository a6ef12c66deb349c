"""
A verdict
=========

The trends, PV against OP, and the half cycles of the control error.
"""

import stickslip as ss
from stickslip.cases.stories import EXPORTS

ss.diagnose(ss.read_loop(EXPORTS / "LIC410_level.csv")).plot()
