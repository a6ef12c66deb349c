"""Diagrams, blocks and runs go through pickle and through every way of starting a process, equal to the last bit."""

import copy
import multiprocessing
import os
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from stickslip.diagram import ensemble, simulate
from stickslip.plant import production_plant
from stickslip.plant.loops import self_regulating_loop

from tests.diagram.random_diagrams import random_diagram

N = int(os.environ.get("STICKSLIP_PICKLED", "12"))  # diagrams per start method; 200 were run once
ASKED = {"every": 0.13}


def same(one, two):
    """Compare two runs to the last bit, NaN included."""
    assert one.status is two.status and one.events == two.events and one.statistics == two.statistics
    assert one.log.names == two.log.names
    for signal in one.log.names:
        assert one.log[signal].tobytes() == two.log[signal].tobytes(), signal
    for here, there in zip(one.final.blocks, two.final.blocks, strict=True):
        assert here.x0.tobytes() == there.x0.tobytes() and here.d0.tobytes() == there.d0.tobytes()


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_random_diagrams_give_the_same_in_another_process(method):
    diagrams = [random_diagram(seed) for seed in range(N)]
    finals = []
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context(method)) as other:
        there = [other.submit(simulate, diagram, 10.0, **ASKED) for diagram in diagrams]  # never laid out here
        for diagram, run in zip(diagrams, there, strict=True):
            here = simulate(diagram, 10.0, **ASKED)
            same(here, run.result())
            finals.append((here.final, run.result().final))
        later = [other.submit(simulate, final, 5.0, t0=10.0, **ASKED) for final, _ in finals]  # laid out here before
        for (final, back), run in zip(finals, later, strict=True):
            same(simulate(final, 5.0, t0=10.0, **ASKED), run.result())
            same(simulate(back, 5.0, t0=10.0, **ASKED), run.result())  # went there and came back


def test_nothing_pickled_holds_an_address_of_compiled_code():
    run = simulate(self_regulating_loop(F_s=1750.0), 5.0)
    addresses = {int(a) for component, I, _ in run.ends for a in I if a > 2**32}
    assert addresses  # there are some to look for
    for value in (run, run.final, run.diagram, run.diagram.with_params({"valve.F_s": 2000.0})):
        content = pickle.dumps(value)
        assert not any(address.to_bytes(8, "little") in content for address in addresses)


def test_every_block_of_the_plant_and_the_plant_itself():
    plant = production_plant(F_s="high")
    for block in plant.blocks:
        back = pickle.loads(pickle.dumps(block))
        assert type(back) is type(block) and back.p.tobytes() == block.p.tobytes() and back.params == block.params
    back = pickle.loads(pickle.dumps(plant))
    assert back.signals == plant.signals and back.params == plant.params
    same(simulate(plant, 2.0, every=0.1, method="stiff"), simulate(back, 2.0, every=0.1, method="stiff"))


def test_an_ensemble_comes_back_as_it_went():
    many = ensemble(self_regulating_loop(), 20.0, params={"valve.F_s": [1750.0, 2250.0]}, every=1.0)
    back = pickle.loads(pickle.dumps(many))
    assert all(back.values[s].tobytes() == many.values[s].tobytes() for s in many.values)
    assert not back.values["PV"].flags.writeable and not back.t.flags.writeable
    same(back.run(1), many.run(1))


def test_a_run_comes_back_whole():
    run = simulate(self_regulating_loop(), 20.0)
    back = pickle.loads(pickle.dumps(run))
    same(run, back)
    same(run, pickle.loads(pickle.dumps(back)))
    assert back.log.units == run.log.units and back.log.spans == run.log.spans
    with pytest.raises(TypeError):
        back.log.signals["PV"] = np.zeros(1)  # still read-only
    with pytest.raises(ValueError):
        back.log["PV"][0] = 1.0


def test_a_copy_stands_on_its_own_and_a_changed_copy_shares_the_plan():
    loop = self_regulating_loop()
    laid = loop.plan()
    assert loop.with_params({"valve.F_s": 1750.0}).plan() is laid  # so that sweeps cost nothing
    other = copy.deepcopy(loop)
    assert other.updfcn.__self__ is other  # python-control's own copy would have called the original
    same(simulate(loop, 5.0), simulate(other, 5.0))
