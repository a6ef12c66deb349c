"""Two effects as one, so that their sizes are fitted at once: parameters are called ``1.name`` and ``2.name``."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from stickslip.diagram.diagram import Diagram
from stickslip.gap.fits.search import Candidate, Fit
from stickslip.gap.insertion.effect import Effect


class Together(Effect):
    """Two effects, each at its own place; the place of the two is not used."""

    def __init__(self, first: Effect, first_place: str, second: Effect, second_place: str) -> None:
        self.parts = (("1.", first, first_place), ("2.", second, second_place))
        named = [replace(p, name=f"{mark}{p.name}") for mark, one, _ in self.parts for p in one.parameters]
        self.name, self.parameters = f"{first.name} and {second.name}", tuple(named)  # type: ignore[misc]
        self.hidden = first.hidden or second.hidden  # type: ignore[misc]

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the blocks of both."""
        for _, one, at in self.parts:
            diagram = one.put(diagram, at)
        return diagram

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the parameters of both; the second has those that suit a diagram with the first, which may scan."""
        found: dict[str, Any] = {}
        for mark, one, at in self.parts:
            found |= one.settings(diagram, at, **_of(values, mark))
            diagram = one.put(diagram, at)
        return found

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with both started where the log starts, beside a stem that alone (``inserting.begun``)."""
        for _, one, at in self.parts:
            diagram = one.started(diagram, at, first) if one.hidden or not self.hidden else diagram
        return diagram

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values of either."""
        return next((bad for mark, one, at in self.parts if (bad := one.rules(diagram, at, _of(values, mark)))), "")

    def nominal(self, diagram: Diagram, place: str) -> dict[str, float]:
        """Return the values at which neither is there."""
        return {f"{mark}{k}": v for mark, one, at in self.parts for k, v in one.nominal(diagram, at).items()}

    def bounds(self, diagram: Diagram, place: str) -> dict[str, tuple[float, float]]:
        """Return the bounds of both."""
        return {f"{mark}{k}": v for mark, one, at in self.parts for k, v in one.bounds(diagram, at).items()}


def together(first: Candidate, second: Candidate) -> Candidate | None:
    """Return two effects as one candidate; None where they are other values of the same parameters of a block."""
    one, two = first.effect, second.effect
    if one is None or two is None or first.noisy or second.noisy:
        return None
    keys = [set(c.effect.settings(c.base, c.place, **c.nominal)) for c in (first, second) if c.effect]
    both = Together(one, first.place, two, second.place)
    return None if keys[0] & keys[1] else Candidate(first.problem, first.problem.quiet, both, first.place)


def values_of(fit: Fit, mark: str) -> dict[str, float]:
    """Return the values of one of the two effects of a fit, ``mark`` "1." or "2.", and of what is free with both."""
    return _of(fit.values, mark) | {key: fit.values[key] for key in fit.candidate.problem.free}


def marked(values: Mapping[str, float], mark: str) -> dict[str, float]:
    """Return values of one effect under their names among both."""
    return {f"{mark}{key}": value for key, value in values.items()}


def _of(values: Mapping[str, Any], mark: str) -> dict[str, Any]:
    return {key.removeprefix(mark): value for key, value in values.items() if key.startswith(mark)}
