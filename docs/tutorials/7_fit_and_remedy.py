"""
Fit a loop, and try remedies
============================

A valve sticks and the shutdown is far away.  What helps until then?
"""

# %%
# Fit the loop to its own log
# ---------------------------
# No model is needed.  This record is simulated: S is 5 % and J is 1.5 % of OP.

import stickslip as ss
from stickslip.remedy.example import sticky

record = sticky(hours=2.0, seed=3)
found = ss.fit(record)
print("the valve sticks:", found.sticks)
print(f"S = {found.S.value:.1f} ({found.S.low:.1f} to {found.S.high:.1f}) {found.op_unit}")
print(f"K_p = {found.controller.K_p:.2f}, T_i = {found.controller.T_i:.0f} s")

# %%
# The intervals come from an ensemble of loops that are about equally likely.

found.plot()

# %%
# Try the remedies
# ----------------
# Each is simulated on the whole ensemble, under the load that the record had.

advice = ss.remedies(found)
for line in advice.words():
    print("-", line)

# %%
# A remedy is recommended only if it helps in 19 of 20 of these loops.

advice.plot()

# %%
# Keep the loop
# -------------
# The fitted loop is a Python file of blocks to edit.

print("\n".join(ss.remedy.python_of(found).splitlines()[:12]))

# %%
# This is new and was tested in simulation only: see :doc:`/remedy`.  Watch the loop before you keep a setting.
