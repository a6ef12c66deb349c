"""One record made ready once, for every method: its facts, its oscillation, an even grid, its wave and half waves.

    record -> facts -> pieces between gaps and set-point moves -> oscillation -> even grid -> wave -> half waves

Everything is worked out when a method first asks for it and kept, so that twenty methods cost one preparation.
The wave of a signal is the signal on the even grid less its centred moving average over two periods, smoothed
without phase by a Butterworth filter of order 2 that cuts at ``CUT`` times the frequency of the oscillation.
Which half waves are accepted, ``half_waves.waves`` says.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from stickslip.detect.half_waves.cycles import Cycles, Refusal, cut
from stickslip.detect.half_waves.waves import HalfWave, half_waves_of
from stickslip.detect.health.causality import causality
from stickslip.detect.health.conditions import drawn_op, examine
from stickslip.detect.health.drawn import free_of_noise
from stickslip.detect.health.fact import Fact
from stickslip.detect.health.stale import without_stale
from stickslip.detect.oscillation import acf_crossings
from stickslip.detect.oscillation.clock import Clock, clock_of
from stickslip.detect.oscillation.gate import Gate
from stickslip.detect.oscillation.pieces import Pieces, pieces_of
from stickslip.detect.prepare.logged_part import logged_part
from stickslip.detect.prepare.record_signals import RecordSignals
from stickslip.detect.signals.filters import smoothed
from stickslip.detect.signals.gaps import bridgeable, split
from stickslip.detect.signals.harris import Harris, harris
from stickslip.detect.signals.smoothing import moving_average, noise_std
from stickslip.detect.stem.process_kind import Kind, kind_of_data, kind_of_tag
from stickslip.detect.stem.recent import recent
from stickslip.logs import LoopRecord, read_loop
from stickslip.logs.arrays import Values
from stickslip.logs.files.frames import frame_kind

if TYPE_CHECKING:
    from stickslip.detect.likelihood.pooled import Evidence
    from stickslip.detect.likelihood.stems import Stems

Signal = Literal["OP", "PV", "SP", "E", "MV"]

CUT = 5.0  # of the oscillation's frequency; higher harmonics carry the shape, noise lies above
SMOOTHED_FROM = 12.0  # samples a period below which a filter at CUT would cut the wave itself
CYCLES_MIN = 5.0  # the most that a method but the surrogates asks for
PERCENT = "% of OP"
STEPS_MAX = 20_000  # of a grid; of a longer piece the last part is looked at


@dataclass(frozen=True, eq=False)
class Grid:
    """A stretch of a record on an even grid.

    t : (n,) [s], every ``dt`` [s]
    op, pv, e : (n,), unit of the record; e = SP - PV, or mean(PV) - PV without SP
    sp, mv : (n,) or None
    drawn : share of the grid's points that lie inside a bridged gap [-]
    """

    t: Values
    dt: float
    op: Values
    pv: Values
    e: Values
    sp: Values | None
    mv: Values | None
    drawn: float

    def __len__(self) -> int:
        return len(self.t)


class Prepared(RecordSignals):
    """A loop record with what methods ask of it; see the module.

    >>> t = np.arange(1000.0)
    >>> loop = Prepared(LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t))
    >>> round(loop.period, 1), len(loop.half_waves("PV")), loop.present
    (50.3, 38, ())
    """

    def __init__(self, record: LoopRecord, *, stale_masked: bool = True) -> None:
        self._logged = logged_part(record)
        self.record = without_stale(self._logged) if stale_masked else self._logged
        self._waves: dict[tuple[str, float], Values] = {}
        self._halves: dict[str, tuple[HalfWave, ...]] = {}

    @cached_property
    def with_stale(self) -> "Prepared":
        """The same loop with its stale samples as they were logged, for what sorts them out itself."""
        return self if self.record is self._logged else Prepared(self._logged, stale_masked=False)

    # --- facts ------------------------------------------------------------------------------------------------
    @cached_property
    def facts(self) -> tuple[Fact, ...]:
        """The facts that are measured before anything is judged."""
        return examine(self.record)

    @cached_property
    def causality(self) -> Fact:
        """Whether PV follows OP; at no lag the PV-OP picture shows the controller."""
        grid = self.whole
        if not len(grid):
            return causality(grid.op, grid.pv, grid.e, math.nan)
        return causality(grid.op, grid.pv, grid.e, self.period / grid.dt, dt=grid.dt)

    @cached_property
    def stems(self) -> "Stems | None":
        """The record ready for the likelihood of stems, in % of OP where its span is known; None where too little is.

        Stale samples are as they were logged: the likelihood leaves them out itself.
        """
        from stickslip.detect.likelihood.stems import stems_of

        grid = self.with_stale.whole
        percent = self.op_percent(1.0)
        return stems_of(grid.op if percent is None else percent * grid.op, grid.pv) if len(grid) else None

    @cached_property
    def dead_travel(self) -> "Evidence | None":
        """What the record says of dead travel of its valve; None where too little of it moves or is left."""
        from stickslip.detect.likelihood.pooled import evidence_of

        return None if self.stems is None else evidence_of([self.stems])

    @property
    def health(self) -> tuple[Fact, ...]:
        """All that is known of the data: the facts, how many cycles there are, and what follows what."""
        if any(fact.code == "signal_missing" for fact in self.present):
            return self.facts
        return (*self.facts, self._cycles_fact, self.causality)

    @property
    def _cycles_fact(self) -> Fact:
        gate = self.gate
        few = bool(gate.oscillating and gate.cycles < CYCLES_MIN)
        text = (
            f"The record holds {gate.cycles:.1f} cycles ({CYCLES_MIN:g} wanted)." if gate.oscillating else gate.reason
        )
        remedy = "Log ten periods at a fixed set point."
        return Fact(
            "too_few_cycles", few, gate.cycles, CYCLES_MIN, text, remedy, forbids=False, judged=gate.oscillating
        )

    @property
    def present(self) -> tuple[Fact, ...]:
        """The facts that are beyond their limit."""
        return tuple(fact for fact in self.facts if fact.present)

    @cached_property
    def kind(self) -> Kind:
        """Whether the process integrates, and from what that was inferred."""
        by_tag = kind_of_tag(self.record)
        grid = self.whole if by_tag.integrating is None else _EMPTY
        return kind_of_data(grid.op, grid.pv, grid.sp, grid.e, self.period / grid.dt) if len(grid) else by_tag

    @property
    def integrating(self) -> bool | None:
        """Whether the process integrates; None where nothing is known."""
        return self.kind.integrating

    # --- oscillation ------------------------------------------------------------------------------------------
    @cached_property
    def pieces(self) -> Pieces:
        """The record between gaps and set-point moves, with the oscillation test of the longest piece."""
        return pieces_of(self.record, acf_crossings.Params())

    @property
    def gate(self) -> Gate:
        """Whether the loop oscillates, how fast and how regularly."""
        return self.pieces.gate

    @property
    def period(self) -> float:
        """Period of the oscillation [s]; NaN where none was found."""
        return self.gate.period if self.gate.oscillating and self.gate.period else math.nan

    @property
    def samples_per_period(self) -> float:
        """Points of the grid in a period [-]; NaN without an oscillation."""
        return self.period / self.stretch.dt

    @cached_property
    def clock(self) -> Clock:
        """Whether the wave of OP keeps time, as one from outside may; without noise or a wave no cycle is counted."""
        grid = self.stretch
        if not math.isfinite(self.period) or free_of_noise(grid.t, grid.pv):
            return Clock(math.nan, 0)
        return clock_of(grid.t, self.wave("OP"))

    @cached_property
    def op_drawn(self) -> Fact:
        """Share of the samples of OP that a historian has drawn."""
        return drawn_op(self.record)

    @cached_property
    def cycles(self) -> Cycles | Refusal:
        """The half cycles of the control error, each with its peak and areas, or why there are none."""
        return cut(self.record, None, self.pieces, self.facts)

    @cached_property
    def performance(self) -> Harris | None:
        """The Harris index of the control error, at an eighth of the period, or ten samples where nothing oscillates.

        The dead time is seldom known; the horizon in its place is ours.
        """
        if any(fact.code == "signal_missing" for fact in self.present):
            return None
        e = self.stretch.e
        ahead = self.samples_per_period / 8.0
        return harris(e, max(1, round(ahead)) if math.isfinite(ahead) else 10) if len(e) else None

    # --- even grids -------------------------------------------------------------------------------------------
    @cached_property
    def stretch(self) -> Grid:
        """The longest piece without long gaps and moves of the set point; only the last part of a long one."""
        t = self.pieces.longest[0]
        return self._last_part(float(t[0]), float(t[-1]), self.period) if len(t) > 1 else _EMPTY

    @cached_property
    def whole(self) -> Grid:
        """The longest piece without a long gap, moves of the set point included; of a long one the last part."""
        t = self.record.t
        every = split(self.record, bridgeable(self.record, 0.0))
        if len(every) > 1 and math.isfinite(self.period):  # with one piece no period needs to be found
            every = split(self.record, bridgeable(self.record, self.period))
        parts = [part for part in every if len(part) > 1]
        if not parts:
            return _EMPTY
        longest = max(parts, key=lambda part: float(t[part[-1]] - t[part[0]]))
        return self._last_part(float(t[longest[0]]), float(t[longest[-1]]), math.nan)

    def _last_part(self, start: float, end: float, period: float) -> Grid:
        """The grid between two times, of a long piece its last part, with enough of a period; see ``recent``."""
        record = self.record
        inside = np.flatnonzero(record.good & (record.t >= start) & (record.t <= end))
        if len(inside) > STEPS_MAX:
            start = float(record.t[inside[recent(record.op[inside], STEPS_MAX, period / record.dt)]])
        return self._grid(start, end)

    def _grid(self, start: float, end: float) -> Grid:
        """Join the good samples by straight lines where PV is measured, by steps where OP and SP are held."""
        record = self.record
        inside = slice(int(np.searchsorted(record.t, start)), int(np.searchsorted(record.t, end, side="right")))
        good = record.good[inside]
        kept = slice(None) if good.all() else good
        at = np.ascontiguousarray(record.t[inside][kept])
        n = min(round((end - start) / record.dt) + 1, STEPS_MAX)
        t = np.linspace(start, end, max(n, 2))
        dt = float(t[1] - t[0])
        even = len(at) == len(t) and bool((at == t).all())
        last = np.maximum(np.searchsorted(at, t + 1e-6 * dt, side="right") - 1, 0)

        def held(x: Values | None) -> Values | None:
            return None if x is None else x[inside][kept] if even else x[inside][kept][last]

        def joined(x: Values) -> Values:
            return x[inside][kept] if even else np.interp(t, at, x[inside][kept])

        pv, sp = joined(record.pv), held(record.sp)
        e = np.mean(pv) - pv if sp is None else sp - pv
        op, mv = held(record.op), None if record.mv is None else joined(record.mv)
        drawn = 0.0 if even else float(np.mean(t - at[last] > 1.5 * record.dt))
        assert op is not None
        return Grid(t, dt, op, pv, e, sp, mv, drawn)

    def signal(self, name: Signal) -> Values:
        """A signal on the grid of ``stretch``, (n,), in its own unit."""
        values = {"OP": self.stretch.op, "PV": self.stretch.pv, "SP": self.stretch.sp, "E": self.stretch.e,
                  "MV": self.stretch.mv}[name]  # fmt: skip
        if values is None:
            raise ValueError(f"{name} is not logged; ask for a signal that the card of the method lists")
        return values

    def noise(self, name: Signal) -> float:
        """Standard deviation of the white noise on a signal [its unit]."""
        return noise_std(self.stretch.t, self.signal(name))

    def op_percent(self, amount: float) -> float | None:
        """An amount in the unit of OP as % of its span; None where the span is unknown."""
        span = self.record.op_span
        return None if span is None else 100.0 * amount / (span[1] - span[0])

    @property
    def op_unit(self) -> tuple[float, str]:
        """What an amount in the unit of OP is multiplied by where it is shown, and the unit that it then has."""
        percent = self.op_percent(1.0)
        return (1.0, "in the unit of OP") if percent is None else (percent, PERCENT)

    # --- waves ------------------------------------------------------------------------------------------------
    def wave(self, name: Signal, cut_at: float = CUT) -> Values:
        """The oscillation in a signal on the grid of ``stretch``, (n,): drift off, smoothed without phase.

        ``cut_at`` times the frequency of the oscillation is where the filter cuts; 0 leaves the noise on.
        """
        key = name, cut_at
        if key not in self._waves:
            self._waves[key] = self._wave(self.signal(name), cut_at)
        return self._waves[key]

    def _wave(self, x: Values, cut_at: float) -> Values:
        t = self.stretch.t
        if not math.isfinite(self.period):
            return np.asarray(x - np.mean(x))
        if t[-1] - t[0] >= 4.0 * self.period:
            y = x - moving_average(t, x, 2.0 * self.period, ends="hold")
        else:
            y = x - np.polynomial.Polynomial.fit(t, x, 1)(t)
        y = y - np.mean(y)
        if cut_at > 0.0 and self.samples_per_period >= max(SMOOTHED_FROM, 2.5 * cut_at) and len(y) > 20:
            y = smoothed(y, 2.0 * cut_at / self.samples_per_period)
        return np.asarray(y)

    def half_waves(self, name: Signal) -> tuple[HalfWave, ...]:
        """The accepted half waves of a signal, in order of time."""
        if name not in self._halves:
            self._halves[name] = tuple(half_waves_of(self.stretch.t, self.wave(name), self.period))
        return self._halves[name]


def prepared(record: LoopRecord | Prepared | Any) -> Prepared:
    """The record made ready; itself where it is already; a frame of pandas, polars or pyarrow as it is read.

    Raises ReadError for a frame that is no loop, TypeError for what is none of these.

    >>> import polars as pl
    >>> prepared(pl.DataFrame({"time": [0.0, 1.0], "PV": [1.0, 2.0], "OP": [3.0, 4.0]})).record.pv
    array([1., 2.])
    """
    if isinstance(record, Prepared):
        return record
    if isinstance(record, LoopRecord):
        return Prepared(record)
    if frame_kind(record):
        return Prepared(read_loop(record))
    raise TypeError(
        f"{type(record).__name__} is no loop; give a LoopRecord, or a frame of pandas, polars or pyarrow with a time, "
        "PV and OP"
    )


_EMPTY = Grid(np.empty(0), math.nan, np.empty(0), np.empty(0), np.empty(0), None, None, 0.0)
