"""One diagram over thousands of parameter sets, starts and seeds, on all cores."""

from stickslip.diagram.ensembles.result import Ensemble
from stickslip.diagram.ensembles.running import ensemble

__all__ = ["Ensemble", "ensemble"]
