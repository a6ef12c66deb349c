"""Parts that sampled valve models share: ports, sampling, rules of their bands, and the valve without friction.

Each takes one sample every ``dt`` seconds and holds MV in between; ``low`` and ``high`` are the ends of OP's span,
where the stem stands on its stop; ``start`` is where OP and MV stand before the first sample.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.ideal_valve import IdealValve
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role


class SampledValve(Block):
    """A valve model that runs at sampling instants; slopes are those of a valve without friction."""

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    period_param = "dt"
    limit_params = ("low", "high")

    def smooth(self) -> IdealValve:
        """Return the valve without friction, of which slopes are taken."""
        return IdealValve.instead_of(self)

    def unseen(self) -> str:
        """Return what python-control loses: a solver that steps over samples feeds the loop with an old MV."""
        dt = float(self.params["dt"])
        return f"samples within its steps, which are long unless solve_ivp_kwargs={{'max_step': {dt:g}}} is given,"


class TwoBandValve(SampledValve):
    """A sampled valve with the bands ``S`` and ``J`` [unit of OP]; subclasses give ``kernels`` and ``memory_at``."""

    def __init__(
        self, S: float, J: float, dt: float, *, low: float = 0.0, high: float = 1.0, start: float = 0.0,
        name: str = "valve", **labels: Any,
    ) -> None:  # fmt: skip
        super().__init__(
            name=name,
            params={"S": S, "J": J, "low": low, "high": high, "dt": dt},
            memory=self.memory_at(start),
            start_output=start,
            **labels,
        )

    @staticmethod
    def memory_at(start: float) -> Mapping[str, float]:
        """Return the memory of a valve at rest at ``start``."""
        raise NotImplementedError

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless 0 <= J <= S <= high - low and dt > 0."""
        check_sampling(params, name)
        check_band(params, name, "S")
        S, J = float(params["S"]), float(params["J"])
        require(0.0 <= J <= S, name, "J", J, f"0 <= J <= S = {S} is needed", "a jump is part of S; lower J or raise S")


def check_sampling(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless low < high and dt > 0."""
    low, high, dt = float(params["low"]), float(params["high"]), float(params["dt"])
    require(low < high, name, "high", high, f"the span of OP ends above its beginning, {low}", "raise high")
    require(0.0 < dt < math.inf, name, "dt", dt, "a sampling period is positive", "give dt in seconds")


def check_band(params: Mapping[str, float], name: str, band: str) -> None:
    """Raise ``BlockError`` unless a band lies within the span of OP."""
    span, value = float(params["high"]) - float(params["low"]), float(params[band])
    rule = f"0 <= {band} <= {span} is needed, the span of OP"
    require(0.0 <= value <= span and math.isfinite(value), name, band, value, rule, "with OP in percent give high=100")
