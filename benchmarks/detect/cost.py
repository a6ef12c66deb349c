"""What the methods cost: processor time of one core on records of 7,200 samples, and how it grows with their length.

    python -m benchmarks.detect.cost [--quick] [--json FILE]

Five loops, each in its worst light for some method: a sticky flow loop with its process known or not, one of slow
period, one under set-point moves, a level.  A figure is the worst of the five, each the best of three.  The growth is
the slope of log(time) over log(samples), 3,600 to 28,800, and a fleet is judged sensibly where it is 1 or little more.
Processor time, not wall time, because neighbours on the machine make wall time a matter of luck.
"""

import pickle
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from stickslip.blocks import PI, FirstOrder, Integrator, SampledSensor, Staircase, StickSlip
from stickslip.detect import GATES, METHODS
from stickslip.detect.judge.answer import answer
from stickslip.detect.loop_stream import LoopStream
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.stream import LoopFacts, Sample
from stickslip.diagram import simulate, wire
from stickslip.logs import LoopRecord

from benchmarks.report import Figures, options, publish

SAMPLES = 7200
LENGTHS = (3600, 7200, 14_400, 28_800)

NOTES = {
    "screen_ms": "data health, oscillation and the methods that stream, 7,200 samples (goal: at most 3 ms)",
    "full_ms": "preparation, all methods and the calibrated verdict, 7,200 samples (goal: at most 400 ms)",
    "verdict_ms": "of that the features and the calibrated verdict",
    "full_growth": "slope of log(time) over log(samples) of the full set (goal: at most 1.2)",
    "stream_us": "update of all streaming methods a sample (goal: at most 20 us)",
    "memory_kb": "state of all methods of one monitored loop (goal: at most 1000 kB)",
}


def loop(samples: int, kind: str = "flow") -> LoopRecord:
    """Return a loop with a sticky valve, one sample a second; ``kind`` is flow, untold, slow, moves or level."""
    level, slow = kind == "level", kind == "slow"
    moves = 0.55 + 0.02 * np.cumsum(np.random.default_rng(3).normal(size=20)) if kind == "moves" else np.full(1, 0.55)
    tau = 60.0 if slow else 5.0
    body = Integrator(K=1.0, T=50.0, u_0=0.5, start=0.5) if level else FirstOrder(K=1.3, tau=tau, theta=1.0, start=0.52)
    K_p, T_i = (1.2, 40.0) if level else (0.6, 1.6 * tau)
    wired = wire(
        [
            Staircase("SP", moves, dwell=samples / len(moves)),
            PI(K_p, T_i, start_op=0.42, inputs={"PV": "PV_m"}),
            StickSlip.from_bands(S=0.06, J=0.03, start=0.40),
            body,
            SampledSensor(dt=1.0, sd=0.0008, seed=11),
        ]
    )
    run = simulate(wired, float(samples), every=1.0)
    assert run.ok, run.hint
    process = "unknown" if kind == "untold" else "integrating" if level else "self_regulating"
    log = run.log
    return LoopRecord.from_arrays(
        log.t, pv=log["PV_m"], op=log["OP"], sp=log["SP"], mv=log["MV"], process=process, op_span=(0.0, 1.0), name="X1"
    )


KINDS = ("flow", "untold", "slow", "moves", "level")


def cost(work: Callable[[], Any], repeats: int = 3) -> float:
    """Return the processor time of a piece of work [ms], the best of a few."""
    took = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        took.append(time.process_time() - start)
    return 1e3 * min(took)


def growth(samples: Sequence[int], ms: Sequence[float]) -> float:
    """Return the slope of log(ms) over log(samples), by least squares.

    >>> round(growth([100, 200, 400], [1.0, 2.0, 4.0]), 6)
    1.0
    """
    return float(np.polyfit(np.log(samples), np.log(ms), 1)[0])


def each(record: LoopRecord, repeats: int = 3) -> dict[str, float]:
    """Return the cost of every method [ms] on a record made ready, and of making it ready under "preparation"."""

    def ready() -> Prepared:
        made = prepared(record)
        _ = made.health, made.stretch, made.whole, made.wave("OP"), made.wave("PV"), made.half_waves("OP"), made.cycles
        return made

    made = ready()
    costs = {"preparation": cost(ready, repeats)}
    costs |= {method.CARD.name: cost(lambda m=method: m.detect(made), repeats) for method in METHODS}
    blind = prepared(replace(record, mv_name=None))  # with the stem logged the model would not be asked
    return costs | {"verdict": cost(lambda: answer(blind), repeats)}


def screen(record: LoopRecord) -> None:
    """Look at the data and the oscillation, and ask the methods that stream."""
    made = prepared(record)
    _ = made.facts, made.gate
    for method in METHODS:
        if method.CARD.streams == "exact":
            method.detect(made)


def streamed(record: LoopRecord) -> tuple[float, float]:
    """Return the cost of a sample in a stream of all methods that stream [us], and the size of all methods [kB]."""
    rows = list(zip(record.t.tolist(), record.pv.tolist(), record.op.tolist(), record.sp.tolist(), strict=True))  # type: ignore[union-attr]
    facts = LoopFacts.of(record)

    def through(methods: Sequence[Any]) -> LoopStream:
        stream = LoopStream(facts, methods)
        for t, pv, op, sp in rows:
            stream = stream.update(t, Sample(pv, op, sp))
        return stream

    streaming = [method for method in METHODS if method.CARD.streams != "no"]
    us = 1e3 * cost(lambda: through(streaming), 2) / len(rows)
    return us, len(pickle.dumps(through(METHODS))) / 1e3


def figures(quick: bool = False) -> Figures:
    """Return all figures; ``quick`` leaves the growth and three of the loops out."""
    kinds = KINDS[:2] if quick else KINDS
    records = {kind: loop(SAMPLES, kind) for kind in kinds}
    costs = {}
    for kind, record in records.items():
        each(record, 1)  # compile and load
        costs[kind] = each(record)
        print(f"{kind} loop: {sum(costs[kind].values()):.0f} ms", file=sys.stderr, flush=True)
    found: Figures = {
        "screen_ms": max(cost(lambda r=record: screen(r), 5) for record in records.values()),
        "full_ms": max(sum(costs[kind].values()) for kind in kinds),
    }
    found["stream_us"], found["memory_kb"] = streamed(records["flow"])
    for name in costs["flow"]:
        found[f"{name}_ms"] = max(costs[kind][name] for kind in kinds)
    for gate in GATES:
        found[f"{gate.CARD.name}_ms"] = cost(lambda g=gate: g.find(records["flow"]))
    if not quick:
        longer = {}
        for n in LENGTHS:
            longer[n] = each(loop(n), 2)
            print(f"{n} samples: {sum(longer[n].values()):.0f} ms", file=sys.stderr, flush=True)
        found["full_growth"] = growth(LENGTHS, [sum(longer[n].values()) for n in LENGTHS])
        for name in costs["flow"]:
            found[f"{name}_growth"] = growth(LENGTHS, [max(longer[n][name], 1e-3) for n in LENGTHS])
    return found


def main() -> None:
    """Measure and print."""
    chosen = options(__doc__.splitlines()[0])
    raise SystemExit(0 if publish(figures(chosen.quick), NOTES, chosen.json, chosen.quick) else 1)


if __name__ == "__main__":
    main()
