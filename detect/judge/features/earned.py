"""Where the record's own likelihood of dead travel may be asked, and whether it clears the valve.

Clearing needs the evidence to exclude dead travel by itself (``likelihood.pooled``), whatever the model holds probable.
"""

from stickslip.detect.likelihood.pooled import Evidence
from stickslip.detect.prepare.prepared import Prepared

# Facts of the data behind which PV tells nothing of the stem.
DRAWN = ("compressed", "frozen_pv", "pv_unresponsive", "manual_mode", "constant_signal", "signal_missing")


def usable(loop: Prepared) -> bool:
    """Whether a record can be weighed: no historian has drawn PV or OP, and enough of them is left."""
    drawn = loop.op_drawn.present or any(fact.code in DRAWN for fact in loop.present)
    return not drawn and loop.stems is not None


def not_earned(found: Evidence | None) -> str:
    """Return why the record does not clear the valve, but for what the evidence says in words; "" where it does."""
    if found is None:
        return "Little speaks for stiction, but PV or OP is compressed, or has too few good rows, to exclude a stick."
    return "" if found.clears else "Little speaks for stiction, but clearing must be earned."
