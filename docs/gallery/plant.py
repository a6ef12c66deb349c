"""
The production plant
====================

Two separators and two compressors on one shaft; the gas valve sticks.
"""

from stickslip.diagram import simulate
from stickslip.plant import kicked, production_plant

run = simulate(kicked(production_plant(F_s="high")), 1200.0, every=0.5, method="stiff")
run.plot(["OP_VPCS1", "MV_VPCS1", "p_1", "tau_d"])
