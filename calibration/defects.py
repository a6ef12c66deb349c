"""Defects that a historian adds to a record: it rounds, compresses, holds and loses values."""

import numpy as np
from numpy.typing import NDArray
from stickslip.calibration.crossings import extent
from stickslip.calibration.spec import LoopSpec
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.dirt import swinging_door_kept
from stickslip.logs.tags import Process

DEFECTS = (
    "noise", "coarse_transmitter", "rounded_pv", "rounded_op", "compressed", "stale", "sp_moves", "no_sp",
    "unknown_process", "unknown_span", "walking_load", "few_points",
)  # fmt: skip
"""Names of the defects that a record can have."""

NOISY = 0.02  # share of the range of PV from which noise is named
FEW = 8.0  # samples per period below which a record is named thinly sampled


def names(spec: LoopSpec) -> tuple[str, ...]:
    """Return which defects a record has."""
    has = {
        "noise": spec.noise >= NOISY, "coarse_transmitter": spec.coarse > 0.0, "rounded_pv": spec.step_pv > 0.0,
        "rounded_op": spec.step_op > 0.0, "compressed": spec.door > 0.0, "stale": spec.stale > 0.0,
        "sp_moves": spec.sp_move > 0.0, "no_sp": not spec.sp_logged, "unknown_process": not spec.process_known,
        "unknown_span": not spec.span_known, "walking_load": spec.walk > 0.0, "few_points": spec.points < FEW,
    }  # fmt: skip
    return tuple(name for name in DEFECTS if has[name])


def stale_rows(n: int, share: float, hold: float, random: np.random.Generator) -> NDArray[np.bool_]:
    """Return which of ``n`` samples repeat the one before, in stretches of ``hold`` samples on average.

    >>> import numpy as np
    >>> float(stale_rows(10_000, 0.3, 10.0, np.random.default_rng(1)).mean().round(1))
    0.3
    """
    held = np.zeros(n, dtype=bool)
    at = 1
    while share > 0.0 and at < n:
        at += int(random.geometric(min(1.0, share / ((1.0 - share) * hold)))) if share < 1.0 else 0
        length = int(random.geometric(1.0 / max(hold, 1.0)))
        held[at : at + length] = True
        at += length
    return held


def rounded(values: Values, steps: float) -> Values:
    """Return a signal in ``steps`` steps per range; 0 leaves it as it is."""
    step = extent(values) / steps if steps > 0.0 else 0.0
    return np.round(values / step) * step if step > 0.0 else values


def compressed(t: Values, values: Values, door: float) -> Values:
    """Return a signal as swinging-door compression gives it back; ``door`` deviation [share of the range]."""
    deviation = door * extent(values)
    if deviation <= 0.0:
        return values
    kept = swinging_door_kept(t, values, deviation)
    return np.interp(t, t[kept], values[kept])


def record(spec: LoopSpec, sp: Values, pv: Values, op: Values, mv: Values | None) -> LoopRecord:
    """Return the record that a historian keeps of a loop; the signals are in % of their spans."""
    random = np.random.default_rng((spec.seed, 2))
    t = np.arange(len(pv), dtype=np.float64) * spec.dt
    pv, op = rounded(pv, spec.step_pv), rounded(op, spec.step_op)
    if spec.door > 0.0:
        pv, op = compressed(t, pv, spec.door), compressed(t, op, spec.door)
    held = stale_rows(len(t), spec.stale, spec.stale_hold, random)
    last = np.maximum.accumulate(np.where(held, 0, np.arange(len(t))))
    pv, op, mv = pv[last], op[last], None if mv is None else mv[last]
    scale_op = 1.0 if spec.span_known else spec.unit_op
    kind: Process = "integrating" if spec.process == "integrating" else "self_regulating"
    return LoopRecord.from_arrays(
        t,
        pv=spec.unit_pv * (pv + 50.0 + spec.zero_pv),
        op=scale_op * op,
        sp=spec.unit_pv * (sp + 50.0 + spec.zero_pv) if spec.sp_logged else None,
        mv=None if mv is None else scale_op * mv,
        name=f"{spec.setting} {spec.seed}",
        process=kind if spec.process_known else "unknown",
        op_span=(0.0, 100.0) if spec.span_known else None,
    )
