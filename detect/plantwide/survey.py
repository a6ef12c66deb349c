"""One answer on a whole log: which tags oscillate together, and which loop's valve to look at first.

    groups      tags with a common line in their spectra (``lines``)
    suspects    the loops whose OP moves, by how plainly no tag answers OP at once (``answers``); a loop that is called
                sticky goes before the others, by its own verdict, where verdicts are given, or by slips of its valve
                that another tag shows (``slips``)
    harmonics   sqrt(power at 2 f .. 5 f / power at f) of every tag [-]
    lag         of a tag behind the first suspect's OP, by the largest correlation within a quarter of a period

Process dynamics smooth a wave on its way, so harmonics fade from the source outward (Thornhill 2005, IEEE Trans.
Control Syst. Technol. 13:434); but a loop that controls well keeps little of the fundamental and then shows the largest
share of harmonics of all, and a lag depends on the dynamics between.  On the simulated production plant both misled the
ranking, so they are shown as evidence and do not rank.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from stickslip.detect.plantwide.answers import Answer, answer_of
from stickslip.detect.plantwide.lines import Spectra, groups, spectra
from stickslip.detect.plantwide.slips import Jumps, Slips, jumps_of, larger, owners, slips_of
from stickslip.detect.stem.sound_valve import MUST_MOVE_PERCENT
from stickslip.detect.verdict import Figure
from stickslip.detect.words import WORDS, Word
from stickslip.logs import Log, LogError, LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.processes import one_thread
from stickslip.logs.shown import Shown

SCHEMA = "stickslip.survey/1"
POINTS = 3000  # of the grid: more shows no group and no band that fewer hide
STILL_PERCENT = 1.0  # % of OP span: a loop whose OP moves less feeds no oscillation worth a look
PLAIN_NATS = math.log(2.0)  # gain from which a band is plain: at most half of what was left is left


@dataclass(frozen=True)
class Suspect:
    """A loop and what the log says of its valve.

    Parameters: ``loop`` (str) tag; ``travel`` (float) range of OP [% of span]; ``gain`` (float) how plainly no tag
    answers OP at once [-], 0 where none shows it; ``S`` (float) travel of OP without an answer [% of span], 0 where
    none shows it; ``seen_in`` (str or None) the tag that shows it; ``follows`` (str or None) a tag that follows OP at
    once;
    ``verdict`` as in ``Verdict``, None where none is given; ``slips`` (Slips or None) what another tag shows that jumps
    each time OP has come back by the same travel.
    """

    loop: str
    travel: float
    gain: float
    S: float
    seen_in: str | None
    follows: str | None
    verdict: Word | None = None
    slips: Slips | None = None

    @property
    def suspected(self) -> bool:
        """Whether its own verdict is stiction, or leaves it open while another tag shows slips; the verdict stays."""
        return self.verdict == "stiction" or (self.slips is not None and self.verdict != "no_stiction")

    @property
    def reason(self) -> str:
        """The reason for or against its valve, in one sentence."""
        moves = f"OP travels {self.travel:.3g} % of its span"
        if self.slips is not None:
            said = (
                f"{moves}, and {self.slips.tag} jumps when OP has come back by {self.slips.S:.2g} %, "
                f"{self.slips.reversals} times, as where a valve slips"
            )
        elif self.seen_in is not None and self.travel <= self.S:
            said = f"{moves}, and {self.seen_in} stands still all the while"
        elif self.gain >= PLAIN_NATS and self.seen_in is not None:
            said = f"{moves}, and {self.seen_in} answers only after {self.S:.2g} %"
        elif self.follows is not None:
            said = f"{moves}, and {self.follows} follows at once: its valve answers"
        else:
            said = f"{moves}; no other tag shows where its valve stands"
        return said + ("." if self.verdict is None else f"; its own verdict: {WORDS[self.verdict].spoken}.")


@dataclass(frozen=True)
class Group:
    """Tags that share one oscillation.

    Parameters: ``period`` (float) [s]; ``shares`` (tag -> float) share of the tag's variance at it [-], largest first;
    ``loops`` (tuple of str) loops whose PV or OP is in it; ``suspects`` (tuple of Suspect) those loops whose OP moves,
    the likeliest source first; ``harmonics`` (tag -> float) [-]; ``lags`` (tag -> float) behind the first suspect's OP
    [s], negative before it.
    """

    period: float
    shares: Mapping[str, float]
    loops: tuple[str, ...]
    suspects: tuple[Suspect, ...]
    harmonics: Mapping[str, float]
    lags: Mapping[str, float]

    @property
    def words(self) -> str:
        """The group in two or three sentences."""
        period = f"{float(f'{self.period:.3g}'):g} s"
        said = f"{len(self.shares)} tags share an oscillation of {period}, of the loops {_listed(self.loops)}."
        if not self.suspects:
            return f"{said} No OP of these loops moves by {STILL_PERCENT:g} % of its span: the source lies elsewhere."
        first = self.suspects[0]
        if first.gain >= PLAIN_NATS or first.suspected:
            return f"{said} Look at the valve of {first.loop} first: {first.reason}"
        return (
            f"{said} No valve of the group is seen to stick; the source may lie outside. {first.loop}: {first.reason}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Survey(Shown):
    """The answer on a log.

    Parameters: ``groups`` (tuple of Group) most tags first; ``suspects`` (tuple of Suspect) every loop whose OP moves,
    the likeliest source first, in a group or not; ``still`` (tuple of str) loops whose OP hardly moves or has no known
    span; ``log`` (Log) what was looked at.
    """

    groups: tuple[Group, ...]
    suspects: tuple[Suspect, ...]
    still: tuple[str, ...]
    log: Log = field(repr=False)

    @property
    def headline(self) -> str:
        """The result in one line."""
        return self.words

    @property
    def words(self) -> str:
        """One paragraph a group, or that there is none."""
        return "\n".join(g.words for g in self.groups) or "No two tags of the log share an oscillation."

    def to_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold, schema "stickslip.survey/1"."""

        def plain(suspect: Suspect) -> dict[str, Any]:
            slips = None if suspect.slips is None else suspect.slips.to_dict()
            return {**suspect.__dict__, "slips": slips, "reason": suspect.reason}

        return {
            "schema": SCHEMA,
            "words": self.words,
            "suspects": [plain(s) for s in self.suspects],
            "still": list(self.still),
            "groups": [
                {
                    "period_s": group.period,
                    "words": group.words,
                    "loops": list(group.loops),
                    "suspects": [s.loop for s in group.suspects],
                    "tags": [
                        {"tag": tag, "share": share, "harmonics": group.harmonics[tag], "lag_s": group.lags.get(tag)}
                        for tag, share in group.shares.items()
                    ],
                }
                for group in self.groups
            ],
        }

    def plot(self) -> Figure:
        """The tags of every group over time with their spectra, and OP of the first suspect against the tag that shows
        it.
        """
        from stickslip.detect.figures.survey import plot_survey

        return plot_survey(self)


