"""How fast and how right is the engine, with its peers in the same run.

    python -m benchmarks.simulate [--quick] [--json FILE]         exit code 1 if a requirement is missed

The subject is ``ideal_high``: the thesis's loop with the full-mass stem, 600 s, 6001 log rows, one in-process
call of ``stickslip.diagram.simulate`` at rtol 1e-8.  Peers solve the same problem: hand-written C, python-control's own
response of its best twin (it knows no events), PathSim with its zero-crossing events.  ``X_over_ideal`` is the
peer's time over ours; every peer's error is printed beside it.
"""

import os
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable

import numpy as np
from stickslip.cases import find
from stickslip.cases.exact import exact_run
from stickslip.diagram import simulate, wire
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.flatten import plan
from stickslip.logs.processes import cores
from stickslip.plant.loops import self_regulating_loop

from benchmarks.peers.coupled_sticky import coupled_sticky_loops
from benchmarks.replay import NOTES as REPLAY_NOTES
from benchmarks.replay import replay_figures
from benchmarks.report import Figures, in_turn, median_seconds, options, publish

RTOL = 1e-8  # so that our error is as small as the C program's; the default of simulate() is 1e-6

NOTES = {
    "ideal_error": "largest error in e against the exact automaton (required: below 1e-6)",
    "ideal_s": "one simulation with its log, median [s]",
    "default_error": "the same at the default tolerance, rtol 1e-6",
    "default_s": "the same at the default tolerance [s]",
    "ideal_over_c": "our median time over hand-written C's, measured in turn (required: at most 2)",
    "c_error": "the C program's largest error in e",
    "dead_time_over_c": "ten coupled loops with dead times, 200 s: our time over C's (required: at most 3)",
    "dead_time_error": "our largest error in the ten PVs, rtol 1e-3",
    "dead_time_c_error": "the C program's, with fixed steps of 1/640 s; it may be the larger one",
    "control_over_ideal": "python-control's time over ours (required: at least 1000)",
    "control_error": "python-control's largest error in e",
    "pathsim_over_ideal": "PathSim's time over ours (required: at least 1000)",
    "pathsim_error": "PathSim's largest error in e",
    "fifty_loops_s": "50 different loops in one diagram, 600 s [s] (required: at most 0.5)",
    "scaling_exponent": "cost ~ N^this from 1 to 200 loops (required: at most 1.2)",
    "coupled_400_s": "400 sticky loops coupled in a ring, 200 s [s] (required: at most 1.0)",
    "coupled_exponent": "cost ~ N^this from 50 to 400 coupled loops (required: at most 1.15)",
    "coupled_scans_s": "the same 400 with controllers that scan each second, one after the other, 200 s [s]",
    "plan_1000_s": "laying out 1000 coupled loops for the engine, once per diagram [s]",
    "plan_exponent": "cost of that ~ N^this from 250 to 1000 loops",
    "ensemble_1000_s": "1000 variants of the ideal loop, all signals kept [s] (required: at most 3)",
    **REPLAY_NOTES,
    "simulate_process_s": "whole process 'stickslip simulate ideal_high', warm cache [s] (required: at most 2.0)",
    "simulate_over_import": "that over 'python -c \"import control\"', in turn (required: at most 1.4)",
    "help_process_s": "whole process 'stickslip --help' [s] (required: at most 0.3)",
}


def many_loops(count: int):
    """Return ``count`` ideal loops in one diagram, friction spread so that events fall apart."""
    friction = np.linspace(1900.0, 2250.0, count)
    return wire([self_regulating_loop(F_s=float(F_s), name=f"loop{i}") for i, F_s in enumerate(friction)])


def process_seconds(arguments: list[str], repeats: int) -> float:
    """Return the median wall time of a whole Python process [s], its byte code kept as usual."""
    command, env = [sys.executable, *arguments], {**os.environ}
    env.pop("PYTHONDONTWRITEBYTECODE", None)
    return median_seconds(lambda: subprocess.run(command, check=True, capture_output=True, env=env), repeats)


def start_figures(repeats: int) -> Figures:
    """Return the wall time of a whole simulation process and its ratio to importing python-control, in turn."""
    simulation, control = [], []
    for _ in range(repeats):
        simulation.append(process_seconds(["-m", "stickslip", "simulate", "ideal_high"], 1))
        control.append(process_seconds(["-c", "import control"], 1))
    return {
        "simulate_process_s": float(np.median(simulation)),
        "simulate_over_import": min(simulation) / min(control),
    }


def coupled_figures(quick: bool) -> Figures:
    """Return what coupled sticky loops cost to lay out and to simulate."""
    sizes = (10, 40) if quick else (50, 100, 200, 400)
    costs = []
    for count in sizes:
        loops = coupled_sticky_loops(count)
        simulate(loops, 200.0, every=1.0)
        costs.append(least_seconds(lambda d=loops: simulate(d, 200.0, every=1.0)))
    most = sizes[-1]
    figures: Figures = {f"coupled_{most}_s": costs[-1], "coupled_exponent": exponent(sizes, costs)}
    scans = coupled_sticky_loops(most, scan=1.0)
    simulate(scans, 200.0, every=1.0)
    figures["coupled_scans_s"] = least_seconds(lambda: simulate(scans, 200.0, every=1.0))
    sizes = (10, 40) if quick else (250, 500, 1000)
    made = [coupled_sticky_loops(count) for count in sizes]
    costs = [least_seconds(lambda d=d: plan(d.with_params({}))) for d in made]
    figures |= {f"plan_{sizes[-1]}_s": costs[-1], "plan_exponent": exponent(sizes, costs)}
    return figures


