"""A diagram whose signals are called and counted as in the log, for the trial of the foreign plants."""

from stickslip.diagram import Diagram

from benchmarks.foreign.trial import Wired


def as_logged(diagram: Diagram, **places: str) -> Wired:
    """Return the model: what its historian keeps is logged as it is; ``places`` block -> block of the data sheet."""
    return Wired(diagram, {name: (1.0, name) for name in diagram["historian"].input_labels}, places)
