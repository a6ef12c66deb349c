"""Does the process settle or run away after a move of OP? The user, the tag or the data under SP moves say it.

    flow, pressure of gas   self-regulating        level   integrating

Of the others the data speak where the set point moves: PV is explained by OP through a lag, and through a lag and an
integrator, with the same freedom (``lags``); the better of the two is taken where it leaves no more than exp(-0.5) of
the other's sum of squares and tells 0.8 of PV.  At a constant set point a wave from outside decides that comparison and
not the process, and nothing is inferred: of 75 simulated loops that it decided 11 came out wrong.  The limits are ours.
"""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.lags import Lags
from stickslip.detect.stem.stick import turn_time
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

BETTER = 0.5  # of ln(sum of squares), from which on one kind is taken
EXPLAINED_SHARE = 0.8  # of PV's variance
POINTS = 1200


class Kind(NamedTuple):
    """Whether the process integrates, None where nothing is known; and from what, a sentence."""

    integrating: bool | None
    text: str


def kind_of_tag(record: LoopRecord) -> Kind:
    """The kind of process that the user states, or else that the measurement implies.

    >>> kind_of_tag(LoopRecord.from_arrays([0, 1], pv=[1, 2], op=[1, 2], name="FIC7"))
    Kind(integrating=False, text='The process is taken as self-regulating: the tag is a flow.')
    """
    if record.process != "unknown":
        return Kind(record.process == "integrating", f"The process is {record.process.replace('_', '-')}, as stated.")
    if record.measurement == "level":
        return Kind(True, "The process is taken as integrating: the tag is a level.")
    if record.measurement == "flow":
        return Kind(False, "The process is taken as self-regulating: the tag is a flow.")
    if record.measurement == "pressure":
        return Kind(False, "The process is taken as self-regulating: the tag is a pressure, taken as that of a gas.")
    return Kind(None, "The process is taken as self-regulating: nothing says otherwise.")


def kind_of_data(op: Values, pv: Values, sp: Values | None, e: Values, period: float) -> Kind:
    """What OP and PV (n,) on an even grid say while SP moves; ``period`` of the oscillation [samples], else NaN."""
    unknown = Kind(None, "The process is taken as self-regulating: nothing says otherwise.")
    if sp is None or len(op) < 200 or np.std(sp) < 0.5 * np.std(e) or np.ptp(op) == 0.0:
        return unknown
    turn = turn_time(op, period)[1]
    k = max(1, min(math.ceil(len(op) / POINTS), int(turn / 8.0)))
    n = len(op) // k * k
    u, y, off = (x[len(x) - n :].reshape(-1, k).mean(axis=1) for x in (op, pv, e))
    sign, turn = controller_sign(u, off), max(turn / k, 2.0)
    models = [Lags(y, turn, kind, sign, POINTS // 2) for kind in (False, True)]
    swing = models[0].tss
    if not swing > 0.0:  # PV stands once its first turns, which no model is asked for, are over
        return unknown
    settles, integrates = (model.fit(u[:, None])[0].rss for model in models)
    explained = 1.0 - min(settles, integrates) / swing
    better = math.log(settles / integrates)
    if explained < EXPLAINED_SHARE or abs(better) < BETTER:
        return unknown
    kind, does = ("integrating", "integrates") if better > 0.0 else ("self-regulating", "settles")
    return Kind(
        better > 0.0,
        f"The process is taken as {kind}: under the moves of SP a model that {does} leaves "
        f"{math.exp(-abs(better)):.2g} of the other's sum of squares.",
    )
