"""The fitted loop as a diagram in which every remedy can be set, and the runs of all remedies on all loops.

    SP -> GapPI -> Knocker -> ConstantReinforcement -> TwoMove -> valve -> process -> (+) -> PV
                                                                     what the record left at PV -^

The load is what the loop leaves of PV in the record: each remedy meets the very load that the loop had.  Values are
deviations from OP at the start; the valve takes a sample with the controller, as in the fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks import (
    Biquad,
    ChenValve,
    ConstantReinforcement,
    FirstOrder,
    GapPI,
    HeValve,
    Integrator,
    Knocker,
    Recorded,
    Sum,
    TwoMove,
)  # fmt: skip
from stickslip.blocks.block import Block
from stickslip.diagram import Diagram, ensemble, wire
from stickslip.remedy.controller import series
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.measures.setting import Setting
from stickslip.remedy.process import Loop
from stickslip.remedy.refusal import FitError
from stickslip.remedy.size import size_of

__all__ = ["Outcome", "diagram_of", "outcomes", "settling"]

Floats = NDArray[np.float64]
MOST, STEP = 10_000, 4_000  # samples of the load that a trial runs through, which may differ along it; behind a step
SKIPPED = 0.15  # of a run, in which it settles
LIKE = 1.25  # times as far as the log that a fitted loop may swing by itself, or the log as far as it
FEWEST = 6  # fitted loops that must
AWAY = 1e3  # times the range of the logged PV, beyond which a run has no end
UNSTABLE = "the loop is not stable with it"
WIDE: dict[str, Any] = {"low": -math.inf, "high": math.inf}
TUNING = {"controller.K_p", "controller.T_i"}  # what acts against stick makes no sense without it
NOTHING = Setting("as it is", {})


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a setting gives on each loop, (loops,): standard deviations of SP - PV and OP, travel, reversals.

    pv_offset : how far the mean of PV stays from that of SP [unit of PV]
    travel [unit of OP per h], reversals [1/h];  all inf where PV runs away;  pv, op : (n,) of the first loop, for
    pictures
    """

    setting: Setting
    pv_sd: Floats
    pv_offset: Floats
    op_sd: Floats
    travel: Floats
    reversals: Floats
    pv: Floats
    op: Floats

    @property
    def pv_rms(self) -> Floats:
        """Root mean square of SP - PV, which a lasting offset adds to [unit of PV]."""
        return np.hypot(self.pv_sd, self.pv_offset)

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        names = ("pv_sd", "pv_rms", "pv_offset", "op_sd", "travel_per_h", "reversals_per_h")
        values = (self.pv_sd, self.pv_rms, self.pv_offset, self.op_sd, self.travel, self.reversals)
        return {name: size_of(own, endless=UNSTABLE).to_dict() for name, own in zip(names, values, strict=True)}


def diagram_of(fit: LoopFit, one: Loop | None = None) -> Diagram:
    """The loop with every remedy in its place, none of them on; with the law of ``one``, or of the likeliest."""
    return wire(_blocks(fit, one or fit.best), inputs=["SP", "v"], outputs=["PV", "OP", "MV"])


def _blocks(fit: LoopFit, one: Loop) -> list[Block]:
    law, dt, u0 = fit.controller, fit.controller.dt, float(fit.days[0].op[0])
    K_p, T_i, T_d = series(law)
    lead: list[Block] = []
    if T_d > 0.0 or law.T_f > 0.0:
        a = math.exp(-dt / law.T_f) if law.T_f > 0.0 else 0.0
        b = [(1.0 - a) * (1.0 + T_d / dt), -(1.0 - a) * T_d / dt, 0.0]
        lead = [Biquad("PV_f", "PV", b=b, a=[-a, 0.0], dt=dt, name="filter")]
    controller = GapPI(
        K_p, T_i, dt=dt, low=law.low - u0, high=law.high - u0, action="reverse" if law.K_p > 0.0 else "direct",
        name="controller", inputs={"SP": "SP", "PV": "PV_f" if lead else "PV"}, outputs={"OP": "OP_c"},
    )  # fmt: skip
    between = [
        Knocker(0.0, 5.0 * dt, 2.0 * dt, dt, inputs="OP_c", outputs="OP_k"),
        ConstantReinforcement(0.0, dt, inputs="OP_k", outputs="OP_r"),
        TwoMove(1.0, 0.0, math.inf, dt, dt, inputs={"OP_c": "OP_r", "SP": "SP", "PV": "PV"}),
    ]
    valve = ChenValve(one.S, one.J, dt, **WIDE) if one.follows else HeValve.from_bands(one.S, one.J, dt, **WIDE)
    late = 0.25 * dt * round(4.0 * one.theta / dt)  # in quarters of a scan: no step of a run is longer than it
    lag = FirstOrder(1.0, max(one.tau_2, 0.01 * dt), name="lag", inputs="MV", outputs="MV_2")
    flow: dict[str, Any] = {"inputs": "MV_2", "outputs": "y", "name": "process"}
    process = Integrator(one.K, 1.0, late, **flow) if one.integrating else FirstOrder(one.K, one.tau, late, **flow)
    return [*lead, controller, *between, valve, lag, process, Sum("PV", {"y": 1.0, "v": 1.0})]


