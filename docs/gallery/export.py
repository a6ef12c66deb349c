"""
An export read
==============

With decimal commas.
"""

import stickslip as ss
from stickslip.cases.stories import EXPORTS

ss.read_loop(EXPORTS / "TIC204_decimal_comma.csv").plot()
