"""The production plant in scipy's LSODA, on compiled equations and restarted at events.

``run``      ``solve_ivp(method="LSODA")``, what a good user writes: flat compiled equations, one compiled event
             function with the analytic dOP/dt, the Jacobian compiled too (scipy's own differences call Python 23
             times), the log by ``t_eval``
``stepped``  the class ``scipy.integrate.LSODA`` stepped by hand without solve_ivp's bookkeeping: half the time

Only the two sticky stems make events; limits of controllers and the check valves stay kinks, over which LSODA steps.
"""

import time
from typing import NamedTuple

import numpy as np
from scipy.integrate import LSODA, solve_ivp
from scipy.optimize import brentq

from benchmarks.peers import production_equations as equations

NEAR = 1e-9  # an event function above -NEAR at a located event has fired


class Problem(NamedTuple):
    """States at the start (23,), memory of the two valves, constants of the parameter set."""

    y: np.ndarray
    valves: np.ndarray
    c: np.ndarray


class PeerRun(NamedTuple):
    """Log times (n,), states (23, n), times of the stems' events, calls of the right-hand side, wall time [s]."""

    t: np.ndarray
    y: np.ndarray
    events: np.ndarray
    rhs: int
    seconds: float


class PeerFailed(RuntimeError):
    """The peer gave up; its message says why."""


def problem(plant, rest, F_s: float, stem) -> Problem:
    """Return the plant as flat arrays: its states, and both valves stuck where ``rest`` has them."""
    valves = np.array([0.0, rest.VLCS1, 0.0, rest.VPCS1, stem.F_c / stem.k, F_s / stem.k])
    return Problem(equations.start(plant), valves, np.array(equations.constants(rest.design)))


def run(
    given: Problem, duration: float, every: float = 0.1, rtol: float = 1e-6, atol: float = 1e-9, jac: bool = True
) -> PeerRun:
    """Simulate with ``solve_ivp``; ``seconds`` is everything but compiling."""
    begin = time.perf_counter()
    grid, valves, c, y, t, log = ready(given, duration, every)
    events, rhs, row = [], 0, 0
    keywords = {"jac": lambda t, y: equations.compiled_jacobian(y, valves, c)} if jac else {}

    def released(t, y):
        return equations.compiled_event(y, valves, c)

    released.terminal, released.direction = True, 1.0
    while t < duration:
        part = solve_ivp(
            lambda t, y: equations.compiled_rates(y, valves, c), (t, duration), y, "LSODA", grid[row:],
            events=released, rtol=rtol, atol=atol, **keywords,
        )  # fmt: skip
        if part.status < 0:
            raise PeerFailed(f"LSODA at t = {t:g} s: {part.message}")
        if len(part.t):
            log[:, row : row + len(part.t)] = part.y
            row += len(part.t)
        rhs += part.nfev
        if part.status == 0:
            break
        t, y = float(part.t_events[0][0]), part.y_events[0][0].copy()
        equations.switch(y, valves, c, NEAR)
        events.append(t)
    return PeerRun(grid, log, np.array(events), rhs, time.perf_counter() - begin)


def stepped(given: Problem, duration: float, every: float = 0.1, rtol: float = 1e-6, atol: float = 1e-9) -> PeerRun:
    """Simulate step by step; dense output only where a log time or an event lies in the step."""
    begin = time.perf_counter()
    grid, valves, c, y, t, log = ready(given, duration, every)
    events, rhs, row = [], 0, 0
    while t < duration:
        solver = LSODA(
            lambda t, y: equations.compiled_rates(y, valves, c), t, y, duration, rtol=rtol, atol=atol,
            jac=lambda t, y: equations.compiled_jacobian(y, valves, c),
        )  # fmt: skip
        fired = False
        while solver.status == "running" and not fired:
            message = solver.step()
            if solver.status == "failed":
                raise PeerFailed(f"LSODA at t = {solver.t:g} s: {message}")
            fired = equations.compiled_event(solver.y, valves, c) > 0.0
            t = solver.t
            if fired or (row < len(grid) and grid[row] <= t):
                inside = solver.dense_output()
                if fired:
                    t = _located(inside, solver.t_old, t, valves, c)
                end = int(np.searchsorted(grid, t, side="right"))
                if end > row:
                    log[:, row:end] = inside(grid[row:end])
                    row = end
        rhs += solver.nfev
        if fired:
            y = inside(t).copy()
            equations.switch(y, valves, c, NEAR)
            events.append(t)
    return PeerRun(grid, log, np.array(events), rhs, time.perf_counter() - begin)


def _located(inside, before: float, after: float, valves: np.ndarray, c: np.ndarray) -> float:
    return float(brentq(lambda t: equations.compiled_event(inside(t), valves, c), before, after, xtol=1e-13))


def ready(given: Problem, duration: float, every: float):
    """Return log times, valves, constants, states and time at the start, room for the log."""
    grid = np.arange(round(duration / every) + 1) * every
    valves = given.valves.copy()
    equations.switch(given.y, valves, given.c, 0.0)
    return grid, valves, given.c, given.y, 0.0, np.empty((23, len(grid)))
