"""
All methods on one loop
=======================

Red accuses, yellow cannot tell, grey does not apply.
"""

import stickslip as ss
from stickslip.cases.stories import EXPORTS

ss.compare(ss.read_loop(EXPORTS / "LIC410_level.csv")).plot()
