"""The examples of ``docs/examples.md`` in PathSim: heading -> signal compared, function of the log times."""

import numpy as np
from pathsim import Connection, Simulation
from pathsim.blocks import ODE, Adder, Amplifier, Constant, Delay, Integrator, Scope
from pathsim.events import ZeroCrossingDown
from pathsim.solvers import ESDIRK43, RKCK54

TIGHT = {"tolerance_lte_rel": 1e-8, "tolerance_lte_abs": 1e-10, "log": False}


def logged(scope, t):
    """Return what a scope has seen, at the log times."""
    seen, values = scope.read()
    return np.interp(t, seen, np.atleast_2d(values)[0])


def oscillator(t):
    """Van der Pol, with PathSim's stiff method."""
    block = ODE(lambda x, u, t: np.array([x[1], 1000.0 * (1.0 - x[0] ** 2) * x[1] - x[0]]), np.array([2.0, 0.0]),
                jac=lambda x, u, t: np.array([[0.0, 1.0], [-2000.0 * x[0] * x[1] - 1.0, 1000.0 * (1.0 - x[0] ** 2)]])
                )  # fmt: skip
    scope = Scope(sampling_period=float(t[1] - t[0]))
    simulation = Simulation([block, scope], [Connection(block[0], scope)], dt=0.01, Solver=ESDIRK43, **TIGHT)
    simulation.run(float(t[-1]))
    return logged(scope, t)


def ball(t):
    """Two integrators and an event."""
    gravity, speed, height = Constant(-9.81), Integrator(0.0), Integrator(1.0)
    scope = Scope(sampling_period=float(t[1] - t[0]))

    def bounce(_):
        speed.engine.set(-0.9 * speed.engine.get())
        height.engine.set(np.abs(height.engine.get()))

    event = ZeroCrossingDown(func_evt=lambda _: float(height.engine.get()[0]), func_act=bounce, tolerance=1e-9)
    simulation = Simulation(
        [gravity, speed, height, scope],
        [Connection(gravity, speed), Connection(speed, height), Connection(height, scope)],
        events=[event], dt=0.01, Solver=RKCK54, **TIGHT,
    )  # fmt: skip
    simulation.run(float(t[-1]))
    return logged(scope, t)


def late_loop(t):
    """PI controller, delay and lag; PathSim's delay interpolates what it has stored."""
    reference, error, output = Constant(1.0), Adder("+-"), Adder("++")
    proportional, rate, integral = Amplifier(1.2), Amplifier(0.25), Integrator(0.0)
    late, process = Delay(1.0), ODE(lambda x, u, t: (u - x) / 4.0, 0.0)
    scope = Scope(sampling_period=float(t[1] - t[0]))
    simulation = Simulation(
        [reference, error, proportional, rate, integral, output, late, process, scope],
        [
            Connection(reference, error[0]), Connection(process, error[1], scope), Connection(error, proportional),
            Connection(proportional, output[0], rate), Connection(rate, integral), Connection(integral, output[1]),
            Connection(output, late), Connection(late, process),
        ],
        dt=0.01, Solver=RKCK54, **TIGHT,
    )  # fmt: skip
    simulation.run(float(t[-1]))
    return logged(scope, t)


PEERS = {
    "Van der Pol's oscillator": ("x", oscillator),
    "A bouncing ball": ("height", ball),
    "A PI loop with dead time": ("PV", late_loop),
}
