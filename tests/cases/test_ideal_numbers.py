"""The ideal cases: published beside analytic beside reproduced, and the runs against solvers of other hands."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.cases import CaseError, find, names
from stickslip.cases.exact import (
    IDEAL_HALF_GAIN,
    IDEAL_HIGH,
    IDEAL_NORMAL,
    INTEGRATOR_HIGH,
    exact_run,
    symmetric_start,
)
from stickslip.cases.ideal import CASES_BY_NAME, GAIN_READING

STICKY = ("ideal_high", "ideal_normal", "ideal_half_gain")


@pytest.fixture(scope="module")
def numbers():
    return {name: {n.quantity: n for n in find(name).numbers()} for name in CASES_BY_NAME}


def test_names_are_the_promised_ones():
    assert {"ideal_high", "ideal_normal", "ideal_half_gain", "ideal_integrating", "sine"} <= set(names())


def test_unknown_case_names_the_nearest():
    with pytest.raises(CaseError, match="no case 'ideal_nomal'; did you mean 'ideal_normal'"):
        find("ideal_nomal")


@pytest.mark.parametrize(
    ("name", "published", "analytic"),
    [  # published: figures 6.1(b), B.3(b), B.3(a); analytic: R of the symmetric cycle in closed form
        ("ideal_high", 3.71, 13.65),
        ("ideal_normal", 6.40, 27.08),
        ("ideal_half_gain", 18.40, 32.50),
    ],
)
def test_printed_model_meets_its_closed_form(numbers, name, published, analytic):
    number = numbers[name]["R, printed model"]
    assert number.published == published
    assert number.analytic == pytest.approx(analytic, abs=0.005)
    assert number.reproduced == pytest.approx(analytic, rel=0.05)
    assert number.published != pytest.approx(number.reproduced, rel=0.3)  # and the note says so
    assert "does not follow" in number.note


@pytest.mark.parametrize(
    ("name", "published", "stated_spread", "reading", "spread_of_reading"),
    [  # published with the thesis's spread; reading: 3.77, 7.30, 18.57, of an independent fixed-step prototype
        ("ideal_high", 3.71, 0.06, 3.77, 0.05),
        ("ideal_normal", 6.40, 0.80, 7.30, 0.08),
        ("ideal_half_gain", 18.40, 0.70, 18.57, 0.17),
    ],
)
def test_one_gain_factor_explains_the_published_values(
    numbers, name, published, stated_spread, reading, spread_of_reading
):
    number = numbers[name][f"R, loop gain x {GAIN_READING}"]
    assert number.reproduced == pytest.approx(reading, abs=spread_of_reading)
    # The stated spread covers high and half gain; of normal it leaves a seventh of the value unexplained.
    reach = stated_spread + (0.15 if name == "ideal_normal" else 0.01)
    assert abs(number.reproduced - published) <= reach


@pytest.mark.parametrize(("name", "jump"), [("ideal_high", 1.90), ("ideal_normal", 0.95), ("ideal_half_gain", 1.90)])
def test_deadband_and_jump_from_the_stem_figure(numbers, name, jump):
    deadband = numbers[name]["deadband in MV-OP"]
    assert deadband.published == 5.0  # published, rounded: table 5.3
    assert deadband.reproduced == pytest.approx(4.76, abs=0.01)  # analytic: 2 F_c / k = 4.762 %
    step = numbers[name]["jump in MV-OP"]
    assert step.published == pytest.approx(round(jump, 0))  # published, rounded: table 5.3
    assert step.reproduced == pytest.approx(jump, abs=0.01)  # analytic: (F_s - F_c) / k = 1.905, 0.952 %


@pytest.mark.parametrize(
    ("name", "period"), [("ideal_high", 116.67), ("ideal_normal", 200.0), ("ideal_half_gain", 233.33)]
)
def test_period(numbers, name, period):
    # Analytic: 4 S T_i / (K_p K J), slips taken as instants.
    assert numbers[name]["period"].reproduced == pytest.approx(period, rel=0.01)


def test_integrating_loop(numbers):
    found = numbers["ideal_integrating"]
    assert found["amplitude of PV"].reproduced == pytest.approx(1 / 6, rel=2e-3)  # analytic: S / (2 K_p)
    assert found["period"].reproduced == pytest.approx(233.33, rel=0.01)  # analytic: 4 S / (K_p g J)
    assert found["OP peak to peak"].reproduced == pytest.approx(100 / 15, rel=2e-3)  # analytic: (F_s + F_c) / k
    assert found["MV peak to peak"].reproduced == pytest.approx(1.905, rel=2e-3)  # analytic: (F_s - F_c) / k


def test_sine(numbers):
    (number,) = numbers["sine"].values()
    assert number.published == 1.03  # published: figure 6.1(a)
    assert number.reproduced == pytest.approx(1.025, abs=5e-4)  # analytic: one sample's lag at phase 0
    assert round(number.reproduced, 2) == number.published


@pytest.mark.parametrize("name", ["ideal_high", "ideal_normal", "ideal_half_gain", "ideal_integrating", "sine"])
def test_every_number_says_its_piece(numbers, name):
    for number in numbers[name].values():
        plain = number.to_dict()
        assert list(plain) == [
            "quantity", "unit", "published", "analytic", "reproduced", "spread", "source", "note",
        ]  # fmt: skip
        assert number.note and np.isfinite(number.reproduced)
        assert (number.published is None) == (number.source == "")


def integrating_exact():
    J, f_c, lowest = 1000.0 / 52500.0, 1250.0 / 52500.0, -3500.0 / 52500.0 / 0.4
    return replace(INTEGRATOR_HIGH, x_0=0.5 * J, PV_0=lowest, z_0=0.5 * J + f_c + 0.2 * lowest)


@pytest.mark.parametrize(
    ("name", "exact"),
    [
        ("ideal_high", IDEAL_HIGH),
        ("ideal_normal", IDEAL_NORMAL),
        ("ideal_half_gain", symmetric_start(IDEAL_HALF_GAIN)),
        ("ideal_integrating", integrating_exact()),
    ],
    ids=["high", "normal", "half gain", "integrating"],
)
def test_runs_against_the_exact_automaton(name, exact):
    run, truth = find(name).run(), exact_run(exact)
    assert run.ok and len(run.log) == len(truth.t)
    np.testing.assert_allclose(run.log["SP"] - run.log["PV"], truth.e, rtol=0, atol=1e-6)
    np.testing.assert_allclose(run.log["OP"], truth.OP, rtol=0, atol=1e-5)
    mode_changes = [event.t for event in run.events if event.block == "valve"]
    assert len(mode_changes) >= 8  # a cycle, not a rest
    np.testing.assert_allclose(mode_changes, [event.t for event in truth.events], rtol=0, atol=1e-4)


def test_ideal_high_against_pathsim():
    pytest.importorskip("pathsim", reason="pathsim is not installed: the independent simulator is SKIPPED")
    from benchmarks.peers import pathsim_loop

    theirs = pathsim_loop.run(replace(IDEAL_HIGH, duration=130.0))
    ours = find("ideal_high").run().log
    rows = len(theirs.t)
    np.testing.assert_allclose(ours.t[:rows], theirs.t, rtol=0, atol=1e-9)
    np.testing.assert_allclose((ours["SP"] - ours["PV"])[:rows], theirs.e, rtol=0, atol=1e-6)


def test_the_case_can_be_changed():
    run = find("ideal_high").run(params={"valve.F_s": 1250.0})  # no jump: nothing throws the loop
    assert abs(run.log["PV"][-1] - 0.5) < 0.03
