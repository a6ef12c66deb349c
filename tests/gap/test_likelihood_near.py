"""Where a model is near its log: scores rank effects, and no stem is searched that does not come near the model."""

import math
from dataclasses import replace

from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.candidates import by_score
from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import fitted, legal, model_alone
from stickslip.gap.likelihood.settling import settled
from stickslip.gap.likelihood.sizes import sizes

from tests.gap import plain_tank
from tests.gap.root_tank import framed, logged, tank


def effect(name: str) -> Effect:
    return next(one for one in CATALOGUE if one.name == name)


def alone(log) -> Fit:
    return settled(model_alone(replace(framed(tank(), log), apart=True)))


def test_an_effect_that_adds_a_state_is_scored_by_a_filter_of_its_own() -> None:
    # gains of the model do not set the state of the lag right: by them it promised nothing
    true = effect("sensor_lag").insert(tank(), "sensor", tau=8.0)
    null = alone(logged(true, 12, duration=3600.0))
    lag = Hypothesis(null.hypothesis.frame, effect("sensor_lag"), "sensor")
    assert not null.best.gross and lag.adds_to(null.hypothesis) and not null.hypothesis.adds_to(lag)
    (found,) = by_score(null, [lag])
    assert found.gain > 10.0
    assert found.direction is None  # gains of its own are no direction that the model's innovations could lie in


def test_an_effect_with_a_filter_of_its_own_promises_what_that_filter_gains() -> None:
    # what the noise and the load of the model have taken in its place, its score leaves out: 9 nats of 157
    record, wired = plain_tank.logged("setpoint_filter", 8.0, duration=3600.0), plain_tank.model()
    null = settled(model_alone(replace(framed(wired, record), apart=True)))
    (found,) = by_score(null, [Hypothesis(null.best.hypothesis.frame, effect("dead_time"), "tank")])
    own = found.hypothesis.filtered(found.values)
    assert null.nll - own.nll > 100.0
    assert found.gain >= null.nll - own.nll


def test_a_slower_scan_of_a_loop_that_bends_is_looked_for_at_a_few_instants() -> None:
    wired = tank()
    null = alone(logged(wired, 15, duration=1200.0))
    scans = sizes(null, Hypothesis(null.best.hypothesis.frame, effect("scan_time"), "controller"))
    assert null.best.gains is not None  # no linear filter follows it
    assert 0 < len(scans) < 150


def test_a_stem_is_fitted_only_where_its_first_sizes_come_near_enough() -> None:
    null = alone(logged(tank(), 13, duration=2400.0))
    stems = [c for c in by_score(null, legal(null, [effect("deadband")])) if c.hypothesis.hides]
    assert stems
    assert fitted(null, stems, raced=False, within=-math.inf) == []
    assert fitted(null, stems, raced=False) == []  # no play shows beside a stem that goes where OP sends it
    played = effect("deadband").insert(tank(), "valve", width=6.0)
    other = alone(logged(played, 13, duration=2400.0))
    found = [c for c in by_score(other, legal(other, [effect("deadband")])) if c.hypothesis.hides]
    (fit,) = fitted(other, found, raced=False)
    assert fit.nll < other.nll - 10.0


def test_a_frame_keeps_what_does_not_depend_on_switches() -> None:
    frame = framed(tank(), logged(tank(), 14, duration=1200.0))
    played, rows = frame.sources["SP"], frame.Y
    other = frame.switching({"SP": {int(k): 2.0 for k in (35,)}})
    assert other.Y is rows and other.free is frame.free
    assert other.sources["SP"] is not played
