"""The archive of a loop: it reads, gives nothing, and the loop does not notice."""

import numpy as np
import pytest
from stickslip.blocks import BlockError, Historian
from stickslip.blocks.dry_run import dry_run
from stickslip.diagram import simulate, wire
from stickslip.plant.loops import self_regulating_loop


def test_it_reads_and_gives_nothing():
    historian = Historian(["SP", "PV", "OP"])
    dry_run(historian)
    assert (historian.role, historian.name) == ("historian", "historian")
    assert (historian.input_labels, historian.output_labels) == (["SP", "PV", "OP"], [])
    with pytest.raises(BlockError, match="keeps at least one"):
        Historian([])


def test_the_loop_does_not_notice():
    loop = self_regulating_loop()
    plain = simulate(loop, 300.0, every=1.0)
    logged = simulate(wire([*loop.blocks, Historian(["SP", "PV", "OP"])]), 300.0, every=1.0)
    assert logged.log.names == plain.log.names
    for name in plain.log.names:
        # Nothing is added; rows of a diagram that has one block more may be rounded otherwise.
        assert np.abs(logged.log[name] - plain.log[name]).max() < 1e-13
