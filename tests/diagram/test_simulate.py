"""What may be asked of ``simulate``: numbers of every kind, some signals, systems that stand alone; the refusals."""

import math
import pickle
import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from stickslip.blocks import PI, Constant, FirstOrder, Gain, Integrator, Noise, Sine, Step
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.recorded import Recorded
from stickslip.diagram import WiringError, simulate, wire
from stickslip.diagram.coarse import ToleranceWarning
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.reference import simulate_reference
from stickslip.engine.entry import advance_to
from stickslip.plant.loops import self_regulating_loop


def _lotka_out(t, x, d, u, p, y):
    y[0] = x[0]
    y[1] = x[1]


def _lotka_der(t, x, d, u, p, dx):
    dx[0] = x[0] * (p[0] - p[1] * x[1])
    dx[1] = x[1] * (p[1] * x[0] - p[0])


class LotkaVolterra(Block):
    """Prey and predators: x' = x (a - b y), y' = y (b x - a); b (x + y) - a ln(x y) never changes."""

    ports_out = (Port("prey"), Port("predators"))
    kernels = Kernels(out=_lotka_out, der=_lotka_der, feeds=False)

    def __init__(self, a=1.0, b=0.5):
        super().__init__(name="lotka", params={"a": a, "b": b}, states={"x": 1.0, "y": 1.0})


def _lorenz_out(t, x, d, u, p, y):
    for i in range(3):
        y[i] = x[i]


def _lorenz_der(t, x, d, u, p, dx):
    dx[0] = p[0] * (x[1] - x[0])
    dx[1] = x[0] * (p[1] - x[2]) - x[1]
    dx[2] = x[0] * x[1] - p[2] * x[2]


class Lorenz(Block):
    """E. N. Lorenz, J. Atmos. Sci. 20 (1963) 130-141."""

    ports_out = (Port("X"), Port("Y"), Port("Z"))
    kernels = Kernels(out=_lorenz_out, der=_lorenz_der, feeds=False)

    def __init__(self, rho):
        super().__init__(
            name="lorenz", params={"sigma": 10.0, "rho": rho, "beta": 8.0 / 3.0}, states={"X": 1.0, "Y": 1.0, "Z": 1.0}
        )


def _halve(t, x, d, u, p, y):
    d[0] *= 0.5
    y[0] = d[0]


class Halving(Block):
    """A sampled system without inputs: halves its memory at every sample."""

    ports_out = (Port("h"),)
    kernels = Kernels(step=_halve, feeds=False)
    period_param = "dt"

    def __init__(self):
        super().__init__(name="halving", params={"dt": 1.0}, memory={"h": 1.0})


# --- systems that stand alone -------------------------------------------------------------------------------------


def test_lotka_and_volterra_keep_their_invariant_and_equal_the_reference():
    alone = wire([LotkaVolterra()])
    run = simulate(alone, 20.0, every=0.5, rtol=1e-10, atol=1e-12)
    x, y = run.log["prey"], run.log["predators"]
    kept = 0.5 * (x + y) - np.log(x * y)
    assert run.ok and np.ptp(x) > 1.0
    assert np.abs(kept - 1.0).max() < 1e-8  # analytic: 0.5 (1 + 1) - ln 1
    assert np.abs(x - simulate_reference(alone, 20.0, every=0.5).log["prey"]).max() < 1e-6


def test_lorenz_comes_to_rest_where_it_should():
    # analytic: for 1 < rho < 24.06 it rests at X = Y = sqrt(beta (rho - 1)), Z = rho - 1
    run = simulate(wire([Lorenz(rho=10.0)]), 60.0, rtol=1e-9)
    end = [abs(run.log[signal][-1]) for signal in ("X", "Y", "Z")]
    assert end == pytest.approx([math.sqrt(24.0), math.sqrt(24.0), 9.0], abs=1e-6)


