"""Convergence orders of the three methods and of their dense output, measured at fixed steps."""

import math

import numpy as np
import pytest
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import wire
from stickslip.engine import layout as at
from stickslip.engine.run import Settings, prepare, run
from stickslip.engine.status import Status


def _der(t, x, d, u, p, dx):
    dx[0] = -0.5 * x[0] * x[0] * x[0]
    dx[1] = x[1] * math.cos(t)


def _out(t, x, d, u, p, y):
    y[0] = x[0]
    y[1] = x[1]


def _limit(t, x, d, u, p, out):
    out[0] = math.inf
    out[1] = p[0]


class Smooth(Block):
    """x' = -x^3/2 and y' = y cos t, with x = 1/sqrt(1 + t), y = exp(sin t)."""

    ports_out = (Port("x"), Port("y"))
    kernels = Kernels(out=_out, der=_der, next_time=_limit, feeds=False, timed=True)

    def __init__(self, h):
        super().__init__(name="smooth", params={"h": h}, states={"x": 1.0, "y": 1.0})


def _stiff_der(t, x, d, u, p, dx):
    dx[0] = -1000.0 * (x[0] - math.sin(t)) + math.cos(t)
    dx[1] = -1000.0 * (x[1] - math.cos(t)) - math.sin(t)


class Stiff(Block):
    """Prothero and Robinson's problem: x = sin t and y = cos t, held there by a stiff spring."""

    ports_out = (Port("x"), Port("y"))
    kernels = Kernels(out=_out, der=_stiff_der, next_time=_limit, feeds=False, timed=True)

    def __init__(self, h):
        super().__init__(name="stiff", params={"h": h}, states={"x": 0.0, "y": 1.0})


def run_with_steps(block, method, h, t_end):
    """Return the log times and the states of fixed steps ``h``."""
    diagram = wire([block], outputs=["x", "y"])
    component = diagram.plan().components[0]
    I, W = prepare(component, Settings(1e-2, 1e30, "stiff" if method == 1 else "explicit"), 0.0)
    I[at.EXPLICIT] = I[at.OTHERWISE] = method
    W[I[at.O_RESTART] : I[at.O_RESTART] + at.RESTARTS] = h
    times = np.concatenate([np.linspace(0.0, t_end, 203)[1:-1], [t_end]])
    outcome = run(component, diagram.plan().flat, I, W, times, t_end)
    assert outcome.status is Status.OK
    assert abs(I[at.STEPS] - t_end / h) <= 2  # the steps are what they should be
    return times, outcome.log


def errors(method, h, t_end=2.0):
    """Return (error at the end, largest error between the steps) of fixed steps ``h``."""
    times, found = run_with_steps(Smooth(h), method, h, t_end)
    exact = np.array([1.0 / np.sqrt(1.0 + times), np.exp(np.sin(times))])  # analytic
    error = np.abs(found - exact).max(axis=0)
    return error[-1], error.max()


@pytest.mark.parametrize(
    ("method", "steps", "order", "dense"),
    [
        (0, (1 / 8, 1 / 16, 1 / 32), 5, 5),  # Dormand-Prince 5(4), interpolant of degree 4
        (1, (1 / 8, 1 / 16, 1 / 32), 5, 5),  # Rosenbrock, interpolant of degree 4
        (2, (1 / 3, 1 / 4, 1 / 5, 1 / 8), 8, 7),  # Dormand-Prince 8(5,3), interpolant of degree 7
    ],
    ids=["explicit", "stiff", "high-order"],
)
def test_orders(method, steps, order, dense):
    # published: Hairer, Norsett & Wanner, Solving ODEs I, tables II.5.2, II.5.3, section II.6; Steinebach, BIT 63:27
    measured = np.array([errors(method, h) for h in steps])
    slope = np.polyfit(np.log(steps), np.log(measured), 1)[0]
    assert order - 0.25 < slope[0] < order + 0.5
    assert dense - 0.25 < slope[1] < dense + 1.0


def test_stiff_method_keeps_its_order_behind_a_smooth_input():
    # Prothero & Robinson 1974; many Rosenbrock methods fall back to order 1 here. Published for Rodas5P: order 4
    def error(h):
        times, found = run_with_steps(Stiff(h), 1, h, 2.0)
        exact = np.array([np.sin(times), np.cos(times)])  # analytic
        return np.abs(found - exact).max()

    steps = (1 / 8, 1 / 16, 1 / 32)
    assert np.polyfit(np.log(steps), np.log([error(h) for h in steps]), 1)[0] > 3.25
