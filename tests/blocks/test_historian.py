"""The historian reads and changes nothing."""

import numpy as np
import pytest

from blocks import BlockError, Historian
from diagram import simulate, wire
from plant.loops import self_regulating_loop


def test_it_only_looks_on():
    loop = self_regulating_loop()
    kept = wire([*loop.blocks, Historian(["SP", "PV", "OP"])])
    one, other = simulate(loop, 100.0, every=1.0), simulate(kept, 100.0, every=1.0)
    assert other.ok and one.log.names == other.log.names
    np.testing.assert_array_equal(one.log["PV"], other.log["PV"])


def test_one_of_nothing_is_refused():
    with pytest.raises(BlockError, match="keeps at least one"):
        Historian([])
