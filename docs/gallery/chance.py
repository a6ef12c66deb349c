"""
Chance
======

One model, forty seeds.
"""

import numpy as np
import stickslip as ss
from stickslip.blocks import Staircase
from stickslip.cases.models import site_flow

set_point = Staircase("SP", [1.5, 1.7, 1.4], dwell=400.0)
model = site_flow(rest=1.5)
many = ss.ensemble(model, 1200.0, every=5.0, inputs={"SP": set_point}, seeds=np.arange(40), progress=False)
many.plot("PV")
