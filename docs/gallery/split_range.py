"""
Split range
===========

A vessel that is filled and emptied by two valves; the vent sticks.
"""

from stickslip.cases import find

case = find("split_range")
case.run().plot(case.signals or None)