@one_thread
def survey(log: Log, verdicts: Mapping[str, Word] | None = None) -> Survey:
    """Group the tags of a log by the oscillations they share and rank the loops by how likely their valve is sticky.

    Parameters: ``log`` notes its loops (``Log.loops``) with the spans of their OP; every other signal is a tag that may
    show where a valve stands; ``verdicts`` loop -> verdict of its own, as ``diagnose`` gives it.

    Raises ``LogError`` if the log notes no loop.

    >>> from stickslip.detect.stem.stick import stick
    >>> from stickslip.logs import LoopSignals
    >>> t = np.arange(2000.0)
    >>> u = 50 + 5 * np.sin(t / 20)
    >>> wave = np.cos(t / 20)
    >>> log = Log(t, {"FI1": stick(u, 4.0, 1.0), "u": u, "p": wave, "v": 50 + wave, "q": wave},
    ...     spans={"u": (0, 100), "v": (0, 100)}, loops={"PC1": LoopSignals("p", "u"), "FC2": LoopSignals("q", "v")})
    >>> found = survey(log)
    >>> [suspect.loop for suspect in found.suspects], round(found.groups[0].period)
    (['PC1', 'FC2'], 126)
    """
    if not log.loops:
        raise LogError("the log notes no loop; build it with loops={tag: LoopSignals(pv=..., op=...)}")
    t = np.linspace(log.t[0], log.t[-1], min(len(log), POINTS))
    signals = {name: on_grid for name in log.names if (on_grid := _on(t, log, name)) is not None}
    records = [record for record in log.loop_records() if record.op_name in signals and record.pv_name in signals]
    suspects, still = _suspects(records, signals, verdicts or {})
    tags = {name: x for name, x in signals.items() if not _steady(x)}
    found = spectra(t, tags) if tags else None
    together = [] if found is None else groups(found)
    return Survey(
        tuple(_group(one.period, one.shares, records, suspects, signals, found, t) for one in together if found),
        suspects,
        tuple(tag for tag in log.loops if tag in still or tag not in {record.name for record in records}),
        log,
    )


