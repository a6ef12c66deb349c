"""
How far does it spread?
=======================

Amplitudes from the valve to the shaft, over friction and starts.
"""

import tempfile

from stickslip.study import production_subject, study

subject = production_subject("E", F_s="high", name="plant_1_high")
with tempfile.TemporaryDirectory() as folder:
    found = study(
        subject,
        {"VPCS1.F_s": [1250.0, 1750.0, 2250.0]},
        plant={"sticky": ["VPCS1"]},
        kicks=4,
        every=0.5,
        duration=1000.0,
        out=folder,
    )
found.plot()
