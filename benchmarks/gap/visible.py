"""How many nats a record tells of its effect: an oracle, by physics alone, of what no diagnosis could see.

    nats = min over tolerances of 1/2 |W d|^2  +  rows x (what the noise of the loop tells a row)

d: logged signals of the loop with the effect less those of a loop that may be taken for it, both without noise; W: the
autoregression that whitens the loop's own noise, fitted to long runs of ``physics``.  The loop that may be taken for it
has any parameters within the tolerances, and no effect, or another one of any size.  What the noise tells: by how much
the noise of the loop with the effect is likelier by its own autoregression than by that of the other.

What bends shows only where noise and load drive the loop to it.  There d is that of both loops under the record's own
random numbers, which nobody knows who sees the log: the nats are then the most that could be told.  Of a stem that
nobody sees a log tells far less: its nats are those of ``unseen_stem``, the likelihood of the true stem against one
that follows OP, or against the best deadband.

Nothing here is shared with the diagnosis, nor does anything depend on what it answered.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.arrays import Values

from benchmarks.gap.generator import Record, packed
from benchmarks.gap.loop_numbers import NAMES, NEUTRAL
from benchmarks.gap.physics import run
from benchmarks.gap.runs import PLACES, VISIBLE, alike
from benchmarks.gap.settings import SETTINGS
from benchmarks.gap.severities import ACTS, FACTORS, OF_PV, OF_TIME, SITE, SIZE
from benchmarks.gap.unseen_stem import by_tolerances, of_stem, sizes
from benchmarks.gap.whitened import FIRST, ORDER, STEPS, judged, kept, noise_of, whitening

Acts = Callable[[Mapping[str, float], Values], Mapping[str, float]]
TRACE = 6.5  # nats below which a test with one false alarm in 300 records misses an effect more often than not
TIE = 6.0  # nats within which two effects leave the same log
FINE = 20  # steps of the integration a second where something has memory, or a dead time is to be told from a lag
DIGITS = ("sensor_noise", "quantisation", "compression", "scan_time")  # what shows in digits, in noise or by scans
STEMS = ("stiction", "deadband")
BENDS = ("stiction", "deadband", "valve_saturation", "valve_rate_limit", "controller_limits")
EITHER = ("valve_leak", "sensor_bias", "sensor_drift", "step_disturbance")  # of either sign
WAVES = ("sine_disturbance", "slug")
BEYOND = 1e12  # nats of what cannot be
SIZES = (0.1, 0.3, 0.6, 1.0, 1.5, 3.0)  # of the typical size, at which another effect is tried first
WIDTHS = (-1.0, -0.5, 0.0, 0.5, 1.0)  # of J, by which a deadband that looks like a stem may be wider than S
PLAIN = 200.0  # nats that no parameter within its tolerance explains
PROBE = 0.02  # of a tolerance, or of a typical size, for slopes
ROUNDS, SETTLED = 8, 0.02  # steps of Gauss and Newton; nats that one must gain


def nats_shown(record: Record) -> float:
    """Return the nats that a record tells of its one effect; infinite for one that digits, noise or scans show."""
    if len(record.effects) != 1 or set(record.effects) & set(DIGITS) or not SETTINGS[record.setting].scanned:
        return float("inf")
    most = _least(record, lambda base, x: base, [np.zeros(0)])
    if most < TRACE or not set(record.effects) & set(STEMS):
        return most
    found = of_stem(record, *sizes(record))
    if found < -TRACE:  # the truth is so unlikely only where its law is another one
        return most
    return min(found - by_tolerances(record), most) if found < PLAIN else min(found, most)


def nats_apart(record: Record, other: str) -> float:
    """Return the nats by which a record tells its one effect from another of any size, a step from the start.

    A sine from a slug, and the other way round, near the period of the one that is there; infinite where it shows
    otherwise.
    """
    loop, (name, values) = SETTINGS[record.setting], next(iter(record.effects.items()))
    if (name, other) == ("stiction", "deadband") and loop.scanned:
        S, J = sizes(record)
        return of_stem(record, S, J) - max(of_stem(record, S + by * J, 0.0) for by in WIDTHS)
    key = {**SIZE, **FACTORS, "step_disturbance": "amplitude"}.get(other, "")
    otherwise = {name, other} & {*DIGITS, *BENDS}
    if len(record.effects) != 1 or otherwise or not (key or {name, other} == set(WAVES)):
        return float("inf")
    if other in WAVES:

        def wave(base: Mapping[str, float], x: Values) -> dict[str, float]:
            its = {
                "amplitude": values["amplitude"] * x[0], "period": values["period"] * (1.0 + 0.1 * x[1]),
                "phase": values["phase"] + x[2],
            }  # fmt: skip
            return {**base, **ACTS[other](its, dict(base))}

        return _least(record, wave, [np.array([share, 0.0, 0.0]) for share in SIZES])
    typical = SITE[other][1] * (loop.slow if other in OF_TIME else loop.span if other in OF_PV else 1.0)

    def act(base: Mapping[str, float], x: Values) -> dict[str, float]:
        size = typical ** float(x[0]) if other in FACTORS else typical * float(x[0])
        return {**base, **ACTS[other]({key: size, "time": 0.0}, dict(base))}

    shares = (*SIZES, *(-share for share in SIZES)) if other in FACTORS or other in EITHER else SIZES
    return _least(record, act, [np.array([share]) for share in shares])


def alike_here(record: Record, names: Sequence[str]) -> tuple[str, ...]:
    """Return those of some effects that the record, without MV, cannot tell from its own: its class in this record."""
    (name,) = record.effects
    known = alike(name, False, record.setting)
    return tuple(one for one in names if one in known or nats_apart(record, one) < TIE)


def traced(record: Record, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the oracle says beside a row of ``scoring``: the nats that the record tells of its effect.

    And, where the truth is in a set that is larger than its class, whether name and places of the set are no more than
    what this record cannot tell apart; None elsewhere.
    """
    nats = nats_shown(record)
    found: dict[str, Any] = {"told": nats if np.isfinite(nats) else None, "told_apart": None, "told_place": None}
    names = row["sets"][0] if len(record.effects) == 1 and row["sets"] else []
    if "cause" in row and not (row["cause"] and row.get("place", True)) and set(record.effects) & set(names):
        here = alike_here(record, names)
        places = {PLACES[one] for one in (*here, *alike(next(iter(record.effects)), False, record.setting))}
        found["told_apart"] = len(here) == len(names)
        found["told_place"] = set(row.get("places", ())) <= places
    return found


