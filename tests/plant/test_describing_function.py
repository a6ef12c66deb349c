"""Limit cycles against describing functions, computed here from the play's own response to a sine.

Level loop with a deadband only (F_s = F_c): PI and an integrator; harmonic balance L(i w) N(A) = -1.  The level sees
a sine of OP only roughly: harmonic balance gives the amplitude to a few per cent, but 531 s instead of 925 for the
period, which therefore comes from the loop stepped by hand.
"""

import numpy as np
import pytest
from scipy.optimize import fsolve
from stickslip.diagram import simulate
from stickslip.plant import SETS, kicked, production_plant, steady_state

from tests.plant.oscillation import period_and_amplitude

F_C, K_STEM = 1250.0, 52500.0
K_P, T_I = 0.1, 200.0  # published: table 5.1


def play_gain(A, half, n=20_000):
    """Return the first harmonic of a play of half width ``half`` over that of the sine of amplitude ``A`` it sees."""
    phase = np.linspace(0.0, 4.0 * np.pi, 2 * n, endpoint=False)
    u = A * np.sin(phase)
    x, out = 0.0, np.empty_like(u)
    for i, value in enumerate(u):
        x = min(max(x, value - half), value + half)
        out[i] = x
    late = slice(n, None)
    return 2.0j * np.mean(out[late] * np.exp(-1.0j * phase[late])) / A


def flow_gain(rest):
    """Return what full travel of VLCS1 draws of liquid volume [m3/s]."""
    z = rest.S1.z
    volume = (1.0 - z) * 0.086 / 659.0 + z * 0.016 / 422.0
    return 6.1 * np.sqrt(18e5) * volume


def predicted(rest):
    """Return period [s] and amplitude of the level [m3] by harmonic balance."""
    g, half = flow_gain(rest), F_C / K_STEM

    def balance(v):
        w, A = np.exp(v)
        controller = K_P * (1.0 + 1.0 / (1.0j * w * T_I))
        value = controller * g / (1.0j * w) * play_gain(A, half) + 1.0
        return [value.real, value.imag]

    w, A = np.exp(fsolve(balance, np.log([2.0 * np.pi / 500.0, 0.03]), xtol=1e-8))
    return 2.0 * np.pi / w, A / abs(K_P * (1.0 + 1.0 / (1.0j * w * T_I)))


def test_gain_of_the_play():
    """Analytic: no play passes everything, amplitude equal to half the width nothing."""
    assert play_gain(1.0, 0.0) == pytest.approx(1.0, abs=1e-6)
    assert abs(play_gain(1.0, 0.999)) < 2e-3
    # analytic: N_p = (pi/2 + asin k + k cos(asin k))/pi with k = 1 - 2 half/A, -N_q = (1 - k^2)/pi
    k = 1.0 - 2.0 * 0.4
    real = (0.5 * np.pi + np.arcsin(k) + k * np.cos(np.arcsin(k))) / np.pi
    assert play_gain(1.0, 0.4) == pytest.approx(real - 1.0j * (1.0 - k * k) / np.pi, abs=1e-3)


def stepped(rest, dt=0.05, duration=12_000.0):
    """Return period and amplitude of PI, play and integrator alone, by small Euler steps."""
    g, half = flow_gain(rest), F_C / K_STEM
    V, z, x, levels = 0.5, 0.0, 0.0, []
    for _ in range(int(duration / dt)):
        V -= dt * g * x
        z += dt * K_P / T_I * V
        x = min(max(x, K_P * V + z - half), K_P * V + z + half)
        levels.append(V)
    late = np.array(levels[len(levels) // 2 :])
    return period_and_amplitude(dt * np.arange(len(late)), late)


@pytest.mark.parametrize("name", ["A", "B", "C"])  # with the design feed of the notes
def test_deadband_alone_cycles_the_level(name):
    rest = steady_state(SETS[name])
    T_balance, A_balance = predicted(rest)
    assert (T_balance, A_balance) == pytest.approx((500.0, 0.24), rel=0.1)  # notes, section 5.9
    plant = kicked(production_plant(name, sticky=("VLCS1",), F_s="none"))
    run = simulate(plant, 8000.0, every=1.0, method="stiff")
    late = run.log.t >= 4000.0
    T, A = period_and_amplitude(run.log.t[late], run.log["V_1"][late])
    assert pytest.approx(A_balance, rel=0.05) == A  # analytic
    assert pytest.approx(stepped(rest), rel=0.02) == (T, A)  # the loop alone, another program
