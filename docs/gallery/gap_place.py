"""
Where a gap lies
================

In the valve.
"""

from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow
from stickslip.diagram import simulate
from stickslip.gap import diagnose
from stickslip.gap.effects import effect

site = effect("deadband").insert(ideal_flow(rest=1.5), "valve", width=2.0)
set_point = Staircase("SP", [1.5, 1.65, 1.35, 1.5], dwell=300.0)
log = simulate(site, 1200.0, every=1.0, inputs={"SP": set_point}, signals=["SP", "PV", "OP"]).log
diagnose(ideal_flow(), log, catalogue=[effect("deadband"), effect("sensor_lag")]).plot_diagram()
