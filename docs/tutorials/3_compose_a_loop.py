"""
Compose a loop
==============

A loop is a list of blocks.  Blocks join by the names of their signals.
"""

# %%
# Wire it
# -------

import numpy as np

import stickslip as ss
from stickslip.blocks import PI, FirstOrder, IdealValve, Step, StickSlip

loop = ss.wire(
    [
        Step("SP", after=0.5),
        PI(K_p=0.4, T_i=10.0),  # SP, PV -> OP
        StickSlip(F_s=2250.0, F_c=1250.0),  # OP -> MV: the stem sticks and slips
        FirstOrder(K=3.0, tau=10.0),  # MV -> PV
    ]
)
loop.plot()

# %%
# Run it
# ------
# The engine finds the instants at which the stem sticks and slips.

run = ss.simulate(loop, 300.0, every=0.1)
print(run)
run.plot()

# %%
# A misspelt signal is an error that names the nearest right one.

try:
    ss.wire([Step("SP", after=0.5), PI(K_p=0.4, T_i=10.0), IdealValve(), FirstOrder(3.0, 10.0, outputs="PW")])
except ValueError as error:
    print(error)

# %%
# Change it
# ---------
# A diagram is a value: these calls return a changed copy.

looser = loop.with_params({"valve.F_s": 1900.0})
sound = loop.replace("valve", IdealValve())
for diagram in (loop, looser, sound):
    pv = ss.simulate(diagram, 6000.0, every=1.0).log["PV"]
    swing = np.ptp(pv[3000:])
    print(f"PV swings by {swing:.4f}")

# %%
# Less static friction makes a smaller cycle, and a valve without friction makes none.
#
# Try twenty valves at once
# -------------------------

forces = np.linspace(1250.0, 2250.0, 20)
many = ss.ensemble(loop, 6000.0, params={"valve.F_s": forces}, every=1.0)
for F_s, pv in list(zip(forces, many.values["PV"], strict=True))[::4]:
    print(f"F_s = {F_s:6.0f} N: PV swings by {np.ptp(pv[3000:]):.4f}")
