"""How fast and how right is the production plant, with its peers in the same run.

    python -m benchmarks.plant [--quick] [--only PARTS] [--json FILE]         exit code 1 if a goal is missed

The subject is set B with high stiction in VLCS1 and VPCS1 (quasi-static stems), kicked: 2000 s, 0.1 s log of all 61
signals, rtol 1e-6, atol 1e-9, one in-process call of ``stickslip.diagram.simulate``.  Peers have the same start,
tolerances and log times: scipy's LSODA and SUNDIALS CVODE on flat compiled equations that share nothing with
``blocks``, and python-control's own response of its best twin, which knows no events and therefore has stems with mass
and smooth friction.  Ours and the compiled peers run in turn; a ratio is the median over these rounds.

The plant's cycle forgets its start: two runs agree until a slip falls within their error of a tie, then they go other
ways.  Errors are therefore given over the first 200 s, and period and amplitude of p_1 over the last 1000 s.
``agreement_s`` says when our run at rtol 1e-10 and LSODA's at 1e-10 part by 1e-3 bar.

Each part says on standard error when it begins and what it took.  ``--only ours,lsoda`` measures some of the parts,
each of which has its own runs of ours to compare with: what was interrupted can be measured alone.  The longest by far
are the interpreted ones, python-control on its twin and the reference, which simulates 20 s.

``--quick`` leaves out the interpreted reference and the diagram twin, lets python-control's twin simulate 50 s for its
error only, and has the study do 20 runs.
"""

import os
import statistics
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from stickslip.diagram import simulate
from stickslip.logs.oscillation import oscillation
from stickslip.logs.processes import cores
from stickslip.plant import SET_B, kicked, production_plant, steady_state
from stickslip.study import production_subject, study

from benchmarks.peers import production_control, production_equations, production_lsoda
from benchmarks.report import Figures, in_turn, options, publish

DURATION, EVERY = 2000.0, 0.1  # s
EARLY, LATE = 200.0, 1000.0  # s: errors are taken before, period and amplitude after
F_S = 2250.0  # N
BAR = 1e5
SHORT_TWIN, DIAGRAM_TWIN, REFERENCE = 50.0, 10.0, 20.0  # s, horizons of the slow peers
PARTS = ("ours", "lsoda", "cvode", "reference", "control", "diagram", "study")

NOTES = {
    "plant_s": "the plant, 2000 s with its log of 61 signals, median [s] (goal: at most 0.060)",
    "plant_min_s": "the same, the quickest [s]",
    "plant_full_s": "the same with stems that have mass [s]",
    "plant_A_normal_s": "set A with normal stiction [s]",
    "steps": "steps accepted",
    "rejected": "steps rejected",
    "rhs": "right-hand sides evaluated, those of the Jacobian included",
    "events": "mode changes located, controllers and check valves included",
    "plant_error": "our largest error in p_1 over 200 s against LSODA at rtol 1e-10 [bar]",
    "plant_self_error": "the same against our own run at rtol 1e-10 [bar]",
    "plant_period": "period of p_1 after 1000 s [s]",
    "plant_amplitude": "half of peak to peak of p_1 after 1000 s [bar]",
    "rest_rate": "largest relative rate of the flat equations where our plant rests [1/s]",
    "agreement_s": "our run and LSODA's, both at rtol 1e-10, agree within 1e-3 bar for [s]",
    "lsoda_over_plant": "solve_ivp(LSODA) with compiled equations and Jacobian, its time over ours (goal: at least 5)",
    "lsoda_plain_over_plant": "the same with scipy's own Jacobian",
    "lsoda_stepped_over_plant": "scipy's LSODA class stepped by hand, its time over ours",
    "lsoda_rhs": "calls of its right-hand side; those of the compiled Jacobian are not among them",
    "lsoda_error": "solve_ivp's largest error in p_1 over 200 s [bar]",
    "cvode_over_plant": "CVODE with compiled equations and Jacobian, its time over ours",
    "cvode_error": "CVODE's largest error in p_1 over 200 s [bar]",
    "cvode_reference_error": "our error in p_1 over 20 s against the reference with CVODE, rtol 1e-8 [bar]",
    "control_over_plant": "python-control's own response of its best twin, its time over ours (goal: at least 300)",
    "control_over_full": "the same over our time for the same physics, stems with mass",
    "control_s": "python-control's time for it, both of the processor [s]",
    "control_error": "its largest error in p_1 over 50 s against our plant with mass at rtol 1e-9 [bar]",
    "full_period": "our period with stems that have mass, for comparison [s]",
    "full_amplitude": "and amplitude [bar]",
    "control_diagram_over_flat": "python-control on a diagram of blocks over its flat twin, both for 10 s",
    "control_diagram_error": "the diagram's largest error in p_1 over 10 s [bar]",
    "study_1000_s": "a study of 1000 runs of 2000 s on all cores [s] (goal: at most 60 on two)",
    "study_20_s": "the same with 20 runs [s]",
    "study_failed": "runs of the study that did not reach their end",
    "load": "load average of the machine at the start and at the end",
}  # fmt: skip


