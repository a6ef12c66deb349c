"""From specs to records: a short pilot run says how far a loop swings and how fast, the main run is made to measure.

The driver of a loop is scaled so that OP swings as far as asked, noise and set-point moves so that they are the asked
share of the range of PV, and the scan time so that the log has the asked number of samples per period.  Loops of one
structure and length run as one ensemble, in which a scan is the unit of time and dead times are whole scans, as the
engine likes them; what a loop gives does not depend on the others.
"""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.calibration.crossings import even, extent, period
from stickslip.calibration.defects import names, record
from stickslip.calibration.excitation import SHAPES
from stickslip.calibration.loops import STEMS, Structure, diagram, parameters, series_filter, structure_of
from stickslip.calibration.sampled import CONTROLLERS, VALVES
from stickslip.calibration.sampled import run as sampled
from stickslip.calibration.spec import LoopSpec, Truth
from stickslip.diagram import ensemble
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

PILOT = 2000  # scans of the pilot run
SETTLE = 700  # of which are left out
NATURALS, INTEGRALS = 60.0, 40.0  # natural periods and integral times that it lasts, at least
WARM = 5.0  # periods before the log begins
MOST = 25_000  # scans that are logged, about
SHORTEST, RATIO = 1000.0, 1.4  # runs last a number of scans on a grid of this ratio; what is over comes before the log
COARSEST = 8.0  # scans per natural period, at least
FOR_EVER = 1e12  # period of a square wave that does not turn [s]
LOUDEST = 0.08  # of the range of OP: the noise that proportional and derivative action hand on to OP, at most
RTOL, ATOL = 1e-4, 1e-9


ASLEEP = 0.3  # range of OP over S below which a pilot run has come to rest
SLOW = 4.0  # natural periods in a cycle by stiction, about
QUIET: Mapping[str, float] = {"sensor.sd": 0.0, "sensor.step": 0.0}


@dataclass(frozen=True)
class Measured:
    """Measures of a pilot run: ranges of OP [% of span] and PV [% of span], and the period [s]."""

    op: float
    pv: float
    period: float


@dataclass(frozen=True)
class Plan:
    """How a main run goes: scan time [s], scans in all and per sample, samples, scale of the driver, ranges."""

    scan: float
    scans: int
    per_sample: int
    samples: int
    drive: float
    shown: Measured

    @property
    def warm(self) -> int:
        """Scans before the log begins."""
        return self.scans - self.samples * self.per_sample

    def times(self, rows: int) -> Values:
        """Return ``rows`` log times [scans]: those of the record, and before them some that fill the row up."""
        others = rows - self.samples
        before = (np.arange(others) + 1.0) * (self.warm / (others + 1.0))
        own = self.warm + np.arange(self.samples, dtype=np.float64) * self.per_sample + 0.5
        return np.concatenate([before, own])


def simulate(specs: Sequence[LoopSpec], workers: int | None = None, mv: bool = False) -> list[tuple[LoopRecord, Truth]]:
    """Return record and truth of every loop, in order.

    ``workers`` threads of the engine (default all cores); ``mv``: the record has the stem position, which is to be
    used to test the truth only.  Raises ``RuntimeError`` if a loop cannot be simulated.

    >>> from stickslip.calibration.drawing import draw
    >>> loop, truth = simulate(draw(1, seed=3))[0]
    >>> truth.cause, len(loop) >= 300
    ('stiction', True)
    """
    shown = _piloted(specs, workers)
    plans = [planned(spec, seen) for spec, seen in zip(specs, shown, strict=True)]
    batches: dict[tuple[object, ...], list[int]] = defaultdict(list)
    for i, (spec, plan) in enumerate(zip(specs, plans, strict=True)):
        batches[(*structure_of(spec), plan.scans)].append(i)
    found: dict[int, tuple[LoopRecord, Truth]] = {}
    for own in batches.values():
        result = _run([specs[i] for i in own], [plans[i] for i in own], workers)
        for k, i in enumerate(own):
            found[i] = _labelled(specs[i], {name: rows[k] for name, rows in result.items()}, mv)
    return [found[i] for i in range(len(specs))]


