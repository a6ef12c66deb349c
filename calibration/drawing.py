"""Which loops are drawn: half with a sticky valve, the rest spread evenly over other causes.

Every defect of data, the sampling, the length and the scales are drawn from one law whatever the cause, so that none
of them tells a cause by itself.
"""

import math
from collections.abc import Sequence
from typing import Any, get_args

import numpy as np
from stickslip.calibration.excitation import SHAPES
from stickslip.calibration.margins import Loop, ultimate
from stickslip.calibration.spec import Cause, Kinds, LoopSpec, Setting

Random = np.random.Generator

OTHERS: dict[str, Cause] = {
    "healthy": "healthy",
    "tight_tuning": "tight_tuning",
    "external_sine": "external_oscillation",
    "external_square": "external_oscillation",
    "external_saw": "external_oscillation",
    "external_stochastic": "external_oscillation",
    "deadband": "deadband",
    "quantisation": "sensor",
    "compression": "healthy",
    "saturation": "saturation",
    "drift": "drift",
    "cascade_slave": "cascade_slave",
    "dead_loop": "dead_loop",
}
"""Groups without stiction and their cause; compression acts on the log of a healthy loop."""

LEVEL = "level_deadband"
"""Integrating with a deadband and no jump, which cycles by itself: to learn from only, of the cause "deadband"."""

NOT_CYCLING = 0.2  # share of the sticky loops that disturbance or set point must move
INTEGRATING = 0.25  # share of integrating processes
CYCLE = (0.9, 1.9)  # range of OP over S in a loop that cycles by stiction, as seen in simulation
TRAVEL = (0.8, 6.0)  # the same where something else moves OP
WANDERS = 0.75  # share of the waves whose periods differ in length, as those that other loops make do
WANDER = (0.005, 0.15)  # of a period: by how much they differ
SWELLS, SWELL = 0.5, (0.03, 0.4)  # share of the waves that differ in size, and the spread of its logarithm
SECONDS = 0.3  # share of the waves that have another beside them, as where two loops move a third
SECOND, SECOND_SIZE = (0.33, 3.0), (0.2, 1.0)  # its period and size over those of the first
TRIANGLES = 0.5  # share of the group "external_saw" that rises and falls alike, as a level upstream does
GIVE = (0.003, 0.06)  # of S: the force that moves a creeping valve over the stiffness of its friction
UNEVENNESS = (0.01, 0.3)  # standard deviation of the logarithm of its jumps

_VALVES = {
    "training": (("kano", 0.25), ("chen", 0.25), ("he", 0.25), ("stick_slip", 0.25)),
    "other_physics": (("stribeck", 0.75), ("lugre", 0.25)),
    "creeping": (("creeping", 1.0),),
}
_CONTROLLERS = {
    "training": (("pi", 0.35), ("pi_filtered", 0.25), ("pid_weighted", 0.4)),
    "other_physics": (("pid_series", 1.0),),
    "creeping": (("pi", 0.35), ("pi_filtered", 0.25), ("pid_weighted", 0.4)),
}
_PROCESSES = (("one_lag", 0.35), ("two_lags", 0.4), ("integrating", INTEGRATING))
_DRIVERS = (*SHAPES, "stochastic", "moves", "moves_SP", "stochastic_SP")


