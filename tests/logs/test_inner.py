"""A function for compiled code only has no door for Python, and says so."""

import numpy as np
import pytest
from stickslip.logs.compiled import njit


@njit(inner=True)
def _twice(x):
    return 2.0 * x


@njit
def _four_times(x):
    return _twice(_twice(x))


def test_compiled_code_calls_it_and_python_is_refused():
    assert _four_times(3.0) == 12.0
    with pytest.raises(TypeError, match="_twice is for compiled code only"):
        _twice(np.float64(3.0))
    assert _twice.py_func(3.0) == 6.0
