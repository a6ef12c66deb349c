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
SIZES = (0.1, 0.3, 0.6, 1.0, 1.5)  # of the typical size, at which another effect is tried first


def told(record: Record) -> float:
    """Return the nats that a record tells of its one effect; infinite for one that shows otherwise.

    >>> from benchmarks.gap.generator import record
    >>> told(record("level", ["sensor_span"], given={"sensor_span": {"factor": 0.97}})) < TRACE
    True
    """
    if len(record.effects) != 1 or set(record.effects) & set(OTHERWISE) or not SETTINGS[record.setting].scanned:
        return float("inf")
    return _least(record, lambda base, size: base, ())


def told_apart(record: Record, other: str) -> float:
    """Return the nats by which a record tells its one effect from another of any size, a step from the start."""
    if len(record.effects) != 1 or {*record.effects, other} & set(OTHERWISE) or other not in {*SIZE, *FACTORS}:
        return float("inf")
    key, loop = {**SIZE, **FACTORS}[other], SETTINGS[record.setting]
    typical = SITE[other][1] * (loop.slow if other in OF_TIME else loop.span if other in OF_PV else 1.0)

    def act(base: Mapping[str, float], share: float) -> dict[str, float]:
        size = typical**share if other in FACTORS else typical * share
        return {**base, **ACTS[other]({key: size}, dict(base))}

    both = other in FACTORS or other in ("valve_leak", "sensor_bias", "sensor_drift")
    return _least(record, act, tuple(way * share for share in SIZES for way in ((1.0, -1.0) if both else (1.0,))))


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
    record: Record, act: Callable[[Mapping[str, float], float], Mapping[str, float]], shares: tuple[float, ...]
) -> float:
    """Return the least nats over tolerances, and over shares of an effect's typical size."""
    loop = SETTINGS[record.setting]
    A, W = whitening(record.setting)
    quiet = [0.0 * one for one in record.random]
    steps = FINE if "dead_time" in record.effects else STEPS
    true, true_n = (_made(record, record.numbers, random, steps) for random in (quiet, record.random))
    nominal = {**NEUTRAL, **loop.numbers}

    def nats(x: Floats) -> float:
        if np.any(np.abs(x[: len(loop.within)]) > 1.0):
            return 1e12
        base = dict(nominal)
        for k, (key, within) in enumerate(loop.within.items()):
            base[key] *= 1.0 + within * x[k]
            if key == "tau":
                base["second"] *= 1.0 + within * x[k]
        other = act(base, float(x[-1]))
        d = true - _made(record, other, quiet, steps)
        d_n = true_n - _made(record, other, record.random, steps)
        if not np.isfinite(d_n).all():
            return 1e12
        return 0.5 * float(np.sum(_white(d, A, W) ** 2)) + float(np.sum(_white(d_n - d, A, W) ** 2))

    at = np.array([(record.base[k] / nominal[k] - 1.0) / share for k, share in loop.within.items()])
    starts = [np.append(0.98 * at, share) for share in shares] or [0.98 * at]
    start = min(starts, key=nats)
    simplex = np.vstack([start, *(start + 0.3 * (1.0 if v < 0.5 else -1.0) * row for v, row in zip(
        start, np.eye(len(start)), strict=True))])  # fmt: skip
    options = {"initial_simplex": simplex, "xatol": 1e-3, "fatol": 0.05, "maxfev": 40 * len(start)}
    found = minimize(nats, start, method="Nelder-Mead", options=options)
    return float(found.fun)


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
