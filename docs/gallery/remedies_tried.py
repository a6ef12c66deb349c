"""
Remedies
========

Tried on the fitted loop.
"""

import stickslip as ss
from stickslip.remedy.example import sticky

ss.remedies(ss.fit(sticky(hours=2.0))).plot()
