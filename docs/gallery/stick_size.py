"""
The swing against friction
==========================

One diagram runs over forty friction forces at once.
"""

import numpy as np
from matplotlib.figure import Figure
from stickslip.cases import find
from stickslip.diagram import ensemble

forces = np.linspace(1250.0, 2500.0, 40)
many = ensemble(find("ideal_high").build(), 3000.0, params={"valve.F_s": forces}, every=1.0)
figure = Figure(figsize=(8, 4), layout="constrained")
panel = figure.subplots()
panel.plot(forces, np.ptp(many.values["PV"][:, 2000:], axis=1), ".-")
panel.set(xlabel="static friction [N]", ylabel="PV, peak to peak")
figure
