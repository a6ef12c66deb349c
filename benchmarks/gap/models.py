"""The model that a diagnosis is given for each setting of the benchmark: nominal, with its nuisances and tolerances."""

from typing import TYPE_CHECKING

NAMES = {
    "ideal": "ideal_flow", "coarse": "ideal_flow", "site": "site_flow", "second_order": "second_order_flow",
    "level": "level_loop", "cascade": "level_cascade",
}  # fmt: skip

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram


def model(setting: str) -> "Diagram":
    """Return the diagram of a setting; raise ``KeyError`` for one that has none."""
    from stickslip.cases import models

    diagram: Diagram = getattr(models, NAMES[setting])()
    return diagram