def test_a_sampled_system_stands_alone_too():
    assert simulate(wire([Halving()]), 3.5, times=[0.5, 1.5, 2.5]).log["h"].tolist() == [0.5, 0.25, 0.125]


@pytest.mark.parametrize("source", [Step("MVV"), Noise("MVV", sd=1.0, dt=1.0), Constant("MVV", 1.0)])
def test_a_source_that_nobody_reads_is_still_refused(source):
    with pytest.raises(WiringError, match="no block reads 'MVV'"):
        wire([source, Step("MV"), FirstOrder(K=1.0, tau=1.0)])


# --- numbers of every kind ----------------------------------------------------------------------------------------

LAG = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
NUMBERS = [10, np.int32(10), np.float32(10.0), np.longdouble(10.0), np.array(10), True + 9]


@pytest.mark.parametrize("ten", NUMBERS, ids=lambda ten: type(ten).__name__)
def test_numbers_of_every_kind_run_on_the_engine_there_is(ten):
    expected = simulate(LAG, 10.0, every=1.0).log["PV"]
    compiled = len(advance_to.signatures)
    one, zero = ten // ten, ten - ten
    runs = [
        simulate(LAG, ten, every=one, t0=zero),
        simulate(LAG, ten, times=np.arange(11).astype(np.asarray(ten).dtype)),
        simulate(LAG, ten, every=one, params={"process.tau": ten / 2}, start={"process.PV": zero}),
        simulate(LAG.without("MV"), ten, every=one, inputs={"MV": one}),
    ]
    for run in runs:
        assert run.log["PV"] == pytest.approx(expected, abs=1e-12)
        assert run.log.t.dtype == np.float64
    spread = ensemble(LAG, ten, params={"process.K": [one, one]}, every=one)
    assert spread.values["PV"][0] == pytest.approx(0.5 * expected, rel=1e-5)
    assert len(advance_to.signatures) == compiled


# --- some signals, and no more than the memory holds --------------------------------------------------------------


def test_only_the_signals_asked_for_are_logged():
    loop = wire([Step("SP", 0.5), PI(0.4, 10.0, outputs="MV"), FirstOrder(3.0, 10.0)])
    whole, some = simulate(loop, 50.0, every=0.3), simulate(loop, 50.0, every=0.3, signals=["PV", "PV", "SP"])
    assert list(some.log.signals) == ["SP", "PV"]
    for signal in ("SP", "PV"):
        assert np.array_equal(some.log[signal], whole.log[signal])
    assert np.array_equal(some.final["process"].x0, whole.final["process"].x0)
    assert list(simulate(loop, 5.0, signals="PV").log.signals) == ["PV"]
    assert some.plot().axes
    with pytest.raises(ValueError, match="no signal 'PVV'; did you mean 'PV'"):
        simulate(loop, 5.0, signals=["PVV"])


@pytest.mark.parametrize("run", [simulate, simulate_reference])
def test_a_log_beyond_the_memory_is_refused_before_anything_runs(run):
    with pytest.raises(ValueError, match=r"2 signals x 10\d+ rows take .* GB, the machine has .* every="):
        run(LAG, 1e6, every=1e-7)
    with pytest.raises(ValueError, match="rows take"):
        run(LAG, 1e15, every=1e-3)


# --- an absolute tolerance that is too large ----------------------------------------------------------------------


def small(K=1e-3):
    return wire([Step("MV", 1.0), FirstOrder(K=K, tau=5.0), Integrator(K=1.0, outputs="V", name="volume")])


def test_an_atol_above_the_signals_is_noted_with_those_it_spoils():
    with pytest.warns(ToleranceWarning, match=r"atol = 0.1 is not small against process \(at most 0.00"):
        run = simulate(small(), 20.0, atol=0.1)
    assert run.ok and "process" in run.notes[0] and "volume" not in run.notes[0]
    advised = float(run.notes[0].split("give atol = ")[1])
    fine = simulate(small(), 20.0, atol=advised)
    exact = 1e-3 * (1.0 - np.exp(-fine.log.t / 5.0))  # analytic
    assert not fine.notes
    assert np.abs(fine.log["PV"] - exact).max() < 1e-6 * 10


