"""How many nats a record tells of a stem that nobody sees: a particle filter by the physics of the benchmark alone.

    e_k = sum_j h_j delta_k-j + white noise           whitened log; delta: stem less OP, mean of a row's interval
    w_i <- w_i N(e_k - sum_j h_j delta_i,k-j; 0, 1),  nats = sum over rows of ln (sum w_i N_i) / N(e_k; 0, 1)

A loop whose stem does not follow OP is the linear loop with one more load, delta; h is what a load of one row does to
the whitened log.  Each particle is a stem with the true S and J.  Of OP between two rows it knows all but what the
sensors' noise of each scan makes of it, which is more than a log tells.
"""

import math
from collections.abc import Mapping

import numpy as np
from numba import njit
from stickslip.logs.arrays import Values

from benchmarks.gap.generator import Record, packed
from benchmarks.gap.loop_numbers import NEUTRAL
from benchmarks.gap.physics import run
from benchmarks.gap.settings import SETTINGS
from benchmarks.gap.whitened import FIRST, ORDER, STEPS, judged, kept, whitened, whitening

STEMS = 400
REACH = 40  # rows that a load of one row is felt
REPEATS = 0.02  # share by which a breakaway differs from stem to stem
ANEW = 0.002  # share of the stems that are put anywhere within the band, a row
PULSE, KICK = 400, 1e-3  # row and size of a load that shows what one row of it does
EVEN = 0.5  # share of the stems that must count


def nats(
    e: Values, h: Values, OP: Values, random: float, S: float, J: float, every: int, first: int, seed: int = 0
) -> float:
    """Return by how many nats a stem with ``S`` and ``J`` is likelier than one that follows OP.

    ``e`` (rows, signals) the whitened log, judged from row ``first`` on; ``h`` (REACH, signals) what a load of 1 over
    one row makes of it later; ``OP`` a value a second without the ``random`` part of its scan (standard deviation), but
    with it at rows, ``every`` seconds; S, J, OP and load in shares of the stem's travel.

    >>> rng = np.random.default_rng(1)
    >>> OP = 0.5 + np.repeat(rng.choice([-0.1, 0.1], 60), 50)  # swings of 20 % behind a stem that sticks 30 %
    >>> stands = np.zeros((600, 1))
    >>> stands[1:, 0] = 20.0 * (0.5 - OP[::5])[:-1]
    >>> h = np.zeros((REACH, 1))
    >>> h[0] = 20.0
    >>> e = rng.normal(size=(600, 1))
    >>> bool(nats(stands + e, h, OP, 0.001, 0.3, 0.2, 5, 60) > 500.0 > 0.0 > nats(e, h, OP, 0.001, 0.3, 0.2, 5, 60))
    True
    """
    rng = np.random.default_rng([5, seed])
    draws, turns = rng.normal(size=(len(OP), STEMS)), rng.random((len(e), 2))
    repeats = 1.0 + REPEATS * rng.normal(size=STEMS)
    return float(_passed(e, h, OP, random, S, J, every, first, draws, turns, repeats))


def sizes(record: Record) -> tuple[float, float]:
    """Return S and J of a record's stem, in shares of its travel."""
    its = next(iter(record.effects.values()))
    return its.get("S", its.get("width", 0.0)) / 100.0, its.get("J", 0.0) / 100.0


def of_stem(record: Record, S: float, J: float) -> float:
    """Return by how many nats a stem with ``S`` and ``J`` [share of travel] is likelier than one that follows OP."""
    loop, base = SETTINGS[record.setting], record.base
    A, W = whitening(record.setting, tuple(float(v) for v in base.values()))
    none, mean = np.zeros(len(record.set_point)), np.full(len(record.set_point), float(np.mean(loop.levels)))
    det = _answered(record, base)
    d = _read(record) - kept(record.setting, det)
    e = whitened(d, A, W)
    load = none.copy()
    load[PULSE * loop.every : (PULSE + 1) * loop.every] = KICK
    made = [kept(record.setting, run(packed(base), mean, none, none, x, none, STEPS, mean[0])) for x in (none, load)]
    h = whitened(made[1] - made[0], A, W)[PULSE + 1 : PULSE + 1 + REACH] / KICK
    # what OP will be at the next row as far as the rows before tell, and so between them; the noise of a scan is drawn
    ahead = (d - e @ np.linalg.inv(W).T)[1:, -1]
    OP = det[:, 2].copy()
    OP[:-1] += np.repeat(ahead, loop.every)
    OP[:: loop.every] = record.signals["OP"]
    fast = base["K_p"] * (1.0 + base["scan"] / base["T_i"])
    slow = fast * base["outer_K"] * (1.0 + 1.0 / base["outer_T"]) * base["outer_noise"]
    random = float(np.hypot(fast * loop.noise, slow))
    return nats(e, h, OP, random, S, J, loop.every, max(FIRST, ORDER))


