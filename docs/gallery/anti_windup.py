"""
Wind-up
=======

OP stands at its limit.  Without anti-windup the integral runs on, and PV overshoots.
"""

from matplotlib.figure import Figure
from stickslip.blocks import PI, FirstOrder, Square
from stickslip.diagram import simulate, wire

figure = Figure(figsize=(8, 4), layout="constrained")
panel = figure.subplots()
for kind in ("none", "conditional", "back_calculation"):
    controller = PI(K_p=2.0, T_i=5.0, anti_windup=kind)
    loop = wire([Square("SP", 0.5, 120.0, mean=0.6), controller, FirstOrder(1.2, 20.0, inputs="OP")])
    log = simulate(loop, 240.0, every=0.2).log
    panel.plot(log.t, log["PV"], label=kind)
panel.plot(log.t, log["SP"], "k:", label="SP")
panel.set(xlabel="time [s]", ylabel="PV")
panel.legend()
figure