def ratio(taken: dict[str, list[float]], peer: str) -> float:
    """Return the median over the rounds of the peer's time over ours."""
    return statistics.median(a / b for a, b in zip(taken[peer], taken["ours"], strict=True))


def cycle(name: str, t: np.ndarray, p_1: np.ndarray) -> Figures:
    """Return period [s] and amplitude [bar] of p_1 [Pa] after 1000 s."""
    late = t >= LATE
    found = oscillation(t[late], p_1[late] / BAR)
    return {f"{name}_period": found.period, f"{name}_amplitude": found.amplitude}


def largest(t: np.ndarray, p_1: np.ndarray, exact: np.ndarray, until: float) -> float:
    """Return the largest difference [bar] of two pressures [Pa] over the first seconds."""
    n = np.searchsorted(t, until + 1e-6)
    return float(np.max(np.abs(p_1[:n] - exact[:n]))) / BAR


class Subject:
    """The plant, its flat twin, and accurate runs of both."""

    def __init__(self) -> None:
        self.plant = kicked(production_plant(SET_B, F_s=F_S))
        self.full = kicked(production_plant(SET_B, F_s=F_S, stem="full"))
        rest = steady_state(SET_B)
        self.flat = production_lsoda.problem(self.plant, rest, F_S, SET_B.stem)
        still = production_lsoda.problem(production_plant(SET_B, F_s=F_S), rest, F_S, SET_B.stem)
        rates = production_equations.compiled_rates(still.y, still.valves, still.c)
        self.rest_rate = float(np.max(np.abs(rates) / np.maximum(np.abs(still.y), 1.0)))
        self.exact = production_equations.pressure_and_level(
            production_lsoda.run(self.flat, DURATION, EVERY, rtol=1e-10, atol=1e-13).y
        )[0]

    def ours(self, duration: float = DURATION, rtol: float = 1e-6):
        """Return our run."""
        return simulate(self.plant, duration, every=EVERY, rtol=rtol, atol=1e-3 * rtol, method="stiff")

    def with_mass(self, duration: float = DURATION, rtol: float = 1e-6):
        """Return our run of the plant whose stems have mass."""
        return simulate(self.full, duration, every=EVERY, rtol=rtol, atol=1e-3 * rtol, method="stiff")


def main() -> None:
    """Measure everything and print it."""
    chosen = options(__doc__.splitlines()[0], PARTS)
    begin_load = os.getloadavg()[0]
    rounds = 1 if chosen.quick else 15
    with announced("an accurate run of LSODA to compare with"):
        subject = Subject()
    parts: dict[str, Callable[[], Figures]] = {
        "ours": lambda: our_figures(subject, rounds),
        "lsoda": lambda: lsoda_figures(subject, rounds),
        "cvode": lambda: cvode_figures(subject, rounds),
        "reference": lambda: {} if chosen.quick else reference_figures(subject),
        "control": lambda: control_figures(subject, chosen.quick),
        "diagram": lambda: {} if chosen.quick else diagram_figures(subject),
        "study": lambda: study_figures(20 if chosen.quick else 1000),
    }
    figures: Figures = {}
    for part in chosen.only:
        with announced(part):
            figures |= parts[part]()
    figures["cores"] = cores()
    figures["load"] = f"{begin_load:.2f} {os.getloadavg()[0]:.2f}"
    raise SystemExit(0 if publish(figures, NOTES, chosen.json, chosen.quick) else 1)


@contextmanager
def announced(part: str) -> Iterator[None]:
    """Say on standard error that a part of the benchmark begins, and then how long it took."""
    begin = time.perf_counter()
    print(f"{part} ...", file=sys.stderr, flush=True)
    yield
    print(f"{part}: {time.perf_counter() - begin:.1f} s", file=sys.stderr, flush=True)


def our_figures(subject: Subject, rounds: int) -> Figures:
    """Return times, work and errors of our own."""
    A = kicked(production_plant("A", F_s="normal"))
    taken = in_turn(
        rounds,
        ours=subject.ours,
        full=subject.with_mass,
        A=lambda: simulate(A, DURATION, every=EVERY, method="stiff"),
    )
    run, exact = subject.ours(), subject.ours(rtol=1e-10)
    p_1 = run.log["p_1"]
    apart = np.abs(exact.log["p_1"] - subject.exact) > 1e-3 * BAR
    return {
        "plant_s": statistics.median(taken["ours"]),
        "plant_min_s": min(taken["ours"]),
        "plant_full_s": statistics.median(taken["full"]),
        "plant_A_normal_s": statistics.median(taken["A"]),
        "steps": run.statistics.steps,
        "rejected": run.statistics.rejected,
        "rhs": run.statistics.rhs,
        "events": run.statistics.events,
        "plant_error": largest(run.log.t, p_1, subject.exact, EARLY),
        "plant_self_error": largest(run.log.t, p_1, exact.log["p_1"], EARLY),
        **cycle("plant", run.log.t, p_1),
        "rest_rate": subject.rest_rate,
        "agreement_s": float(run.log.t[np.argmax(apart)]) if apart.any() else DURATION,
    }


