"""The latent input: what would have to be added to a logged signal for the model to give another as logged.

    y(k) - y0(k) = sum_i g(i) d(k - i) + n(k)           y0 the segment driven by its logged inputs, g its response to
                                                        one row of u, d a random walk, n white
    D = r conj(G) Y / (r |G|^2 + |1 - z^-1|^2)          r = (step of d / n)^2, likeliest by Whittle (1953)

What explains a gap bends this input in a way of its own: a play gives a loop over OP, a leak or a bias a level, a load
something that goes with time alone.  Beside each picture stands the share of its variance that goes with it, by means
of ``GROUPS`` groups of equally many rows, less what as many groups of white noise would take.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.segments import Segment
from stickslip.gap.answers.report import GapReport
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.record import GapError, Record
from stickslip.gap.records.start import start_values
from stickslip.gap.reporting.driven import driven_to, filled, most_amiss, segment_at
from stickslip.logs import Log
from stickslip.logs.arrays import Values
from stickslip.logs.normal import spread
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GROUPS = 24  # of rows, by which shares are told
RATIOS = np.logspace(-8.0, 4.0, 49)  # of the step of d to the noise, as squares, times the largest |G|^2
PULSE = 0.02  # of the range of u, for one row
LEAST_SHARE = 0.1  # least share that is put in words
TURN = 6.0  # standard deviations of the noise of u by which it has turned
SETTLED = 0.02  # of its largest value, below which a response is over
LASTING = 0.25  # of a record: a response as long is that of an integral


@dataclass(frozen=True, eq=False, repr=False)
class LatentInput(Shown):
    """``values`` (rows,) [unit of ``signal``] that added to ``signal`` make the model give ``shown`` as it was logged.

    ``t`` (rows,) [s]; ``against`` what it may go with, name -> (rows,); ``shares`` name -> part of its variance that
    does, 0 to 1.
    """

    signal: str
    shown: str
    t: Values
    values: Values
    against: Mapping[str, Values] = field(default_factory=dict)
    shares: Mapping[str, float] = field(default_factory=dict)

    @property
    def headline(self) -> str:
        """The result in one line."""
        return str(self)

    def __str__(self) -> str:
        best = max(self.shares, key=lambda name: self.shares[name])
        share = 100.0 * self.shares[best]
        goes = (
            f"{share:.0f} % of the variance of this change goes with {best}"
            if self.shares[best] >= LEAST_SHARE
            else "this change goes with no level, rate or direction of a logged signal, nor with time"
        )
        return (
            f"The model gives {self.shown} as logged if {self.signal} is changed by {float(np.mean(self.values)):.2g} "
            f"on average, with a standard deviation of {float(np.std(self.values)):.2g}; {goes}."
        )

    def plot(self) -> "Figure":
        """Draw the latent input against each of these: rows, and their means by groups."""
        from stickslip.gap.reporting.figures import plot_latent

        return plot_latent(self)


def latent_input(report: GapReport, log: Log) -> LatentInput:
    """Return the latent input of the segment of a report's first place, from the log that the report is of.

    Raises ``GapError`` where the report has no gap, or where no logged signal drives that segment.

    >>> from stickslip.blocks import Staircase
    >>> from stickslip.cases.models import ideal_flow
    >>> from stickslip.diagram import simulate
    >>> from stickslip.gap import diagnose
    >>> from stickslip.gap.effects import effect
    >>> real = effect("deadband").insert(ideal_flow(), "valve", width=4.0)
    >>> set_point = Staircase("SP", [1.2, 1.6, 1.4] * 20, dwell=40.0)
    >>> signals = ["SP", "PV", "OP"]
    >>> log = simulate(real, 2400.0, every=1.0, signals=signals, inputs={"SP": set_point}).log
    >>> found = latent_input(diagnose(ideal_flow(), log), log)
    >>> found.signal, found.shown, max(found.shares, key=found.shares.get)
    ('OP', 'PV', 'the direction of OP')
    """
    if report.where is None:
        raise GapError("there is no gap, so there is no latent input; ask a report with a gap")
    opened, record = read(report.diagram, getattr(log, "log", log))
    quiet = silenced(opened)
    quiet = quiet.starting_at(start_values(quiet, record))
    segment = segment_at(quiet, record, report.where.place)
    shown = most_amiss(segment, report.residuals)
    known = [s for s in segment.reads if s in record.log]
    if not {*known} - {shown}:
        raise GapError(f"no logged signal drives the blocks {', '.join(segment.blocks)}; log what does")
    return _found(quiet, segment, record, known, shown)


def _found(quiet: Diagram, segment: "Segment[Diagram]", record: Record, known: list[str], shown: str) -> LatentInput:
    log = record.log
    inputs = {s: filled(log[s]) for s in known}
    first = driven_to(quiet, segment, log, inputs, shown)
    responses = {}
    drivers = [s for s in known if s != shown]  # a loop in one segment reads its own output
    for s in drivers:
        span = float(np.ptp(inputs[s])) or 1.0
        moved = inputs[s].copy()
        moved[1] += PULSE * span
        responses[s] = (driven_to(quiet, segment, log, {**inputs, s: moved}, shown)[1:] - first[1:]) / (PULSE * span)
    # what a block drives comes before a set point: the measurement of a controller, the OP of a valve
    driven = [s for s in drivers if s in quiet.driven] or drivers
    signal = max(driven, key=lambda s: float(np.abs(responses[s]).max()) * float(np.std(inputs[s])))
    g = responses[signal]
    if not np.abs(g).max() > 0.0:
        raise GapError(
            f"{shown} does not answer {', '.join(drivers)} in the model, so its missing input cannot be computed"
        )
    late = np.flatnonzero(np.abs(g) > SETTLED * np.abs(g).max())
    length = int(late[-1]) + 1
    left = filled(log[shown]) - first
    d = _deconvolved(left, g, integral=length > LASTING * len(g))
    ends = min(length, len(d) // 10)
    kept = slice(ends, len(d) - ends)
    against = {
        f"the level of {signal}": inputs[signal][kept],
        f"the rate of {signal}": np.gradient(inputs[signal], log.t)[kept],
        f"the direction of {signal}": _direction(inputs[signal])[kept],
        f"the level of {shown}": filled(log[shown])[kept],
        "time": log.t[kept],
    }
    shares = {name: _share(d[kept], values) for name, values in against.items()}
    return LatentInput(signal, shown, log.t[kept], d[kept], against, shares)


def _deconvolved(y: Values, g: Values, integral: bool) -> Values:
    if integral:
        y, g = np.diff(y, prepend=y[0]), np.diff(g, prepend=0.0)
    n = len(y)
    size = 2 * n
    Y, G = np.fft.rfft(y, size), np.fft.rfft(g, size)
    step = np.abs(1.0 - np.exp(-2j * np.pi * np.arange(len(Y)) / size)) ** 2
    noise = step if integral else np.ones_like(step)
    gain = np.abs(G) ** 2
    gain_by_step = gain[1:] / step[1:]

    def loss(r: float) -> float:
        spectrum = r * gain_by_step + noise[1:]
        return float(np.log(spectrum).mean() + np.log((np.abs(Y[1:]) ** 2 / spectrum).mean()))

    r = min(RATIOS / float(gain.max()), key=loss)
    spread = r * gain + noise * step
    # an output that does not answer a lasting input does not tell its mean, and none is needed
    spectrum = np.divide(r * np.conj(G) * Y, spread, out=np.zeros_like(Y), where=spread > 0.0)
    return np.asarray(np.fft.irfft(spectrum, size)[:n])


def _direction(values: Values) -> Values:
    """Return which way a signal goes, -1 or 1, (rows,): it turns where it has come back by ``TURN`` times its noise."""
    second = np.diff(values, 2)
    least = TURN * spread(second) / float(np.sqrt(6.0))  # of white noise
    way, furthest, found = 1.0, values[0], np.empty(len(values))
    for k, value in enumerate(values.tolist()):
        if (value - furthest) * way > 0.0:
            furthest = value
        elif (furthest - value) * way > least:
            way, furthest = -way, value
        found[k] = way
    return found


def _share(d: Values, values: Values) -> float:
    """Return the share of the variance of d that goes with a signal, by groups of it, less what chance would give."""
    levels = np.unique(values)
    edges = levels if len(levels) <= GROUPS else np.quantile(values, np.linspace(0.0, 1.0, GROUPS + 1)[1:-1])
    group = np.searchsorted(edges, values)
    count = np.bincount(group)
    means = np.bincount(group, d) / np.maximum(count, 1)
    within, whole = float(np.mean((d - means[group]) ** 2)), float(np.var(d))
    free = len(d) - int((count > 0).sum())
    return float(np.clip(1.0 - within / whole * (len(d) - 1) / max(free, 1), 0.0, 1.0)) if whole > 0.0 else 0.0
