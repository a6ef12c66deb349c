"""A valve whose stem is known: what it gives is played from a path, whatever OP does.

Given the path nothing hidden is left, so that a filter is exact as far as the rest is linear: its gains are those that
a bank of stems shares, and noise, loads and tolerances can be fitted.
"""

from dataclasses import dataclass

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close
from stickslip.gap.insertion.bent_valve import stem_signal, with_stem
from stickslip.gap.insertion.effect import Effect
from stickslip.logs.arrays import Values


@dataclass(frozen=True, eq=False)
class KnownStem(Effect):
    """A stem that goes through ``values`` at the times ``t`` [s], held or in lines between them (``hold``)."""

    t: Values
    values: Values
    hold: str = "previous"

    name = "known_stem"
    role = Role.VALVE
    parameters = ()

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the stem."""
        signal, given = stem_signal(diagram, place), f"{self.block(place)}:given"
        stem = Sum(signal, {signal: 0.0, given: 1.0}, name=self.block(place))
        played = Recorded(given, self.t, self.values, hold=self.hold, name=given)
        return close(with_stem(diagram, place, stem, (given,)), {given: played})
