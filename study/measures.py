"""Measures of a run: mean, amplitude, standard deviation and period of signals, saturation, slips.

Amplitude is half of peak to peak; the period is the mean time between turns from low to high, as in
``stickslip.logs.oscillation``.  Saturated is the share of the logged time an OP spends at a limit of its controller.  A
slip is a change from stuck to sliding.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from stickslip.blocks.declared import STUCK_MODE
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.logs.arrays import Values
from stickslip.logs.oscillation import oscillations

AT_LIMIT = 1e-9  # of the limit's size, or of 1: rounding at the stop
STANDS = 1e-12  # of the size of a signal: an amplitude below is rounding, and has no period

NAMES = ("mean", "amplitude", "sd", "period")


@dataclass(frozen=True)
class OwnMeasures:
    """Measures in place of the usual ones: ``function`` takes times and signals of a run and gives the ``names``."""

    names: tuple[str, ...]
    function: Callable[[Values, Mapping[str, Values]], Mapping[str, float]]


class Measures:
    """Measures the runs of a diagram from ``since`` [s] on; signals and limits are looked up once."""

    def __init__(
        self, diagram: Diagram, signals: Sequence[str], since: float, params: Mapping[str, float] | None = None
    ) -> None:
        self.signals, self.since = tuple(signals), since
        self.limits = limits(diagram, signals, params)

    def __call__(self, t: Values, log: Mapping[str, Values]) -> dict[str, float]:
        """Return the numbers of one run: ``SIGNAL.mean`` and so on."""
        first = int(np.searchsorted(t, self.since - 1e-9 * max(1.0, self.since)))
        late = t[first:]
        Y = np.array([log[signal][first:] for signal in self.signals])
        mean = Y.mean(axis=1)
        sd = Y.std(axis=1)
        period, amplitude = oscillations(late, Y)
        period[amplitude <= STANDS * np.abs(mean)] = math.nan
        table = np.stack([mean, amplitude, sd, period], axis=1).tolist()
        found = {
            f"{signal}.{name}": value
            for signal, row in zip(self.signals, table, strict=True)
            for name, value in zip(NAMES, row, strict=True)
        }
        for signal, (low, high) in self.limits.items():
            y = Y[self.signals.index(signal)]
            at = np.zeros(len(y), dtype=bool)
            if math.isfinite(low):
                at |= y <= low + AT_LIMIT * max(1.0, abs(low))
            if math.isfinite(high):
                at |= y >= high - AT_LIMIT * max(1.0, abs(high))
            found[f"{signal}.saturated"] = float(at.mean())
        return found


def limits(
    diagram: Diagram, signals: Sequence[str], params: Mapping[str, float] | None = None
) -> dict[str, tuple[float, float]]:
    """Return low and high of the signals that a controller with a finite limit gives; ``params`` come first.

    >>> from stickslip.plant import production_plant
    >>> limits(production_plant(), ["OP_VPCS1", "p_1", "tau_d"])
    {'OP_VPCS1': (0.0, 1.0), 'tau_d': (0.0, inf)}
    """
    found = {}
    for signal, (least, most) in limiting(diagram, signals).items():
        ends = zip((least, most), diagram.blocks[diagram.driven[signal][0]].limits, strict=True)
        low, high = ((params or {}).get(key, value) for key, value in ends)
        if math.isfinite(low) or math.isfinite(high):
            found[signal] = (low, high)
    return found


def limiting(diagram: Diagram, signals: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return the parameters, as ``block.parameter``, that limit the signals which a controller or valve gives as OP.

    >>> from stickslip.plant import production_plant
    >>> limiting(production_plant(), ["OP_VPCS1", "p_1"])
    {'OP_VPCS1': ('PCS11.low', 'PCS11.high')}
    """
    found = {}
    for signal in signals:
        block = diagram.blocks[diagram.driven[signal][0]]
        if block.role in (Role.CONTROLLER, Role.VALVE) and signal == block.loop_signal("OP") and block.limit_params:
            low, high = (f"{block.name}.{name}" for name in block.limit_params)
            found[signal] = (low, high)
    return found


def valves(diagram: Diagram) -> dict[str, tuple[int, float]]:
    """Return the blocks that can stick: name -> (number of the block, value of their mode "stuck")."""
    return {block.name: (b, block.modes[STUCK_MODE]) for b, block in enumerate(diagram.blocks) if block.can_stick}


def slips(events: Values, sticky: Mapping[str, tuple[int, float]], since: float) -> dict[str, int]:
    """Return how often each valve broke away from ``since`` [s] on; ``events`` (n, 4): t, block, before, after."""
    late = events[events[:, 0] >= since]
    away = late[late[:, 2] != late[:, 3]]
    return {
        name: int(np.sum((away[:, 1] == number) & (away[:, 2] == stuck))) for name, (number, stuck) in sticky.items()
    }