def by_tolerances(record: Record) -> float:
    """Return by how many nats other parameters within the tolerances suit a log better than the true ones.

    One step of Fisher's scoring:  - min g x + 1/2 x' H x  within the tolerances,  g = e . D - rows d ln|W|,  H = D' D
    """
    loop, nominal, logged = SETTINGS[record.setting], {**NEUTRAL, **SETTINGS[record.setting].numbers}, _read(record)

    def seen(base: Mapping[str, float]) -> tuple[Values, float]:
        A, W = whitening(record.setting, tuple(float(v) for v in base.values()))
        return judged(logged - kept(record.setting, _answered(record, base)), A, W).ravel(), np.linalg.slogdet(W)[1]

    e, width = seen(record.base)
    found, low, high, h = [], [], [], 0.2
    for key, share in loop.within.items():
        at = (record.base[key] / nominal[key] - 1.0) / share
        step = h if at < 0.0 else -h
        moved = dict(record.base)
        for name in (key, "second") if key == "tau" else (key,):
            moved[name] *= (1.0 + share * (at + step)) / (1.0 + share * at)
        probe, other = seen(moved)
        found.append(((probe - e) / step, (other - width) / step))
        low.append(-1.0 - at)
        high.append(1.0 - at)
    D, rows = np.stack([d for d, _ in found], axis=1), len(logged) - max(FIRST, ORDER)
    g, H, x = e @ D - rows * np.array([w for _, w in found]), D.T @ D, np.zeros(len(found))
    for _ in range(60):
        for k in range(len(x)):
            x[k] = np.clip(x[k] - (g[k] + H[k] @ x) / max(H[k, k], 1e-12), low[k], high[k])
    return -float(g @ x + 0.5 * x @ H @ x)


def _answered(record: Record, numbers: Mapping[str, float]) -> Values:
    """Return what a loop with these numbers makes of the set point, without noise and load, a value a second."""
    sp, none = record.set_point, np.zeros(len(record.set_point))
    return np.asarray(run(packed(numbers), sp, none, none, none, none, STEPS, float(sp[0])))


def _read(record: Record) -> Values:
    """Return the logged signals, (rows, signals)."""
    names = ("L", "SP", "PV", "OP") if "L" in record.signals else ("PV", "OP")
    return np.stack([record.signals[name] for name in names], axis=1)


@njit(cache=True)
def _passed(e, h, OP, random, S, J, every, first, draws, turns, repeats):  # type: ignore[no-untyped-def]
    rows, kinds = e.shape
    M = draws.shape[1]
    x, w = np.empty(M), np.full(M, 1.0 / M)
    past, other, other_x = np.zeros((M, REACH)), np.empty((M, REACH)), np.empty(M)
    log_w = np.empty(M)
    for i in range(M):
        x[i] = OP[0] + 0.5 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
    total = 0.0
    for k in range(rows - 1):
        for i in range(M):
            away = 0.0
            for s in range(every):
                at = k * every + s
                command = OP[at] + (random * draws[at, i] if s else 0.0)
                pull = command - x[i]
                if abs(pull) > max(0.5 * (S + J) * repeats[i], 0.5 * (S - J)):
                    x[i] = command - math.copysign(0.5 * (S - J), pull)
                away += (x[i] - command) / every
            past[i, k % REACH] = away
        largest, none = -1e300, 0.0
        for q in range(kinds):
            none -= 0.5 * e[k + 1, q] ** 2
        for i in range(M):
            log_w[i] = 0.0
            for q in range(kinds):
                miss = e[k + 1, q]
                for j in range(min(REACH, k + 1)):
                    miss -= h[j, q] * past[i, (k - j) % REACH]
                log_w[i] -= 0.5 * miss * miss
            largest = max(largest, log_w[i])
        density = 0.0
        for i in range(M):
            w[i] *= math.exp(log_w[i] - largest)
            density += w[i]
        even = 0.0
        for i in range(M):
            w[i] /= density
            even += w[i] ** 2
        if k + 1 >= first:
            total += math.log(density) + largest - none
        if 1.0 / even < EVEN * M:
            passed, i = w[0], 0
            for q in range(M):
                share = (q + turns[k, 0]) / M
                while passed < share and i < M - 1:
                    i += 1
                    passed += w[i]
                other[q] = past[i]
                other_x[q] = x[i]
            past[:] = other
            x[:] = other_x
            w[:] = 1.0 / M
        # a few stems anywhere within the band, in turn
        lost = ANEW * M
        for i in range(M):
            if (i + turns[k, 1] * M) % M < lost:
                x[i] = OP[k * every] + 0.5 * (S + J) * (2.0 * ((i * 0.618034) % 1.0) - 1.0)
    return total
