"""
Poles and what they are made of
===============================

Six decades of time constants in one plant.
"""

from stickslip.diagram.linear import linearise
from stickslip.plant import production_plant

linearise(production_plant("B", F_s="high")).plot()
