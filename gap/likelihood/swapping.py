"""The swap test: replace what the blamed segment gives by what the log says it gave, and see the gap vanish elsewhere.

    share = 1 - (E(swapped)^2 - w^2) / (E(free)^2 - w^2)
                            E root mean square of a free run less the log, for signals of other segments; w their noise

In a loop every signal is wrong when one block is.  If only the blamed segment is, all others come right as soon as its
outputs are those of the log.
"""

from dataclasses import dataclass

import numpy as np
from stickslip.diagram.ensembles.running import ensemble
from stickslip.gap.likelihood.replay import Replays


@dataclass(frozen=True)
class Swap:
    """The swap test: ``given`` signals come from the log. ``before`` and ``after`` are the errors of ``signal``, and
    ``noise`` is its error without a gap [unit].

    >>> print(Swap(("PV",), "OP", 0.024, 0.52, 0.001))
    Swap test: with PV from the log in place of the model's, the error of OP in a free run rises from 0.024 to 0.52 (so
    it says nothing of the place).
    """

    given: tuple[str, ...]
    signal: str
    before: float
    after: float
    noise: float

    @property
    def share(self) -> float:
        """Share of the error beyond the noise that has gone, as squares; 0 where there is none."""
        removable = self.before**2 - self.noise**2
        return float(np.clip((self.before**2 - self.after**2) / removable, 0.0, 1.0)) if removable > 0.0 else 0.0

    def __str__(self) -> str:
        falls = self.after < self.before
        part = f"{100.0 * self.share:.0f} % of what exceeds the noise" if falls else "so it says nothing of the place"
        return (
            f"Swap test: with {' and '.join(self.given)} from the log in place of the model's, the error of "
            f"{self.signal} in a free run {'falls' if falls else 'rises'} from {self.before:.2g} to {self.after:.2g} "
            f"({part})."
        )


def swapped(frame: Replays, place: str) -> Swap | None:
    """Return what the swap of the segment of a block shows; None where no other segment drives a logged signal."""
    pinned = frame.record.pinned
    logged = [s for s in frame.record.log.names if s in frame.quiet.signals]
    segment = next((one for one in frame.quiet.segments(logged) if place in one.blocks), None)
    if segment is None:
        return None
    given = tuple(s for s in pinned if s in segment.drives)
    others = tuple(s for s in pinned if s not in given)
    if not given or not others:
        return None
    free, swap = (_errors(frame, held, others) for held in ((), given))
    worst = max(others, key=lambda s: free[s] - swap[s])
    k = pinned.index(worst)
    noise = 0.0 if frame.null_model.changes[k] else float(np.linalg.norm(frame.null_model.L[k]))
    return Swap(given, worst, free[worst], swap[worst], noise)


def _errors(frame: Replays, given: tuple[str, ...], signals: tuple[str, ...]) -> dict[str, float]:
    """Return signal -> root mean square of a run, with some signals as the log has them, less the log."""
    log = frame.record.log
    held = frame.quiet.pinned(log, [*frame.record.played, *given])
    many = ensemble(
        held, log.duration, t0=np.full(1, log.t[0]), times=log.t, signals=list(signals), progress=False
    )  # fmt: skip
    return {
        s: float(np.sqrt(np.nanmean((many.values[s][0] - log[s])[frame.null_model.skipped :] ** 2))) for s in signals
    }
