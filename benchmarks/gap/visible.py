"""How many nats a record tells of its effect: an oracle, by physics alone, of what no diagnosis could see.

    nats = min over tolerances of 1/2 |W d|^2  +  rows x (what the noise of the loop tells a row)

d: logged signals of the loop with the effect less those of a loop that may be taken for it, both without noise; W: the
autoregression that whitens the loop's own noise, fitted to long runs of ``physics``.  The loop that may be taken for it
has any parameters within the tolerances, and no effect, or another one of any size.  What the noise tells: by how much
the noise of the loop with the effect is likelier by its own autoregression than by that of the other.  Nothing here is
shared with the diagnosis.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from benchmarks.gap.generator import Record, autoregression, packed
from benchmarks.gap.physics import NAMES, NEUTRAL, run
from benchmarks.gap.runs import VISIBLE
from benchmarks.gap.settings import SETTINGS
from benchmarks.gap.severities import ACTS, FACTORS, OF_PV, OF_TIME, SITE, SIZE

Floats = NDArray[np.float64]
TRACE = 6.5  # nats below which a test with one false alarm in 300 records misses an effect more often than not
TIE = 6.0  # nats within which two effects leave the same log
ORDER = 24  # rows that whitening looks back
HOURS = 100  # of noise that it is fitted to
STEPS, FINE = 5, 20  # of the integration a second; where a dead time is to be told from a lag
FIRST = 60  # rows that no diagnosis judges
# what shows otherwise than in a linear loop: by the digits, by noise, by a stem that sticks, by its scans, at limits
OTHERWISE = (
    "stiction", "deadband", "sensor_noise", "quantisation", "compression", "scan_time",
    "valve_saturation", "valve_rate_limit", "controller_limits",
)  # fmt: skip
EITHER = ("valve_leak", "sensor_bias", "sensor_drift", "step_disturbance")  # of either sign
WAVES = ("sine_disturbance", "slug")
BEYOND = 1e12  # nats of what cannot be
SIZES = (0.1, 0.3, 0.6, 1.0, 1.5, 3.0)  # of the typical size, at which another effect is tried first


def told(record: Record) -> float:
    """Return the nats that a record tells of its one effect; infinite for one that shows otherwise."""
    if len(record.effects) != 1 or set(record.effects) & set(OTHERWISE) or not SETTINGS[record.setting].scanned:
        return float("inf")
    return _least(record, lambda base, x: base, [np.zeros(0)])


def told_apart(record: Record, other: str) -> float:
    """Return the nats by which a record tells its one effect from another of any size, a step from the start.

    A sine from a slug, and the other way round, near the period of the one that is there; infinite where it shows
    otherwise.
    """
    loop, (name, values) = SETTINGS[record.setting], next(iter(record.effects.items()))
    key = {**SIZE, **FACTORS, "step_disturbance": "amplitude"}.get(other, "")
    if len(record.effects) != 1 or {name, other} & set(OTHERWISE) or not (key or {name, other} == set(WAVES)):
        return float("inf")
    if other in WAVES:

        def wave(base: Mapping[str, float], x: Floats) -> dict[str, float]:
            its = {
                "amplitude": values["amplitude"] * x[0], "period": values["period"] * (1.0 + 0.1 * x[1]),
                "phase": values["phase"] + x[2],
            }  # fmt: skip
            return {**base, **ACTS[other](its, dict(base))}

        return _least(record, wave, [np.array([share, 0.0, 0.0]) for share in SIZES])
    typical = SITE[other][1] * (loop.slow if other in OF_TIME else loop.span if other in OF_PV else 1.0)

    def act(base: Mapping[str, float], x: Floats) -> dict[str, float]:
        size = typical ** float(x[0]) if other in FACTORS else typical * float(x[0])
        return {**base, **ACTS[other]({key: size, "time": 0.0}, dict(base))}

    shares = (*SIZES, *(-share for share in SIZES)) if other in FACTORS or other in EITHER else SIZES
    return _least(record, act, [np.array([share]) for share in shares])


def traced(record: Record, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the oracle says beside a row of ``scoring``: the nats that the record tells of its effect.

    And whether it cannot tell apart the names of a set that is larger than the effect's class either; None where it
    says nothing.
    """
    nats = told(record)
    names = row["sets"][0] if len(record.effects) == 1 and row["sets"] else []
    wide = "cause" in row and not row["cause"] and set(record.effects) & set(names)
    return {
        "told": nats if np.isfinite(nats) else None,
        "told_apart": all(told_apart(record, name) < TIE for name in names if name not in record.effects)
        if wide else None,
    }  # fmt: skip


def visible(row: Mapping[str, Any]) -> bool:
    """Return whether the effect of a row leaves a trace that tolerances and load do not hide."""
    return bool(row["visible"] > VISIBLE and (row.get("told") is None or row["told"] > TRACE))


