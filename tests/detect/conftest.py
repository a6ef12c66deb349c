"""Waves and loops with known shape; every number follows from the formula, none from the code under test."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.logs import LoopRecord


def _wave(kind, t, period=50.0, phase=0.0, tau=8.0):
    """Amplitude near 1, crossing zero upwards at phase 0."""
    u = (np.asarray(t) / period + phase) % 1.0
    sign, part = np.where(u < 0.5, 1.0, -1.0), 2 * (u % 0.5)  # part: 0 to 1 within the half cycle
    if kind == "sine":
        return np.sin(2 * np.pi * u)
    if kind == "triangle":
        return sign * (1 - np.abs(2 * part - 1))
    if kind == "square":
        return sign
    if kind == "exponential":  # steady response of 1 / (tau s + 1) to a square wave; switches at part = 0
        h = period / 2 / tau
        return sign * (1 - (1 + np.tanh(h / 2)) * np.exp(-part * h))
    raise ValueError(kind)


def own_turns(t, period):
    """Turns of a cycle that keeps no time: its phase strays by 1 % of a cycle from one to the next."""
    t = np.asarray(t)
    knots = np.arange(0.0, t[-1] + 2.0 * period, period)
    return t / period + np.interp(t, knots, 0.01 * np.cumsum(np.random.default_rng(11).normal(size=len(knots))))


def _loop(t, e, **more):
    """A flow loop at constant SP with this control error; OP is its running integral, as under a PI."""
    e = np.asarray(e, dtype=float)
    op = 50 + 0.05 * (e + np.cumsum(np.nan_to_num(e)) * 0.02)
    more.setdefault("process", "self_regulating")
    return LoopRecord.from_arrays(t, pv=30 - e, op=op, sp=np.full(len(e), 30.0), name="FIC1", **more)


def _sticky(
    process="self_regulating", S=6.0, J=4.0, noise=0.0, n=3000, K=1.0, tau=10.0, K_p=0.5, T_i=10.0, load=50.0,
    moves=(), walk=0.0, R=1.0, seed=0,
):  # fmt: skip
    """A PI loop with a sticky valve (Kano et al. 2004), a lag or an integrator, one sample a second, all in %.

    `load` is the outflow of the integrator; in the middle of the two places of the valve, half waves are alike.
    `moves` of the set point follow one another evenly over the record: 51.3 and what each adds to it. `walk` is the
    step of a random load (correlated over 1000 s), `R` the rangeability of an equal-percentage valve, 1 for linear.

    Written anew for the tests: plain recursions, no block and no engine.
    """
    rng = np.random.default_rng(seed)
    pv, m, us, u_prev, way, stuck, integral = 50.0, 50.0, 50.0, 50.0, 1.0, True, 50.0
    if process == "integrating":
        K_p, T_i = 1.2, 120.0
    rows = np.empty((n, 3))
    steps = np.concatenate([[0.0], np.asarray(moves, dtype=float)])
    sps = 51.3 + steps[np.arange(n) * len(steps) // n]
    loads = lfilter([1], [1, -0.999], walk * np.random.default_rng([5, seed]).normal(size=n))
    for k in range(n):
        sp = sps[k]
        seen = pv + noise * rng.normal()
        e = sp - seen
        integral += K_p * e / T_i
        u = min(max(integral + K_p * e, 0.0), 100.0)
        if not stuck and (u - u_prev) * way <= 0.0:
            us, stuck = u_prev, True
        if stuck:
            if -way * (u - us) > S:
                way, stuck = -way, False
            elif way * (u - us) > J:
                stuck = False
        if not stuck:
            m = u - way * (S - J) / 2.0
        u_prev = u
        flow = m if R == 1.0 else 50.0 + 100.0 / np.log(R) * np.expm1(np.log(R) * (m - 50.0) / 100.0)
        flow += loads[k]
        pv += (flow - load) / (5.0 * tau) if process == "integrating" else (K * flow - pv) * -np.expm1(-1.0 / tau)
        rows[k] = seen, u, m
    rows = rows[n // 5 :]
    return LoopRecord.from_arrays(
        np.arange(float(len(rows))), pv=rows[:, 0], op=rows[:, 1], mv=rows[:, 2], sp=sps[n // 5 :],
        name="LIC1" if process == "integrating" else "FIC1", process=process,
    )  # fmt: skip


def _forced(n=3000, period=60.0, S=0.0, J=0.0, noise=0.05, swing=3.0, walk=0.03, seed=0):
    """A PI loop on a lag of 10 s that an outside sine of amplitude `swing` and a random walk move, all in %.

    The valve is Kano's: with S = 0 it follows OP.
    """
    rng = np.random.default_rng([77, seed])
    load = swing * np.sin(2 * np.pi * (np.arange(n) / period + rng.uniform())) + np.cumsum(rng.normal(0, walk, n))
    f_s, f_d = (S + J) / 2.0, (S - J) / 2.0
    pv, integral, m, way, moves, rows = 50.0, 50.0, 50.0, 1.0, True, np.empty((n, 3))
    for k in range(n):
        seen = pv + noise * rng.normal()
        integral += 0.04 * (50.0 - seen)
        u = integral + 0.4 * (50.0 - seen)
        back = way * (u - m) < -f_s
        moves = back or way * (u - m) > (f_d if moves else f_s)
        way = -way if back else way
        m = u - way * f_d if moves else m
        pv += (m + load[k] - pv) * -np.expm1(-1.0 / 10.0)
        rows[k] = seen, u, m
    t = np.arange(float(n))
    return LoopRecord.from_arrays(
        t, pv=rows[:, 0], op=rows[:, 1], mv=rows[:, 2], sp=np.full(n, 50.0), name="FIC1", process="self_regulating"
    )


def _outside_square(seed, n=2500, period=None):
    """A PI loop on a lag with a healthy valve, moved by a square wave and a walk from outside, all in %."""
    rng = np.random.default_rng([91, seed])
    period = rng.uniform(40.0, 160.0) if period is None else period
    tau = rng.uniform(4.0, 20.0)
    load = rng.uniform(1.0, 5.0) * np.sign(np.sin(2 * np.pi * (np.arange(n) / period + rng.uniform())))
    load += np.cumsum(rng.normal(0, 0.02, n))
    pv, integral, rows = 50.0, 50.0, np.empty((n, 2))
    for k in range(n):
        seen = pv + 0.05 * rng.normal()
        integral += 0.5 / tau * (50.0 - seen)
        u = integral + 0.5 * (50.0 - seen)
        pv += (u + load[k] - pv) * -np.expm1(-1.0 / tau)
        rows[k] = seen, u
    t = np.arange(float(n))
    return LoopRecord.from_arrays(
        t, pv=rows[:, 0], op=rows[:, 1], sp=np.full(n, 50.0), name="FIC1", process="self_regulating"
    )


def _noise(kind, n, seed):
    """Noise without any period: white, AR(1), a random walk, white noise through two lags, a loop under a walk."""
    rng = np.random.default_rng([2009, seed, n])
    w = rng.normal(size=n + 1000)
    if kind == "white":
        x = w
    elif kind == "walk":
        x = np.cumsum(w)
    elif kind == "two lags":
        x = lfilter([1], [1, -np.exp(-1 / 10)], lfilter([1], [1, -np.exp(-1 / 30)], w))
    elif kind == "loop":  # PI with K_p = 1, T_i = 10 on 1 / (10 s + 1), one sample a second, walk at the input:
        # e = -s / (10 s + 1) / (s + 0.1) * load, hence white noise through two equal lags of 10
        x = lfilter([1], [1, -2 * np.exp(-0.1), np.exp(-0.2)], w)
    else:
        x = lfilter([1], [1, -kind], w)
    return x[1000:]


def _simulated(valve, process="self_regulating", S=6.0, J=4.0, moves=(), noise=0.05, theta=0.0, n=1500, seed=0):
    """The same loop from the blocks and the engine; `valve` is "kano", "choudhury" or "he", S, J and noise in %."""
    from stickslip.blocks import ChoudhuryValve, FirstOrder, HeValve, Integrator, KanoValve, SampledPI, Staircase
    from stickslip.diagram import simulate, wire

    bands = {"S": S / 100, "J": J / 100}
    if valve == "he":
        stem = HeValve(f_s=(S + J) / 200, f_d=(S - J) / 200, dt=1.0, start=0.5)
    else:
        stem = (KanoValve if valve == "kano" else ChoudhuryValve)(**bands, dt=1.0, start=0.5)
    level = process == "integrating"
    body = Integrator(K=1.0, T=50.0, theta=theta, u_0=0.5, start=0.5) if level else FirstOrder(
        K=1.0, tau=3.0, theta=theta, start=0.5
    )  # fmt: skip
    K_p, T_i = (1.2, 40.0) if level else (0.4, 2.0)
    levels = 0.513 + np.concatenate([[0.0], np.asarray(moves, dtype=float)]) / 100
    run = simulate(
        wire([Staircase("SP", levels, dwell=n / len(levels)), SampledPI(K_p, T_i, dt=1.0, start_op=0.5), stem, body]),
        float(n), every=1.0,
    )  # fmt: skip
    assert run.ok
    pv = run.log["PV"] + noise / 100 * np.random.default_rng(seed).normal(size=len(run.log))
    return LoopRecord.from_arrays(
        run.log.t, pv=pv, op=run.log["OP"], mv=run.log["MV"], sp=run.log["SP"], process=process, op_span=(0.0, 1.0),
        name="LIC2" if level else "FIC2",
    )  # fmt: skip


def _bare(record, gain=1.0, offset=0.0, op_gain=1.0, every=1):
    """The record without MV, PV and SP in another unit, OP mirrored about 50 or scaled, every n-th sample."""
    r, pick = record, slice(None, None, every)
    return LoopRecord.from_arrays(
        r.t[pick], pv=gain * r.pv[pick] + offset, sp=gain * r.sp[pick] + offset, process=r.process,
        op=50 + op_gain * (r.op[pick] - 50), op_span=(50 - 50 * abs(op_gain), 50 + 50 * abs(op_gain)), name=r.name,
    )  # fmt: skip


@pytest.fixture
def bare():
    return _bare


@pytest.fixture
def simulated():
    return _simulated


@pytest.fixture
def forced():
    return _forced


@pytest.fixture
def outside_square():
    return _outside_square


@pytest.fixture
def noise():
    return _noise


@pytest.fixture
def sticky():
    return _sticky


@pytest.fixture
def wave():
    return _wave


@pytest.fixture
def loop():
    return _loop
