"""The ideal loop in PathSim: stuck and slipping as a mode variable switched by its ZeroCrossing events."""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
from pathsim import Connection, Simulation
from pathsim.blocks import ODE, Adder, Amplifier, Constant, Integrator, Scope
from pathsim.events import ZeroCrossingDown, ZeroCrossingUp
from pathsim.solvers import RKCK54
from stickslip.cases.exact import IDEAL_HIGH, ExactLoop

RTOL, ATOL, EVENT_TOLERANCE = 1e-5, 1e-8, 1e-7


class PathSimLog(NamedTuple):
    """Signals at the log times, each of shape (n,), times of the mode changes, and the wall time of the run [s]."""

    t: np.ndarray
    SP: np.ndarray
    PV: np.ndarray
    OP: np.ndarray
    MV: np.ndarray
    v: np.ndarray
    e: np.ndarray
    event_times: np.ndarray
    seconds: float


class _Stem:
    """Mass on a spring with a mode: 0 stuck, +1 or -1 the direction of the slip."""

    def __init__(self, loop: ExactLoop) -> None:
        self.loop = loop
        self.block = ODE(func=self._slope, initial_value=np.array([loop.x_0, 0.0]))
        # PathSim sees crossings only, and the reference step at t = 0 may already lie past the threshold.
        pull = loop.K_p * (loop.SP - loop.PV_0) + loop.z_0 - loop.x_0
        self.mode = int(np.sign(pull)) if abs(pull) > loop.f_s else 0

    def _slope(self, w: np.ndarray, u: np.ndarray, t: float) -> np.ndarray:
        if self.mode == 0:
            return np.zeros(2)
        loop = self.loop
        force = loop.k * (u[0] - w[0]) - self.mode * loop.F_c - loop.F_v * w[1]
        return np.array([w[1], force / loop.M])

    def _pull(self) -> float:
        """Actuator less stem position, OP - x, as a fraction of travel."""
        return float(self.block.inputs[0] - self.block.engine.state[0])

    def breakaway(self, t: float) -> float:
        """Negative while static friction holds; -1 while slipping, so that it cannot fire."""
        return abs(self._pull()) / self.loop.f_s - 1.0 if self.mode == 0 else -1.0

    def reversal(self, t: float) -> float:
        """Velocity in the direction of the slip [1/s]; 1 while stuck, so that it cannot fire."""
        return self.mode * float(self.block.engine.state[1]) if self.mode else 1.0

    def slip(self, t: float) -> None:
        self.mode = 1 if self._pull() > 0.0 else -1

    def stick(self, t: float) -> None:
        self.mode = 0
        self.block.engine.state = np.array([self.block.engine.state[0], 0.0])


def run(
    loop: ExactLoop = IDEAL_HIGH,
    rtol: float = RTOL,
    atol: float = ATOL,
    event_tolerance: float = EVENT_TOLERANCE,
    solver: type = RKCK54,
) -> PathSimLog:
    """Simulate the loop; ``seconds`` is the run without building the diagram.

    ``rtol``, ``atol``: local error of the solver; ``event_tolerance``: on |OP - x| / f_s - 1 and on v [1/s]. Most
    of the time goes into the log: PathSim steps onto every log time. RKCK54 was the best of eight explicit solvers in
    error for the time; RKBS32 is 12 % faster with an error 18 times larger, and still below 1e-6.
    """
    stem = _Stem(loop)
    reference, error = Constant(loop.SP), Adder("+-")
    proportional, integral_gain, integral = Amplifier(loop.K_p), Amplifier(loop.K_i), Integrator(loop.z_0)
    output = Adder("++")
    process = ODE(func=lambda y, u, t: loop.a * y + loop.b * u, initial_value=loop.PV_0)
    scope = Scope(sampling_period=loop.log_interval)
    slips = ZeroCrossingUp(stem.breakaway, stem.slip, tolerance=event_tolerance)
    sticks = ZeroCrossingDown(stem.reversal, stem.stick, tolerance=event_tolerance)
    simulation = Simulation(
        blocks=[reference, error, proportional, integral_gain, integral, output, stem.block, process, scope],
        connections=[
            Connection(reference, error[0], scope[0]),
            Connection(process, error[1], scope[1]),
            Connection(error, proportional, integral_gain),
            Connection(integral_gain, integral),
            Connection(proportional, output[0]),
            Connection(integral, output[1]),
            Connection(output, stem.block, scope[2]),
            Connection(stem.block[0], process, scope[3]),
            Connection(stem.block[1], scope[4]),
        ],
        events=[slips, sticks],
        dt=1e-3,
        Solver=solver,
        tolerance_lte_rel=rtol,
        tolerance_lte_abs=atol,
        log=False,
    )
    start = time.perf_counter()
    simulation.run(loop.duration)
    seconds = time.perf_counter() - start

    t, (SP, PV, OP, MV, v) = scope.read()
    events = np.sort(np.array([*slips, *sticks]))
    return PathSimLog(t, SP, PV, OP, MV, v, SP - PV, events, seconds)
