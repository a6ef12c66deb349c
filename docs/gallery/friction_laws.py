"""
Laws of friction
================

Three stems under one sine: Coulomb, Stribeck and LuGre.
"""

from matplotlib.figure import Figure
from stickslip.blocks import LuGreStem, Sine, StickSlip, StribeckStem
from stickslip.diagram import drive

figure = Figure(figsize=(6, 5), layout="constrained")
panel = figure.subplots()
for stem in (StickSlip(start=0.5), StribeckStem(start=0.5), LuGreStem(start=0.5)):
    log = drive(stem, 120.0, every=0.05, OP=Sine("OP", 0.2, 60.0, mean=0.5)).log
    panel.plot(log["OP"], log["MV"], label=type(stem).__name__)
panel.set(xlabel="OP", ylabel="MV")
panel.legend()
figure
