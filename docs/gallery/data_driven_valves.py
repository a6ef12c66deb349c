"""
Valves of two parameters
========================

The valves of five papers with one S and J.
"""

from matplotlib.figure import Figure
from stickslip.blocks import ChenValve, ChoudhuryValve, HeValve, KanoValve, Sine, StenmanValve
from stickslip.diagram import drive

figure = Figure(figsize=(6, 5), layout="constrained")
panel = figure.subplots()
for valve in (
    KanoValve(0.1, 0.04, 0.5, start=0.5),
    ChoudhuryValve(0.1, 0.04, 0.5, start=0.5),
    ChenValve(0.1, 0.04, 0.5, start=0.5),
    HeValve(0.07, 0.03, 0.5, start=0.5),
    StenmanValve(0.04, 0.5, start=0.5),
):
    log = drive(valve, 120.0, every=0.5, OP=Sine("OP", 0.2, 60.0, mean=0.5)).log
    panel.plot(log["OP"], log["MV"], label=type(valve).__name__)
panel.set(xlabel="OP", ylabel="MV")
panel.legend()
figure
