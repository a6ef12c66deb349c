"""
Open loops
==========

Each loop is opened at its controller, with all others closed.
"""

from stickslip.diagram.linear import linearise
from stickslip.plant import production_plant

linearise(production_plant("B", F_s="high")).bode()
