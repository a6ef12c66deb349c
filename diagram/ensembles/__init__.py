"""One diagram over thousands of parameter sets, starts and seeds, on all cores."""

from diagram.ensembles.result import Ensemble
from diagram.ensembles.running import ensemble

__all__ = ["Ensemble", "ensemble"]
