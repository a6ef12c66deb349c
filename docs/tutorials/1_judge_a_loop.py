"""
Judge a loop
============

You have an export from a historian and want to know whether the valve sticks.
"""

# %%
# Read the file
# -------------
# The package brings five exports.  Yours may be CSV, Parquet or Excel.  Whatever the reader guesses is a note.

import stickslip as ss
from stickslip.cases.stories import EXPORTS

record = ss.read_loop(EXPORTS / "FIC101_pi_export.csv")
print(record)
for note in record.notes:
    print("-", note)

# %%
# Ask for the verdict
# -------------------

answer = ss.diagnose(record)
print(answer)
print(answer.reason)

# %%
# S is how far OP travels until the stem moves.  J is how far the stem then jumps.  The picture shows the trends, the
# loop of PV against OP, and the shape of the half cycles.

answer.plot()

# %%
# What to do
# ----------

print(answer.action)

# %%
# An answer may be open
# ---------------------
# Here the historian has compressed the log, and the verdict says what is missing.  That is no fault of the valve.

compressed = ss.diagnose(ss.read_loop(EXPORTS / "FIC512_compressed.csv"))
print(compressed)
print(compressed.action)

# %%
# A valve is cleared only where the record earns it.  The answer then names the S that it excludes.

cleared = ss.diagnose(ss.read_loop(EXPORTS / "PIC305_long_form.csv"))
print(cleared.reason)
cleared.plot()

# %%
# ``stickslip check FILE`` does the same from the shell.
