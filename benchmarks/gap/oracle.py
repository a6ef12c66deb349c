"""What shrinkage was possible: that of the true effect at its true size, on the rows that judge a diagnosis."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram
    from stickslip.logs import Log


def possible(model: "Diagram", log: "Log", effects: Mapping[str, Mapping[str, float]]) -> float | None:
    """Return the held-out shrinkage with the true effect, None for none, several, or one of log or noise only."""
    from stickslip.gap.diagnosis import held_against
    from stickslip.gap.effects import effect
    from stickslip.gap.likelihood.fit import tried, unfitted
    from stickslip.gap.likelihood.held_out import shrunk
    from stickslip.gap.likelihood.hypothesis import Hypothesis
    from stickslip.gap.likelihood.search import model_alone

    if len(effects) != 1:
        return None
    ((name, values),) = effects.items()
    one = effect(name)
    if one.of_log or name == "sensor_noise":
        return None
    null = model_alone(held_against(model, log))
    frame = null.hypothesis.frame
    own = {p.name: float(values[p.name]) for p in one.parameters if p.name in values}
    each = (tried(Hypothesis(frame, one, place), {**null.best.values, **own}) for place in one.places(frame.model))
    found = [x for x in each if x is not None]
    return shrunk(null, unfitted(min(found, key=lambda x: x.nll))).fraction if found else None


def relative(found: Mapping[str, Any]) -> float | None:
    """Return the shrinkage of a row relative to what was possible, at most 1; None where little was possible."""
    got, best = found.get("shrinkage"), found.get("oracle")
    if got is None:
        return None
    return min(float(got) / max(float(best), 0.05), 1.0) if best is not None and best < 1.0 else min(float(got), 1.0)


def right(row: Mapping[str, Any]) -> bool:
    """Return whether the answer of a row is right: the name up to its class, both names of a pair, unknown, no gap."""
    if len(row["effects"]) == 1:
        return bool(row["cause"])
    if row["effects"]:
        return bool(row["both"])
    return bool(row["unknown"]) if row["outside"] else not row["gap"]
