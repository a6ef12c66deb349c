"""
What a historian leaves
=======================

Swinging-door compression draws straight lines, and hides the shape that shows a sticky valve.
"""

from matplotlib.figure import Figure
from stickslip.cases import find
from stickslip.gap.effects import effect

log = find("ideal_high").run().log
kept = effect("compression").on_log(log, deviation=0.01)
figure = Figure(figsize=(8, 3), layout="constrained")
panel = figure.subplots()
for one, label in ((log, "plant"), (kept, "historian")):
    panel.plot(one.t, one["PV"], label=label)
panel.set(xlabel="time [s]", ylabel="PV", xlim=(200.0, 600.0), ylim=(0.4, 0.6))
panel.legend()
figure