def draw(n: int, seed: int, setting: Setting = "training", *, first: int = 0, kinds: Kinds = "usual") -> list[LoopSpec]:
    """Return ``n`` loops: half sticky (a fifth of these not cycling), the rest spread evenly over ``OTHERS``.

    ``setting`` "other_physics" has another law of friction (Stribeck with mass, LuGre), a pneumatic lag, a PID in
    series form, longer dead times and other colours of disturbance; no calibration may use it.  "creeping" is
    "training" with a valve that gives a little before it breaks away, slips by another jump each time, and has J of 0.1
    to 1 S in place of 0.3 to 1 S.  ``first``: number of the first loop, where a large set is drawn in parts.
    Two ``kinds`` are to learn from only: "moved", where four fifths of the sticky loops are moved by something else in
    place of one fifth (these take the most examples; whoever learns from them weights them down again), and "levels",
    integrating loops with a deadband and no jump, none of which sticks.

    Raises ``ValueError`` unless n >= 1, seed >= 0 and setting and kinds are known.

    >>> specs = draw(200, seed=1)
    >>> sum(spec.cause == "stiction" for spec in specs), specs == draw(200, seed=1)
    (100, True)
    """
    if n < 1 or seed < 0 or first < 0:
        raise ValueError(
            f"n = {n}, seed = {seed}, first = {first}; draw at least 1 loop, with seed and first of 0 or more"
        )
    if setting not in get_args(Setting):
        raise ValueError(f"setting = {setting!r}; give one of {', '.join(get_args(Setting))}")
    if kinds not in get_args(Kinds):
        raise ValueError(f"kinds = {kinds!r}; give one of {', '.join(get_args(Kinds))}")
    others = tuple(OTHERS)
    specs = []
    for i in range(first, first + n):
        group = "sticky" if i % 2 == 0 else others[(i // 2) % len(others)]
        if group == "sticky":
            rare = (i // 2) % round(1 / NOT_CYCLING) == 0
            group = "excited" if rare != (kinds == "moved") else "cycling"
        if kinds == "levels":
            group = LEVEL
        specs.append(one(group, (seed, i, get_args(Setting).index(setting)), setting))
    return specs


def one(group: str, stream: Sequence[int], setting: Setting = "training") -> LoopSpec:
    """Return one loop of a group ("cycling", "excited" or one of ``OTHERS``), drawn from the stream given.

    Raises ``ValueError`` for a group that is not known.
    """
    if group not in OTHERS and group not in ("cycling", "excited", LEVEL):
        raise ValueError(f"group = {group!r}; give one of cycling, excited, {LEVEL}, {', '.join(OTHERS)}")
    r, level = np.random.default_rng(stream), group == LEVEL
    values: dict[str, Any] = {"seed": int(r.integers(2**31)), "setting": setting, "group": group}
    values["cause"] = "deadband" if level else OTHERS.get(group, "stiction")
    group = "deadband" if level else group
    law = _pick(r, _VALVES[setting])
    values |= _loop(r, group, law, setting, level)
    values |= _valve(r, group, law, values["natural"] / values["per_natural"])
    if law == "creeping":
        values |= {"give": _log(r, *GIVE), "unevenness": _log(r, *UNEVENNESS)}
    values |= _driver(r, group, setting, values)
    values |= _data(r, group)
    if values["driver"] in SHAPES and r.random() < WANDERS:
        values["driver_wander"] = _log(r, *WANDER)
    values |= _wave(r, values["group"], values["driver"])
    return LoopSpec(**values)


def _log(r: Random, low: float, high: float) -> float:
    """Draw evenly in the logarithm."""
    return float(math.exp(r.uniform(math.log(low), math.log(high))))


def _pick(r: Random, shares: Sequence[tuple[str, float]]) -> str:
    """Draw a word by its share."""
    weights = np.array([share for _, share in shares])
    sums = (weights / weights.sum()).cumsum()
    return shares[int(np.searchsorted(sums / sums[-1], r.random(), side="right"))][0]  # as r.choice, which checks more


def _loop(r: Random, group: str, law: str, setting: Setting, level: bool) -> dict[str, Any]:
    """Draw process and controller; the gain is a share of the one at which the loop rings for ever."""
    process = "integrating" if level else _pick(r, _PROCESSES)
    if process == "integrating" and group == "deadband" and not level:
        process = "two_lags"  # with an integrating process a deadband makes a cycle of its own
    tau1 = 10.0
    theta = tau1 * (_log(r, 0.1, 5.0) if setting != "other_physics" else _log(r, 0.3, 4.0))
    tau2 = tau1 * r.uniform(0.1, 1.0) if process != "one_lag" else 0.0
    K = _log(r, 0.3, 3.0) * (1.0 if r.random() < 0.5 else -1.0)
    K /= tau1 if process == "integrating" else 1.0
    kind = _pick(r, _CONTROLLERS[setting])
    tight = group == "tight_tuning"
    share = r.uniform(0.8, 0.97) if tight else _log(r, 0.12, 0.55)
    T_i = (tau1 + theta) * _log(r, 0.4, 2.0) * (4.0 if group == "dead_loop" else 1.0)  # or it winds up
    T_d = (theta + tau2 + 0.05 * tau1) * r.uniform(0.05, 0.25) if kind.startswith("pid") else 0.0
    T_f = _log(r, 0.02, 0.3) * (theta + tau2 + 0.1 * tau1) if kind == "pi_filtered" else 0.0
    per_natural = _log(r, 10.0, 20.0)
    loop = Loop(process, abs(K), tau1, tau2, theta, kind, T_i, T_d, T_f)
    if process == "integrating":  # integral slow enough for the gain, or the loop swings at low frequency
        gain, _ = ultimate(loop.with_integral(math.inf))
        damped = r.uniform(2.5, 8.0) if not tight or r.random() < 0.6 else r.uniform(0.15, 0.5)
        T_i = max(damped / (share * gain * abs(K)), (4.0 if damped > 1.0 else 1.5) * (theta + tau2))
        share = share if damped > 1.0 else share * 0.4
        loop = loop.with_integral(T_i)
    gain, ring = ultimate(loop)
    while math.isinf(gain):  # so much integral action that no gain would hold it
        T_i *= 1.5
        loop = loop.with_integral(T_i)
        gain, ring = ultimate(loop)
    gain, ring = ultimate(loop, ring / per_natural)
    K_p = share * gain
    if process == "integrating" and T_i * K_p * abs(K) < 1.0:
        ring = max(ring, 2.0 * math.pi * math.sqrt(T_i / (K_p * abs(K))))
    b = float(r.uniform(0.0, 1.0)) if kind == "pid_weighted" else 1.0
    return {
        "process": process, "K": K, "tau1": tau1, "tau2": tau2, "theta": theta, "controller": kind, "K_p": K_p,
        "T_i": T_i, "T_d": T_d, "b": b, "T_f": T_f, "natural": ring * (1.0 if tight else 1.3),
        "per_natural": per_natural,
    }  # fmt: skip


def _valve(r: Random, group: str, law: str, scan: float) -> dict[str, Any]:
    """Draw the bands of friction and the lag of stem and actuator [s]."""
    S, share = _log(r, 2.0, 15.0), float(r.uniform(0.1 if law == "creeping" else 0.3, 1.0))
    sticky = group in ("cycling", "excited")
    bands = {"S": S, "J": S * share} if sticky else {"S": 0.0, "J": 0.0}
    slowest = 1.5 if law in ("stick_slip", "creeping") else 0.6
    return {"valve": law, "valve_lag": scan * _log(r, 0.15, slowest)} | bands


def _driver(r: Random, group: str, setting: Setting, loop: dict[str, Any]) -> dict[str, Any]:
    """Draw what moves the loop, and how far OP is to travel [% of its span]."""
    driver, on = "stochastic", "load"
    time = loop["natural"] * _log(r, 0.5, 6.0)
    if group.startswith("external_"):
        driver = group.removeprefix("external_")
    elif group in ("excited", "deadband", "quantisation", "saturation", "compression"):
        driver, _, where = str(_DRIVERS[int(r.integers(len(_DRIVERS)))]).partition("_")
        on = where or "load"
    elif group in ("healthy", "cascade_slave"):
        driver, on = ("moves", "SP") if r.random() < 0.4 else ("stochastic", "SP")
        if group == "healthy":
            on = "load" if r.random() < 0.5 else "SP"
        elif r.random() < 0.4:
            driver = "sine"
        time = loop["natural"] * (_log(r, 0.3, 3.0) if group == "cascade_slave" else _log(r, 1.0, 20.0))
    elif group == "drift":
        driver = "drift"
    elif group == "dead_loop":  # what drives PV has no mean, or OP would run into a limit and stay there
        driver, time = _DRIVERS[int(r.integers(4))], loop["natural"] * _log(r, 0.3, 2.0)
    elif group == "cycling":
        driver = "none"
    if driver in ("stochastic", "moves"):
        time *= _log(r, 0.1, 0.5) if setting != "other_physics" else 0.15
    virtual = loop["S"] if loop["J"] > 0.0 else _log(r, 2.0, 15.0)  # so that the range of OP tells no cause
    free = group == "excited" or (group != "cycling" and r.random() < NOT_CYCLING)
    swing = 0.0 if group == "cycling" else min(virtual * _log(r, *(TRAVEL if free else CYCLE)), 85.0)
    S = swing / _log(r, *TRAVEL) if group == "deadband" else loop["S"]
    clip = float(r.uniform(0.2, 0.8)) if group == "saturation" else 0.0
    half = min(0.6 * max(swing, 5.0 * virtual), 45.0)
    op0 = float(r.uniform(half, 100.0 - half))
    if clip > 0.0:
        op0 = clip * swing / 2.0 if r.random() < 0.5 else 100.0 - clip * swing / 2.0
    return {
        "S": S, "driver": driver, "driver_on": on, "driver_time": time, "swing": swing, "op0": op0, "clip": clip,
        "authority": 0.0 if group == "dead_loop" else 1.0,
    }  # fmt: skip


def _wave(r: Random, group: str, driver: str) -> dict[str, Any]:
    """Draw what waves from other loops are like: their size, what is beside them, and which saws are triangles."""
    values: dict[str, Any] = {}
    if driver not in SHAPES:
        return values
    if group == "external_saw" and r.random() < TRIANGLES:
        values["driver"] = "triangle"
    if r.random() < SWELLS:
        values["driver_swell"] = _log(r, *SWELL)
    if r.random() < SECONDS:
        values |= {"driver_second": _log(r, *SECOND), "driver_second_size": _log(r, *SECOND_SIZE)}
    return values


def _data(r: Random, group: str) -> dict[str, Any]:
    """Draw noise, sampling, length, scales and the defects of the log, from one law for all groups."""
    values: dict[str, Any] = {
        "noise": _log(r, 0.002, 0.25), "noise_time": 0.0 if r.random() < 0.7 else _log(r, 0.02, 0.2), "coarse": 0.0,
        "walk": _log(r, 0.05, 1.0) if r.random() < 0.35 else 0.0,
        "sp_move": _log(r, 0.2, 2.0) if r.random() < 0.25 else 0.0, "sp_hold": _log(r, 4.0, 40.0),
        "points": _log(r, 5.0, 60.0), "samples": round(_log(r, 300.0, 7200.0)),
        "step_pv": _log(r, 8.0, 200.0) if r.random() < 0.3 else 0.0,
        "step_op": _log(r, 8.0, 200.0) if r.random() < 0.2 else 0.0,
        "door": _log(r, 0.005, 0.06) if r.random() < 0.3 else 0.0,
        "stale": float(r.uniform(0.05, 0.5)) if r.random() < 0.15 else 0.0, "stale_hold": _log(r, 2.0, 40.0),
        "sp_logged": bool(r.random() > 0.15), "process_known": bool(r.random() < 0.5),
        "span_known": bool(r.random() < 0.75), "dt": _log(r, 0.2, 60.0), "unit_pv": _log(r, 1e-3, 1e3),
        "zero_pv": float(r.uniform(-2.0, 20.0)), "unit_op": _log(r, 0.01, 10.0),
    }  # fmt: skip
    coarse, door = _log(r, 1.2, 6.0), _log(r, 0.08, 0.3)
    if group == "quantisation":
        values["coarse"] = coarse
    if group == "compression":
        values["door"] = door
    return values
