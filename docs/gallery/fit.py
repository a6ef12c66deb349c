"""
A loop fitted
=============

The likeliest stem.
"""

import stickslip as ss
from stickslip.remedy.example import sticky

ss.fit(sticky(hours=2.0)).plot()
