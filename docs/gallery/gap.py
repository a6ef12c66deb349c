"""
A gap closed
============

The log against the model as it is, and with the cause that was found.
"""

from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow
from stickslip.diagram import simulate
from stickslip.gap import diagnose, replayed
from stickslip.gap.effects import effect

site = effect("dead_time").insert(ideal_flow(rest=1.5), "process", theta=3.0)
set_point = Staircase("SP", [1.5, 1.65, 1.35, 1.5], dwell=300.0)
log = simulate(site, 1200.0, every=1.0, inputs={"SP": set_point}, signals=["SP", "PV", "OP"]).log
report = diagnose(ideal_flow(), log, catalogue=[effect("dead_time"), effect("process_gain")])
replayed(report, log).plot()
