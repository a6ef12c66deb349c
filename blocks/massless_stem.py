"""Parts that stems without mass share.  Python-control knows no jumps, so it sees them with a little mass.

    dx/dt = v,   dv/dt = r^2 (OP - x - mode (S - J)/2) - 2 r v      mode of ``seen_stem``, breakaway (S + J)/2

Critically damped: it lags by 2/r and does not overshoot.  A jump has to be over soon, for what OP does meanwhile moves
where the stem stands next; a stem that cannot jump may be slower, which is less stiff.  Mode "ideal" is MV = OP.
"""

from typing import Self

import numpy as np
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.seen_stem import IDEAL, STUCK, halted, seen_mode, stuck_rate

JUMPING, SLIDING = 3000.0, 200.0  # r [1/s] of a stem with J > 0, and without: lags of 0.7 and 10 ms


class MasslessStem(Block):
    """A valve stem without mass.  Its parameters begin with S, J, low and high; its memory is mode and position."""

    def seen_states(self) -> tuple[str, ...]:
        """Return position and speed of the stem with a little mass; none in mode "ideal", where MV = OP."""
        return () if self.d0[0] == IDEAL else ("x", "v")

    def seen_start(self) -> Floats:
        """Return the start values of ``seen_states``: at rest."""
        return np.zeros(0) if self.d0[0] == IDEAL else np.array([self.d0[1], 0.0])

    def in_mode(self, mode: str) -> Self:
        """Return a copy in the named mode; see ``Block.in_mode``."""
        return self._with_seen_states(super().in_mode(mode))

    def starting_at(self, **values: float) -> Self:
        """Return a copy with other start values; see ``Block.starting_at``.  Only python-control knows the speed."""
        own = {key: value for key, value in values.items() if key != "v"}
        return self._with_seen_states(super().starting_at(**own))

    def _with_seen_states(self, other: Self) -> Self:
        other.set_states(list(other.seen_states()))
        return other

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.d0[0] == IDEAL:
            return np.zeros(0)
        S, J, low, high = self._p_now
        pull, pace = u[0] - x[0], JUMPING if J > 0.0 else SLIDING
        mode = self.d0[0] if self.keeps_mode else seen_mode(x[0], x[1], pull, 0.5 * (S + J), low, high)
        if mode == STUCK:
            return np.array([0.0, stuck_rate(x[1], pull, pace)])
        rate = pace * (pace * (pull - mode * 0.5 * (S - J)) - 2.0 * x[1])
        return np.array([x[1], halted(x[1], rate, 2.0 * pace) if abs(pull) <= 0.5 * (S + J) else rate])

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        return np.array([u[0] if self.d0[0] == IDEAL else x[0]])
