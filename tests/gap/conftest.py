"""Records of the ideal flow loop, with and without an effect."""

import numpy as np
import pytest
from stickslip.cases.models import ideal_flow, site_flow
from stickslip.diagram import ensemble
from stickslip.gap.effects import effect
from stickslip.logs import Log

ROWS = 1801  # half an hour, a row a second
START = {"SP": 1.5, "PV": 1.5, "OP": 0.5}


def simulated(model, SP, seed):
    """What the historian of a diagram logs at the set points of a log."""
    run = ensemble(model, SP.duration, times=SP.t, inputs=SP, seeds=[seed], signals=["OP", "PV"], progress=False)
    return Log(SP.t, {"SP": SP["SP"], **{s: run.values[s][0].round(6) for s in ("OP", "PV")}})


@pytest.fixture(scope="session")
def logged():
    """Simulate a diagram at the set points of another log, as its historian would log it."""

    def log(model, plain, seed):
        return simulated(model, Log(plain.t, {"SP": plain["SP"]}), seed)

    return log


@pytest.fixture(scope="session")
def recorded():
    """Simulate the ideal flow loop with an effect as its historian would log it."""

    def record(name="", place="", seed=1, **values):
        t = np.arange(float(ROWS))
        SP = np.repeat(np.random.default_rng(seed).choice([1.2, 1.35, 1.5, 1.65, 1.8], 10), 200)[:ROWS]
        SP[:200] = 1.5
        model = ideal_flow(rest=1.5)
        if name:
            one = effect(name)
            model = one.started(one.insert(model, place, **values), place, {"SP": 1.5, "PV": 1.5, "OP": 0.5})
        return simulated(model, Log(t, {"SP": SP}), seed)

    return record


@pytest.fixture(scope="session")
def with_effects(recorded, logged):
    """Simulate the loop with effects (name, place, values), as its historian would keep it."""

    def log(seed, *effects):
        model = ideal_flow(rest=1.5)
        for name, place, values in effects:
            one = effect(name)
            model = one.started(one.insert(model, place, **values), place, START)
        return logged(model, recorded(seed=seed), seed)

    return log


@pytest.fixture(scope="session")
def site_record():
    """Simulate a loop of a site, by default its flow loop, as its historian would log it, a row every 5 s."""

    def record(
        name="",
        place="",
        seed=2,
        loop=site_flow,
        middle=1.5,
        reach=0.45,
        digit=0.0015,
        stem=False,
        hours=1.25,
        **values,
    ):
        t = np.arange(0.0, 3600.0 * hours + 1.0, 5.0)
        SP = np.repeat(np.random.default_rng(seed).uniform(middle - reach, middle + reach, 29).round(2), 50)[: len(t)]
        SP[:50] = middle
        model = loop(rest=middle)
        if name:
            one = effect(name)
            model = one.started(one.insert(model, place, **values), place, {"SP": middle, "PV": middle, "OP": 0.5})
        steps = {"OP": 0.001, "PV": digit} | ({"MV": 0.001} if stem else {})
        many = ensemble(
            model, t[-1], times=t, inputs=Log(t, {"SP": SP}), seeds=[seed], signals=[*steps], progress=False
        )
        return Log(t, {"SP": SP, **{s: np.round(many.values[s][0] / q) * q for s, q in steps.items()}})

    return record


@pytest.fixture
def without_hints(monkeypatch):
    """Leave out the search for mistakes in the log beside "unknown": it takes as long, and ``test_hints`` tests it."""
    monkeypatch.setattr("stickslip.gap.diagnosis.hints", lambda diagram, log: ())
