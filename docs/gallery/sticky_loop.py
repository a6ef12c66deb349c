"""
A sticky loop
=============

The stem stands still until OP has moved by S, and then jumps by J.
"""

import stickslip as ss
from stickslip.cases import find

ss.simulate(find("ideal_high").build(), 600.0, every=0.1).plot()
