"""
Relative gains
==============

Near one on the diagonal: the valves are paired well.
"""

from stickslip.diagram.linear import linearise
from stickslip.plant import production_plant

model = linearise(production_plant("B", F_s="high"))
model.rga(["LCS11", "PCS11", "LCS21", "PCS21"]).plot()
