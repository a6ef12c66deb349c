"""Compressor: map, torque, surge against an independent integration, tabulated map compiled and interpreted."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from stickslip.blocks.compressor import Compressor
from stickslip.blocks.compressor_map import CubicMap
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.plenum import Plenum
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Constant
from stickslip.blocks.tabulated_map import TabulatedMap
from stickslip.diagram import drive, simulate, wire

W_D = 994.838


def made_up_map():
    V = np.linspace(0.56, 1.2, 9)
    curves = {s: (s * V, s**2 * (1.17 - 0.9 * (V - 0.56) ** 1.6)) for s in (0.8, 1.0, 1.1)}
    eta = {s: (s * V, 0.8 - 0.3 * (V - 0.8) ** 2) for s in (0.8, 1.0, 1.1)}
    return TabulatedMap.from_curves(curves, eta, speed=1.0, flow=1.0, head_at=1.0)


def test_ratio_torque_and_corrected_flow():
    C = Compressor(start=47.05)
    w = 0.97 * W_D
    m, tau, q, q_s = C.output(0.0, C.x0, [22.1e5, 75e5, w])
    assert m == 47.05 and q_s == 0.56
    assert q == pytest.approx(47.05 * 29.7 / 22.1 / 76.0 / 0.97, rel=1e-12)  # analytic
    assert tau == pytest.approx(47.05 * 235590.0 / 0.78 * w / W_D**2, rel=1e-12)  # plant notes 1.5, Euler work
    psi = 0.93 + 0.12 * (1 + 1.5 * (q / 0.28 - 1) - 0.5 * (q / 0.28 - 1) ** 3)
    head = 235590.0 * 0.97**2 * psi
    ratio = (1 + head / (453.43**2 / 0.3067)) ** (1.3067 / 0.3067)
    assert C.dynamics(0.0, C.x0, [22.1e5, 75e5, w])[0] == pytest.approx(
        0.00956 / 1.8 * (ratio * 22.1e5 - 75e5), rel=1e-9
    )


def test_reverse_flow_loads_the_shaft_and_pushes_forward():
    C = Compressor(start=-5.0)
    assert C.output(0.0, C.x0, [22.1e5, 60e5, W_D])[1] > 0.0
    still = C.dynamics(0.0, [0.0], [22.1e5, 60e5, W_D])[0]
    assert C.dynamics(0.0, C.x0, [22.1e5, 60e5, W_D])[0] > still


def test_zero_signals_do_no_harm():
    """Python-control first evaluates a diagram with every signal at zero."""
    C = Compressor(start=47.05)
    assert np.all(np.isfinite(C.output(0.0, C.x0, [0.0, 0.0, 0.0])))
    assert np.all(np.isfinite(Compressor(made_up_map(), start=47.0).output(0.0, C.x0, [0.0, 0.0, 0.0])))


def rig(K, shape=None):
    """Return a compressor between a plenum fed from constant pressure and one throttled to atmosphere."""
    return wire(
        [
            Constant("p_0", 22.5e5, unit="Pa"),
            Constant("p_away", 20e5, unit="Pa"),
            Constant("w", W_D, unit="rad/s"),
            FlowResistance(0.3, inputs=["p_0", "p_in"], outputs="m_in", name="inlet_pipe"),
            Plenum(start=22e5, outflows=["m"], name="inlet", outputs="p_in"),
            Compressor(shape, start=45.0),
            Plenum(start=75e5, inflows=["m"], name="outlet", outputs="p_out"),
            FlowResistance(K, inputs=["p_out", "p_away"], outputs="m_out", name="throttle"),
        ]
    )


def peer(K, t_end, times):
    """Integrate the rig in plain numpy."""
    c2, A_L = 453.43**2, 0.00956 / 1.8

    def root(d):
        return d / (d * d + 1e4) ** 0.25

    def f(t, y):
        p_in, m, p_out = y
        q = m * 29.7e5 / p_in / 76.0
        s = q / 0.28
        psi = 0.93 + (0.24 * s * s if s < 0 else 0.12 * (1 + 1.5 * (s - 1) - 0.5 * (s - 1) ** 3))
        ratio = max(0.2, 1 + 235590.0 * psi / (c2 / 0.3067)) ** (1.3067 / 0.3067)
        m_in, m_out = 0.3 * root(22.5e5 - p_in), K * root(p_out - 20e5)
        return [(m_in - m) * c2 / 0.6, A_L * (ratio * p_in - p_out), (m - m_out) * c2 / 0.6]

    return solve_ivp(f, (0, t_end), [22e5, 45.0, 75e5], "LSODA", times, rtol=1e-10, atol=1e-6).y


@pytest.mark.parametrize(("K", "surges"), [(0.02, False), (0.009, True)])
def test_surge_cycle_agrees_with_an_independent_integration(K, surges):
    times = np.linspace(0.0, 2.0, 401)
    run = simulate(rig(K), 2.0, times=times, rtol=1e-9)
    expected = peer(K, 2.0, times)
    for row, signal in zip(expected, ("p_in", "m", "p_out"), strict=True):
        scale = np.abs(row).max()
        np.testing.assert_allclose(run.log[signal] / scale, row / scale, rtol=0, atol=1e-4)
    assert (run.log["m"][200:].min() < -1.0) == surges  # throttled far enough, the flow reverses in every cycle
    assert (run.log["m"][200:].max() - run.log["m"][200:].min() > 20.0) == surges


@pytest.mark.parametrize("K", [0.02, 0.009])
def test_tabulated_map_runs_compiled_as_interpreted(K):
    shape = made_up_map()
    C = Compressor(shape, start=45.0)
    for m, w in ((45.0, W_D), (20.0, 0.9 * W_D), (-3.0, 1.05 * W_D), (70.0, 0.7 * W_D)):
        run = drive(C.starting_at(m=m), 1e-9, every=1e-9, p_in=22e5, p_out=75e5, w=w)
        interpreted = C.output(0.0, [m], [22e5, 75e5, w])
        for value, signal in zip(interpreted, ("m", "tau", "q", "q_s"), strict=True):
            assert run.log[signal][0] == pytest.approx(value, rel=1e-12)
        n, q = w / W_D, interpreted[2]
        assert interpreted[1] == pytest.approx(abs(m) * 235590.0 * n**2 * shape.work(q, n) / w, rel=1e-12)  # e m / w
    run = simulate(rig(K, shape), 2.0, every=0.01)
    assert run.ok
    assert (run.log["m"][100:].min() < 0.0) == (K < 0.015)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"gamma = 0.9, but a heat capacity ratio exceeds 1"):
        Compressor(start=40.0, gamma=0.9)
    with pytest.raises(BlockError, match=r"m_d = 0.0, but it must be positive and finite"):
        Compressor(start=40.0, m_d=0.0)
    with pytest.raises(BlockError, match=r"eta = 78.0, but it is a fraction; divide percent by 100"):
        Compressor(CubicMap(eta=78.0), start=40.0)
    with pytest.raises(BlockError, match=r"valley = 3.0, but it is a fraction"):
        Compressor(made_up_map(), start=40.0).with_params(valley=3.0)
    with pytest.raises(BlockError, match=r"m = nan, but it must start at a finite number"):
        Compressor(start=float("nan"))
    with pytest.raises(BlockError, match=r"points = 5, but the table has that size"):
        Compressor(made_up_map(), start=40.0).with_params(points=5)
