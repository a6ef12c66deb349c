"""
A plant
=======

One sticky valve shakes a whole plant.  Which valve is it?
"""

# %%
# Simulate the plant
# ------------------
# Two separators and two compressors stand on one shaft.  Only the gas valve of the first separator sticks.

import stickslip as ss
from stickslip.plant import kicked, production_plant

plant = kicked(production_plant(F_s="high", sticky=["VPCS1"]), 1.02, 1.03)
run = ss.simulate(plant, 1200.0, every=2.0, method="stiff")
run.plot(["MV_VPCS1", "p_1", "m_2", "tau_d"])

# %%
# The stem jumps, and the pressure, the flow and the torque of the shaft follow with the same period.
#
# Ask all loops together
# ----------------------
# A log knows which signals belong to one loop.  The survey groups the loops that swing together.

found = ss.survey(run.log.between(200.0, 1200.0))
print(found)
for suspect in found.suspects:
    print(suspect.loop, suspect.seen_in)

# %%
# The first suspect is the loop of the sticky valve.

found.plot()

# %%
# Read the plant from a file
# --------------------------
# ``stickslip check plant.csv`` reads such a log.  ``stickslip scan FOLDER`` ranks thousands of loops.

run.log.to_csv("plant.csv")
again = ss.read_log("plant.csv")
print(len(again.loops), "loops")