def planned(spec: LoopSpec, shown: Measured) -> Plan:
    """Return how the main run of a loop goes, after what its pilot showed."""
    if spec.group == "cycling" and not shown.op > ASLEEP * spec.S:  # without noise this one comes to rest
        size = abs(spec.K) * (spec.natural if spec.process == "integrating" else 1.0)
        shown = Measured(spec.S, size * spec.J, SLOW * spec.natural)
    drive = spec.swing / shown.op if spec.swing > 0.0 and shown.op > 0.0 else 1.0
    time = spec.natural if spec.driver == "drift" or math.isnan(shown.period) else shown.period
    wanted = spec.per_natural * time / (spec.natural * spec.points)
    per_sample = max(1, min(math.ceil(wanted), MOST // spec.samples))
    scan = min(time / (spec.points * per_sample), spec.natural / COARSEST)
    warm = min(math.ceil(WARM * max(time, spec.natural) / scan), MOST // 10)
    least = warm + spec.samples * per_sample
    scans = math.ceil(SHORTEST * RATIO ** math.ceil(math.log(max(least / SHORTEST, 1.0)) / math.log(RATIO) - 1e-9))
    seen = Measured(shown.op * drive, shown.pv * drive, scan * per_sample * spec.points)
    if spec.driver == "drift":  # noise is set against what the load would do to PV without control
        size = abs(spec.K) * (spec.tau1 if spec.process == "integrating" else 1.0)
        seen = replace(seen, op=spec.swing, pv=0.2 * size * spec.swing)
    return Plan(scan, scans, per_sample, spec.samples, drive, seen)


def _piloted(specs: Sequence[LoopSpec], workers: int | None) -> list[Measured]:
    """Run every loop shortly, without noise, limits and defects, and measure it."""
    batches: dict[tuple[str, ...], list[int]] = defaultdict(list)
    for i, spec in enumerate(specs):
        batches[pilot_of(spec.valve), spec.process, spec.controller].append(i)
    found: dict[int, Measured] = {}
    for (valve, process, controller), own in batches.items():
        columns, scans = [], []
        for i in own:
            spec = specs[i]
            scan = max(NATURALS * spec.natural, INTEGRALS * spec.T_i) / PILOT
            bare = in_scans(spec if spec.group == "cycling" else replace(spec, S=0.0, J=0.0), scan)
            columns.append({**parameters(bare, valve, False), **driver(bare, 1.0, PILOT), **QUIET})
            scans.append(scan)
        grid = np.arange(SETTLE, PILOT - 1, dtype=np.float64) + 0.5
        seeds = [specs[i].seed for i in own]
        result = _ensemble((valve, process, controller), PILOT, columns, seeds, grid, workers)
        for k, i in enumerate(own):
            op, pv = result["OP"][k], result["PV_m"][k]
            found[i] = Measured(extent(op), extent(pv), period(op) * scans[k])
    return [found[i] for i in range(len(specs))]


def _run(specs: Sequence[LoopSpec], plans: Sequence[Plan], workers: int | None) -> Mapping[str, Values]:
    """Run loops of one structure and length."""
    rows = max(plan.samples for plan in plans)
    columns = []
    for spec, plan in zip(specs, plans, strict=True):
        own, length = in_scans(spec, plan.scan), plan.samples * plan.per_sample
        rest = trouble(own, plan.shown, plan.shown.period / plan.scan, length)
        columns.append({**parameters(own, spec.valve, True), **driver(own, plan.drive, length), **rest})
    times = np.stack([plan.times(rows) for plan in plans])
    seeds = [spec.seed for spec in specs]
    return _ensemble(structure_of(specs[0]), plans[0].scans, columns, seeds, times, workers)


def _ensemble(
    structure: Structure, scans: int, columns: Sequence[Mapping[str, float]], seeds: Sequence[int], times: Values,
    workers: int | None,
) -> Mapping[str, Values]:  # fmt: skip
    """Return the signals (n, rows) of loops of one structure, in sampled time where that is exact."""
    if structure[0] in VALVES and structure[2] in CONTROLLERS:
        return sampled(structure, scans, columns, seeds, times)
    return by_engine(structure, scans, columns, seeds, times, workers)


def by_engine(
    structure: Structure, scans: int, columns: Sequence[Mapping[str, float]], seeds: Sequence[int], times: Values,
    workers: int | None = None,
) -> Mapping[str, Values]:  # fmt: skip
    """Return the signals (n, rows) of loops of one structure, by the engine; arguments as in ``sampled.run``.

    Raises ``RuntimeError`` if a loop cannot be simulated.
    """
    params = {key: np.array([own[key] for own in columns]) for key in columns[0]}
    result = ensemble(
        diagram(structure), float(scans), params=params, seeds=seeds, times=times, rtol=RTOL, atol=ATOL,
        workers=workers, progress=False,
    )  # fmt: skip
    if not result.ok.all():
        i = int(np.argmin(result.ok))
        raise RuntimeError(f"loop with seed {seeds[i]} on {structure}: {result.hint(i)}")
    return result.values


def pilot_of(valve: str) -> str:
    """Return the law of friction of a pilot run: the loop's own, or its limit without mass and without creep.

    Under an OP that is held from scan to scan such a stem comes to rest in every scan, as the valve of He does.
    """
    return "he" if valve in STEMS else "chen" if valve == "creeping" else valve


def loudness(spec: LoopSpec) -> float:
    """Return the gain from one noisy value of PV to OP [% of OP per % of PV]; the times of ``spec`` in scans."""
    if spec.controller == "pid_weighted":
        return spec.K_p * (1.0 + min(8.0, spec.T_d))
    if spec.controller == "pid_series":
        return spec.K_p * (1.0 + spec.T_d) / (1.0 + series_filter(spec.T_d))
    return spec.K_p


def in_scans(spec: LoopSpec, scan: float) -> LoopSpec:
    """Return the same loop with its times in scans of ``scan`` [s], and its dead time a whole number of them."""
    integrating = spec.process == "integrating"
    return replace(
        spec, K=spec.K * scan if integrating else spec.K, tau1=spec.tau1 / scan, tau2=spec.tau2 / scan,
        theta=float(round(spec.theta / scan)), T_i=spec.T_i / scan, T_d=spec.T_d / scan, T_f=spec.T_f / scan,
        valve_lag=spec.valve_lag / scan, natural=spec.natural / scan, driver_time=spec.driver_time / scan,
    )  # fmt: skip


def driver(spec: LoopSpec, scale: float, length: int) -> Mapping[str, float]:
    """Return the parameters of load and set point that drive a loop; ``scale`` [% of OP], ``length`` [scans]."""
    found: dict[str, float] = {}
    for block in ("load", "SP"):
        found |= {f"{block}.{key}": 0.0 for key in ("shape", "amplitude", "slope", "sd", "correlation_time", "move")}
        found |= {f"{block}.{key}": 1.0 for key in ("period", "hold", "second")}
        found |= {f"{block}.{key}": 0.0 for key in ("walk", "wander", "swell", "second_size")}
    on, time = spec.driver_on, spec.driver_time
    size = scale if on == "load" else scale * abs(spec.K) * (spec.tau1 if spec.process == "integrating" else 1.0)
    if spec.driver in SHAPES:
        found |= {f"{on}.shape": float(SHAPES.index(spec.driver)), f"{on}.amplitude": size, f"{on}.period": time}
        found |= {f"{on}.wander": spec.driver_wander, f"{on}.swell": spec.driver_swell}
        if spec.driver_second > 0.0:
            found |= {f"{on}.second": spec.driver_second, f"{on}.second_size": spec.driver_second_size}
    elif spec.driver == "stochastic":
        found |= {f"{on}.sd": size, f"{on}.correlation_time": time}
    elif spec.driver == "moves":
        found |= {f"{on}.move": size, f"{on}.hold": time}
    elif spec.driver == "drift":
        found["load.slope"] = spec.swing / length * (1.0 if spec.seed % 2 else -1.0)
    else:  # a load that steps at the start makes OP travel until the valve slips; from then on the loop cycles
        found |= {"load.shape": 1.0, "load.amplitude": spec.S, "load.period": FOR_EVER}
    return found


def trouble(spec: LoopSpec, shown: Measured, time: float, length: int) -> Mapping[str, float]:
    """Return the parameters of noise, transmitter, walking load and set-point moves; period ``time`` [scans]."""
    loudest = (
        LOUDEST * shown.op / loudness(spec)
    )  # a controller that shook its valve with noise would have been detuned
    found = {
        "sensor.sd": min(spec.noise * shown.pv, loudest), "sensor.correlation_time": spec.noise_time * time,
        "sensor.step": shown.pv / spec.coarse if spec.coarse > 0.0 else 0.0,
        "load.walk": spec.walk * shown.op / math.sqrt(length),
    }  # fmt: skip
    if spec.sp_move > 0.0 and not (spec.driver == "moves" and spec.driver_on == "SP"):
        found |= {"SP.move": spec.sp_move * shown.pv, "SP.hold": max(spec.sp_hold * time, 1.0)}
    return found


def _labelled(spec: LoopSpec, values: Mapping[str, Values], mv: bool) -> tuple[LoopRecord, Truth]:
    """Return the record of a loop and what is true of it."""
    n = spec.samples
    op, stem = values["OP"][:n] + spec.op0, values["MV"][:n] + spec.op0
    sticks = spec.S > 0.0
    swing = extent(op)
    truth = Truth(
        cause=spec.cause,
        group=spec.group,
        S=spec.S if sticks else math.nan,
        J=spec.J if sticks else math.nan,
        process="integrating" if spec.process == "integrating" else "self_regulating",
        cycling=even(op),
        travel=swing / spec.S if sticks else math.nan,
        op_range=swing,
        period=period(op) * spec.dt,
        defects=names(spec),
    )
    return record(spec, values["SP"][:n], values["PV_m"][:n], op, stem if mv else None), truth
