"""A filter that lags far behind the likeliest so far is given up; what is near is followed to its end."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.gap.effects import effect
from stickslip.gap.likelihood import framing, phase
from stickslip.gap.likelihood.fit import tried
from stickslip.gap.likelihood.hypothesis import LATE, Hypothesis
from stickslip.gap.likelihood.phase import in_phase
from stickslip.gap.likelihood.stems import Bank
from stickslip.gap.records.model import read

from tests.gap.root_tank import framed, logged, tank


@pytest.fixture(scope="module")
def known():
    return Hypothesis(framed(tank(), logged(tank(), 6))).filtered({})


def test_the_sum_of_losses_at_which_another_is_given_up_is_its_own_and_a_margin(known):
    counted = known.hypothesis.frame.counted
    assert np.isnan(known.bar[~counted]).all() and np.isfinite(known.bar[counted]).all()
    without = np.isnan(known.S) & ~np.isfinite(known.hypothesis.frame.Y)  # rows that have no value
    assert not without.any()
    left = np.nansum(np.minimum(known.e**2, 8.0 * np.abs(known.e)))  # Huber's loss, twice
    assert known.bar[counted][-1] == pytest.approx(known.nll + LATE + 0.01 * left)


def test_what_is_nearly_as_likely_is_followed_to_its_end_and_what_is_hopeless_is_not(known):
    one = Hypothesis(known.hypothesis.frame, effect("valve_gain"), "valve")
    name = one.own[0]
    near, far = one.nominal[name] * 1.01, one.nominal[name] * 1.6
    free = tried(one, {name: near})
    assert free is not None and free.nll < known.nll + LATE
    bound = tried(one, {name: near}, best=known)
    assert bound is not None and bound.nll == free.nll
    hopeless = tried(one, {name: far})
    assert hopeless is not None and hopeless.nll > known.nll + LATE
    assert tried(one, {name: 1.01 * far}, best=known) is None


def test_a_bank_of_stems_is_given_up_as_well(known):
    one = Hypothesis(known.hypothesis.frame, effect("deadband"), "valve")
    assert one.bare is not None and not one.cheap  # its rows are in step with its scans, but the tank is no line
    (name,) = one.own
    bank = Bank(one, dict(one.frame.stated), known.hypothesis.filtered({}, joined=True), 4)
    best = bank.tried({name: 0.1})
    assert best is not None
    assert bank.tried({name: 0.11}) is not None and bank.tried({name: 40.0}) is None


def test_few_phases_of_a_scan_are_followed_in_all_rows(monkeypatch):
    log = logged(tank(), 7, every=7.3, duration=10800.0)
    late = Hypothesis(framed(tank(), replace(log, t=log.t + 1.0))).filtered({})
    asked = []

    def followed(one, values):
        asked.append(len(one.frame.record.log))
        return tried(one, values)

    monkeypatch.setattr(phase, "tried", followed)
    found = in_phase(late)
    assert found.nll < late.nll - phase.CLEAR
    assert found.hypothesis.frame.record.log.t[0] % 2.0 == pytest.approx(0.0, abs=0.3)
    assert sum(rows == len(log) for rows in asked) <= 3


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_start_from_which_no_run_ends_gives_way_to_the_one_that_is_stated(monkeypatch):
    # where a log stands far from its model, the start that suits its first rows was a stem at 30,000 %
    opened, record = read(tank(), logged(tank(), 6))
    monkeypatch.setattr(framing, "start_values", lambda quiet, record: {"tank.h": 1e300})
    frame = framing.frame_of(opened, record)
    assert frame is not None and frame.given.model["tank"].x0.tolist() == [1.0]
