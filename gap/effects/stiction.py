"""Stiction: the stem sticks, and jumps when it breaks away.

A massless stem behind the valve's own (``stickslip.blocks.quasi_static_stem``): what the valve gives is where the stem
is wanted.

    S  deadband plus stickband [% of OP's span]        J  slip jump [% of OP's span], 0 <= J <= S

J = 0 is a deadband.  Another law of friction shows the same S and J in its MV-OP figure.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.he_valve import HeValve
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.resting_stem import RestingStem
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, not_below
from stickslip.gap.insertion.inserted import Inserted, percent_of_stem


class Stiction(Inserted):
    """A valve that sticks by S and jumps by J.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> Stiction().insert(self_regulating_loop(), "valve", S=5.0, J=2.0)["valve:stiction"].params["S"]
    0.05
    """

    name = "stiction"
    role = Role.VALVE
    parameters = (Parameter("S", "% OP", 0.0, 0.2, 20.0, "log"), Parameter("J", "% OP", 0.0, 0.0, 20.0))
    where = "at"
    state = "x"
    hidden = True
    nests = "deadband"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the stem."""
        return QuasiStaticStem(0.01, 0.0, low=-math.inf, high=math.inf, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return S and J in units of the stem."""
        percent = percent_of_stem(diagram, place)
        return {f"{self.block(place)}.{key}": values[key] * percent for key in ("S", "J")}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["J"] > values["S"]:
            return f"J = {values['J']:g} %, but a jump is part of S = {values['S']:g} %; lower J or raise S"
        return not_below(values, {"S": 0.0, "J": 0.0})


class RestingStiction(Stiction):
    """A valve that sticks anew whenever OP stands still, as between the scans of a controller.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> type(RestingStiction().insert(self_regulating_loop(), "valve", S=5.0, J=2.0)["valve:stiction"]).__name__
    'RestingStem'
    """

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the stem."""
        return RestingStem(0.01, 0.0, low=-math.inf, high=math.inf, name=self.block(place))


class SampledStiction(Stiction):
    """A valve that takes OP every ``period`` [s] only, and sticks anew each time (``stickslip.blocks.he_valve``).

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> SampledStiction(1.0).insert(self_regulating_loop(), "valve", S=5.0, J=2.0)["valve:stiction"].params["f_s"]
    0.035
    """

    state = "MV"

    def __init__(self, period: float) -> None:
        self.period = period

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the stem."""
        return HeValve(0.01, 0.0, self.period, low=-math.inf, high=math.inf, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the friction bands in units of the stem."""
        half = 0.5 * percent_of_stem(diagram, place)
        S, J = values["S"], values["J"]
        bands = {"f_s": half * (S + J), "f_d": half * np.maximum(S - J, 0.0)}
        return {f"{self.block(place)}.{key}": value for key, value in bands.items()}
