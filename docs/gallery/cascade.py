"""
A cascade hides the stick
=========================

A flow loop takes the cycle away from the level.
"""

from stickslip.cases import find

case = find("cascade_flow")
case.run().plot(case.signals or None)
