"""A hypothesis of a record, an effect at a place or none, and the innovations that its filter leaves."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.diagram.changes import blocks_with_params
from stickslip.engine.filtering import extended, followed, otherwise
from stickslip.engine.restarts import kept_sizes, standing, steps_taken
from stickslip.gap.exact.affine import NotAffine
from stickslip.gap.exact.exact import LEAST, start_spread
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.gains import Labels, gains_for, turns_for
from stickslip.gap.likelihood.path import Path, complain
from stickslip.gap.likelihood.prepared import Prepared, prepared
from stickslip.gap.likelihood.replay import Replays, left_by_replays
from stickslip.gap.likelihood.statement import Statement
from stickslip.gap.likelihood.threads import go_on
from stickslip.gap.null_model.null_model import NU, UNIT, losses
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values

Whole = NDArray[np.int64]
FAR = 8.0  # standard deviations beyond which an innovation counts in proportion only
GROSS = 3.0  # mean square of innovations, each at most as far as counts in full, beyond which gains say nothing
CLIPPED = 6.0  # standard deviations as far as which an innovation is judged
EVENTS = 4096  # that one interval may hold
ENDLESS = 2**62
LATE, LATE_SHARE = 200.0, 0.01  # nats, and share of what another leaves, by which a filter is behind to be given up
KEPT_BYTES = 2**24  # of slopes: each of some seventy hypotheses keeps its latest filter
NEVER = np.zeros(0)


@dataclass(frozen=True, eq=False)
class Hypothesis(Statement):
    """An ``effect`` at a ``place``, or none, and the filters that follow a record with it."""

    @cached_property
    def prepared(self) -> Prepared:
        """The changed model ready for the filter."""
        longest = self.settings({name: high for name, (_, high) in self.bounds.items()})
        return prepared(self.changed, self.frame.record, self.frame.scan, longest, self.frame.doubts)

    def filtered(
        self,
        values: Mapping[str, float],
        near: "Innovations | None" = None,
        joined: bool = False,
        most_runs: int = ENDLESS,
        best: "Innovations | None" = None,
    ) -> "Innovations":
        """Return what a filter of these values leaves; with the gains of ``near``, which is quicker, its mean alone.

        ``joined``: whether every row has all gains, which a bank needs; ``most_runs`` from stop to stop for slopes;
        ``best`` of the same rows, which is to be beaten.

        Raises ``ArithmeticError`` where a run of the diagram fails, slopes take more runs, or the best is far ahead.
        """
        go_on()
        f = self.frame
        full = {**self.nominal, **values}
        if f.replays:
            (found,) = self.replayed([full])
            if found is None:
                raise ArithmeticError("a replay of the diagram failed")
            return found
        if near is None and (known := self.latest.get((f.record, f.draws, joined))) and known.values == full:
            return replace(known, hypothesis=self)
        exactly = None if joined else self.exactly(full)
        if exactly is not None:
            return exactly
        p, near = self.prepared, None if near is None else near.followed
        I, W = p.fresh(float(f.stops[0][0]), self.blocks_with(full), f.most_steps)
        phi, sd = self.noise_with(full)
        z = standing(W, self.places[0])
        n, m, q = len(z), len(f.signals), len(p.noise)
        times, row_of = f.stops
        buffer = np.empty((EVENTS, 4))
        if near is not None:
            theirs = near.hypothesis.labels
            assert near.gains is not None
            gains, turns = gains_for(self.labels, theirs, near.gains), turns_for(self.labels, theirs, near.turns)
            shown, missed = np.empty(f.Y.shape), np.full(f.Y.shape, np.nan)
            status = followed(
                I, W, buffer, *kept_sizes(I), self.places, self.shown, self.places[0, self.where], times, row_of,
                phi, f.anew, gains, near.kinks, turns, z, shown, missed,
            )  # fmt: skip
            complain(status)
            return Innovations(self, full, missed / np.sqrt(near.S), near.S, gains, near.kinks, turns, shown,
                               steps=near.steps)  # fmt: skip
        size, spread = self._start(z)
        e, S, shown = (np.full(f.Y.shape, np.nan) for _ in range(3))
        gains, force = np.zeros((len(f.Y), 2 * n + m + q + 1, m)), np.empty((len(times), q))
        which, kinks = np.zeros(len(times), dtype=np.int64), np.zeros(len(f.Y), dtype=np.bool_)
        turns = np.zeros((len(times), n + m))
        status, *pools = extended(
            I, W, buffer, *kept_sizes(I), self.places, self.prepared.modes, self.shown, self.places[0, self.where],
            self.where, size, times, row_of, phi, sd, f.anew, f.r, f.probed, joined, most_runs // (2 * n), bar_of(best),
            f.sure, FAR, z.copy(), spread, which, force, gains, kinks, turns, shown, e, S,
        )  # fmt: skip
        complain(status)
        found = Innovations(self, full, e, S, gains, kinks, turns, shown, Path(z, phi, which, force, tuple(pools)),
                            steps=steps_taken(I))  # fmt: skip
        self.latest.clear()
        if sum(pool.nbytes for pool in pools) < KEPT_BYTES:
            self.latest[f.record, f.draws, joined] = found
        return found

    def replayed(self, many: "Sequence[Mapping[str, float]]", modes: bool = True) -> "list[Innovations | None]":
        """Return what replays of each of many sets of values leave, None of those that fail."""
        f = self.frame
        assert isinstance(f, Replays)
        full = [{**self.nominal, **values} for values in many]
        found = left_by_replays(f, self.silent, [self.settings(own) for own in full], self.drawing, modes)
        none = np.zeros(len(f.Y), dtype=np.bool_), np.zeros((0, 0))
        return [
            None if left is None else Innovations(self, own, left.e, left.S, None, *none, charge=left.charge)
            for own, left in zip(full, found, strict=True)
        ]

    def exactly(self, values: Mapping[str, float]) -> "Innovations | None":
        """Return what the exact filter leaves, None where there is none."""
        if self.exact is None:
            return None
        try:
            e, S, shown = self.exact.filtered(*self.stated_of(self.exact, values), self.frame.anew, self.frame.r)
        except (NotAffine, np.linalg.LinAlgError):
            self.__dict__["exact"] = None
            return None
        kinks, turns = np.zeros(len(e), dtype=np.bool_), np.zeros((0, 0))
        return Innovations(self, dict(values), e, S, None, kinks, turns, shown)

    def noisier(self, known: "Innovations", values: Mapping[str, float], joined: bool = False) -> "Innovations":
        """Return what is left with other noise, in the slopes of a known filter of the same path; see ``filtered``."""
        f = self.frame
        full = {**known.values, **values}
        if known.gains is None:
            return self.filtered(full, joined=joined)
        path, shown = known.path, known.shown
        assert path is not None and shown is not None
        phi, sd = self.noise_with(full)
        size, spread = self._start(path.z)
        e, S = np.full(f.Y.shape, np.nan), np.full(f.Y.shape, np.nan)
        gains = np.zeros_like(known.gains)
        otherwise(self.where, size, f.stops[1], path.phi, phi, sd, f.anew, f.r, joined, spread, path.which, path.force,
                  *path.slopes, shown, known.missed, known.gains, gains, e, S)  # fmt: skip
        return Innovations(self, full, e, S, gains, known.kinks, known.turns)

    def of(self, frame: Frame) -> "Hypothesis":
        """Return the same hypothesis of another record of the same rows and set points."""
        other = replace(self, frame=frame)
        if self.frame.replays:
            other.__dict__.update(silent=self.silent)
            return other
        other.__dict__.update(prepared=self.prepared, latest=self.latest)
        if "exact" in self.__dict__ and self.frame.scans is not None:
            there = None if self.exact is None or frame.scans is None else self.exact.of(frame.record, frame.scans)
            other.__dict__["exact"] = there
        return other

    @cached_property
    def latest(self) -> "dict[tuple[Record, int, bool], Innovations]":
        """The latest filter of its own, which fits of other rows of the same record begin with."""
        return {}

    @property
    def filtering(self) -> Frame:
        """What the hypotheses of a record share."""
        return self.frame

    def blocks_with(self, values: Mapping[str, float]) -> tuple[Block, ...]:
        """Return the blocks of the prepared diagram with these values, inputs switching when the record has them do."""
        p = self.prepared
        others = {p.late.get(k, k): v for k, v in self.settings(values).items() if k not in self.noise_keys}
        found = blocks_with_params(p.diagram, others)
        for s, source in self.frame.sources.items():  # the prepared diagram may be that of other switches
            found[p.diagram.driven[s][0]] = source
        return tuple(found)

    @cached_property
    def noise_keys(self) -> frozenset[str]:
        """The parameters that only make the random numbers of the model larger, or slower."""
        sources = self.frame.noise if self.frame.replays else tuple(one for one, _ in self.prepared.noise)
        return frozenset(f"{one.block}.{key}" for one in sources for key in ("sd", "correlation_time"))

    def noise_with(self, values: Mapping[str, float]) -> tuple[Values, Values]:
        """Return how much of each noise stays at each stop, and the standard deviation of what is drawn there."""
        f, settings = self.frame, self.settings(values)
        times, _ = f.stops
        gap = np.diff(times, prepend=times[0])
        phi, drawn = np.ones((len(times), len(self.prepared.noise))), np.zeros((len(times), len(self.prepared.noise)))
        for j, (one, _) in enumerate(self.prepared.noise):
            if one.block in f.doubted:
                phi[:, j], drawn[:, j] = f.doubted[one.block]
                continue
            sd = settings.get(f"{one.block}.sd", one.sd)
            T = settings.get(f"{one.block}.correlation_time", one.correlation_time)
            phi[:, j] = np.exp(-gap / T) if T > 0.0 else np.where(f.drawn(one), 0.0, 1.0)
            sd = math.hypot(sd, one.rounding)
            drawn[:, j] = sd * np.sqrt(np.maximum(1.0 - phi[:, j] ** 2, 0.0))
            drawn[0, j] = sd
        return phi, drawn

    def _start(self, z: Values) -> tuple[Values, Values]:
        """Return the size of each state, and a factor of what is not known of it at the start, (states, columns)."""
        spread = np.diag(start_spread(z, self.names, self.frame.unsure))
        return np.maximum(np.abs(z), LEAST), np.delete(spread, self.where, axis=1)

    def adds_to(self, other: "Hypothesis") -> bool:
        """Return whether it has a state that another has not, which the gains of the other would not set right."""
        return not self.frame.replays and not {*self.names} <= {*other.names}

    @cached_property
    def names(self) -> list[str]:
        """Names of the state."""
        return [name for name, *_ in self.prepared.states]

    @cached_property
    def labels(self) -> Labels:
        """Names of the state, and of what holds each noise."""
        return Labels(self.names, [holder for _, holder in self.prepared.noise])

    @cached_property
    def places(self) -> Whole:
        """Where the state is set, and where it is read, (2, states)."""
        return np.array([(at, read) for _, at, read in self.prepared.states], dtype=np.int64).T.copy()

    @cached_property
    def where(self) -> Whole:
        """Where in the state the noises in force stand."""
        return np.array([self.names.index(f"{holder}.value") for holder in self.labels.noises], dtype=np.int64)

    @cached_property
    def shown(self) -> Whole:
        """Where logged signals are read, (signals,)."""
        p = self.prepared
        return np.array([p.component.signals[p.diagram.signals.index(s)] for s in self.frame.signals], dtype=np.int64)


def bar_of(best: "Innovations | None") -> Values:
    """Return the sums of losses at which a filter is given up that is to beat the best, (0,) where there is none."""
    return NEVER if best is None else best.bar


@dataclass(frozen=True, eq=False)
class Innovations:
    """What a hypothesis with certain ``values`` leaves: ``e`` (rows, signals) of unit variance if it is right, their
    variances ``S``, and the ``gains`` of the filter; ``kinks`` the rows near a limit or a kink, ``turns`` what bends
    add to the mean at each stop (see ``extended``); ``shown`` what its mean showed at each row before the row set it
    right, and the ``path`` that it took.

    Of a bank: the filter ``near`` whose gains it has, ``mixed`` losses of its rows, and where one likely ``stem`` stood
    at each stop.  ``steps`` that the engine took, where they are known.
    """

    hypothesis: Hypothesis
    values: Mapping[str, float]
    e: Values
    S: Values
    gains: Values | None
    kinks: NDArray[np.bool_]
    turns: Values
    shown: Values | None = None
    path: Path | None = None
    near: "Innovations | None" = None
    mixed: Values | None = None
    stem: Values | None = None
    charge: float = 0.0
    steps: int = ENDLESS

    def again(self) -> "Innovations":
        """Return the same values with slopes and a path of their own."""
        return self.hypothesis.filtered(self.values)

    @cached_property
    def followed(self) -> "Innovations":
        """The same by the filter across runs, whose gains other hypotheses may have."""
        return self if self.gains is not None else self.hypothesis.filtered(self.values, joined=True)

    @property
    def explanation(self) -> Hypothesis:
        """The hypothesis."""
        return self.hypothesis

    @cached_property
    def losses(self) -> Values:
        """Negative logarithm of the likelihood of each row, without its constant, (rows,) [nats]: Huber's loss.

        Beyond ``FAR`` standard deviations it grows in proportion: a right hypothesis leaves nothing there, and a wrong
        one is not to be judged by a few rows alone.  A value that is as foretold for sure, an output that stands at a
        limit or has not been made anew, counts as its rounding.
        """
        f = self.hypothesis.frame
        sure = (np.isnan(self.S) & np.isfinite(f.Y)) @ f.sure
        return np.asarray(sure + self._unsure)

    @cached_property
    def _unsure(self) -> Values:
        """Loss of the values of each row that have a variance, (rows,) [nats]."""
        if self.mixed is not None:
            return self.mixed
        if self.hypothesis.frame.replays:
            loss = losses(self.e)
        else:
            near = np.minimum(np.abs(self.e), FAR)
            loss = 0.5 * near**2 + FAR * (np.abs(self.e) - near)
        return np.asarray(np.nansum(loss, axis=1) + 0.5 * np.nansum(np.log(self.S), axis=1))

    @cached_property
    def bar(self) -> Values:
        """Sum of losses up to each row at which another filter is too late to be likelier, NaN where no row counts."""
        f = self.hypothesis.frame
        lost = np.where(f.counted, self._unsure + np.isnan(self.S) @ f.sure, 0.0)
        late = LATE + LATE_SHARE * float(np.nansum(np.minimum(self.e**2, FAR * np.abs(self.e))))
        return np.where(f.counted, np.cumsum(lost) + late, np.nan)

    @cached_property
    def weights(self) -> Values:
        """Weight of each innovation in a fit, (rows, signals): 1, less beyond ``FAR``; 0 where there is none."""
        size = np.abs(self.e)
        if self.hypothesis.frame.replays:
            return np.asarray(np.where(np.isfinite(size), (NU + 1.0) / (NU * UNIT**2 + size**2), 0.0))
        return np.asarray(np.where(np.isfinite(size), np.minimum(1.0, FAR / np.maximum(size, 1e-300)), 0.0))

    @cached_property
    def nll(self) -> float:
        """Negative logarithm of the likelihood of the rows that count [nats]."""
        with np.errstate(over="ignore", invalid="ignore"):  # gains of one model may drive another away
            value = float(self.losses[self.hypothesis.frame.counted].sum()) + self.charge
        return value if math.isfinite(value) else math.inf

    @cached_property
    def missed(self) -> Values:
        """Innovations in the units of their signals, (rows, signals)."""
        return np.asarray(self.e * np.sqrt(self.S))

    @cached_property
    def gross(self) -> bool:
        """Whether it is so far from the log that its gains say nothing of anything else."""
        return float(np.nanmean(np.minimum(np.abs(self.judged), FAR) ** 2)) > GROSS

    @cached_property
    def judged(self) -> Values:
        """The innovations that count, each as far as ``CLIPPED``: a row at which a filter errs is no gap."""
        f = self.hypothesis.frame
        return np.clip(np.where(f.limited[:, None], np.nan, self.e)[f.skipped :], -CLIPPED, CLIPPED)
