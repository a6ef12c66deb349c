"""One control loop: which signals of a log are its set point, measurement, controller output and stem."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self, get_args

import numpy as np
import numpy.typing as npt
from stickslip.logs.arrays import Mask, Values
from stickslip.logs.errors import LogError
from stickslip.logs.log import Log
from stickslip.logs.shown import Shown
from stickslip.logs.tags import Process, measurement_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["LoopRecord", "noted_loop"]


@dataclass(frozen=True, eq=False, repr=False)
class LoopRecord(Shown):
    """A view of a log as one control loop, e = SP - PV.

    Parameters: ``log`` (Log) Holds the signals; ``name`` (str) Tag of the loop, for titles and reports; ``sp_name``,
    ``pv_name``, ``op_name`` (str) Signals of the set point (None if not logged), the measurement and the controller
    output; ``mv_name`` (str, optional) Signal of the true stem position, which few plants log; ``mode_name`` (str,
    optional) Signal of the controller mode: 0 manual, 1 automatic, 2 cascade, NaN unknown; ``process``
    ({"self_regulating", "integrating", "unknown"}) What PV does after a step of OP: it settles or it runs away;
    ``measurement`` (str) "flow", "level", "pressure", "temperature", "analyser" or "".

    Raises ``LogError`` if a signal is not in the log, one signal is given two parts, or ``process`` is none of the
    three.

    >>> loop = LoopRecord.from_arrays([0, 1, 2], pv=[4, 5, 6], op=[50, 49, 48], sp=[5, 5, 5], name="FIC211")
    >>> loop.e.tolist(), loop.dt, loop.measurement
    ([1.0, 0.0, -1.0], 1.0, 'flow')
    """

    log: Log
    name: str
    sp_name: str | None
    pv_name: str
    op_name: str
    mv_name: str | None = None
    mode_name: str | None = None
    process: Process = "unknown"
    measurement: str = ""

    def __post_init__(self) -> None:
        parts = {
            "sp": self.sp_name,
            "pv": self.pv_name,
            "op": self.op_name,
            "mv": self.mv_name,
            "mode": self.mode_name,
        }
        taken: dict[str, str] = {}
        for part, signal in parts.items():
            if signal is None:
                if part in ("pv", "op"):
                    raise LogError(f"{part} = None; a loop needs PV and OP, name the signals that hold them")
                continue
            self.log[signal]
            if signal in taken:
                raise LogError(f"signal {signal!r} is given as {taken[signal]} and as {part}; name one for each")
            taken[signal] = part
        if self.process not in get_args(Process):
            raise LogError(f"process = {self.process!r}; give one of {', '.join(get_args(Process))}")

    @classmethod
    def from_arrays(
        cls,
        t: npt.ArrayLike,
        pv: npt.ArrayLike,
        op: npt.ArrayLike,
        sp: npt.ArrayLike | None = None,
        mv: npt.ArrayLike | None = None,
        name: str = "",
        process: Process = "unknown",
        op_span: tuple[float, float] | None = (0.0, 100.0),
        unit_pv: str = "",
        mode: npt.ArrayLike | None = None,
    ) -> Self:
        """A loop from plain arrays of equal length.

        Parameters: ``t`` ((n,) [s]) Or moments: datetime64, datetime objects, a DatetimeIndex; seconds then count from
        the first; ``pv``, ``sp`` ((n,) [unit_pv]); ``op``, ``mv`` ((n,) [unit of op_span]) Controller output and, if
        measured, the stem position, both on the same span; ``op_span`` ((low, high) or None) Span of OP; (0, 100) means
        %, None means unknown; ``mode`` ((n,), optional) 0 manual, 1 automatic, 2 cascade, NaN unknown.

        Raises LogError as ``Log`` does.
        """
        given = {"SP": sp, "PV": pv, "OP": op, "MV": mv, "MODE": mode}
        # Log converts and checks them; the cast only tells the type checker so.
        times: Any = t
        signals: dict[str, Any] = {key: values for key, values in given.items() if values is not None}
        units: dict[str, str] = {key: unit_pv for key in ("SP", "PV") if key in signals}
        if op_span is not None and tuple(op_span) == (0, 100):
            units |= {key: "%" for key in ("OP", "MV") if key in signals}
        spans: dict[str, tuple[float, float]] = {
            key: op_span for key in ("OP", "MV") if key in signals and op_span is not None
        }
        return cls(
            log=Log(t=times, signals=signals, units=units, spans=spans, origin="arrays"),
            name=name,
            sp_name="SP" if sp is not None else None,
            pv_name="PV",
            op_name="OP",
            mv_name="MV" if mv is not None else None,
            mode_name="MODE" if mode is not None else None,
            process=process,
            measurement=measurement_of(name),
        )

    def __len__(self) -> int:
        return len(self.log)

    @property
    def headline(self) -> str:
        """The record in one line."""
        known = "".join(f", {part}" for part in ("SP", "MV", "MODE") if self._logged(part))
        return (
            f"{self.name or '(unnamed)'}: {len(self)} samples, dt {self.dt:g} s, PV, OP{known}; "
            f"{self.measurement or 'measurement unknown'}, {self.process}"
        )

    def _logged(self, part: str) -> bool:
        return {"SP": self.sp_name, "MV": self.mv_name, "MODE": self.mode_name}[part] is not None

    @property
    def t(self) -> Values:
        """Time [s], shape (n,)."""
        return self.log.t

    @property
    def sp(self) -> Values | None:
        """Set point [unit of PV], shape (n,), or None if it is not logged."""
        return None if self.sp_name is None else self.log[self.sp_name]

    @property
    def pv(self) -> Values:
        """Measurement [its unit], shape (n,)."""
        return self.log[self.pv_name]

    @property
    def op(self) -> Values:
        """Controller output [its unit], shape (n,)."""
        return self.log[self.op_name]

    @property
    def mv(self) -> Values | None:
        """True stem position [its unit], shape (n,), or None if it is not logged."""
        return None if self.mv_name is None else self.log[self.mv_name]

    @property
    def mode(self) -> Values | None:
        """Controller mode (0 manual, 1 automatic, 2 cascade, NaN unknown), shape (n,), or None."""
        return None if self.mode_name is None else self.log[self.mode_name]

    @property
    def e(self) -> Values | None:
        """Control error e = SP - PV [unit of PV], shape (n,), or None if SP is not logged."""
        return None if self.sp is None else self.sp - self.pv

    @property
    def dt(self) -> float:
        """Median sampling interval [s]; NaN for a single sample."""
        return self.log.dt

    @cached_property
    def good(self) -> Mask:
        """True where PV, OP and SP (if logged) are good and the mode (if logged) is automatic or cascade."""
        mask = self.log.good(self.pv_name) & self.log.good(self.op_name)
        if self.sp_name is not None:
            mask &= self.log.good(self.sp_name)
        if self.mode_name is not None:
            mask &= self.log.good(self.mode_name) & (self.log[self.mode_name] >= 1)
        mask.flags.writeable = False
        return mask

    @cached_property
    def kept(self) -> slice | Mask:
        """What picks the good samples of a signal: a slice where all are good, which copies nothing, else ``good``.

        >>> loop = LoopRecord.from_arrays(range(3), pv=[1, 2, 3], op=[4, 5, 6])
        >>> loop.kept, loop.pv[loop.kept].tolist()
        (slice(None, None, None), [1.0, 2.0, 3.0])
        """
        return slice(None) if self.good.all() else self.good

    @property
    def op_span(self) -> tuple[float, float] | None:
        """Span of OP in its unit, or None when it is unknown."""
        return self.log.spans.get(self.op_name)

    @property
    def op_percent(self) -> Values | None:
        """OP in % of its span, 100 (OP - low) / (high - low), or None when the span is unknown.

        >>> LoopRecord.from_arrays([0, 1], pv=[1, 2], op=[4, 12], op_span=(4, 20)).op_percent
        array([ 0., 50.])
        """
        if self.op_span is None:
            return None
        low, high = self.op_span
        return 100.0 * (self.op - low) / (high - low)

    def segments(self, min_samples: int = 2, gap_factor: float = 5.0) -> list[LoopRecord]:
        """Stretches of good samples without a gap, each of at least ``min_samples``.

        A gap is a step longer than ``gap_factor`` times the median step of the whole record.

        Raises LogError unless min_samples >= 1 and gap_factor > 0.

        >>> loop = LoopRecord.from_arrays(range(6), pv=[1, 2, float("nan"), 4, 5, 6], op=[1, 1, 1, 1, 1, 1])
        >>> [part.t.tolist() for part in loop.segments()]
        [[0.0, 1.0], [3.0, 4.0, 5.0]]
        """
        if min_samples < 1:
            raise LogError(f"min_samples = {min_samples}; a stretch has at least 1 sample")
        if not gap_factor > 0:
            raise LogError(f"gap_factor = {gap_factor!r} is not positive; give a multiple of the median step")
        joined = np.zeros(len(self), dtype=bool)  # joined[i]: sample i continues the stretch of i - 1
        joined[1:] = self.good[1:] & self.good[:-1] & ~(np.diff(self.t) > gap_factor * self.dt)
        starts = np.flatnonzero(self.good & ~joined)
        ends = np.flatnonzero(self.good & ~np.append(joined[1:], False)) + 1
        return [
            replace(self, log=self.log.samples(int(first), int(stop)))
            for first, stop in zip(starts, ends, strict=True)
            if stop - first >= min_samples
        ]

    @property
    def notes(self) -> tuple[str, ...]:
        """Assumptions, repairs and missing parts, one sentence each."""
        own = []
        if self.sp_name is None:
            own.append("SP is not logged: e = SP - PV is not known.")
        if self.op_span is None:
            seen = self.op[self.log.good(self.op_name)]
            extent = f"values {seen.min():.4g} to {seen.max():.4g}" if len(seen) else "no good value"
            own.append(f"OP has no known span ({extent}): amounts in % are not given.")
        return (*self.log.notes, *own)

    def plot(self) -> Figure:
        """Trend of SP, PV and OP with the PV-OP (and MV-OP) phase plot; see ``stickslip.logs.figures.plot_loop``."""
        from stickslip.logs.figures import plot_loop

        return plot_loop(self)


def noted_loop(log: Log, tag: str) -> LoopRecord:
    """Return the loop that a log notes under a tag; raise KeyError if there is none."""
    loop = log.loops[tag]
    parts = {f"{part}_name": signal for part, signal in loop.parts.items()}
    return LoopRecord(
        log, tag, parts.pop("sp_name", None), **parts,
        process=loop.process, measurement=loop.measurement or measurement_of(tag),
    )  # fmt: skip
