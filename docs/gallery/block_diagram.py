"""
A diagram drawn
===============

Every diagram draws itself: blocks by their roles, arrows by their signals.
"""

from stickslip.cases import find

find("level_cascade").build().plot()
