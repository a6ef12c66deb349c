"""
Close a gap
===========

A model and a log disagree.  Which effect does the model lack?
"""

# %%
# A model and a log
# -----------------
# The valve of the model is ideal.  At the "site" it sticks, and the model does not know that.

import stickslip as ss
from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow
from stickslip.gap import replayed
from stickslip.gap.effects import effect

model = ideal_flow()
site = effect("stiction").insert(ideal_flow(rest=1.5), "valve", S=3.0, J=1.0)
set_point = Staircase("SP", [1.5, 1.65, 1.35, 1.5, 1.8, 1.2], dwell=600.0)
log = ss.simulate(site, 3600.0, every=1.0, inputs={"SP": set_point}, signals=["SP", "PV", "OP"]).log

# %%
# Ask
# ---
# Without ``catalogue`` every effect is tried at every place.  Five of them are enough here.

known = [effect(name) for name in ("stiction", "deadband", "dead_time", "process_gain", "sensor_lag")]
report = ss.gap.diagnose(model, log, catalogue=known)
print(report)

# %%
# Where it arises
# ---------------

report.plot_diagram()

# %%
# How far it closes
# -----------------
# The upper picture has the model as it is.  The lower one has the model with the stiction that was found.

replayed(report, log).plot()

# %%
# Put the effect into the model
# -----------------------------
# The better model is a diagram like any other.

sizes = {name: found.value for name, found in report.causes[0].parameters.items()}
better = effect(report.causes[0].effect).insert(model, report.causes[0].place, **sizes)
print([block.name for block in better.blocks if "stiction" in block.name], sizes)
