"""
Dead travel found
=================

The likeliest stem, the gain of each S, and where in the record it is gained.
"""

import stickslip as ss
from stickslip.cases.stories import EXPORTS
from stickslip.detect.methods import dead_travel

dead_travel.detect(ss.read_loop(EXPORTS / "FIC101_pi_export.csv")).plot()
