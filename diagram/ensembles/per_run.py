"""Settings of each run of an ensemble besides its numbers: start time, log times, inputs."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import Inputs, source, source_name
from stickslip.diagram.kept import log_times

Floats = NDArray[np.float64]


def grids(
    t0: Floats, duration: float, every: float | None, times: ArrayLike | None, signals: int, kept: bool
) -> Floats:
    """Return the log times [s]: (rows,) where all runs have the same, else (runs, rows).

    Raises ``ValueError`` as ``log_times`` does, the run's number added.
    """
    n = len(t0)
    own = times is not None and np.ndim(times) == 2
    if not own and (t0 == t0[0]).all():
        return log_times(duration, every, times, float(t0[0]), signals, n if kept else 1)
    rows = []
    for i, begin in enumerate(t0.tolist()):
        try:
            asked = np.asarray(times)[i] if own else times
            rows.append(log_times(duration, every, asked, begin, signals, n if kept and i == 0 else 1))
        except ValueError as error:
            error.add_note(f"run {i} of the ensemble")
            raise
    return np.array(rows)


def apart(diagram: Diagram, inputs: Inputs | None) -> tuple[Inputs | None, dict[str, list[Block]]]:
    """Return the inputs of the first run, and for those given as a list or array of one a run the source of each.

    A log or table stays whole.  Sources of one input must be of one kind, which ``variants`` checks.
    """
    table = isinstance(inputs, Mapping) and "time" in inputs and "time" not in diagram.open_inputs
    if table or not isinstance(inputs, Mapping):
        return inputs, {}
    first: dict[str, Any] = {}
    own: dict[str, list[Block]] = {}
    for signal, given in inputs.items():
        one_a_run = isinstance(given, list) or (isinstance(given, np.ndarray) and given.ndim == 1)
        if one_a_run and len(given) > 0:
            unit = diagram.input_units.get(signal, "")
            made = [source(signal, one, source_name(diagram, signal), unit) for one in given]
            own[made[0].name] = made
            first[signal] = made[0]
        else:
            first[signal] = given
    return first, own
