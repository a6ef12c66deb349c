"""A logged stem that stands still while OP travels, turns back and comes again: its valve sticks, if the tag lives.

    a stem at rest leaves its place when OP has gone f_S to either side, so that over the whole record
    range of OP < 2 f_S = S + J        and, as J is at most S,        S > half of the range of OP

A control valve shall follow moves of 1 % (EnTech, Control Valve Dynamic Specification 3.0, 1998), one with a positioner
follows 0.1 to 0.5 %.  So a stem that stands while OP moves by ``MUST_MOVE_PERCENT`` and back is beyond a sound valve.
A deadband without jump (J = 0) stands as well.  It is the rarer: of 6,000 simulated loops (training law, seeds 64000
and 64010 to 64019), half of them sticky, the stem stood in 17 with a stick and 1 with a deadband while OP turned back.

A tag that is dead looks the same, and these tell it:

    PV follows the moves of SP, or shows itself that its valve slips: then the valve moves
    MV lies outside of where OP goes, by more than half of its range: a stem at rest between its two f_S does not

Where SP stands still and MV lies there, only a test of the valve tells a dead tag from a stick, and the answer says so.
A stick wider than ``WIDEST`` is not believed without such a test.  Stems at an end of their span are not judged,
because their seat or stop may hold them.
"""

from typing import Literal, NamedTuple

import numpy as np
from stickslip.detect.prepare.prepared import Grid, Prepared
from stickslip.detect.signals.smoothing import noise_std
from stickslip.detect.stem.sound_valve import MUST_MOVE_PERCENT, NEED_NOT_MOVE_PERCENT
from stickslip.detect.stem.stick import turns
from stickslip.logs.two_digits import rounded

WIDEST_PERCENT = 30.0  # % of OP: S + J beyond it is rarer than a tag that is dead (plants show S up to 15 %, J up to S)
TURNS = 2  # of OP, by more than half of its range
NOISE_SIGMAS = 8.0  # standard deviations of MV's noise that a stem which stands may range over
MOVES_SHARE = 0.05  # of OP's range, that it may range over
END_PERCENT = 0.5  # % of the span within which seat or stop may hold the stem
BESIDE_SHARE = 0.5  # of OP's range, that the stem may lie outside of it
FOLLOWS = 3.0  # times that SP ranges further than e, by their quartiles: PV goes with it

SURE = (
    "or, more rarely, has a deadband as wide. A dead transmitter of the stem would look the same: look at the valve "
    "while OP moves."
)
OPEN = "it sticks or has a deadband at all: its transmitter may be dead. Which it is shows only when OP moves further."


class Still(NamedTuple):
    """A stem that stands: how far OP travels [``unit``], how often it turns back, and what that says.

    ``means`` : "sticks"; "dead" where PV shows that the valve moves; "open" where it stays open
    """

    travel: float
    unit: str
    turned: int
    means: Literal["sticks", "dead", "open"]
    why: str


def still_stem(loop: Prepared) -> Still | None:
    """Return what a logged stem says that never moves while OP does; None where none is logged, or it moves.

    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(2000.0)
    >>> u, load = 50 + 2 * np.sin(t / 50), np.sin(t / 50 + 1)
    >>> still = still_stem(Prepared(LoopRecord.from_arrays(t, pv=load, op=u, mv=0 * t + 50.3, op_span=(0, 100))))
    >>> still.means, round(still.travel, 1), still.turned
    ('sticks', 4.0, 11)
    """
    grid = loop.whole
    mv, op = grid.mv, grid.op
    if mv is None or not np.all(np.isfinite(mv)):
        return None
    reach, moved = float(np.ptp(op)), float(np.ptp(mv))
    steady = moved <= 1e-6 * max(float(np.max(np.abs(mv))), 1e-300)
    if not steady and moved > min(NOISE_SIGMAS * noise_std(grid.t, mv), MOVES_SHARE * reach):
        return None
    percent = loop.op_percent(1.0)
    scale, unit = (percent, "% of its span") if percent is not None else (1.0, "its unit")
    travel, turned = reach * scale, len(turns(op, 0.5 * reach))
    if travel < NEED_NOT_MOVE_PERCENT:
        return None
    means, why = _meaning(loop, grid, float(np.mean(mv)), percent)
    if means == "sticks":
        band = f"S + J above {rounded(travel):g} {unit.replace('its span', 'OP').replace('its', 'the')}"
        enough = percent is not None and MUST_MOVE_PERCENT <= travel <= WIDEST_PERCENT and turned >= TURNS
        means, why = ("sticks", f"it sticks, {band}, {why}") if enough else ("open", f"{band}, if {OPEN}")
    return Still(travel, unit, turned, means, why)


def _meaning(
    loop: Prepared, grid: Grid, place: float, percent: float | None
) -> tuple[Literal["sticks", "dead", "open"], str]:
    """What a stem at ``place`` means, with the words for it."""
    if grid.sp is not None and np.all(np.isfinite(grid.sp)):
        moved, off = (float(np.subtract(*np.percentile(x, [75, 25]))) for x in (grid.sp, grid.sp - grid.pv))
        if moved > FOLLOWS * off > 0.0:
            return "dead", (
                "PV follows the moves of SP all the same, so that the valve moves and the stem's tag is dead."
            )
    span = loop.record.op_span
    if span is not None and percent is not None and not min(abs(place - end) for end in span) > END_PERCENT / percent:
        return "open", "it lies at an end of its span, where its seat or stop may hold it."
    low, high = float(np.min(grid.op)), float(np.max(grid.op))
    if not low - BESIDE_SHARE * (high - low) <= place <= high + BESIDE_SHARE * (high - low):
        return "open", f"its tag says {place:.4g}, where OP never goes: it is dead, or has another unit than OP."
    return "sticks", SURE
