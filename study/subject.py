"""The subject of a study: a diagram, or a function that builds diagrams from quantities of its own."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.settings import Settings
from stickslip.logs.arrays import Values
from stickslip.study.axes import Value


@dataclass(frozen=True, eq=False)
class Subject:
    """A diagram that a study can rebuild.

    ``build`` takes values of some ``quantities`` (name -> default; numbers or words) and returns the diagram at rest;
    ``start`` moves it to where it begins when nobody asks for kicks.  ``stages`` (name -> signals) are measured unless
    others are named, in the order in which an oscillation travels; ``kicked`` are the states a start kick moves,
    ``BLOCK.STATE``; ``settings`` say how it is best integrated.
    """

    name: str
    build: Callable[[Mapping[str, Value]], Diagram]
    quantities: Mapping[str, Value] = field(default_factory=dict)
    start: Callable[[Diagram], Diagram] = lambda diagram: diagram
    stages: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    kicked: tuple[str, ...] = ()
    settings: Settings = field(default_factory=Settings)

    @property
    def signals(self) -> tuple[str, ...]:
        """The signals of all stages."""
        return tuple(signal for signals in self.stages.values() for signal in signals)


def as_subject(given: Subject | Diagram) -> Subject:
    """Return a diagram as a subject: it measures what is not a set point, and kicks what a controller measures.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> subject = as_subject(self_regulating_loop())
    >>> subject.signals, subject.kicked
    (('OP', 'MV', 'PV'), ('process.PV',))
    """
    if isinstance(given, Subject):
        return given
    return Subject(given.name, lambda _: given, stages={given.name: _moving(given)}, kicked=_measured(given))


def start_kicks(values: Values, count: int, seed: int, size: float) -> Values:
    """Return start values (count, states): ``values`` (states,) times independent uniform factors 1 -+ size.

    A value of zero is moved by up to ``size`` in its own unit.  More kicks leave the first ones as they were.

    >>> start_kicks(np.array([100.0, 0.0]), 2, 1, 0.03).round(4).tolist()
    [[100.0709, 0.027], [97.865, 0.0269]]
    """
    factors = np.random.default_rng(seed).uniform(1.0 - size, 1.0 + size, (count, len(values)))
    return np.asarray(np.where(values == 0.0, factors - 1.0, values * factors))


def _moving(diagram: Diagram) -> tuple[str, ...]:
    still = {label for block in diagram.blocks if block.role is Role.SOURCE for label in block.output_labels}
    return tuple(signal for signal in diagram.signals if signal not in still)


def _measured(diagram: Diagram) -> tuple[str, ...]:
    """Return the states of the blocks that drive what a controller measures, those before its sensor included."""
    found: dict[str, None] = {}
    for block in diagram.blocks:
        label = block.loop_signal("PV") if block.role is Role.CONTROLLER else None
        seen: set[str] = set()
        while label in diagram.driven and label not in seen:
            seen.add(label)
            driver = diagram.blocks[diagram.driven[label][0]]
            found |= dict.fromkeys(f"{driver.name}.{state}" for state in driver.state_names)
            label = driver.loop_signal("PV") if driver.role in (Role.SENSOR, Role.FILTER) else None
    return tuple(found)
