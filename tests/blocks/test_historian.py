"""What an archive makes of a signal, and that the loop does not notice."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from blocks import BlockError, Historian
from blocks.role import Role
from diagram import drive, simulate, wire
from plant.loops import self_regulating_loop


@given(st.floats(-1e6, 1e6), st.sampled_from([0.0, 0.001, 0.5, 25.0]))
def test_what_is_kept_is_the_nearest_multiple(value, step):
    kept = float(Historian(1.0, step=step).output(0.0, [], [value])[0])
    assert abs(kept - value) <= 0.5 * step * (1.0 + 1e-9) + 1e-9 * abs(value)  # analytic: half a step
    if step:
        assert kept / step == pytest.approx(round(kept / step), abs=1e-6)


def test_it_keeps_a_sine_on_its_own_times():
    t = np.arange(0.0, 60.5, 0.5)
    PV = np.sin(t / 7.0)
    log = drive(Historian(4.0, step=0.1, offset=1.0, start=-0.3), 60.0, every=0.5, PV=(t, PV)).log
    last = 1.0 + 4.0 * np.floor((t - 1.0) / 4.0)  # the last logged time
    expected = np.where(t < 1.0, -0.3, 0.1 * np.floor(np.interp(last, t, PV) / 0.1 + 0.5))  # analytic
    assert log["PV_logged"] == pytest.approx(expected, abs=1e-9)


def test_the_loop_does_not_notice():
    loop = self_regulating_loop()
    plain = simulate(loop, 300.0, every=1.0, rtol=1e-9)
    logged = simulate(wire([*loop.blocks, Historian(5.0, step=0.05)]), 300.0, every=1.0, rtol=1e-9)
    assert logged.log["PV"] == pytest.approx(plain.log["PV"], abs=1e-6)
    assert logged.log["PV_logged"][::5] == pytest.approx(plain.log["PV"][::5], abs=0.0251)


def test_python_control_sees_the_signal_itself_and_mistakes_are_said():
    historian = Historian(1.0, step=0.1, inputs="OP", outputs="OP_logged", name="OP_historian")
    assert historian.role is Role.HISTORIAN
    assert historian.smooth().output(0.0, [], [0.123]).tolist() == [0.123]
    for wrong, message in (({"dt": 0.0}, "dt = 0.0"), ({"dt": 1.0, "step": -0.1}, "step = -0.1")):
        with pytest.raises(BlockError, match=message):
            Historian(**wrong)
