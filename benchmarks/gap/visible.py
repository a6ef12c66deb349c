"""How many nats a record tells of its effect: an oracle, by physics alone, of what no diagnosis could see.

    nats = min over tolerances of   1/2 |W d|^2 + |W (d_n - d)|^2

d: logged signals of the loop with the effect less those of a loop that may be taken for it, both without noise; d_n the
same with the noise and the load of the record in both; W: the autoregression that whitens the loop's own noise, fitted
to long runs of ``physics``.  The loop that may be taken for it has any parameters within the tolerances, and no effect,
or another one of any size.  The second term is at least what the noise tells: an effect that changes how the loop
answers it shows in the noise too.  Nothing here is shared with the diagnosis.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from benchmarks.gap.generator import Record, autoregression, packed
from benchmarks.gap.physics import NEUTRAL, run
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
# what shows otherwise than in the mean of a linear loop: by the digits, by noise, by a stem that sticks, by its scans
OTHERWISE = ("stiction", "deadband", "sensor_noise", "quantisation", "compression", "scan_time")
EITHER = ("valve_leak", "sensor_bias", "sensor_drift", "step_disturbance")  # of either sign
WAVES = ("sine_disturbance", "slug")
BEYOND = 1e12  # nats of what cannot be
SIZES = (0.1, 0.3, 0.6, 1.0, 1.5)  # of the typical size, at which another effect is tried first


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
    A, W = whitening(record.setting)
    steps, within = FINE if "dead_time" in record.effects else STEPS, len(loop.within)
    quiet = [0.0 * one for one in record.random]
    true, true_n = (_made(record, record.numbers, random, steps) for random in (quiet, record.random))
    nominal = {**NEUTRAL, **loop.numbers}

    def nats(x: Floats) -> float:
        if np.any(np.abs(x[:within]) > 1.0):
            return BEYOND
        base = dict(nominal)
        for k, (key, share) in enumerate(loop.within.items()):
            base[key] *= 1.0 + share * x[k]
            if key == "tau":
                base["second"] *= 1.0 + share * x[k]
        other = act(base, x[within:])
        d = true - _made(record, other, quiet, steps)
        d_n = true_n - _made(record, other, record.random, steps)
        if not np.isfinite(d_n).all():
            return BEYOND
        return 0.5 * float(np.sum(_white(d, A, W) ** 2)) + float(np.sum(_white(d_n - d, A, W) ** 2))

    at = np.array([(record.base[key] / nominal[key] - 1.0) / share for key, share in loop.within.items()])
    start = min((np.append(0.98 * at, more) for more in starts), key=nats)
    simplex = np.array([start] * (len(start) + 1))
    for k, value in enumerate(start):
        simplex[k + 1, k] += 0.3 if value < 0.5 else -0.3
    options = {"initial_simplex": simplex, "xatol": 1e-3, "fatol": 0.05, "maxfev": 40 * len(start)}
    return float(minimize(nats, start, method="Nelder-Mead", options=options).fun)


def _made(record: Record, numbers: Mapping[str, float], random: Sequence[Floats], steps: int) -> Floats:
    """Return the logged signals of a loop with these numbers, not rounded, (rows, signals)."""
    sp = record.set_point
    out = run(packed(numbers), sp, *random, 0.0 * sp, steps, float(sp[0]))
    return _kept(record.setting, out)


def _kept(setting: str, out: Floats) -> Floats:
    loop = SETTINGS[setting]
    return np.asarray(out[:: loop.every][:, [5, 0, 1, 2] if "outer_K" in loop.numbers else [1, 2]])


def _white(d: Floats, A: Floats, W: Floats) -> Floats:
    e = d.copy()
    for j, a in enumerate(A, start=1):
        e[j:] -= d[:-j] @ a.T
    return np.asarray(e[max(FIRST, ORDER) :] @ W.T)


@lru_cache(maxsize=8)
def whitening(setting: str) -> tuple[Floats, Floats]:
    """Return (A_j, W) that make the noise of a loop's logged signals white, of unit variance."""
    loop = SETTINGS[setting]
    rng = np.random.default_rng([3, list(SETTINGS).index(setting)])
    n = 3600 * HOURS
    sp = np.full(n, round(float(np.mean(loop.levels)), 2))
    random = loop.noise * rng.normal(size=n), rng.normal(size=n), loop.load * autoregression(rng, n)
    out = run(packed({**NEUTRAL, **loop.numbers}), sp, *random, 0.0 * sp, STEPS, float(sp[0]))
    rows = _kept(setting, out)[3600 // loop.every :]
    fine, coarse = loop.rounding
    steps = [fine, coarse, fine, coarse] if rows.shape[1] == 4 else [fine, coarse]
    rows = np.round(rows / steps) * steps
    rows -= rows.mean(axis=0)
    scale = rows.std(axis=0)
    rows /= scale
    m = rows.shape[1]
    past = np.hstack([rows[ORDER - j : -j] for j in range(1, ORDER + 1)])
    C = np.linalg.lstsq(past, rows[ORDER:], rcond=None)[0]
    left = rows[ORDER:] - past @ C
    W = np.linalg.inv(np.linalg.cholesky(left.T @ left / len(left)))
    A = np.stack([scale[:, None] * C[m * j : m * (j + 1)].T / scale for j in range(ORDER)])
    return A, W / scale