def _least(
    record: Record, act: Callable[[Mapping[str, float], Floats], Mapping[str, float]], starts: Sequence[Floats]
) -> float:
    """Return the least nats over tolerances, and over the numbers of another effect; ``starts`` of these."""
    loop = SETTINGS[record.setting]
    nominal = {**NEUTRAL, **loop.numbers}
    A, W = whitening(record.setting, tuple(nominal.values()))
    steps, within = FINE if "dead_time" in record.effects else STEPS, len(loop.within)
    true = _made(record, record.numbers, steps)

    def numbers(x: Floats) -> dict[str, float]:
        base = dict(nominal)
        for k, (key, share) in enumerate(loop.within.items()):
            base[key] *= 1.0 + share * x[k]
            if key == "tau":
                base["second"] *= 1.0 + share * x[k]
        return dict(act(base, x[within:]))

    def nats(x: Floats) -> float:
        if np.any(np.abs(x[:within]) > 1.0):
            return BEYOND
        other = _made(record, numbers(x), steps)
        e = _white(true - other, A, W)[~_limited(true, other)]
        return 0.5 * float(np.sum(e**2)) if np.isfinite(e).all() else BEYOND

    at = np.array([(record.base[key] / nominal[key] - 1.0) / share for key, share in loop.within.items()])
    start = min((np.append(0.98 * at, more) for more in starts), key=nats)
    simplex = np.array([start] * (len(start) + 1))
    for k, value in enumerate(start):
        simplex[k + 1, k] += 0.3 if value < 0.5 else -0.3
    options = {"initial_simplex": simplex, "xatol": 1e-3, "fatol": 0.05, "maxfev": 40 * len(start)}
    found = minimize(nats, start, method="Nelder-Mead", options=options)
    return float(found.fun) + _of_noise(record, numbers(found.x))


def _limited(one: Floats, other: Floats) -> NDArray[np.bool_]:
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
    rows = _noise(record.setting, own)
    loss = []
    for numbers in (tuple(float(other[name]) for name in NAMES), own):
        A, W = whitening(record.setting, numbers)
        loss.append(0.5 * float(np.mean(np.sum(_white(rows, A, W) ** 2, axis=1))) - float(np.linalg.slogdet(W)[1]))
    return len(record.signals["time"]) * max(loss[0] - loss[1], 0.0)


def _made(record: Record, numbers: Mapping[str, float], steps: int) -> Floats:
    """Return the logged signals of a loop with these numbers, without noise, not rounded, (rows, signals)."""
    sp = record.set_point
    none = np.zeros(len(sp))
    return _kept(record.setting, run(packed(numbers), sp, none, none, none, none, steps, float(sp[0])))


def _kept(setting: str, out: Floats) -> Floats:
    loop = SETTINGS[setting]
    return np.asarray(out[:: loop.every][:, [5, 0, 1, 2] if "outer_K" in loop.numbers else [1, 2]])


def _white(d: Floats, A: Floats, W: Floats) -> Floats:
    e = d.copy()
    for j, a in enumerate(A, start=1):
        e[j:] -= d[:-j] @ a.T
    return np.asarray(e[max(FIRST, ORDER) :] @ W.T)


@lru_cache(maxsize=8)
def _noise(setting: str, numbers: tuple[float, ...]) -> Floats:
    """Return what the noise of a loop makes of its logged signals, always of the same random numbers."""
    loop = SETTINGS[setting]
    rng = np.random.default_rng([3, list(SETTINGS).index(setting)])
    n = 3600 * HOURS
    sp = np.full(n, round(float(np.mean(loop.levels)), 2))
    random = loop.noise * rng.normal(size=n), rng.normal(size=n), loop.load * autoregression(rng, n)
    out = run(np.array(numbers), sp, *random, np.zeros(n), STEPS, float(sp[0]))
    rows = _kept(setting, out)[3600 // loop.every :]
    fine, coarse = loop.rounding
    steps = [fine, coarse, fine, coarse] if rows.shape[1] == 4 else [fine, coarse]
    rows = np.round(rows / steps) * steps
    return np.asarray(rows - rows.mean(axis=0))


@lru_cache(maxsize=8)
def whitening(setting: str, numbers: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Return (A_j, W) that make the noise of a loop's logged signals white, of unit variance."""
    rows = _noise(setting, numbers)
    scale = rows.std(axis=0)
    rows = rows / scale
    m = rows.shape[1]
    past = np.hstack([rows[ORDER - j : -j] for j in range(1, ORDER + 1)])
    C = np.linalg.lstsq(past, rows[ORDER:], rcond=None)[0]
    left = rows[ORDER:] - past @ C
    W = np.linalg.inv(np.linalg.cholesky(left.T @ left / len(left)))
    A = np.stack([scale[:, None] * C[m * j : m * (j + 1)].T / scale for j in range(ORDER)])
    return A, W / scale
