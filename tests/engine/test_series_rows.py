"""Log rows inside a step of a series, where signals have series of their own: as right as block by block, and cheap."""

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, Gain, QuasiStaticStem, Ramp, Sensor, Step, StickSlip, Sum
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import simulate, wire
from stickslip.engine import layout as at

SHARP = {"rtol": 1e-10, "atol": 1e-12}


def loop(valve):
    """Return a loop with signals that follow one state, several, the time, and none."""
    return wire(
        [
            Step("SP", 0.5, at=2.0), Ramp("drift", 1e-4), PI(0.4, 10.0, inputs={"PV": "PV_m"}), valve,
            FirstOrder(3.0, 10.0), Sum("seen", {"PV": 1.0, "drift": -2.0}), Sensor(inputs="seen", outputs="PV_m"),
            Gain("percent", "seen", 100.0),
        ],
        outputs=["percent"],
    )  # fmt: skip


@pytest.mark.parametrize("valve", [QuasiStaticStem(0.06, 0.02), StickSlip.high()], ids=["massless", "mass"])
def test_rows_are_those_of_the_blocks(valve):
    """Rows far apart are computed block by block, many in a step from series; other methods know no series."""
    diagram = loop(valve)
    assert diagram.plan().components[0].I[at.AFFINE] == 1
    many = simulate(diagram, 300.0, every=0.01, **SHARP).log
    apart = simulate(diagram, 300.0, every=50.0, **SHARP).log
    theirs = simulate(diagram, 300.0, every=0.01, method="explicit", **SHARP).log
    for signal in many.names:
        np.testing.assert_allclose(many[signal][::5000], apart[signal], rtol=1e-12, atol=1e-13, err_msg=signal)
        slips = np.abs(many[signal] - theirs[signal]) > 1e-7 * (1.0 + np.abs(theirs[signal]).max())
        assert slips.mean() < 1e-4, signal  # at most the row beside a slip
    np.testing.assert_allclose(many["percent"], 100.0 * (many["PV"] - 2.0 * many["drift"]), atol=1e-9)  # analytic
    assert np.array_equal(many["SP"], np.where(many.t < 2.0, 0.0, 0.5))


def _watch_out(t, x, d, u, p, y):
    y[0] = 2.0 * u[0]


_watch_out.may_run_in_python = "the test counts its calls"


class Watched(Block):
    """A gain of two that counts how often it is asked."""

    ports_in, ports_out = (Port("in"),), (Port("out"),)
    kernels = Kernels(out=_watch_out, linear=True)

    def __init__(self):
        super().__init__(name="watched", params={}, inputs="PV", outputs="twice")


def test_a_row_more_is_no_sweep_more():
    diagram = wire([Step("MV", 1.0), FirstOrder(2.0, 5.0), Watched()], outputs=["twice"])
    run = simulate(diagram, 50.0, every=0.01)
    np.testing.assert_allclose(run.log["twice"], 2.0 * run.log["PV"], rtol=1e-13)  # analytic
    assert run.in_python[0].calls < 10 * run.statistics.steps + 20 < 400 < len(run.log)


def _kinked_out(t, x, d, u, p, y):
    y[0] = u[0] if u[0] < 5.0 else 5.0 + 0.5 * (u[0] - 5.0)


class Kinked(Block):
    """A block that says that it is linear, and is where it is tried, but not beyond 5."""

    ports_in, ports_out = (Port("in"),), (Port("out"),)
    kernels = Kernels(out=_kinked_out, linear=True)

    def __init__(self):
        super().__init__(name="kinked", params={}, inputs="PV", outputs="bent")


def test_a_block_that_is_less_linear_than_it_says_is_logged_all_the_same():
    diagram = wire([Step("MV", 4.0), FirstOrder(2.0, 5.0), Kinked()], outputs=["bent"])
    assert diagram.plan().components[0].I[at.AFFINE] == 1
    log = simulate(diagram, 4.9, every=0.01).log
    PV = 8.0 * (1.0 - np.exp(-log.t / 5.0))  # analytic; it passes 5 at 4.904 s
    np.testing.assert_allclose(log["bent"], PV, atol=1e-5)
    log = simulate(diagram, 50.0, every=0.01).log
    assert log["PV"][-1] > 7.9
    np.testing.assert_allclose(log["bent"][-1], 5.0 + 0.5 * (log["PV"][-1] - 5.0), rtol=1e-12)
    crossing = np.flatnonzero(log["PV"] > 5.0)[0]
    np.testing.assert_allclose(log["bent"][crossing:], 5.0 + 0.5 * (log["PV"][crossing:] - 5.0), rtol=1e-9)
