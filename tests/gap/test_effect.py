"""Effects in any diagram: a neutral one changes nothing, what it cannot be is refused with value, rule and remedy."""

import numpy as np
import pytest
from stickslip.blocks import PI, DeadTime, FirstOrder, IdealValve, Recorded, Sensor, Staircase, StateSpace
from stickslip.diagram import simulate, wire
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.gap.insertion.effect import EffectError, Parameter

T, EXACT = 120.0, {"every": 1.0, "rtol": 1e-10, "atol": 1e-12}


def loop(**changes):
    return wire(
        [
            Staircase("SP", [0.5, 0.7, 0.6], dwell=40.0),
            PI(0.4, 10.0, anti_windup="conditional"),
            IdealValve(),
            FirstOrder(3.0, 10.0, outputs="y"),
            Sensor(inputs="y", outputs="PV"),
        ],
        outputs=["PV"],
    )


def test_a_late_process_is_the_process_with_that_dead_time():
    late = effect("dead_time").insert(loop(), "process", theta=3.0)
    by_hand = loop().replace("process", FirstOrder(3.0, 10.0, 3.0))
    one, other = simulate(late, T, **EXACT).log, simulate(by_hand, T, **EXACT).log
    for signal in ("OP", "MV", "y", "PV"):
        np.testing.assert_allclose(one[signal], other[signal], atol=1e-9)  # analytic: the same equations
    assert late.declared_outputs == ("PV",)


def test_a_process_without_dead_time_gets_a_delay_in_front():
    lag = StateSpace([[-0.1]], [[0.3]], [[1.0]], name="process", inputs="MV", outputs="y")
    late = effect("dead_time").insert(loop().replace("process", lag), "process", theta=3.0)
    assert isinstance(late["process:dead_time"], DeadTime)
    by_hand = loop().replace("process", FirstOrder(3.0, 10.0, 3.0))
    one, other = simulate(late, T, **EXACT).log, simulate(by_hand, T, **EXACT).log
    np.testing.assert_allclose(one["PV"], other["PV"], atol=1e-8)


def test_what_is_in_the_delay_at_the_start_follows_the_log():
    late = effect("dead_time").insert(loop(), "process", theta=3.0)
    assert effect("dead_time").started(late, "process", {"MV": 0.25})["process"].value_before == 0.25
    assert effect("dead_time").started(late, "process", {"PV": 0.25})["process"].value_before == 0.0


def test_the_stem_sticks_by_S_and_jumps_by_J():
    valve = wire([Recorded("OP", [0.0, 100.0, 200.0], [0.5, 0.7, 0.5]), IdealValve()])
    sticky = effect("stiction").insert(valve, "valve", S=6.0, J=2.0)
    sticky = effect("stiction").started(sticky, "valve", {"OP": 0.5})
    log = simulate(sticky, 200.0, every=0.1).log
    # analytic, from rest at 0.5: it breaks away f_s = 4 % later, then trails by f_c = 2 %; after the reversal it rests
    # until OP has come back by S = 6 %, and jumps by J = 2 %
    lag = log["OP"] - log["MV"]
    up = (log.t > 20.1) & (log.t < 100.0)
    np.testing.assert_allclose(lag[up], 0.02, atol=1e-9)
    np.testing.assert_allclose(log["MV"][log.t < 19.9], 0.5, atol=1e-12)
    resting = (log.t > 100.0) & (log.t < 129.9)
    np.testing.assert_allclose(log["MV"][resting], 0.68, atol=1e-9)
    np.testing.assert_allclose(lag[log.t > 130.1], -0.02, atol=1e-9)
    assert sticky.signals == ("OP", "MV:valve", "MV")


def test_percent_is_of_the_span_of_OP():
    percent = loop().replace("controller", PI(40.0, 10.0, low=0.0, high=100.0))
    percent = percent.replace("process", FirstOrder(0.03, 10.0))
    one = simulate(effect("stiction").insert(percent, "valve", S=5.0, J=2.0), T, **EXACT).log
    other = simulate(effect("stiction").insert(loop(), "valve", S=5.0, J=2.0), T, **EXACT).log
    assert np.ptp(one["MV"] - one["MV:valve"]) > 2.0
    np.testing.assert_allclose(one["PV"], other["PV"], atol=1e-3)


@pytest.mark.parametrize("name", [one.name for one in CATALOGUE])
def test_places_are_blocks_of_the_role(name):
    one = effect(name)
    for place in one.places(loop()):
        assert loop()[place].role is one.role


def test_an_effect_of_a_block_does_not_make_it_a_place():
    late = effect("stiction").insert(loop(), "valve", S=1.0)
    assert effect("stiction").places(late) == ("valve",)


@pytest.mark.parametrize(
    ("name", "place", "values", "said"),
    [
        ("stiction", "valve", {"S": 2.0, "J": 3.0}, "J = 3 %, but a jump is part of S = 2 %; lower J or raise S"),
        ("stiction", "valve", {"S": -2.0, "J": -3.0}, "S = -2, but it must be finite and at least 0"),
        ("stiction", "valve", {"s": 2.0}, "has no parameter 's'"),
        ("stiction", "sensor", {"S": 2.0}, "cannot be at 'sensor'"),
        ("dead_time", "process", {"theta": -1.0}, "theta = -1, but it must be finite and at least 0; give 0 for none"),
        ("dead_time", "process", {"theta": float("nan")}, "theta is not a number"),
        ("dead_time", "process", {"theta": "late"}, "must be a single number"),
    ],
)
def test_nonsense_is_refused(name, place, values, said):
    with pytest.raises(EffectError, match=said):
        effect(name).insert(loop(), place, **values)


def test_an_effect_is_put_in_once():
    once = effect("stiction").insert(loop(), "valve", S=2.0)
    with pytest.raises(EffectError, match="stiction is at 'valve' already"):
        effect("stiction").insert(once, "valve", S=1.0)


def test_an_unknown_name_is_told():
    with pytest.raises(EffectError, match="did you mean 'stiction'"):
        effect("sticktion")


def test_a_grid_covers_the_bounds_without_the_neutral_value():
    assert Parameter("factor", "-", 1.0, 0.1, 10.0, "log").grid(3).tolist() == [0.1, 10.0]
    assert effect("dead_time").bounds(loop(), "process")["theta"] == (0.1, 30.0)  # T_i = 10 s
