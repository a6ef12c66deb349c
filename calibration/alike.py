"""Loops drawn to be like one record: its sampling, length, noise, rounding, compression, set point and travel of OP.

What the record tells is taken from it, with a spread for what it tells roughly; what it does not tell, and the cause,
is drawn as in ``drawing``.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from stickslip.calibration.conditions import Conditions
from stickslip.calibration.drawing import OTHERS, one
from stickslip.calibration.spec import LoopSpec

Random = np.random.Generator

CYCLE = (1.02, 2.2)  # range of OP over S where the valve makes the cycle
TRAVEL = (0.7, 8.0)  # and where something else moves OP: wide, because it says which stick would have shown
EXCITED = 0.35  # share of the sticky loops that something else moves
SPREAD = 0.25  # of what is measured roughly, in the logarithm
TRIES = 60  # draws for one loop that fits what is known of process and set point
LIMITED = 0.05  # share of samples at a limit from which OP is saturated
LAW = {"chen": "kano", "stick_slip": "he"}  # two laws of friction do: each structure is a run of its own
SLOW = 0.35  # share of OP's range that its moving average covers, from which the load walks


def alike(seen: Conditions, n: int, seed: int) -> list[LoopSpec]:
    """Return ``n`` loops like the record, half of them with a sticky valve, the rest spread over other causes."""
    others = [group for group in OTHERS if group != "cascade_slave" or seen.sp in ("always", "none")]
    drawn = []
    for i in range(n):
        r = np.random.default_rng((seed, i, 7))
        group = others[(i // 2) % len(others)] if i % 2 else "excited" if r.random() < EXCITED else "cycling"
        drawn.append(_fitted(next(_possible(group, seen, (seed, i))), seen, r))
    return drawn


def _possible(group: str, seen: Conditions, stream: tuple[int, int]) -> Iterator[LoopSpec]:
    """Yield loops of a group that agree with what is known of process and set point; at last any."""
    spec = one(group, (*stream, 0))
    for k in range(TRIES):
        spec = one(group, (*stream, k))
        kind = seen.integrating is None or (spec.process == "integrating") == seen.integrating or group == "deadband"
        moved = spec.driver_on == "SP"
        if kind and not (moved and seen.sp == "still") and (moved or seen.sp != "always" or group != "excited"):
            yield spec
    yield spec


def _fitted(spec: LoopSpec, seen: Conditions, r: Random) -> LoopSpec:
    """Return a loop with the record's conditions."""

    def rough(value: float) -> float:
        return value * math.exp(SPREAD * r.normal())

    changes: dict[str, Any] = {
        "valve": LAW.get(spec.valve, spec.valve),
        "samples": seen.samples, "points": max(rough(seen.points), 3.0), "dt": seen.dt,
        "noise": min(rough(max(seen.noise, 1e-4)), 0.5), "noise_time": 0.0,
        "step_pv": seen.step_pv, "step_op": seen.step_op,
        "door": 0.0 if not seen.compressed else spec.door or math.exp(r.uniform(math.log(0.005), math.log(0.1))),
        "stale": seen.stale, "stale_hold": max(seen.stale_hold, 1.0),
        "sp_logged": seen.sp != "none", "process_known": seen.integrating is not None, "span_known": True,
        "walk": rough(seen.drifting) if seen.drifting > SLOW else 0.0,
        "sp_move": rough(0.5 * seen.sp_move) if seen.sp == "moves" else 0.0, "sp_hold": max(seen.sp_hold, 0.1),
        "op0": min(max(seen.op_mean, 5.0), 95.0) if seen.span_known else 50.0,
    }  # fmt: skip
    span = min(seen.op_range, 85.0) if seen.span_known else 20.0
    low, high = CYCLE if spec.group == "cycling" else TRAVEL
    sticks = math.exp(r.uniform(math.log(low), math.log(high)))
    if spec.J > 0.0:
        changes |= {"S": min(span / sticks, 90.0), "J": min(span / sticks, 90.0) * spec.J / spec.S}
    elif spec.group == "deadband":
        changes["S"] = min(span / sticks, 90.0)
    if spec.swing > 0.0:
        changes["swing"] = span
    if spec.group == "saturation":
        changes["op0"] = spec.clip * span / 2.0 if r.random() < 0.5 else 100.0 - spec.clip * span / 2.0
    return replace(spec, **changes)
