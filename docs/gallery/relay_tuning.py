"""
Tune by a relay
===============

A relay in place of the controller finds the ultimate gain and period.
"""

from stickslip.blocks import FirstOrder, RelayTuner, Step
from stickslip.diagram import simulate, wire

process = FirstOrder(1.5, 10.0, theta=2.0, start=0.45, inputs="OP")
run = simulate(wire([Step("SP", 0.5), RelayTuner(0.1, bias=0.3, dt=0.1), process]), 80.0, every=0.1)
print({name: float(run.log[name][-1].round(2)) for name in ("K_u", "T_u", "K_p", "T_i")})
run.plot(["SP", "PV", "OP"])
