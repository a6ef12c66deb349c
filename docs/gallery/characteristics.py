"""
Characteristics
===============

Flow over travel.
"""

from matplotlib.figure import Figure
from stickslip.blocks import Characteristic, Ramp
from stickslip.diagram import drive

figure = Figure(figsize=(6, 5), layout="constrained")
panel = figure.subplots()
for valve, label in (
    (Characteristic(), "linear"),
    (Characteristic(50.0), "equal percentage"),
    (Characteristic.quick_opening(), "quick opening"),
):
    log = drive(valve, 1.0, every=0.01, MV=Ramp("MV", 1.0)).log
    panel.plot(log["MV"], log["flow"], label=label)
panel.set(xlabel="stem position", ylabel="share of the full flow")
panel.legend()
figure
