"""One record and one model, and what every candidate explanation of their gap is measured with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.gap.answers.sureness import Sureness
from stickslip.gap.floors.floor import Floor, losses, scored
from stickslip.gap.floors.modes import branches_of
from stickslip.gap.records.model import known_within
from stickslip.gap.records.offsets import READY, branched, known_starts, offsets
from stickslip.gap.records.record import FEWEST, Record
from stickslip.logs import Log

Floats = NDArray[np.float64]
AFTER_LIMIT = 6  # rows behind a limit that are not scored where residuals are predicted
EARLY = 0.2  # share of the record on which sizes are tried first
SHOWN = 600.0  # nats by which the gap must show there
FAIR = 0.4  # of its share by rows, at least
SIGMAS = 4.5  # by which F may exceed its mean without a gap
SIGMAS_OF_FILTER = 3.5  # the same of a large diagram, whose mean and spread forty runs tell


@dataclass(frozen=True, eq=False)
class Settled:
    """Parameters that are known within tolerances, as they suit the record best: ``values``, and innovations ``e``."""

    values: Mapping[str, float]
    e: Floats


@dataclass(frozen=True, eq=False)
class Problem:
    """``model`` with its nuisances, ``quiet`` without, both starting as the record does; ``record``; ``floor``;
    ``settled`` the parameters that have tolerances, as they suit the record best without any effect; ``before``
    the problem before the switches of its set points were put at scans; ``sureness`` how often names are right;
    ``modes`` whether modes of a stem that the model gets wrong are set right.
    """

    model: Diagram
    quiet: Diagram
    record: Record
    floor: Floor
    start: Mapping[str, float]
    settled: Settled | None = None
    before: "Problem | None" = None
    sureness: Sureness = field(default_factory=Sureness)
    modes: bool = True

    @cached_property
    def free(self) -> dict[str, tuple[float, float]]:
        """Parameters of the model that are known within a tolerance only, with (low, high)."""
        return known_within(self.quiet)

    def innovations(
        self,
        diagram: Diagram,
        params: Mapping[str, ArrayLike] | None = None,
        record: Record | None = None,
        logs: Sequence[Log] | None = None,
    ) -> Floats:
        """Return the innovations of a diagram, one run for each entry of the parameters, (runs, rows, signals).

        ``logs``: one a run in place of the record's.
        """
        return self.replayed(diagram, params, record, logs)[0]

    def begun(self, diagram: Diagram) -> Diagram:
        """Return a diagram that starts as the record does."""
        return _started(diagram, tuple(self.start.items()))

    def offsets(self, diagram: Diagram, params: Mapping[str, ArrayLike]) -> Floats:
        """Return what the pins add to a diagram that starts as the record does, (runs, rows, signals)."""
        return offsets(self.begun(diagram), self.record, params)

    def replayed(
        self,
        diagram: Diagram,
        params: Mapping[str, ArrayLike] | None = None,
        record: Record | None = None,
        logs: Sequence[Log] | None = None,
    ) -> tuple[Floats, Floats]:
        """Return the innovations, and how many modes of a stem that the model lacks were set right, (runs,).

        ``logs``: one a run in place of the record's.
        """
        ready = self.begun(diagram)
        branches = branches_of(diagram, self.quiet, self.record, self.floor, params) if self.modes else None
        found, kept = branched(ready, record or self.record, params, logs=logs, branches=branches)
        e = self.floor.innovations(found)
        if self.floor.coloured and logs is None and self.record.filter is None:  # what it drives is logged there
            e[:, self.at_limit[: e.shape[1]]] = np.nan
        return e, kept

    @cached_property
    def at_limit(self) -> NDArray[np.bool_]:
        """Whether a logged signal is at a limit of the block that drives it, or was a moment ago, (scored rows,).

        There the model is not linear, and a filter of it says nothing for some rows.
        """
        log = self.record.log
        found = np.zeros(len(log), dtype=bool)
        for s in self.record.pinned:
            block = self.quiet.blocks[self.quiet.driven[s][0]]
            if block.limit_params is None:
                continue
            low, high = block.limits
            near = 1.5 * self.record.lattice(s)
            found |= (log[s] <= low + near) | (log[s] >= high - near)
        for back in range(1, AFTER_LIMIT):
            found[back:] |= found[:-back] & True
        return found[self.floor.skipped :]

    @cached_property
    def as_it_is(self) -> Floats:
        """Innovations of the model as it is, its unsure parameters settled within their tolerances, (rows, signals)."""
        if self.settled is not None:
            return self.settled.e
        found: Floats = self.innovations(self.quiet)[0]
        return found

    @cached_property
    def score(self) -> float:
        """F of the model as it is."""
        return float(scored(self.as_it_is))

    @cached_property
    def early(self) -> "Problem":
        """The problem of the first part of the record where that shows the gap as well as the whole, else this one.

        Sizes are tried there first, at a fifth of the cost.
        """
        if (self.floor.coloured and self.record.filter is None) or self.free:
            return self
        scored_rows = round(EARLY * len(self.record.log)) - self.floor.skipped
        if scored_rows < FEWEST:
            return self
        head = replace(self, record=self.record.first_part(EARLY))
        e = self.as_it_is[:scored_rows]
        excess = float(losses(e).sum()) - self.floor.mean * scored_rows
        share = scored_rows / self.rows
        enough = excess > SHOWN and excess > FAIR * share * (self.score - self.level)
        return head if enough else self

    @cached_property
    def quick(self) -> "Problem":
        """The problem in which a filter takes what runs do between rows from the model for all explanations.

        That makes a replay several times quicker, and so little less exact that only explanations that come near the
        best have to be replayed with runs of their own.
        """
        return self.holding(self.quiet)

    def holding(self, diagram: Diagram, params: Mapping[str, ArrayLike] | None = None) -> "Problem":
        """Return the problem in which a filter takes what runs do between rows from one run of a diagram."""
        record = self.record
        if record.filter is None or record.filter.holds:
            return self
        held = record.filter.holding(self.begun(diagram), record, params)
        return replace(self, record=replace(record, filter=held))

    @property
    def rows(self) -> int:
        """How many rows are scored."""
        return len(self.as_it_is)

    @property
    def known(self) -> float:
        """How many rows are scored, a row with missing signals by the share that is there."""
        return float(np.isfinite(self.as_it_is).mean()) * self.rows

    @property
    def level(self) -> float:
        """Mean of F without a gap."""
        return self.floor.mean * self.known

    @property
    def limit(self) -> float:
        """F that records without a gap do not exceed."""
        far = SIGMAS if self.record.filter is None else SIGMAS_OF_FILTER
        return self.level + float(far * self.floor.sd * np.sqrt(self.known))


@lru_cache(maxsize=READY)
def _started(diagram: Diagram, start: tuple[tuple[str, float], ...]) -> Diagram:
    """Return a diagram with the start values that it has; the same one again for its next replays."""
    return diagram.starting_at(known_starts(diagram, dict(start)))
