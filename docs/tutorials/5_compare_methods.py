"""
Compare methods on one case
===========================

Twenty-three published methods look at one loop.  They do not agree.
"""

# %%
# A case with known truth
# -----------------------
# The thesis's loop sticks: S is 6.7 % and J is 1.9 % of OP.

import stickslip as ss
from stickslip.cases import find
from stickslip.detect import METHODS
from stickslip.detect.methods import curve_fit, parallelogram

log = ss.simulate(find("ideal_high").build(), 3600.0, every=1.0).log
percent = 100.0 * log["OP"]
record = ss.LoopRecord.from_arrays(
    log.t, pv=log["PV"], op=percent, sp=log["SP"], op_span=(0.0, 100.0), process="self_regulating"
)
print(record)

# %%
# Ask all methods
# ---------------

compared = ss.compare(record)
compared.plot()

# %%
# A method that does not apply says why.  That is an answer, and no vote.

for verdict in compared.loops[0].verdicts:
    if verdict.verdict == "not_applicable":
        print(f"{verdict.method}: {verdict.reason}")

# %%
# Ask one method
# --------------
# A method is a module with a card and a function.

print(curve_fit.CARD.source)
verdict = curve_fit.detect(record)
print(verdict.verdict, verdict.index, verdict.reason)
verdict.plot()

# %%
# This one draws PV against OP and measures the band.

parallelogram.detect(record).plot()

# %%
# The verdict of ``diagnose`` rests on more than their votes: see :doc:`/verdict`.

print(len(METHODS), "methods;", ss.diagnose(record))
