"""A log: one time axis and any number of named signals on it, with units, spans and quality."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from stickslip.logs.arrays import Mask, Values, check_time, checked_mask, checked_span, frozen_array, seconds_and_start
from stickslip.logs.errors import LogError
from stickslip.logs.hint import nearest
from stickslip.logs.loop_signals import LoopSignals, LoopsLater, renamed

if TYPE_CHECKING:
    import polars as pl
    from matplotlib.figure import Figure
    from stickslip.logs.loop import LoopRecord
    from stickslip.logs.tags import Process

__all__ = ["Log", "LogError"]


@dataclass(frozen=True, eq=False)
class Log:
    """Signals over time, unchangeable once built.

    Parameters: ``t`` ((n,) array [s]) Finite, strictly increasing, n >= 1; it may start anywhere and need not be evenly
    spaced. Moments (datetime64, datetime objects) become seconds from the first one, which is then ``start``;
    ``signals`` (mapping of name to (n,) array) Values in the signal's own unit; NaN means missing. Arrays are copied
    unless they are read-only; ``units`` (mapping of name to str) Unit of each signal; absent means unknown; ``spans``
    (mapping of name to (low, high)) Instrument span in the signal's unit, low < high; absent means unknown; ``quality``
    (mapping of name to (n,) bool array) True where the sample is good; absent means every finite value is good;
    ``loops`` (mapping of tag to LoopSignals) Which signals make up which control loop, where that is known; ``origin``
    (str) One line: where the log comes from; ``start`` (datetime, optional) Wall-clock time of t = 0;
    ``notes`` (tuple of str) What a reader assumed or repaired, one sentence each.

    Raises ``LogError`` if lengths differ, time does not increase, a span is empty or a mapping names an unknown signal.

    >>> log = Log(t=[0, 1, 2], signals={"OP": [50, 51, 52], "PV": [4, float("nan"), 5]}, units={"OP": "%"})
    >>> log.names, len(log), log.duration
    (('OP', 'PV'), 3, 2.0)
    >>> log.good("PV").tolist()
    [True, False, True]
    """

    t: Values
    signals: Mapping[str, Values]
    units: Mapping[str, str] = field(default_factory=dict)
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    quality: Mapping[str, Mask] = field(default_factory=dict)
    origin: str = ""
    start: datetime | None = None
    notes: tuple[str, ...] = ()
    loops: Mapping[str, LoopSignals] = field(default_factory=dict)

    def __post_init__(self) -> None:
        seconds, start = seconds_and_start(self.t)
        t = frozen_array(seconds, "time")
        check_time(t)
        signals = {name: frozen_array(values, f"signal {name!r}") for name, values in self.signals.items()}
        for name, values in signals.items():
            if not isinstance(name, str) or not name or name == "time":
                raise LogError(
                    f"a signal cannot be called {name!r}: names are text other than '' and 'time'; rename it"
                )
            if len(values) != len(t):
                raise LogError(f"signal {name!r} has {len(values)} samples and time has {len(t)}; they must be equal")
        for kind, mapping in (("units", self.units), ("spans", self.spans), ("quality", self.quality)):
            for name in mapping:
                if name not in signals:
                    raise LogError(f"{kind} name a signal {name!r} that is not logged; {nearest(name, signals)}")
        loops = self.loops
        if not isinstance(loops, LoopsLater):  # what is worked out later is not known yet
            loops = MappingProxyType(dict(loops))
            for tag, part, signal in [(tag, *part) for tag, loop in loops.items() for part in loop.parts.items()]:
                if signal not in signals:
                    raise LogError(
                        f"{part} of loop {tag!r} is {signal!r}, which is not logged; {nearest(signal, signals)}"
                    )
        set_field = object.__setattr__
        set_field(self, "t", t)
        set_field(self, "start", self.start if start is None else start)
        set_field(self, "signals", MappingProxyType(signals))
        set_field(self, "units", MappingProxyType({name: str(u) for name, u in self.units.items() if u}))
        set_field(self, "spans", MappingProxyType({n: checked_span(n, s) for n, s in self.spans.items()}))
        set_field(self, "quality", MappingProxyType({n: checked_mask(n, q, len(t)) for n, q in self.quality.items()}))
        set_field(self, "notes", tuple(self.notes))
        set_field(self, "loops", loops)

    def __reduce__(self) -> tuple[Any, ...]:
        # Read-only mappings cannot be pickled; process pools need logs that can.
        plain = (dict(self.signals), dict(self.units), dict(self.spans), dict(self.quality))
        return type(self), (self.t, *plain, self.origin, self.start, self.notes, dict(self.loops))

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} [{self.units[name]}]" if name in self.units else name for name in self.names)
        return f"<Log of {len(self)} samples over {self.duration:g} s: {shown or 'no signals'}>"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the signals, in the order given."""
        return tuple(self.signals)

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.t[-1] - self.t[0])

    @cached_property
    def dt(self) -> float:
        """Median sampling interval [s]; NaN for a single sample."""
        return float(np.median(np.diff(self.t))) if len(self.t) > 1 else float("nan")

    def __len__(self) -> int:
        return len(self.t)

    def __contains__(self, name: object) -> bool:
        return name in self.signals

    def __getitem__(self, name: str) -> Values:
        """Values of the signal ``name``, shape (n,), read-only.

        >>> Log(t=[0.0], signals={"OP": [50.0]})["Op"]
        Traceback (most recent call last):
        ...
        stickslip.logs.errors.LogError: no signal 'Op'; did you mean 'OP'? known: OP
        """
        try:
            return self.signals[name]
        except KeyError:
            raise LogError(f"no signal {name!r}; {nearest(name, self.signals)}") from None

    def good(self, name: str) -> Mask:
        """True where ``name`` is finite and not marked bad, shape (n,)."""
        finite = np.isfinite(self[name])
        return finite & self.quality[name] if name in self.quality else finite

    def gaps(self, factor: float = 5.0) -> list[tuple[float, float]]:
        """Stretches without samples: pairs (t0, t1) [s] of neighbours with t1 - t0 > ``factor`` * median step.

        Raises LogError unless the factor is positive.

        >>> Log(t=[0, 1, 2, 3, 20, 21], signals={}).gaps()
        [(3.0, 20.0)]
        """
        if not factor > 0:
            raise LogError(f"factor = {factor!r} is not positive; give a multiple of the median step")
        steps = np.diff(self.t)
        if len(steps) == 0:
            return []
        before = np.flatnonzero(steps > factor * np.median(steps))
        return [(float(self.t[i]), float(self.t[i + 1])) for i in before]

    def samples(self, first: int, stop: int) -> Log:
        """The samples first, first + 1, ..., stop - 1 as a log of their own; time keeps its origin.

        Raises LogError unless 0 <= first < stop <= number of samples.
        """
        if not 0 <= first < stop <= len(self):
            raise LogError(
                f"samples {first} to {stop} are not a stretch of 0 to {len(self)}; "
                "give 0 <= first < stop <= number of samples"
            )
        part = slice(first, stop)
        return replace(
            self,
            t=self.t[part],
            signals={name: values[part] for name, values in self.signals.items()},
            quality={name: mask[part] for name, mask in self.quality.items()},
        )

    def between(self, t0: float, t1: float) -> Log:
        """The samples with t0 <= t <= t1 [s]; time keeps its origin.

        Raises LogError if there is none.

        >>> Log(t=[0, 1, 2, 3], signals={"OP": [5, 6, 7, 8]}).between(1, 2)["OP"]
        array([6., 7.])
        """
        first = int(np.searchsorted(self.t, t0, side="left"))
        stop = int(np.searchsorted(self.t, t1, side="right"))
        if first >= stop:
            raise LogError(
                f"no sample between {t0!r} s and {t1!r} s; the log runs from {self.t[0]} s to {self.t[-1]} s"
            )
        return self.samples(first, stop)

    def with_signals(self, **signals: npt.ArrayLike) -> Log:
        """A log with these signals added or replaced; a replaced signal keeps unit and span, not quality."""
        # Construction converts and checks them; Any only tells the type checker so.
        merged: dict[str, Any] = {**self.signals, **signals}
        return replace(
            self,
            signals=merged,
            quality={name: mask for name, mask in self.quality.items() if name not in signals},
        )

    def with_signal(
        self, name: str, values: npt.ArrayLike, unit: str = "", span: tuple[float, float] | None = None
    ) -> Log:
        """A log with the signal ``name`` added or replaced, with its unit and its span in that unit.

        >>> Log(t=[0, 1], signals={}).with_signal("OP", [50, 51], unit="%", span=(0, 100)).spans["OP"]
        (0.0, 100.0)
        """
        log = self.with_signals(**{name: values})
        units = {**log.units, name: unit} if unit else log.units
        spans = {**log.spans, name: span} if span is not None else log.spans
        return replace(log, units=units, spans=spans)

    def renamed(self, names: Mapping[str, str]) -> Log:
        """A log with signals renamed old -> new.

        Raises LogError for an unknown signal, or if two would have one name.

        >>> Log(t=[0], signals={"u": [1], "y": [2]}).renamed({"u": "OP", "y": "PV"}).names
        ('OP', 'PV')
        """
        for old in names:
            self[old]
        new = [names.get(name, name) for name in self.names]
        if len(set(new)) < len(new):
            twice = next(name for name in new if new.count(name) > 1)
            raise LogError(f"two signals would be called {twice!r}; give each a name of its own")
        return replace(
            self,
            signals={names.get(name, name): values for name, values in self.signals.items()},
            units={names.get(name, name): unit for name, unit in self.units.items()},
            spans={names.get(name, name): span for name, span in self.spans.items()},
            quality={names.get(name, name): mask for name, mask in self.quality.items()},
            loops=renamed(self.loops, names),
        )

    def clock(self) -> list[datetime]:
        """Wall-clock time of every sample.

        Raises LogError if ``start`` is not known.
        """
        if self.start is None:
            raise LogError("the wall-clock time is not known; build the log with start=datetime(...)")
        return [self.start + timedelta(seconds=float(seconds)) for seconds in self.t]

    def loop(
        self,
        sp: str | None = "SP",
        pv: str = "PV",
        op: str = "OP",
        mv: str | None = None,
        mode: str | None = None,
        name: str = "",
        process: Process = "unknown",
    ) -> LoopRecord:
        """The control loop made of these signals.

        A log without "SP" gives a loop without set point; "MV" (the stem position) and "MODE" are taken
        when they are logged and no other name is given. A ``name`` that is one of ``loops`` takes the signals noted
        there, unless others are given.  What is noted of a loop with this PV and OP (kind of process, measurement)
        holds unless other is said.

        >>> log = Log(t=[0, 1], signals={"PV": [4, 5], "OP": [50, 51]})
        >>> log.loop(name="FIC211").sp is None
        True
        """
        from stickslip.logs.loop import LoopRecord
        from stickslip.logs.tags import measurement_of

        if name in self.loops and (sp, pv, op, mv, mode) == ("SP", "PV", "OP", None, None):
            record = self._noted_loop(name)
            return record if process == "unknown" else replace(record, process=process)
        noted = next((loop for loop in self.loops.values() if (loop.pv, loop.op) == (pv, op)), None)
        if noted is not None and process == "unknown":
            process = noted.process

        return LoopRecord(
            log=self,
            name=name,
            sp_name=None if sp == "SP" and "SP" not in self else sp,
            pv_name=pv,
            op_name=op,
            mv_name="MV" if mv is None and "MV" in self and "MV" not in (sp, pv, op) else mv,
            mode_name="MODE" if mode is None and "MODE" in self else mode,
            process=process,
            measurement=measurement_of(name) or ("" if noted is None else noted.measurement),
        )

    def _noted_loop(self, tag: str) -> LoopRecord:
        from stickslip.logs.loop import noted_loop

        return noted_loop(self, tag)

    def loop_records(self) -> tuple[LoopRecord, ...]:
        """Every loop noted in ``loops``, or, where none is, the one of PV and OP.

        Raises ``LogError`` if there is neither.

        >>> log = Log(t=[0, 1], signals={"p": [4, 5], "u": [50, 51]}, loops={"PC1": LoopSignals(pv="p", op="u")})
        >>> [(record.name, record.pv_name) for record in log.loop_records()]
        [('PC1', 'p')]
        """
        return tuple(self._noted_loop(tag) for tag in self.loops) if self.loops else (self.loop(),)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write a CSV file with the metadata in '# ' lines; ``read_log`` gives the same log back."""
        from stickslip.logs.files.write import write_csv

        write_csv(self, path)

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write a Parquet file with the metadata in its footer; ``read_log`` gives the same log back."""
        from stickslip.logs.files.write import write_parquet

        write_parquet(self, path)

    def to_pandas(self) -> Any:
        """A pandas data frame: one column a signal, the time [s] as index, units in ``attrs["units"]``.

        Raises ImportError that says what to install if pandas is not there. Quality and spans are left behind.
        """
        from stickslip.logs.as_frames import to_pandas

        return to_pandas(self)

    def to_polars(self) -> pl.DataFrame:
        """A polars data frame: the column "time" [s] and one column a signal. Units, quality, spans are left behind.

        >>> Log(t=[0, 1], signals={"OP": [50, 51]}).to_polars().columns
        ['time', 'OP']
        """
        from stickslip.logs.as_frames import to_polars

        return to_polars(self)

    def _repr_html_(self) -> str:
        from stickslip.logs.notebook import table

        return table(self)

    def plot(self, names: str | list[str] | tuple[str, ...] | None = None) -> Figure:
        """A figure with one panel per signal over time; see ``stickslip.logs.figures.plot_log``."""
        from stickslip.logs.figures import plot_log

        return plot_log(self, names)
