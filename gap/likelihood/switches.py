"""When an input switched: the log says between which two rows, the filter says when; and whether it is a ramp.

Every switch is tried at the same few instants of its interval, one run for each; it takes the instant that is likeliest
in the rows behind.  Of a controller that scans only its scans count.

A size and the instants that suit it hold each other: a larger gain follows from earlier switches.  So all are moved
alike as well, and for each step the sizes x follow from the slopes D of the innovations e:

    x <- x - I^-1 D' e,   nll <- nll - e' D I^-1 D' e / 2
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.fits.coordinates import moved
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Innovations
from stickslip.gap.likelihood.inputs import in_lines, moves
from stickslip.gap.records.record import switch_rows, switches
from stickslip.logs.arrays import Values

Leads = Mapping[str, Mapping[int, float]]
BEHIND = 5  # rows in which a switch shows
TRIED, FINER = 12, 4  # instants of an interval, and of a part of it to both sides
LATE = 1e-6  # share of an interval by which a switch stays behind the row before
SHOWN = 15.0  # nats by which rows behind switches at wrong instants are less likely than those before
CLEARLY = 2.0  # standard deviations of that sum: what else is wrong shows behind some switches and before others
GAIN = 1.0  # nats that other instants must gain


def with_switches(now: Innovations) -> Innovations:
    """Return a filter of the same values with inputs that switch when it suits the record; the same if none does."""
    frame = now.hypothesis.frame
    switching = _switching(frame)
    if not switching or not _shows(now, switching):
        return now
    most = frame.record.log.dt * (1.0 - LATE)
    step = frame.scanned or frame.record.log.dt / TRIED
    best = _placed(now, {s: {} for s in switching}, np.append(np.arange(0.0, most, step), most))
    # where all switches are far off, each drives the run from the log for the next: near ones are tried as well
    fine = np.array([-step, step]) if frame.scanned else np.linspace(-0.5, 0.5, 2 * FINER + 1) * step
    for s in switching if best is not now or frame.scanned else ():  # each alone: two may switch between the same rows
        best = _placed(best, _leads(best.hypothesis.frame, [s]), fine)
    return now if best is now else _likelier(now, best.hypothesis.frame)


def most_by_switches(now: Innovations) -> float:
    """Return how many nats other switches can gain at most: rows behind them lose no more than half of all do then."""
    frame = now.hypothesis.frame
    lost = np.where(frame.counted, np.nan_to_num(now.losses), 0.0)
    behind = np.zeros(len(lost), dtype=np.bool_)
    for s in _switching(frame):
        for k in switch_rows(frame.record.log, s):
            behind[k : k + BEHIND] = True
    return float(np.sum(np.maximum(lost[behind] - np.median(lost[frame.counted]), 0.0)))


def _shows(now: Innovations, switching: Sequence[str]) -> bool:
    """Return whether rows behind switches are less likely than those before, as those of wrong instants are."""
    frame = now.hypothesis.frame
    if not frame.replays:
        return True
    lost = np.nan_to_num(now.losses)
    rows = [k for s in switching for k in switch_rows(frame.record.log, s).tolist() if k >= max(frame.skipped, BEHIND)]
    more = np.array([np.sum(lost[k : k + BEHIND]) - np.sum(lost[k - BEHIND : k]) for k in rows])
    chance = CLEARLY * float(np.std(more)) * math.sqrt(len(more)) if len(more) > 1 else 0.0
    return float(np.sum(more)) > max(SHOWN, chance)


def moved_alike(fit: Fit) -> Innovations | None:
    """Return a filter with all switches of inputs moved alike, and the sizes that follow; None if none is likelier.

    Where no effect is in the model, switches make up for what is missing.
    """
    now, one = fit.best, fit.hypothesis
    frame, log = one.frame, one.frame.record.log
    known = _leads(frame, _switching(frame))
    own = [k for k, name in enumerate(fit.names) if name not in one.noise_keys]
    if not known or not own or one.effect is None or frame.replays:
        return None
    names, D, information = [fit.names[k] for k in own], fit.slopes[own][:, frame.counted], fit.I
    step = frame.scanned or log.dt / TRIED
    steps = [way * by for by in np.arange(step, log.dt, step) for way in (1.0, -1.0)]
    best, d, frame_of_best = now.nll - GAIN, np.zeros(len(own)), frame
    for by in steps:
        there = _with_leads(frame, _stepped(frame, known, by))
        found = tried(one.of(there), now.values, now)
        if found is None:
            continue
        g = np.sum(D * np.nan_to_num(found.weights * found.e)[frame.counted], axis=(1, 2))
        follows = -np.linalg.lstsq(information[np.ix_(own, own)], g, rcond=None)[0]
        if found.nll + 0.5 * float(g @ follows) < best:
            best, d, frame_of_best = found.nll + 0.5 * float(g @ follows), follows, there
    if frame_of_best is frame:
        return None
    found = tried(one.of(frame_of_best), {**now.values, **moved(one, names, now.values, d)})
    return found if found is not None and found.nll < now.nll - GAIN else None


def with_ramps(now: Innovations) -> Innovations:
    """Return a filter of the same values with inputs that go in lines where they move at row after row, if they do.

    A sensor that scans as the controllers do reads such a line in steps.
    """
    frame = now.hypothesis.frame
    for s in frame.record.played if frame.record.filter is None else ():
        if moves(frame.record, s):
            doubts = {**frame.doubts, s: in_lines(frame.record, s)}
            for every in (0.0, frame.scanned) if 0.0 < frame.scanned < frame.record.log.dt else (0.0,):
                record = replace(frame.record, ramps={**frame.record.ramps, s: every})
                found = tried(replace(now.hypothesis, frame=replace(frame, record=record, doubts=doubts)), now.values)
                now = found if found is not None and found.nll < now.nll - GAIN else now
            frame = now.hypothesis.frame
    return now


def _placed(now: Innovations, about: Leads, steps: Sequence[float] | Values) -> Innovations:
    """Return what is left if each switch lies at the likeliest of some ``steps`` [s] from where it is thought to be.

    A switch that no step makes likelier stays.
    """
    frame = now.hypothesis.frame
    rows = {s: switch_rows(frame.record.log, s).tolist() for s in about}
    stays = _stepped(frame, _leads(frame, about), 0.0)
    losses, leads = [], []
    for trial in (stays, *(_stepped(frame, about, step) for step in steps)):
        found = tried(now.hypothesis.of(_with_leads(frame, {**frame.record.leads, **trial})), now.values, now)
        if found is not None:
            losses.append(found.losses)
            leads.append(trial)
    if not leads or leads[0] is not stays:
        return now
    cost = np.array(losses)
    likeliest = {
        s: {k: leads[int(np.argmin(cost[:, k : k + BEHIND].sum(axis=1)))][s][k] for k in rows[s]} for s in about
    }
    found = tried(now.hypothesis.of(_with_leads(frame, {**frame.record.leads, **likeliest})), now.values, now)
    return found if found is not None and found.nll < float(cost[0][frame.counted].sum()) - GAIN else now


def _likelier(now: Innovations, other: Frame) -> Innovations:
    """Return a filter with each switch where filters of their own find it likelier: now, or in another frame."""
    own = tried(now.hypothesis.of(other), now.values)
    if own is None:
        return now
    record = now.hypothesis.frame.record
    mixed: dict[str, dict[int, float]] = {}
    for s in other.record.leads.keys() | record.leads.keys():
        before, ahead = record.leads.get(s, {}), other.record.leads.get(s, {})
        rows = {k: slice(k, k + BEHIND) for k in before.keys() | ahead.keys()}
        gained = {k for k, behind in rows.items() if own.losses[behind].sum() < now.losses[behind].sum()}
        mixed[s] = {k: (ahead if k in gained else before).get(k, 0.0) for k in rows}
    both = tried(now.hypothesis.of(_with_leads(now.hypothesis.frame, mixed)), now.values)
    return min((x for x in (now, own, both) if x is not None), key=lambda x: x.nll)


def _switching(frame: Frame) -> list[str]:
    """Return the inputs that switch; none where a large diagram has a filter of its own."""
    if frame.record.filter is not None:
        return []
    return [s for s in frame.record.played if switches(frame.record.log, s)]


def _leads(frame: Frame, signals: Iterable[str]) -> Leads:
    """Return by how much inputs are thought to switch before the rows that show it [s]."""
    return {s: frame.record.leads.get(s, {}) for s in signals}


def _stepped(frame: Frame, about: Leads, step: float) -> dict[str, dict[int, float]]:
    """Return switches that lie a step [s] from where they are thought to be, within their intervals."""
    most = frame.record.log.dt * (1.0 - LATE)
    return {
        s: {k: float(np.clip(known.get(k, 0.0) + step, 0.0, most)) for k in switch_rows(frame.record.log, s).tolist()}
        for s, known in about.items()
    }


def _with_leads(frame: Frame, leads: Leads) -> Frame:
    """Return what hypotheses share if inputs switch so long before the rows that show it."""
    early = {s: {k: lead for k, lead in known.items() if lead > 0.0} for s, known in leads.items()}
    return frame.switching(early)
