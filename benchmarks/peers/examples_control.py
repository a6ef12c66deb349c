"""The examples of ``docs/examples.md`` in python-control: heading -> signal compared, function of the log times.

Steps and waves stand inside the equations, because python-control joins the samples of an input by straight lines.
"""

import math

import control as ct
import numpy as np

TIGHT = {"rtol": 1e-8, "atol": 1e-11, "max_step": 0.1}


def respond(system, t, start, **changes):
    """Return the first output of an autonomous system at the times ``t``."""
    given = {"solve_ivp_method": changes.pop("method", "RK45"), "solve_ivp_kwargs": {**TIGHT, **changes}}
    return ct.input_output_response(system, t, 0, start, **given).outputs.reshape(-1, len(t))[0]


def alone(update, states, out=None):
    """Return a system without inputs that matter."""
    return ct.nlsys(update, out or (lambda t, x, u, params: x[0]), inputs=1, outputs=1, states=states)


def cruise(t):
    """Car and controller as two systems, joined."""

    def car(t, x, u, params):
        v, throttle, slope = x[0], u[0], math.radians(4.0) if t >= 5.0 else 0.0
        torque = 190.0 * (1.0 - 0.4 * (12.0 * v / 420.0 - 1.0) ** 2)
        drag = 0.5 * 1.3 * 0.32 * 2.4 * v * v
        return [(12.0 * throttle * torque - 1600.0 * 9.8 * (0.01 + math.sin(slope)) - drag) / 1600.0]

    vehicle = ct.nlsys(car, None, inputs=["throttle"], outputs=["v"], states=["v"], name="car")
    controller = ct.nlsys(
        lambda t, x, u, params: [0.1 * (20.0 - u[0])], lambda t, x, u, params: [0.5 * (20.0 - u[0]) + x[0]],
        inputs=["v"], outputs=["throttle"], states=1, name="controller",
    )  # fmt: skip
    loop = ct.interconnect([vehicle, controller], inputs=[], outputs=["v"])
    return respond(loop, t, [20.0, 0.1687])


def steering(t):
    """The closed loop by matrices."""
    A, B, K = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.5], [1.0]]), np.array([[0.49, 0.745]])
    return ct.step_response(ct.ss(A - B @ K, 0.49 * B, [[1.0, 0.0]], 0.0), t).outputs


def hares(t):
    """Predator and prey."""

    def rate(t, x, u, params):
        eaten = 3.2 * x[0] * x[1] / (50.0 + x[0])
        return [1.6 * x[0] * (1.0 - x[0] / 125.0) - eaten, 0.6 * eaten - 0.56 * x[1]]

    return respond(alone(rate, 2), t, [20.0, 30.0])


def double_integrator(t):
    """The closed loop of a mass and a lead compensator."""
    mass = ct.ss([[0, 1], [0, 0]], [[0], [1]], [[1, 0]], [[0]])
    loop = ct.feedback(mass, ct.ss(ct.tf([6, 2], [1, 4])))
    return ct.initial_response(loop, t, [1.0, 0.0, 0.0]).outputs


def plane(t):
    """The kinematic car; compared in y."""

    def rate(t, x, u, params):
        delta = 0.1 * math.sin(2.0 * math.pi * t / 4.0)
        return [math.cos(x[2]) * 10.0, math.sin(x[2]) * 10.0, 10.0 / 3.0 * math.tan(delta)]

    return respond(alone(rate, 3, lambda t, x, u, params: x[1]), t, [0.0, -2.0, 0.0])


def pendulum(t):
    """Rod and hand."""

    def rate(t, x, u, params):
        return [x[1], math.sin(x[0]) - 0.1 * x[1] + (-3.0 * x[0] - 2.0 * x[1]) * math.cos(x[0])]

    return respond(alone(rate, 2), t, [0.3, 0.0])


def ladder(t):
    """The ladder on a square wave, from its exact step response."""
    step = ct.step_response(ct.tf([1], [1, 3, 1]), t).outputs
    y, sign = step.copy(), -2.0
    for k in range(100, len(t), 100):  # the wave changes its sign every 10 s, that is, every 100 rows
        y[k:] += sign * step[:-k]
        sign = -sign
    return y


def oscillator(t):
    """Van der Pol, with the stiff method that python-control can be asked to take."""

    def rate(t, x, u, params):
        return [x[1], 1000.0 * (1.0 - x[0] ** 2) * x[1] - x[0]]

    return respond(alone(rate, 2), t, [2.0, 0.0], method="Radau", max_step=np.inf)


PEERS = {
    "Cruise control": ("v", cruise),
    "Steering, linearised": ("offset", steering),
    "Hares and lynxes": ("H", hares),
    "A double integrator": ("y", double_integrator),
    "A car on a plane": ("y", plane),
    "An inverted pendulum": ("angle", pendulum),
    "An RC ladder": ("V_C", ladder),
    "Van der Pol's oscillator": ("x", oscillator),
}
