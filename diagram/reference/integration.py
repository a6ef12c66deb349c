"""A second opinion on every run: slow, interpreted, integrated by other people's solvers.

The same kernels run as plain Python; SciPy (Radau, LSODA, BDF, DOP853, RK45) or SUNDIALS CVODE integrates between
instants.  The sweep, the event search, the sampling clock and the dead times (interpolation of their own history
at Chebyshev points) are written anew here and share nothing with ``engine`` but the words for a status.

Limits: hundreds of times slower than ``simulate``; steps are never longer than the shortest dead time.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.ports import nearest, number
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import Inputs
from stickslip.diagram.kept import log_times
from stickslip.diagram.kinds import known_loops
from stickslip.diagram.past import resumed
from stickslip.diagram.playback import check_logged
from stickslip.diagram.reference.interpreter import Interpreter
from stickslip.diagram.run_events import in_order
from stickslip.diagram.simulation import Run, set_up
from stickslip.engine.status import HINTS, Statistics, Status
from stickslip.logs import Log
from stickslip.logs.loop_signals import LoopsLater, within

Floats = NDArray[np.float64]
SCIPY = ("LSODA", "Radau", "BDF", "DOP853", "RK45")
SCAN = np.linspace(0.0, 1.0, 9)[1:]  # where each solver step is searched for events


class SolverFailed(Exception):
    """A solver gave up; the run ends with STEP_TOO_SMALL."""


@dataclass
class Stretch:
    """One accepted solver step: where it ends and the state as a function of time inside."""

    t: float
    x: Floats
    state_at: Callable[[float], Floats]
    root: bool = False


@dataclass
class Settings:
    """Solver settings of one reference run."""

    backend: str
    method: str
    rtol: float
    atol: float
    max_step: float
    max_steps: int
    steps: int = field(default=0)


def simulate_reference(
    diagram: Diagram,
    duration: float,
    *,
    every: float | None = None,
    times: ArrayLike | None = None,
    inputs: Inputs | None = None,
    params: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
    backend: str = "scipy",
    method: str = "Radau",
    rtol: float = 1e-9,
    atol: float = 1e-11,
    max_step: float = np.inf,
    max_steps: int = 1_000_000,
    t0: float = 0.0,
) -> Run:
    """Simulate as ``simulate`` does, with an independent backend; see there for the common parameters.

    Parameters: ``backend`` "scipy" or "cvode" (SUNDIALS through scikit-sundae); ``method`` the SciPy solver;
    ``max_step`` [s] bounds the steps, between which events could be missed.

    Raises ``ValueError`` for an unknown backend or method, ``ImportError`` if scikit-sundae is missing.

    >>> from stickslip.blocks import FirstOrder, Step
    >>> from stickslip.diagram import wire
    >>> loop = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
    >>> simulate_reference(loop, 5.0, every=5.0).log["PV"].round(4).tolist()
    [0.0, 1.2642]
    """
    if backend not in ("scipy", "cvode"):
        raise ValueError(f"backend = {backend!r}; {nearest(backend, ['scipy', 'cvode'])}")
    if method not in SCIPY:
        raise ValueError(f"method = {method!r}; {nearest(method, list(SCIPY))}")
    rtol, atol = number("reference", "rtol", rtol), number("reference", "atol", atol)
    max_step = number("reference", "max_step", max_step)
    if not (rtol >= 1e-13 and atol > 0.0 and max_step > 0.0):
        raise ValueError(
            f"rtol = {rtol!r}, atol = {atol!r}, max_step = {max_step!r}, but rtol >= 1e-13, atol > 0 and max_step > 0 "
            "are needed; leave them out for 1e-9, 1e-11 and no limit"
        )
    ready = set_up(diagram, inputs, params, start)
    grid = log_times(duration, every, times, t0, len(ready.signals))
    duration, t0 = float(duration), float(t0)
    check_logged(ready.blocks, t0, t0 + duration)
    past = resumed(ready.past, ready.blocks, t0)
    if past is not None and (past.delays or past.sampled):
        raise ValueError("the reference goes on from no run; start afresh with diagram.with_past(None), or simulate")
    world = Interpreter(ready, t0)
    settings = Settings(backend, method, rtol, atol, min([max_step, *(0.5 * th for th in world.thetas)]), max_steps)
    status, rows = _run(world, grid, t0 + duration, settings)
    log = Log(
        t=grid,
        signals=dict(zip(ready.signals, rows.T, strict=True)),
        units={s: u for s, u in ready.signal_units.items() if u},
        spans=ready.signal_spans,
        origin=f"reference ({backend}): {ready.name}",
        loops=LoopsLater(lambda: within(known_loops(ready), ready.signals)),
    )
    statistics = Statistics(steps=settings.steps, rhs=world.n_rates, events=world.n_fired, components=1)
    return Run(log, in_order([np.array(world.events).reshape(-1, 4)]), status, HINTS[status], statistics, ready, ())


def _run(world: Interpreter, grid: Floats, t_end: float, settings: Settings) -> tuple[Status, Floats]:
    rows = np.full((len(grid), len(world.s)), np.nan)
    row = 0
    while True:
        if not world.settle():
            return Status.CHATTERING, rows
        if not np.all(np.isfinite(world.s[world.checked])):
            return Status.NOT_FINITE, rows
        while row < len(grid) and grid[row] <= world.t + world.rounding(world.t):
            rows[row] = world.s
            row += 1
        if world.t >= t_end - world.rounding(t_end):
            return Status.OK, rows
        stop, largest = world.next_stop(t_end)
        solver = _solver(world, stop, min(settings.max_step, largest), settings)
        arrived = False
        while not arrived:
            t, left = world.t, world.event_values(world.t, world.x)
            try:
                stretch = solver()
            except SolverFailed:
                return Status.STEP_TOO_SMALL if np.all(np.isfinite(world.x)) else Status.NOT_FINITE, rows
            settings.steps += 1
            if not np.all(np.isfinite(stretch.x)) or np.max(np.abs(stretch.x), initial=0.0) > 1e100:
                return Status.NOT_FINITE, rows
            if settings.steps > settings.max_steps:
                return Status.TOO_MANY_STEPS, rows
            t_new, fired = _first_event(world, t, stretch, left)
            x_new = stretch.x if t_new == stretch.t else stretch.state_at(t_new)
            arrived = fired or t_new >= stop
            while row < len(grid) and grid[row] < t_new - world.rounding(t_new):
                rows[row] = world.signals_at(grid[row], stretch.state_at(grid[row]))
                row += 1
            world.remember(t, t_new, stretch.state_at)
            world.arrive(t_new, x_new, fired)


def _first_event(world: Interpreter, t: float, stretch: Stretch, left: Floats) -> tuple[float, bool]:
    """Return (end of the stretch or the first instant at which an event function is positive, whether one is)."""
    waiting = left <= 0.0
    if not waiting.any():
        return stretch.t, False

    def top(at: float) -> float:
        x = stretch.x if at == stretch.t else stretch.state_at(at)
        return float(np.max(world.event_values(at, x)[waiting]))

    before = t
    for part in SCAN:
        after = stretch.t if part == 1.0 else t + part * (stretch.t - t)
        if top(after) > 0.0:
            while after - before > world.rounding(t):
                middle = 0.5 * (before + after)
                if middle in (before, after):
                    break
                if top(middle) > 0.0:
                    after = middle
                else:
                    before = middle
            return after, True
        before = after
    return stretch.t, False


def _solver(world: Interpreter, stop: float, max_step: float, settings: Settings) -> Callable[[], Stretch]:
    """Return a function that takes one step after the other from the world's present towards ``stop``."""
    if world.n_states == 0:
        return lambda: Stretch(min(stop, world.t + max_step), world.x, lambda at: world.x)
    if settings.backend == "cvode":
        return _cvode(world, stop, max_step, settings)
    import scipy.integrate

    solver = getattr(scipy.integrate, settings.method)(
        world.rates, world.t, world.x, stop, max_step=max_step, rtol=settings.rtol, atol=settings.atol
    )

    def step() -> Stretch:
        message = solver.step()
        if solver.status == "failed":
            raise SolverFailed(message)
        return Stretch(float(solver.t), np.array(solver.y), solver.dense_output())

    return step


