"""Stiction or a deadband, and of what size, where few stems leave it open: by a bank that draws OP (``drawn``).

A deadband whose width lies between S - J and S is the best that a bank without jumps finds of stiction.  So stems of
growing J are tried that have this width in the middle, and the likeliest is followed.
"""

from collections.abc import Sequence

import numpy as np
from stickslip.gap.filters.drawn import Draws, drawn
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.hysteresis import JUMPS, moved_stem
from stickslip.gap.insertion.effect import Effect

STEMS = 200
SHARES = (0.15, 0.3, 0.5, 0.75)  # of J in S
MIDDLE = 0.55  # of J by which such a width lies below S
AHEAD, BEHIND = 16.0, 60.0  # nats by which a jump decides; by which a jump may lag before it is followed
EVEN = 4.0  # nats by which a jump may lag and still be as likely as none
STEPS = (0.08, 0.04, 0.02)  # of a width, of S + J and of S - J


def decided(flat: Filtered, stiction: Effect, stuck: Sequence[Filtered] = ()) -> tuple[Filtered, ...]:
    """Return stiction where its jump gains ``AHEAD`` nats over the best deadband, else that; beside it stiction that
    jumps and lags by less than ``EVEN``, which the record does not separate: all as drawing banks leave them.

    ``flat`` the deadband and ``stuck`` stiction as another bank found them.
    """
    f = flat.explanation.filtering
    one = Explanation(f, stiction, flat.explanation.place)
    draws, free = Draws.of(one, STEMS), {key: flat.values[key] for key in f.free}
    play = _followed(drawn(flat.explanation, flat.values, draws), draws)
    width, tried = play.values["width"], [dict(near.values) for near in stuck]
    for share in SHARES:
        S = float(np.clip(width / (1.0 - MIDDLE * share), *one.bounds["S"]))
        tried.append({**free, "S": S, "J": share * S})
    looked = [drawn(one, values, draws) for values in tried]
    jump = min(looked, key=lambda found: found.nll)
    if jump.nll > play.nll + BEHIND:
        return (play,)
    jump = _followed(jump, draws)
    between = jump.values["S"] - MIDDLE * jump.values["J"]
    play = min(play, drawn(play.explanation, {**play.values, "width": between}, draws), key=lambda found: found.nll)
    if jump.nll < play.nll - AHEAD:
        return (jump,)
    jumping = [found for found in (*looked, jump) if found.values["J"] >= JUMPS * found.values["S"]]
    likely = min(jumping, key=lambda found: found.nll)
    return (play, likely) if likely.nll < play.nll + EVEN else (play,)


def _followed(best: Filtered, draws: Draws) -> Filtered:
    """Return the likeliest of sizes near a start, one after the other in ever smaller steps."""
    one = best.explanation
    for step in STEPS:
        for name in one.own:
            for way in (step, -step):
                new = drawn(one, moved_stem(one, best.values, name, way), draws)
                if new.nll < best.nll:
                    best = new
                    break
    return best