def lsoda_figures(subject: Subject, rounds: int) -> Figures:
    """Return the figures of scipy's LSODA."""
    flat = subject.flat
    taken = in_turn(
        rounds,
        ours=subject.ours,
        lsoda=lambda: production_lsoda.run(flat, DURATION, EVERY),
        plain=lambda: production_lsoda.run(flat, DURATION, EVERY, jac=False),
        stepped=lambda: production_lsoda.stepped(flat, DURATION, EVERY),
    )
    run = production_lsoda.run(flat, DURATION, EVERY)
    p_1 = production_equations.pressure_and_level(run.y)[0]
    return {
        "lsoda_over_plant": ratio(taken, "lsoda"),
        "lsoda_plain_over_plant": ratio(taken, "plain"),
        "lsoda_stepped_over_plant": ratio(taken, "stepped"),
        "lsoda_error": largest(run.t, p_1, subject.exact, EARLY),
        "lsoda_rhs": run.rhs,
        **cycle("lsoda", run.t, p_1),
    }


def cvode_figures(subject: Subject, rounds: int) -> Figures:
    """Return the figures of SUNDIALS CVODE on compiled equations."""
    try:
        from benchmarks.peers import production_cvode
    except ImportError as reason:
        print(f"CVODE is SKIPPED: {reason}; install the extra 'bench'", file=sys.stderr)
        return {"cvode_over_plant": None, "cvode_error": None}
    taken = in_turn(rounds, ours=subject.ours, cvode=lambda: production_cvode.run(subject.flat, DURATION, EVERY))
    run = production_cvode.run(subject.flat, DURATION, EVERY)
    p_1 = production_equations.pressure_and_level(run.y)[0]
    return {
        "cvode_over_plant": ratio(taken, "cvode"),
        "cvode_error": largest(run.t, p_1, subject.exact, EARLY),
        "cvode_rhs": run.rhs,
        **cycle("cvode", run.t, p_1),
    }


def reference_figures(subject: Subject) -> Figures:
    """Return our error against CVODE as the interpreted reference of the plant."""
    from stickslip.diagram.reference import simulate_reference

    try:
        run = simulate_reference(subject.plant, REFERENCE, every=EVERY, backend="cvode", rtol=1e-8, atol=1e-11)
    except ImportError as reason:
        print(f"CVODE is SKIPPED: {reason}; install the extra 'bench'", file=sys.stderr)
        return {"cvode_reference_error": None}
    ours = subject.ours(REFERENCE).log
    return {"cvode_reference_error": largest(ours.t, ours["p_1"], run.log["p_1"], REFERENCE)}


def control_figures(subject: Subject, quick: bool) -> Figures:
    """Return the figures of python-control's own response.

    One run takes too long to be repeated in turn with ours, so both are measured in processor time, which other work
    on the machine disturbs less.  A short run says nothing about speed, only about error.
    """
    exact = subject.with_mass(SHORT_TWIN, 1e-9).log["p_1"]
    twin = production_control.flat(subject.flat, F_S)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = production_control.run(*twin, SHORT_TWIN if quick else DURATION, EVERY)
        error = largest(run.t, run.p_1, exact, SHORT_TWIN)
    if quick:
        return {"control_error": error}
    taken = in_turn(9, time.process_time, ours=subject.ours, full=subject.with_mass)
    ours, full = statistics.median(taken["ours"]), statistics.median(taken["full"])
    return {
        "control_over_plant": run.seconds / ours,
        "control_over_full": run.seconds / full,
        "control_s": run.seconds,
        "control_error": error,
        **cycle("control", run.t, run.p_1),
        **cycle("full", run.t, subject.with_mass().log["p_1"]),
    }


def diagram_figures(subject: Subject) -> Figures:
    """Return the figures of python-control's own response of a diagram of blocks, against its flat twin."""
    exact = subject.with_mass(DIAGRAM_TWIN, 1e-9).log["p_1"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        diagram = production_control.run(*production_control.diagram(subject.plant, F_S), DIAGRAM_TWIN, EVERY)
        flat = production_control.run(*production_control.flat(subject.flat, F_S), DIAGRAM_TWIN, EVERY)
    return {
        "control_diagram_over_flat": diagram.seconds / flat.seconds,
        "control_diagram_error": largest(diagram.t, diagram.p_1, exact, DIAGRAM_TWIN),
    }


def study_figures(runs: int) -> Figures:
    """Return the time of a study: 50 sizes of stiction in VPCS1 times 20 kicks (or 5 times 4)."""
    sizes, kicks = (50, 20) if runs == 1000 else (5, runs // 5)
    begin = time.perf_counter()
    found = study(
        production_subject("B", F_s="high"), plant={"VPCS1.F_s": np.linspace(1300.0, F_S, sizes).tolist()},
        kicks=kicks, duration=DURATION, every=0.5, progress=False,
    )  # fmt: skip
    seconds = time.perf_counter() - begin
    failed = sum(status != "OK" for status in found.table["status"].to_list())
    return {f"study_{len(found.table)}_s": seconds, "study_failed": failed}


if __name__ == "__main__":
    main()
