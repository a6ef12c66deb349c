"""Ensembles: requests that are refused, faults in Python, and variants that fail, each with its name."""

import numpy as np
import pytest
from stickslip.blocks import BlockError, FirstOrder, Gain, Step
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import simulate, wire
from stickslip.diagram.ensembles import ensemble
from stickslip.engine.status import Status
from stickslip.plant.loops import self_regulating_loop

LOOP = self_regulating_loop()


LAG = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)], name="lag")


def same(result, i, run):
    """Tell whether variant i is this run, to the last bit."""
    return all(np.array_equal(result.values[s][i], run.log[s], equal_nan=True) for s in result.values)


def test_a_failed_variant_is_scored_not_raised():
    result = ensemble(
        LOOP,
        600.0,
        params={"SP.after": [0.0, 0.5]},
        every=1.0,
        max_steps=100,
        summary=lambda t, s: {"end": s["PV"][-1]},
    )  # at SP = 0 nothing moves; the other needs more steps than it may take
    assert result.ok.tolist() == [True, False]
    assert Status(int(result.status[1])) is Status.TOO_MANY_STEPS
    assert "max_steps" in result.hint(1) and result.hint(0) == ""
    assert np.isnan(result.summary["end"]).tolist() == [False, True]
    assert np.isnan(result.values["PV"][1][-1]) and not np.isnan(result.values["PV"][1][0])
    assert 0.0 < result.ended[1] < 600.0
    assert "1 OK, 1 TOO_MANY_STEPS" in repr(result)


class Faulty:
    """A block's Python part that fails for K = 2."""

    def init(self, p):
        return 0

    def step(self, t, state, u, p):
        if p[1] == 2.0:
            raise ZeroDivisionError("a fault of the block")
        return state + 1, [u[0]]


class Hosted(Block):
    ports_in = (Port("PV"),)
    ports_out = (Port("seen"),)
    kernels = Kernels(feeds=False)
    period_param = "dt"

    def __init__(self, host):
        self.host = host
        super().__init__(name="watcher", params={"dt": 1.0, "K": 1.0})

    def smooth(self):
        return Gain("seen", "PV", self.p[1], name=self.name)


def test_a_fault_in_python_names_the_variant():
    watched = wire([*LAG.blocks, Hosted(Faulty())], outputs=["seen"])
    fine = ensemble(watched, 10.0, params={"watcher.K": [1.0, 3.0]}, every=1.0)
    assert same(fine, 1, simulate(watched, 10.0, every=1.0))
    with pytest.raises(ZeroDivisionError) as fault:
        ensemble(watched, 10.0, params={"watcher.K": [1.0, 2.0]}, every=1.0)
    assert fault.value.__notes__ == ["variant 1 of the ensemble"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "nothing says how many variants"),
        ({"params": {"process.K": 1.0}}, "nothing says how many variants"),
        ({"params": {"process.K": []}}, "0 variants"),
        ({"params": {"process.K": [1.0, 2.0], "process.tau": [1.0, 2.0, 3.0]}}, "'process.K' 2, 'process.tau' 3"),
        ({"params": {"process.K": [[1.0], [2.0]]}}, "flat array"),
        ({"params": {"proces.K": [1.0]}}, "did you mean 'process'"),
        ({"params": {"process.k": [1.0]}}, "did you mean 'K'"),
        ({"start": {"process.y": [1.0]}}, "no state 'y'"),
        ({"start": {"process.PV": [0.0, np.nan]}}, "'process.PV' is to start at nan in variant 1"),
        ({"seeds": [0.5]}, "integers"),
        ({"seeds": [-1]}, "integers"),
        ({"seeds": [1], "signals": ["pv"]}, "did you mean 'PV'"),
        ({"seeds": [1], "keep_logs": False}, "summary"),
        ({"seeds": [1], "workers": 0}, "workers = 0"),
        ({"seeds": [1], "method": "euler"}, "method"),
        ({"seeds": np.arange(10**6), "every": 1e-4}, "GB"),
    ],
)
def test_senseless_requests_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        ensemble(LAG, 10.0, **arguments)


def test_a_block_refuses_a_variant_before_anything_runs():
    with pytest.raises(BlockError) as refused:
        ensemble(LAG, 10.0, params={"process.tau": [1.0, 2.0, -3.0]})
    assert refused.value.__notes__ == ["variant 2 of the ensemble"]


def test_open_inputs_are_closed_or_refused():
    plant = wire([FirstOrder(K=2.0, tau=5.0)], inputs=["MV"])
    with pytest.raises(ValueError, match="input 'MV' is open"):
        ensemble(plant, 10.0, params={"process.K": [1.0]})
    result = ensemble(plant, 10.0, params={"process.K": [1.0, 2.0]}, inputs={"MV": 1.0})
    assert np.allclose(result.values["PV"][1], 2.0 * result.values["PV"][0], rtol=1e-5)  # linear


def test_a_variant_whose_model_ends_says_why_as_its_run_alone_does():
    from stickslip.plant import production_plant

    plant = production_plant("B")
    result = ensemble(
        plant, 20.0, start={"S1.N_oil": [3.02e5, 9e5]}, params={"F_in.value": [8000.0, 8000.0]}, every=10.0,
        signals=["p_1"], method="stiff",
    )  # fmt: skip
    alone = simulate(plant, 20.0, start={"S1.N_oil": 9e5}, every=10.0, method="stiff")
    assert alone.status is Status.MODEL_ENDED and result.status.tolist() == [Status.OK, Status.MODEL_ENDED]
    assert result.hint(1) == alone.hint
    assert alone.hint.startswith("S1 is full: 119 of")  # analytic: 117.4 m3 of oil, 1.5 of methane
    assert result.hint(0) == ""