def _cvode(world: Interpreter, stop: float, max_step: float, settings: Settings) -> Callable[[], Stretch]:
    try:
        from sksundae.cvode import CVODE
    except ImportError as error:
        raise ImportError(
            "backend='cvode' needs scikit-sundae; pip install 'stickslip[sundials]', or use backend='scipy'"
        ) from error

    def rhs(t: float, x: Floats, dx: Floats) -> None:
        dx[:] = world.rates(t, x)

    longest = 0.0 if np.isinf(max_step) else max_step
    solver = CVODE(rhs, method="BDF", rtol=settings.rtol, atol=settings.atol, max_step=longest, max_num_steps=100_000)
    solver.init_step(world.t, world.x)

    def step() -> Stretch:
        t, x, f = world.t, world.x, world.rates(world.t, world.x)
        solution = solver.step(stop, method="onestep", tstop=stop)
        if not solution.success:
            raise SolverFailed(str(solution.message))
        t_new, x_new = float(np.ravel(solution.t)[-1]), np.array(solution.y, dtype=float).reshape(-1)[-len(x) :]
        return Stretch(t_new, x_new, _hermite(t, x, f, t_new, x_new, world.rates(t_new, x_new)))

    return step


def _hermite(t: float, x: Floats, f: Floats, t1: float, x1: Floats, f1: Floats) -> Callable[[float], Floats]:
    """Return the cubic through states and rates at both ends of a step."""
    h = t1 - t

    def state_at(at: float) -> Floats:
        s = (at - t) / h
        bend = (1.0 - s) * (1.0 - s)
        value: Floats = bend * (1.0 + 2.0 * s) * x + s * s * (3.0 - 2.0 * s) * x1
        return value + h * s * (bend * f - s * (1.0 - s) * f1)

    return state_at
