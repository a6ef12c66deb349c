"""Noise and loads that a model states wrongly: no gap, but a note with what the log says of them."""

from collections.abc import Mapping

from stickslip.diagram.diagram import Diagram
from stickslip.gap.records.model import stated, stated_about

WRONG = 1.5  # factor from which on a note says so


def stated_wrongly(model: Diagram, found: Mapping[str, float]) -> tuple[str, ...]:
    """Return a sentence for each noise or load that the log has otherwise than the model states it.

    ``found`` has fitted values, block.parameter -> value, also of other parameters.

    >>> from stickslip.blocks import Noise
    >>> from stickslip.diagram import wire
    >>> stated_wrongly(wire([Noise("D", sd=0.2, dt=1.0, name="feed")], outputs=["D"]), {"feed.sd": 0.35})
    ('feed.sd is stated as 0.2; the log says 0.35.',)
    """
    said = []
    for key, value in stated(model, stated_about(model)).items():
        now = found.get(key, value)
        if max(now / value, value / now) > WRONG:
            said.append(f"{key} is stated as {value:g}; the log says {now:.3g}.")
    return tuple(said)