def least_seconds(action, repeats: int = 3) -> float:
    """Return the least wall time of an action [s]: what else runs on the machine only ever adds to it."""
    taken = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        taken.append(time.perf_counter() - begin)
    return min(taken)


def exponent(sizes, costs) -> float:
    """Return by which power of the size the cost grows."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def main() -> None:
    """Measure everything and print it."""
    chosen = options(__doc__.splitlines()[0])
    repeats = 1 if chosen.quick else 30
    case = find("ideal_high")
    loop = case.build()
    exact = exact_run()
    figures: Figures = {}

    def ours(rtol=RTOL):
        return simulate(loop, case.duration, every=case.every, rtol=rtol, atol=1e-3 * rtol)

    def error(run):
        return float(np.max(np.abs(run.log["SP"] - run.log["PV"] - exact.e)))

    figures["ideal_error"] = error(ours())
    figures |= c_figures(ours, exact.e, repeats)
    ideal = figures["ideal_s"]
    figures["default_error"] = error(ours(1e-6))
    figures["default_s"] = median_seconds(lambda: ours(1e-6), repeats)
    figures |= dead_time_figures(repeats)
    if not chosen.quick:
        figures |= control_figures(ideal, exact.e)
        figures |= pathsim_figures(ideal, exact.e)

    sizes = (1, 10, 50) if chosen.quick else (1, 5, 20, 50, 100, 200)
    costs = []
    for count in sizes:
        diagram = many_loops(count)
        costs.append(median_seconds(lambda d=diagram: simulate(d, 600.0, every=0.1), min(repeats, 5)))
    figures["fifty_loops_s"] = costs[sizes.index(50)]
    figures["scaling_exponent"] = exponent(sizes, costs)

    figures |= coupled_figures(chosen.quick)

    variants = 100 if chosen.quick else 1000
    spread = {"valve.F_s": np.linspace(1750.0, 2250.0, variants)}
    begin = time.perf_counter()
    result = ensemble(loop, case.duration, params=spread, every=case.every)
    figures[f"ensemble_{variants}_s"] = time.perf_counter() - begin
    figures["ensemble_failed"] = int(np.sum(np.asarray(result.status) != 0))

    figures |= replay_figures(repeats)

    figures |= start_figures(1 if chosen.quick else 7)
    figures["help_process_s"] = process_seconds(["-m", "stickslip", "--help"], 1 if chosen.quick else 7)
    figures["cores"] = cores()
    raise SystemExit(0 if publish(figures, NOTES, chosen.json, chosen.quick) else 1)


def c_figures(ours: Callable[[], object], exact_e: np.ndarray, repeats: int) -> Figures:
    """Return our time and the figures of the hand-written C program.

    The two run in turn, so that whatever else the machine does meets both: measured one after the other, the load may
    change in between.  Both are medians of wall times, after one warm-up each, logs included; the C program writes its
    six columns into a buffer that it keeps, ours allocates its log and checks what it was asked.
    """
    from benchmarks.peers import c_loop

    try:
        once = c_loop.prepare()
    except c_loop.NoCompiler as reason:
        print(reason, file=sys.stderr)
        return {"ideal_s": median_seconds(ours, repeats), "ideal_over_c": None, "c_error": None}
    error = float(np.max(np.abs(once().e - exact_e)))
    taken = in_turn(repeats, ours=ours, c=once)
    ideal, c = (statistics.median(taken[name]) for name in ("ours", "c"))
    return {"ideal_s": ideal, "ideal_over_c": ideal / c, "c_error": error}


def dead_time_figures(repeats: int) -> Figures:
    """Return the figures of ten coupled loops with dead times, against a fixed-step C program of no smaller error."""
    from benchmarks.peers import c_coupled
    from benchmarks.peers.c_library import NoCompiler

    seconds, steps, diagram = 200, 640, c_coupled.diagram()

    def ours(rtol=1e-3):
        return simulate(diagram, seconds, every=1.0, rtol=rtol, atol=1e-3 * rtol)

    def measured(run):
        return np.array([run.log[name] for name in run.log.names if name.startswith("PV")]).T

    exact = measured(ours(1e-11))
    figures: Figures = {"dead_time_over_c": None, "dead_time_c_error": None}
    figures["dead_time_error"] = float(np.max(np.abs(measured(ours()) - exact)))
    try:
        once = c_coupled.prepare(seconds, steps)
        figures["dead_time_c_error"] = float(np.max(np.abs(once() - exact)))
    except NoCompiler as reason:
        print(reason, file=sys.stderr)
        return figures
    figures["dead_time_over_c"] = median_seconds(ours, repeats) / median_seconds(once, min(repeats, 5))
    return figures


def control_figures(ideal: float, exact_e: np.ndarray) -> Figures:
    """Return the figures of python-control's own response."""
    from benchmarks.peers import python_control

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        _, e, seconds = python_control.run()
    return {"control_over_ideal": seconds / ideal, "control_error": float(np.max(np.abs(e - exact_e)))}


def pathsim_figures(ideal: float, exact_e: np.ndarray) -> Figures:
    """Return the figures of PathSim."""
    try:
        from benchmarks.peers import pathsim_loop
    except ImportError as reason:
        print(f"PathSim is SKIPPED: {reason}; install the extra 'bench'", file=sys.stderr)
        return {"pathsim_over_ideal": None, "pathsim_error": None}
    log = pathsim_loop.run()
    return {"pathsim_over_ideal": log.seconds / ideal, "pathsim_error": float(np.max(np.abs(log.e - exact_e)))}


if __name__ == "__main__":
    main()