def visible(row: Mapping[str, Any]) -> bool:
    """Return whether the effect of a row leaves a trace that tolerances and load do not hide."""
    return bool(row["visible"] > VISIBLE and (row.get("told") is None or row["told"] > TRACE))


def _least(record: Record, act: Acts, starts: Sequence[Values]) -> float:
    """Return the least nats over tolerances, and over the numbers of another effect; ``starts`` of these."""
    loop = SETTINGS[record.setting]
    nominal = {**NEUTRAL, **loop.numbers}
    A, W = whitening(record.setting, tuple(nominal.values()))
    within, bends = len(loop.within), bool(set(record.effects) & set(BENDS))
    steps = FINE if bends or "dead_time" in record.effects else STEPS
    true = _made(record, record.numbers, steps, bends)

    def numbers(x: Values) -> dict[str, float]:
        base = dict(nominal)
        for k, (key, share) in enumerate(loop.within.items()):
            base[key] *= 1.0 + share * x[k]
            if key == "tau":
                base["second"] *= 1.0 + share * x[k]
        return dict(act(base, x[within:]))

    def left(x: Values) -> Values:
        """Whitened differences, each row of unit variance."""
        other = _made(record, numbers(x), steps, bends)
        e = judged(true - other, A, W)
        e[_limited(true, other)] = 0.0
        return np.asarray(e.ravel())

    def nats(x: Values) -> float:
        e = left(x)
        return 0.5 * float(e @ e) if np.isfinite(e).all() else BEYOND

    at = np.array([(record.base[key] / nominal[key] - 1.0) / share for key, share in loop.within.items()])
    best = min((np.append(0.98 * at, more) for more in starts), key=nats)
    ends = np.where(np.arange(len(best)) < within, 1.0, np.inf)
    least = nats(best)
    for _ in range(ROUNDS):
        now, D = left(best), np.empty((len(left(best)), len(best)))
        for k in range(len(best)):
            h = PROBE if best[k] + PROBE <= ends[k] else -PROBE
            probe = best.copy()
            probe[k] += h
            D[:, k] = (left(probe) - now) / h
        if not np.isfinite(D).all():
            break
        step, gained = np.linalg.lstsq(D, -now, rcond=None)[0], 0.0
        for _ in range(5):
            new = np.clip(best + step, -ends, ends)
            if (value := nats(new)) < least:
                best, least, gained = new, value, least - value
                break
            step = 0.3 * step
        if gained < SETTLED:
            break
    return least + (0.0 if bends else _of_noise(record, numbers(best)))


def _limited(one: Values, other: Values) -> NDArray[np.bool_]:
    """Return the whitened rows of which a controller's output at a limit is part, where no loop is linear, (rows,)."""
    found = np.zeros(len(one), dtype=bool)
    for rows in (one, other):
        outputs = rows[:, [1, 3]] if rows.shape[1] == 4 else rows[:, 1:]
        found |= ((outputs <= 1e-9) | (outputs >= 1.0 - 1e-9)).any(axis=1)
    found = np.convolve(found, np.ones(ORDER + 1))[: len(one)] > 0.0
    return np.asarray(found[max(FIRST, ORDER) :])


def _of_noise(record: Record, other: Mapping[str, float]) -> float:
    """Return the nats by which the noise of a record's loop tells it from a loop with other numbers."""
    own = tuple(float(v) for v in record.numbers.values())
    rows = noise_of(record.setting, own)
    loss = []
    for numbers in (tuple(float(other[name]) for name in NAMES), own):
        A, W = whitening(record.setting, numbers)
        loss.append(0.5 * float(np.mean(np.sum(judged(rows, A, W) ** 2, axis=1))) - float(np.linalg.slogdet(W)[1]))
    return len(record.signals["time"]) * max(loss[0] - loss[1], 0.0)


def _made(record: Record, numbers: Mapping[str, float], steps: int, random: bool) -> Values:
    """Return the logged signals of a loop with these numbers, not rounded, (rows, signals).

    With the ``random`` numbers of the record, or without noise.  A dead time between two steps lies between both.
    """
    sp = record.set_point
    noise, noise_2, load = record.random if random else np.zeros((3, len(sp)))
    low = np.floor(numbers["theta"] * steps + 1e-9) / steps
    share = max(numbers["theta"] - low, 0.0) * steps
    found = np.zeros(0)
    for theta, part in ((low, 1.0 - share), (low + 1.0 / steps, share)):
        if part > 1e-6:
            its = packed({**numbers, "theta": max(theta, 0.0)})
            rows = run(its, sp, noise, noise_2, load, np.zeros(len(sp)), steps, float(sp[0]))
            rows = part * kept(record.setting, rows)
            found = found + rows if len(found) else rows
    return found
