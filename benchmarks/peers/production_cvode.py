"""The production plant in SUNDIALS CVODE (BDF, through scikit-sundae) on the same compiled right-hand side.

As in LSODA's peer the Jacobian is compiled and only the two sticky stems make events, found by CVODE's own root search.
"""

import time

import numpy as np
from sksundae.cvode import CVODE

from benchmarks.peers import production_equations as equations
from benchmarks.peers.production_lsoda import NEAR, PeerFailed, PeerRun, Problem, ready


def run(given: Problem, duration: float, every: float = 0.1, rtol: float = 1e-6, atol: float = 1e-9) -> PeerRun:
    """Simulate; ``seconds`` is everything but compiling."""
    begin = time.perf_counter()
    grid, valves, c, y, t, log = ready(given, duration, every)
    events, rhs, row = [], 0, 0

    def rates(t, y, dy):
        equations.write_rates(y, valves, c, dy)

    def jacobian(t, y, dy, J):
        J[:] = equations.compiled_jacobian(y, valves, c)

    def released(t, y, g):
        g[0] = equations.compiled_event(y, valves, c)

    released.terminal, released.direction = [True], [1]
    solver = CVODE(
        rates, rtol=rtol, atol=atol, jacfn=jacobian, eventsfn=released, num_events=1, max_num_steps=1_000_000
    )
    while t < duration:
        part = solver.solve(np.append(t, grid[np.searchsorted(grid, t, side="right") :]), y)
        if not part.success:
            raise PeerFailed(f"CVODE at t = {t:g} s: {part.message}")
        rhs += part.nfev
        fired = part.t[-1] < duration
        count = len(part.t) - (1 if fired else 0)
        first = 0 if row == 0 else 1
        log[:, row : row + count - first] = part.y[first:count].T
        row += count - first
        if not fired:
            break
        t, y = float(part.t[-1]), part.y[-1].copy()
        equations.switch(y, valves, c, NEAR)
        events.append(t)
    return PeerRun(grid, log, np.array(events), rhs, time.perf_counter() - begin)
