"""Scan time: the controller computes every ``period`` [s] only and holds OP in between; 0 is continuous.

A continuous PI or PID controller becomes a sampled one with its settings; one that scans gets another period.  Two
things that a log does not say but a replay needs come with it: ``offset``, the time of the first scan [s], and
``present``, whether the integral takes in the present error before the output is made (1) or after it (0); makers do
either.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.pi import PI
from stickslip.blocks.pid import PID
from stickslip.blocks.role import Role
from stickslip.blocks.sampled_pi import SampledPI
from stickslip.blocks.sampled_pid import SampledPID
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, not_below


class ScanTime(Effect):
    """A controller that scans.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ScanTime().insert(self_regulating_loop(), "controller", period=4.0)["controller"].period
    4.0
    """

    name = "scan_time"
    role = Role.CONTROLLER
    parameters = (
        Parameter("period", "s", 0.0, 0.02, 3.0, "log", "time", smooth=False),
        Parameter("offset", "s", 0.0, 0.0, 3.0, per="time", nuisance=True, smooth=False),
        Parameter("present", "-", 1.0, 0.0, 1.0, nuisance=True, smooth=False),
    )

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether there is a sampled form of the controller."""
        return isinstance(block, PI | PID | SampledPI)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a continuous controller replaced by a sampled one of the same settings."""
        old = diagram[place]
        if not isinstance(old, PI | PID):
            return diagram
        own = old.params
        shared: dict[str, Any] = {
            "dt": 1.0, "low": own["low"], "high": own["high"], "action": "reverse" if own["action"] > 0.0 else "direct",
            "units": old.units, "spans": old.spans, "name": place,
        }  # fmt: skip
        new = (
            SampledPI(own["K_p"], own["T_i"], T_t=min(own["T_t"], 1e300), anti_windup=old.anti_windup, **shared)
            if isinstance(old, PI)
            else SampledPID(
                own["K_p"], own["T_i"], own["T_d"], N=own["N"], b=own["b"], c=own["c"],
                T_t=own["T_t"] or math.sqrt(own["T_i"] * own["T_d"]), **shared,
            )
        )  # fmt: skip
        return diagram.replace(place, new.starting_at(**dict(zip(old.state_names, old.x0.tolist(), strict=True))))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return period, first scan and kind of the integral."""
        found = {f"{place}.dt": values["period"], f"{place}.offset": values["offset"]}
        return found | {f"{place}.present": values["present"]}

    def nominal(self, diagram: Diagram, place: str) -> dict[str, float]:
        """Return no period, and the first scan and kind of the integral of a controller that scans."""
        own = diagram[place].params
        return {"period": own.get("dt", 0.0), "offset": own.get("offset", 0.0), "present": own.get("present", 1.0)}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["present"] not in (0.0, 1.0):
            return f"present = {values['present']:g}, but it is 0 or 1; give one of them"
        if not 0.0 <= values["offset"] < math.inf:
            return f"offset = {values['offset']:g} s, but the first scan is at 0 s or later; give its time"
        return not_below(values, {"period": 0.0})
