"""
A whole plant judged
====================

The loops that swing together, and the valve to look at first.
"""

import stickslip as ss
from stickslip.plant import kicked, production_plant

plant = kicked(production_plant(F_s="high", sticky=["VPCS1"]), 1.02, 1.03)
log = ss.simulate(plant, 1200.0, every=2.0, method="stiff").log
ss.survey(log.between(200.0, 1200.0)).plot()
