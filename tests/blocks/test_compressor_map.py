"""Compressor maps: the cubic, and head against pressure ratio."""

import numpy as np
import pytest
from stickslip.blocks.compressor_map import CubicMap, cubic, head_for, pressure_ratio


def test_cubic_at_its_marks():
    # analytic: value psi_0 and no slope at q = 0, peak psi_0 + 2 H at q = 2 W_q
    assert cubic(0.0, 0.93, 0.12, 0.28) == pytest.approx(0.93, abs=1e-15)
    assert cubic(0.56, 0.93, 0.12, 0.28) == pytest.approx(1.17, abs=1e-15)
    for q in (0.0, 0.56):
        slope = (cubic(q + 1e-6, 0.93, 0.12, 0.28) - cubic(q - 1e-6, 0.93, 0.12, 0.28)) / 2e-6
        assert abs(slope) < 1e-4
    assert round(cubic(1.0, 0.93, 0.12, 0.28), 3) == 0.493  # plant notes 1.5


def test_surge_line_of_the_cubic_is_its_peak():
    shape = CubicMap()
    q = np.linspace(0.0, 1.0, 2001)
    assert q[np.argmax([shape.psi(v) for v in q])] == pytest.approx(shape.surge(), abs=1e-9)


def test_pressure_ratio():
    c, gamma = 453.43, 1.3067
    assert pressure_ratio(0.0, c, gamma) == 1.0
    h = head_for(3.0, c, gamma)
    # analytic: isentropic work of an ideal gas, R T/W = c^2/gamma
    assert h == pytest.approx(c**2 / gamma * gamma / (gamma - 1) * (3.0 ** ((gamma - 1) / gamma) - 1), rel=1e-14)
    assert pressure_ratio(-1e9, c, gamma) == pytest.approx(0.2 ** (gamma / (gamma - 1)), rel=1e-14)