def _parameters(fit: LoopFit, one: Loop, setting: Setting) -> dict[str, float]:
    """All parameters of the loop with a setting."""
    factors, law, stick = setting.factors, fit.controller, setting.factors.get("stick", 1.0)
    K_p, T_i = (factors.get(f"controller.{key}", 1.0) * getattr(law, key) for key in ("K_p", "T_i"))
    fit = replace(fit, controller=replace(law, K_p=K_p, T_i=T_i))
    blocks = _blocks(fit, replace(one, S=stick * one.S, J=stick * one.J))
    own = {f"{block.name}.{key}": value for block in blocks for key, value in block.params.items()}
    return {**own, **setting.params}


def _run(
    fit: LoopFit, loops: Sequence[Loop], settings: Sequence[Setting], loads: Sequence[Floats], sp: Floats, z: float,
    begun: Floats,
) -> dict[str, Floats]:  # fmt: skip
    """Signals (settings, loops, n) of each setting on each loop, which has its load; PV is 0 and its stem ``begun``."""
    n, dt = len(sp), fit.controller.dt
    t = np.arange(n) * dt
    found = {name: np.empty((len(settings), len(loops), n)) for name in ("PV", "OP", "MV")}
    for follows in {one.follows for one in loops}:
        at = [i for i, one in enumerate(loops) if one.follows == follows]
        plain = _parameters(fit, loops[at[0]], NOTHING)
        columns = [_parameters(fit, loops[i], setting) for setting in settings for i in at]
        differ = {key: np.array([each[key] for each in columns]) for key in plain}
        stems, rest = (np.tile(one, len(settings)) for one in (begun[at], [-loads[i][0] for i in at]))
        differ["process.theta_start"] = stems
        begin = {"valve.MV": stems, "lag.PV": stems, "process.PV": rest, "controller.z": np.full(len(stems), z)}
        values = ensemble(
            diagram_of(fit, loops[at[0]]), float(t[-1]), start=begin, times=t, signals=list(found), rtol=1e-5,
            params={key: each for key, each in differ.items() if np.any(each != plain[key])}, atol=1e-8, workers=1,
            inputs={
                "SP": Recorded("SP", t, sp, hold="previous"),
                "v": [Recorded("v", t, loads[i], hold="previous") for _ in settings for i in at],
            }, progress=False,
        ).values  # fmt: skip
        for name, signals in found.items():
            signals[:, at] = values[name].reshape(len(settings), len(at), n)
    return found


