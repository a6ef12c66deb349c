"""Where a filter across runs went, and how it says that a run failed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.arrays import Values

Whole = NDArray[np.int64]


def complain(status: int) -> None:
    """Raise ``ArithmeticError`` for a status that is not 0."""
    if status != 0:
        raise ArithmeticError(f"a run of the diagram failed, with status {status}")


@dataclass(frozen=True, eq=False)
class Path:
    """Where a filter began, ``z``; how much of each noise stayed, ``phi``; ``which`` of the ``slopes`` a stop has, and
    the noise in ``force`` before it (see ``extended``).
    """

    z: Values
    phi: Values
    which: Whole
    force: Values
    slopes: tuple[Values, ...]
