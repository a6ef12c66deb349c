"""Parts that streaming twins share: a sample, the facts of a loop, and a buffer of constant size.

A twin is three functions: ``init(p, facts) -> state``, ``update(p, state, t, sample) -> state`` and
``verdict(p, state) -> Verdict``. States are values: updating one leaves the old one as it was, so a stream can
be replayed or branched, and a state can be pickled.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

_CHUNK = 64  # appending copies at most so many rows


class Sample(NamedTuple):
    """One scan of a loop, each in its own unit; NaN where it is missing or bad. mode: 0 is manual."""

    pv: float
    op: float
    sp: float = math.nan
    mode: float = 1.0


@dataclass(frozen=True)
class LoopFacts:
    """Facts of a loop that are known before its first sample: name, process, measurement, span of OP, SP logged."""

    name: str = ""
    process: str = "unknown"
    measurement: str = ""
    op_span: tuple[float, float] | None = (0.0, 100.0)
    has_sp: bool = True

    @classmethod
    def of(cls, record: LoopRecord) -> "LoopFacts":
        """The facts of a record."""
        return cls(record.name, record.process, record.measurement, record.op_span, record.sp is not None)


@dataclass(frozen=True)
class Buffer:
    """Rows (t, pv, op, sp, mode) in the order of arrival.

    >>> b = Buffer().append(0.0, Sample(1, 2)).append(1.0, Sample(3, 4))
    >>> len(b), b.rows()[:, 1].tolist()
    (2, [1.0, 3.0])
    """

    chunks: tuple[Values, ...] = ()
    recent: tuple[tuple[float, ...], ...] = ()
    held: int = 0  # rows in the chunks

    def __len__(self) -> int:
        return self.held + len(self.recent)

    @property
    def last_time(self) -> float:
        """Time of the youngest row [s]; -inf when empty."""
        if self.recent:
            return self.recent[-1][0]
        return float(self.chunks[-1][-1, 0]) if self.chunks else -math.inf

    def append(self, t: float, sample: Sample) -> "Buffer":
        """The buffer with one more row; raises ValueError when t [s] does not advance."""
        if not t > self.last_time:
            raise ValueError(f"t = {t} s follows {self.last_time} s; time must increase, drop repeated samples")
        recent = (*self.recent, (t, *sample))
        if len(recent) < _CHUNK:
            following = object.__new__(Buffer)  # once a sample: the constructor of a frozen class costs twice as much
            following.__dict__.update(chunks=self.chunks, recent=recent, held=self.held)
            return following
        return Buffer((*self.chunks, np.array(recent)), (), self.held + len(recent))

    def last(self, n: int) -> "Buffer":
        """The last n rows."""
        if not n:
            return Buffer()
        rows = self.rows()[-n:]
        return Buffer((rows,), (), len(rows))

    def rows(self) -> Values:
        """All rows, shape (n, 5)."""
        parts = [*self.chunks, np.array(self.recent, dtype=float).reshape(-1, 5)]
        return np.concatenate(parts)

    def record(self, facts: LoopFacts) -> LoopRecord:
        """The rows as a loop record."""
        rows = self.rows()
        record = LoopRecord.from_arrays(
            rows[:, 0], pv=rows[:, 1], op=rows[:, 2], sp=rows[:, 3] if facts.has_sp else None, mode=rows[:, 4],
            name=facts.name, op_span=facts.op_span,
        )  # fmt: skip
        return replace(record, process=facts.process, measurement=facts.measurement)  # type: ignore[arg-type]
