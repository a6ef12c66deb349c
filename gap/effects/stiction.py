"""Stiction: the stem sticks, and jumps when it breaks away.

A massless stem behind the valve's own (``blocks.quasi_static_stem``): what the valve gives is where the stem is wanted.

    S  deadband plus stickband [% of OP's span]        J  slip jump [% of OP's span], 0 <= J <= S

J = 0 is a deadband.  Another law of friction shows the same S and J in its MV-OP figure.
"""

import math
from collections.abc import Mapping
from typing import Any

from blocks.block import Block
from blocks.quasi_static_stem import QuasiStaticStem
from blocks.role import Role
from diagram.diagram import Diagram
from gap.effect import Effect, Parameter, known_first, not_below
from gap.scales import span


class Stiction(Effect):
    """A valve that sticks by S and jumps by J.

    >>> from blocks import IdealValve
    >>> from plant.loops import self_regulating_loop
    >>> loop = self_regulating_loop().replace("valve", IdealValve())
    >>> Stiction().insert(loop, "valve", S=5.0, J=2.0)["valve:stiction"].params["S"]
    0.05
    """

    name = "stiction"
    role = Role.VALVE
    parameters = (Parameter("S", "% OP", 0.0, 0.2, 20.0, "log"), Parameter("J", "% OP", 0.0, 0.0, 20.0))
    hidden = True

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the valve drives one signal from one."""
        return len(block.ports_out) == 1 and len(block.ports_in) == 1

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a sticking stem behind the valve's own."""
        stem = QuasiStaticStem(0.01, 0.0, low=-math.inf, high=math.inf, name=self.block(place))
        return diagram.insert(diagram[place].output_labels[0], stem)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return S and J in units of the stem."""
        percent = span(diagram, diagram[place].input_labels[0]) / 100.0
        return {f"{self.block(place)}.{key}": values[key] * percent for key in ("S", "J")}

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with the stem at rest where MV is first, else where OP is."""
        stem = diagram[self.block(place)]
        signals = [stem.output_labels[0], stem.input_labels[0], diagram[place].input_labels[0]]
        return diagram.starting_at({f"{stem.name}.x": known_first(first, signals)})

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["J"] > values["S"]:
            return f"J = {values['J']:g} %, but a jump is part of S = {values['S']:g} %; lower J or raise S"
        return not_below(values, {"S": 0.0, "J": 0.0})