def _on(t: Values, log: Log, name: str) -> Values | None:
    """A signal on the even grid, None where less than half of it is good."""
    good = log.good(name)
    return np.interp(t, log.t[good], log[name][good]) if np.mean(good) >= 0.5 else None


def _steady(x: Values) -> bool:
    return float(np.ptp(x)) <= 1e-9 * float(np.max(np.abs(x)))


def _suspects(
    records: list[LoopRecord], signals: Mapping[str, Values], verdicts: Mapping[str, Word]
) -> tuple[tuple[Suspect, ...], set[str]]:
    """The loops whose OP moves, likeliest source first, and the others."""
    asked: set[str | None] = set()  # what controllers give or are given says nothing of a stem
    for record in records:
        asked |= {record.sp_name, record.op_name, record.mode_name}
    stems = {record.mv_name for record in records}
    found, still = [], set()
    jumps = {name: jumps_of(x) for name, x in signals.items() if name not in asked | stems and not _steady(x)}
    slips: dict[str, dict[str, Slips]] = {}
    for record in records:
        span = record.op_span
        op = np.zeros(1) if span is None else 100.0 * (signals[record.op_name] - span[0]) / (span[1] - span[0])
        travel = float(np.ptp(op))
        if travel < STILL_PERCENT:
            still.add(record.name)
            continue
        own = record.mv_name if record.mv_name in signals else None
        if own is not None and _steady(signals[own]):  # what goes with OP goes with PV, and says nothing of this stem
            gain = PLAIN_NATS if travel >= MUST_MOVE_PERCENT else 0.0  # no sound stem stands through it
            found.append(Suspect(record.name, travel, gain, travel, own, None, verdicts.get(record.name)))
            continue
        if own is not None:  # the stem itself is logged: no other tag need be asked
            tags = {own: signals[own]}
        else:
            tags = {n: x for n, x in signals.items() if n not in asked | stems | {record.pv_name}}
            seen = {tag: _slips(op, tags[tag], at, tag) for tag, at in jumps.items() if tag in tags}
            slips[record.name] = {tag: one for tag, one in seen.items() if one is not None}
        a: Answer = answer_of(op, tags)
        found.append(Suspect(record.name, travel, a.gain, a.S, a.tag, a.follows, verdicts.get(record.name)))
    own_slips = owners(slips, jumps)
    found = [replace(suspect, slips=own_slips.get(suspect.loop)) for suspect in found]
    order = sorted(found, key=lambda s: (not s.suspected, -s.gain, -s.travel))
    return tuple(order), still


def _slips(op: Values, y: Values, jumps: Jumps, tag: str) -> Slips | None:
    """The slips that the jumps of a tag show, or else its larger ones."""
    return slips_of(op, y, jumps, tag) or slips_of(op, y, larger(jumps), tag)


def _group(
    period: float, shares: Mapping[str, float], records: list[LoopRecord], suspects: tuple[Suspect, ...],
    signals: Mapping[str, Values], found: Spectra, t: Values,
) -> Group:  # fmt: skip
    inside = tuple(r.name for r in records if {r.pv_name, r.op_name} & set(shares))
    ranked = tuple(s for s in suspects if s.loop in inside)
    harmonics = {tag: _harmonics(found, tag, 1.0 / period) for tag in shares}
    lags = {}
    if ranked:
        op = next(r.op_name for r in records if r.name == ranked[0].loop)
        lags = {tag: _lag(signals[op], signals[tag], float(t[1] - t[0]), period) for tag in shares}
    return Group(period, shares, inside, ranked, harmonics, lags)


def _harmonics(found: Spectra, tag: str, f: float) -> float:
    """sqrt(power at 2 f .. 5 f over power at f) [-]."""
    i, step = found.tags.index(tag), float(found.f[1] - found.f[0])
    lines = [float(found.share(round(k * f / step))[i]) for k in range(1, 6) if round(k * f / step) < len(found.f)]
    return math.sqrt(sum(lines[1:]) / max(lines[0], 1e-12))


def _lag(op: Values, x: Values, dt: float, period: float) -> float:
    """Lag [s] of x behind OP at the largest correlation of either sign within a quarter of a period."""
    n, reach = len(op), max(1, round(0.25 * period / dt))
    a, b = op - np.mean(op), x - np.mean(x)
    both = np.fft.irfft(np.conj(np.fft.rfft(a, 2 * n)) * np.fft.rfft(b, 2 * n), 2 * n)
    around = np.concatenate([both[-reach:], both[: reach + 1]])
    return float(int(np.argmax(np.abs(around))) - reach) * dt


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:-1]) + (" and " if len(names) > 1 else "") + (names[-1] if names else "none")
