"""
A folder scanned
================

Verdicts and periods.
"""

import tempfile

import stickslip as ss
from stickslip.cases.stories import EXPORTS

with tempfile.TemporaryDirectory() as folder:
    found = ss.scan.scan(EXPORTS, out=folder, workers=1)
found.plot()
