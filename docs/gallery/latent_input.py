"""
What is missing
===============

It goes with OP's direction.
"""

from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow
from stickslip.diagram import simulate
from stickslip.gap import diagnose, latent_input
from stickslip.gap.effects import effect

site = effect("stiction").insert(ideal_flow(rest=1.5), "valve", S=3.0, J=1.0)
set_point = Staircase("SP", [1.5, 1.65, 1.35, 1.5, 1.8, 1.2], dwell=600.0)
log = simulate(site, 3600.0, every=1.0, inputs={"SP": set_point}, signals=["SP", "PV", "OP"]).log
report = diagnose(ideal_flow(), log, catalogue=[effect("stiction"), effect("process_gain")])
latent_input(report, log).plot()
