"""
Unit-test a block
=================

Write a block of your own, and hold it to a closed form.
"""

# %%
# Write it
# --------
# A tank of area A has an outflow k L.  The arguments of the function are states, inputs and parameters by name.

import numpy as np
from stickslip.blocks import Equations, Step
from stickslip.diagram import drive, wire
from stickslip.diagram.reference import simulate_reference


def rate(L, F, A=2.0, k=0.5):
    """Return dL/dt [m/s]."""
    return (F - k * L) / A


tank = Equations("tank", der=rate, states={"L": 0.0}, inputs="F", outputs="L")
print(repr(tank))

# %%
# Drive it alone
# --------------
# ``drive`` gives its inputs a value, an array or a source.

run = drive(tank, 20.0, every=0.1, F=1.0)
run.plot()

# %%
# Compare it with a closed form
# -----------------------------
# L(t) = F / k (1 - exp(-k t / A)).

exact = (1.0 - np.exp(-0.5 * run.log.t / 2.0)) / 0.5
error = np.abs(run.log["L"] - exact).max()
print(f"largest error {error:.1e} m")
assert error < 1e-6

# %%
# Test what it must refuse
# ------------------------
# A function that asks for what is not there is refused at once.  The message says what there is.

try:
    Equations("bad", der=lambda L, Q: Q - L, states={"L": 0.0}, inputs="F", outputs="L")
except ValueError as error:
    print(error)

# %%
# Compare two simulators
# ----------------------
# The reference simulator shares no code with the engine.

diagram = wire([Step("F", after=1.0, at=2.0), tank])
ours = drive(tank, 20.0, every=0.1, F=Step("F", after=1.0, at=2.0)).log["L"]
theirs = simulate_reference(diagram, 20.0, every=0.1).log["L"]
print(f"they differ by {np.abs(ours - theirs).max():.1e} m")

# %%
# A block that others shall use is a file in ``blocks/``.  CONTRIBUTING has the page to start from.
