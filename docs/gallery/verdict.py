"""
A verdict
=========

The trends, PV against OP, and how PV moves while OP travels.
"""

import stickslip as ss
from stickslip.cases.stories import EXPORTS

ss.diagnose(ss.read_loop(EXPORTS / "LIC410_level.csv")).plot()