def test_an_atol_that_suits_is_not_noted():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert not simulate(small(), 20.0).notes
        still = wire([Constant("MV", 0.0), FirstOrder(K=2.0, tau=5.0)])
        assert not simulate(still, 20.0, atol=1.0).notes  # at rest at 0: nothing to spoil


def test_an_ensemble_warns_too():
    with pytest.warns(ToleranceWarning, match="process"):
        ensemble(small(), 20.0, params={"process.K": [1e-3, 2e-3]}, atol=0.1)


# --- wrong calls --------------------------------------------------------------------------------------------------


def test_events_are_named_when_asked_for_and_in_order_of_time():
    loops = wire([self_regulating_loop(F_s=F_s, name=f"loop{F_s:g}") for F_s in (1750.0, 2250.0)])
    run = simulate(loops, 300.0)
    assert run.statistics.components == 2 and "events" not in vars(run)
    assert len(run.events) == len(run.raw_events) > 10
    assert {e.block for e in run.events} == {"loop1750/valve", "loop2250/valve"}
    assert [e.t for e in run.events] == run.raw_events[:, 0].tolist() == sorted(e.t for e in run.events)


def test_log_times_given_stay_the_callers_own():
    asked = np.array([0.0, 1.0, 2.5])
    run = simulate(wire([Step("SP", 1.0)], outputs=["SP"]), 2.5, times=asked)
    asked[1] = 2.0
    assert run.log.t.tolist() == [0.0, 1.0, 2.5]


@pytest.mark.parametrize("times", [[[0.0, 1.0], [2.0, 3.0]], pd.date_range("2024-05-06", periods=3, freq="1s")])
def test_log_times_that_are_no_row_of_seconds_are_refused(times):
    with pytest.raises(ValueError, match=r"shape \(2, 2\)|begin at 2024-05-06"):
        simulate(wire([Step("MV"), FirstOrder(1.0, 2.0)]), 10.0, times=times)


def test_log_times_may_be_durations():
    run = simulate(wire([Step("MV"), FirstOrder(1.0, 2.0)]), 10.0, times=pd.timedelta_range(0, periods=3, freq="5s"))
    assert run.log.t.tolist() == [0.0, 5.0, 10.0]


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
def test_systems_without_a_state_run_by_every_method(method):
    run = simulate(wire([Sine("SP", 1.0, 8.0), Gain("g", "SP", 2.0)]), 6.0, every=2.0, method=method)
    assert run.ok
    np.testing.assert_allclose(run.log["g"], [0.0, 2.0, 0.0, -2.0], atol=1e-12)  # analytic


def test_what_a_block_is_made_of_cannot_be_written_into():
    """Written in place it would change later runs, while ``params`` says otherwise and no rule is checked."""
    diagram = wire([Step("MV"), FirstOrder(K=3.0, tau=10.0)])
    given = np.array([1.0, 2.0])
    for block in (
        diagram["process"],
        pickle.loads(pickle.dumps(diagram["process"])),
        diagram["process"].with_params(K=2),
    ):
        for array in (block.p, block.x0, block.d0, block.y0):
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 1.0
    source = Recorded("PV", [0.0, 1.0], given)
    given[:] = 9.0  # the caller's own array stays writeable, and the block has its own
    assert float(source.output(1.0, [], [])[0]) == 2.0


def test_a_run_with_one_event_says_so_in_the_singular():
    run = simulate(wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)]), 5.0, every=1.0)
    assert ", 1 event, " in repr(replace(run, raw_events=np.zeros((1, 4))))
    assert ", 2 events, " in repr(replace(run, raw_events=np.zeros((2, 4))))