def outcomes(fit: LoopFit, settings: Sequence[Setting], count: int = 16) -> list[Outcome]:
    """What each setting gives on up to ``count`` loops, under the load of the record.

    The first setting is the loop as it is: fitted loops that are not stable with it, or stick and do not swing as the
    log does, cannot be the logged one, and are left out.  Raises ``FitError`` where fewer than ``FEWEST`` of them stay.
    """
    day = fit.days[0]
    n, base = min(len(fit.lefts[0][0]), MOST), float(day.pv[0])
    loads, logged = [own[0][:n] - base for own in fit.lefts], day.pv[:n] - base
    sp = (np.full(n, float(np.mean(day.pv))) if day.sp is None else day.sp[:n]) - base
    start = -math.copysign(series(fit.controller)[0], fit.controller.K_p) * float(sp[0])  # OP is 0 at the start
    first, hours = int(SKIPPED * n), (n - int(SKIPPED * n)) * day.dt / 3600.0
    (still,) = _run(fit, fit.loops, settings[:1], loads, sp, start, fit.begun)["PV"]
    swings = np.std((sp - still)[:, first:], axis=1) / np.std((sp - logged)[first:])
    ends = AWAY * np.ptp(day.pv)
    like = (np.max(np.abs(still), axis=1) < ends) & (not fit.sticks or (swings < LIKE) & (swings > 1.0 / LIKE))
    if np.sum(like) < min(FEWEST, len(like)):
        raise FitError(_unlike(fit, int(np.sum(like)), swings))
    at = np.flatnonzero(like)[:count]
    found = _run(fit, [fit.loops[i] for i in at], settings, [loads[i] for i in at], sp, start, fit.begun[at])
    made = []
    for setting, pv, op, stem in zip(settings, found["PV"], found["OP"], found["MV"], strict=True):
        e = (sp - pv)[:, first:]
        values = (
            np.std(e, axis=1), np.abs(np.mean(e, axis=1)), np.std(op[:, first:], axis=1),
            np.sum(np.abs(np.diff(stem[:, first:], axis=1)), axis=1) / hours,
            np.array([_reversals(own[first:]) / hours for own in stem]),
        )  # fmt: skip
        stays = np.max(np.abs(pv), axis=1) < ends
        sd, offset, op_sd, travel, turns = (np.where(stays, own, math.inf) for own in values)
        pv_0, op_0 = base + (0.0 if stays[0] else math.nan), float(day.op[0])
        made.append(Outcome(setting, sd, offset, op_sd, travel, turns, pv[0] + pv_0, op[0] + op_0))
    return made


def _unlike(fit: LoopFit, like: int, swings: Floats) -> str:
    """Why no remedy is tried on these loops, and what record would do."""
    low, middle, high = np.nanpercentile(swings, [10.0, 50.0, 90.0])
    hours = sum(float(day.t[-1] - day.t[0]) for day in fit.days) / 3600.0
    return (
        f"left as they are, {like} of {len(swings)} fitted loops swing {1.0 / LIKE:g} to {LIKE:g} times as far as the "
        f"log, and {FEWEST} are needed to try a remedy on; the middle one swings {middle:.2g} times as far, most "
        f"{low:.2g} to {high:.2g} times. The record does not tell valve and process well enough: log "
        f"{2.0 * hours:.2g} h at the controller's scan, with some steps of SP"
    )


def _reversals(stem: Floats) -> int:
    moves = np.sign(np.diff(stem))
    moves = moves[moves != 0.0]
    return int(np.sum(moves[1:] != moves[:-1]))


def settling(fit: LoopFit, settings: Sequence[Setting], count: int = 6) -> list[tuple[Floats, Floats]]:
    """Times (loops,) [s] in which PV comes to 5 % behind a step of SP, and of a load at the valve, without stick.

    They are those of the tuning alone: neither stick nor noise nor the record's load.  inf where it does not within the
    run.
    """
    loops, dt = [replace(one, S=0.0, J=0.0) for one in fit.loops[:count]], fit.controller.dt
    t, none = np.arange(STEP) * dt, [np.zeros(STEP)] * len(loops)
    ways = [t if one.integrating else 1.0 - np.exp(-t / max(one.tau, dt)) for one in loops]
    loads = [np.asarray(one.K * way) for one, way in zip(loops, ways, strict=True)]
    plain = [replace(one, params={key: one.params[key] for key in TUNING & one.params.keys()}) for one in settings]
    steps = _run(fit, loops, plain, none, np.ones(STEP), 0.0, np.zeros(len(loops)))["PV"] - 1.0
    pushed = _run(fit, loops, plain, loads, np.zeros(STEP), 0.0, np.zeros(len(loops)))["PV"]
    return [
        (
            np.array([_settled(own, 0.05, dt) for own in after_step]),
            np.array([_settled(own, 0.05 * float(np.abs(own).max() or 1.0), dt) for own in after_load]),
        )
        for after_step, after_load in zip(steps, pushed, strict=True)
    ]


def _settled(e: Floats, band: float, dt: float) -> float:
    outside = np.flatnonzero(~(np.abs(e) <= band))
    if not len(outside):
        return 0.0
    return math.inf if outside[-1] >= len(e) - 2 else float((outside[-1] + 1) * dt)
