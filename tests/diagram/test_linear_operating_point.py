"""Operating points: from another feed to where the recipe rests, from kicks, of small loops; where there is none."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import (
    PI,
    Constant,
    FirstOrder,
    Integrator,
    SampledFunction,
    SampledPI,
    SampledSensor,
    Sensor,
    Sine,
    Step,
    StickSlip,
)  # fmt: skip
from stickslip.diagram import WiringError, simulate, wire
from stickslip.diagram.linear import NoOperatingPoint, linearise, operating_point
from stickslip.plant import kicked, production_plant
from stickslip.plant.build import compressor_2
from stickslip.plant.feed import constant
from stickslip.plant.loops import self_regulating_loop

FEEDS = [(8000.0, 0.25), (7600.0, 0.36), (7000.0, 0.20), (6500.0, 0.35), (8300.0, 0.30), (8200.0, 0.38)]


def off(point, plant):
    """Return the largest relative distance from where the recipe puts the plant, held integrators apart."""
    found = np.array([point.states[label] for label in plant.state_labels])
    free = np.array([label not in point.held for label in plant.state_labels])
    return float((np.abs(found - plant.x0) / np.maximum(np.abs(plant.x0), 1e-3))[free].max())


@pytest.mark.parametrize("name", ["A", "B"])
@pytest.mark.parametrize(("F_in", "Z_I"), FEEDS)
def test_from_the_rest_of_another_feed(name, F_in, Z_I):
    """The oracle is the recipe of stickslip.plant.rest, which shares nothing with the search."""
    plant = production_plant(name, F_in=F_in, Z_I=Z_I)
    point = operating_point(plant, production_plant(name))
    assert off(point, plant) < 1e-8
    assert point.residual < 1e-9 and point.held == ("PCS12[z]", "PCS22[z]")


def test_from_any_feasible_feed():
    rng, starts, worst = np.random.default_rng(11), {name: production_plant(name) for name in "AB"}, 0.0
    for i in range(10):
        name, F_in, Z_I = "AB"[i % 2], rng.uniform(5500.0, 8600.0), rng.uniform(0.15, 0.45)
        plant = production_plant(name, F_in=F_in, Z_I=Z_I)
        worst = max(worst, off(operating_point(plant, starts[name]), plant))
    assert worst < 1e-8


@pytest.mark.parametrize("back", [True, False])
def test_recycle_valve_opens_and_shuts_on_the_way(back):
    feeds = [(8000.0, 0.37), (8000.0, 0.25)]  # with 0.25 the recycle valve of C2 is open
    there, here = (feeds[0], feeds[1]) if back else (feeds[1], feeds[0])
    plants = [production_plant("A", F_in=F, Z_I=Z) for F, Z in (there, here)]
    point = operating_point(plants[0], plants[1])
    assert off(point, plants[0]) < 1e-8
    assert (point["OP_VRVC2"] > 0.01) is not back


def test_from_kicked_starts():
    plant = production_plant("B")
    assert off(operating_point(kicked(plant, 1.1, 1.02)), plant) < 1e-8
    rng = np.random.default_rng(4)
    fast = [label for label in plant.state_labels if label.startswith(("S1", "S2", "C2", "C3"))]
    for _ in range(3):
        start = {label[:-1].replace("[", "."): (1.0 + 0.03 * rng.uniform(-1, 1)) for label in fast}
        values = dict(zip([s[:-1].replace("[", ".") for s in plant.state_labels], plant.x0, strict=True))
        point = operating_point(plant, {key: factor * values[key] for key, factor in start.items()})
        assert off(point, plant) < 1e-8


@pytest.mark.parametrize("stem", ["quasi_static", "full"])
def test_the_diagram_returned_rests_with_its_sticky_stems(stem):
    plant = production_plant("B", stem=stem, F_s="high", feed=constant(7600.0, 0.36), F_in=8000.0, Z_I=0.37)
    point = operating_point(plant)
    assert point.diagram["VPCS1"].mode == "stuck"
    run = simulate(point.diagram, 500.0, every=10.0, method="stiff")
    for signal in ("p_1", "V_1", "p_out2", "w"):
        np.testing.assert_allclose(run.log[signal], point[signal], rtol=1e-9)
    assert not any(event.block.startswith("V") for event in run.events)


def test_python_controls_own_search_agrees():
    """Near rest ct.find_operating_point needs no help; the same diagram, unscaled."""
    plant = production_plant("B", sticky=())
    found = ct.find_operating_point(plant, plant.x0 * 1.0005, [], root_kwargs={"options": {"xtol": 1e-14}})
    point = operating_point(plant, {"S1.N_metG": 1.0005 * plant["S1"].x0[2]})
    free = [i for i, s in enumerate(plant.state_labels) if s not in point.held and abs(plant.x0[i]) > 0.0]
    np.testing.assert_allclose(np.array(list(point.states.values()))[free], found.states[free], rtol=1e-7)


def test_small_loops_in_closed_form():
    point = operating_point(self_regulating_loop(setpoint=0.6))
    assert (point["PV"], point["OP"], point["controller[z]"]) == pytest.approx((0.6, 0.2, 0.2), abs=1e-12)  # analytic
    limited = wire([Step("SP", 5.0), PI(0.4, 10.0, anti_windup="conditional"), FirstOrder(3.0, 10.0, inputs="OP")])
    point = operating_point(limited)
    assert (point["OP"], point["PV"]) == pytest.approx((1.0, 3.0), abs=1e-9)  # analytic: all the valve has
    assert point.held == ("controller[z]",)


def test_sources_stand_still_at_the_time_asked_for():
    loop = wire([Sine("SP", 0.1, 40.0, mean=0.5), PI(0.4, 10.0, outputs="MV"), FirstOrder(3.0, 10.0)])
    for t, SP in ((0.0, 0.5), (10.0, 0.6), (30.0, 0.4)):
        assert operating_point(loop, t=t)["PV"] == pytest.approx(SP, abs=1e-9)  # analytic


def test_sampled_controllers_and_dead_times():
    loop = wire(
        [Step("SP", 0.6), SampledPI(0.2, 10.0, dt=1.0), StickSlip(), FirstOrder(3.0, 10.0, theta=2.0)], name="sampled"
    )
    point = operating_point(loop)
    assert point["PV"] == pytest.approx(0.6, abs=1e-9)
    assert point.diagram["process"].params["theta_start"] == pytest.approx(0.2, abs=1e-9)


def test_open_inputs_are_given_or_asked_for():
    gas = 0.016 * 2283.7189819065397
    point = operating_point(compressor_2("B"), inputs={"m_G1": 0.9 * gas})
    assert point["m_out2"] == pytest.approx(47.05088519 - 0.1 * gas, rel=1e-8)  # analytic: gas in is gas out
    with pytest.raises(ValueError, match=r"input 'm_G1' is open; give it a value"):
        operating_point(compressor_2("B"))


@pytest.mark.parametrize(
    ("F_in", "Z_I", "says"),
    [
        (10500.0, 0.30, r"comes to no rest.*LCS11 misses its set point by -\d.* with OP = 1 at its limit"),
        (8000.0, 0.90, r"comes to no rest.*PCS11 misses its set point by .* with OP = 1 at its limit"),
    ],
)
def test_infeasible_feeds_say_what_is_at_its_limit(F_in, Z_I, says):
    with pytest.raises(NoOperatingPoint, match=says):
        operating_point(production_plant("B", feed=constant(F_in, Z_I), F_in=8000.0, Z_I=0.37))


def test_a_tank_with_nothing_to_balance_it_has_no_rest():
    tank = wire([Step("MV", 0.3), Integrator(K=1.0, T=10.0)], name="tank")
    with pytest.raises(NoOperatingPoint, match=r"'tank' comes to no rest.*process\[PV\] \(\+0.03/s\)"):
        operating_point(tank)


def test_unknown_names_are_explained():
    with pytest.raises(ValueError, match=r"did you mean 'process'"):
        operating_point(self_regulating_loop(), {"proces.PV": 0.5})
    with pytest.raises(WiringError, match=r"no open input"):
        operating_point(self_regulating_loop(), inputs={"F_in": 0.5})


def test_a_diagram_without_states_rests_as_it_is():
    from stickslip.cases import find

    point = operating_point(find("sine").build(), t=12.5)
    assert point["e"] == pytest.approx(0.075, rel=1e-12) and point.states == {}  # analytic: the amplitude


def test_a_vessel_that_runs_over_on_the_way_is_told():
    plant = production_plant("B")
    with pytest.raises(NoOperatingPoint, match=r"comes to no rest: on the way S1 is full: .* \(at t = \d"):
        operating_point(plant.with_params({"F_in.value": 1e5}))
    with pytest.raises(NoOperatingPoint, match=r"S1 is full: 40.95 of 40 m3 are liquid"):
        operating_point(plant.with_params({"S1.V_sep": 40.0}))


def test_times_and_tolerances_that_are_none():
    for t in (float("nan"), float("inf")):
        with pytest.raises(ValueError, match=r"t = .*, but sources stand still at a finite time"):
            operating_point(self_regulating_loop(), t=t)
    for tolerance in (0.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match=r"tolerance = .*, but a largest relative rate is positive"):
            operating_point(self_regulating_loop(), tolerance=tolerance)


def mean(state, y):
    return y, (state + y) / 2.0


SAMPLED = {
    "FIR": (ct.tf([0.5, 0.5], [1, 0], 0.5, inputs="y", outputs="yf", name="f"), 1.0),
    "gain": (ct.tf([0.5], [1], 0.5, inputs="y", outputs="yf", name="f"), 0.5),
    "moving mean": (ct.tf([0.25] * 4, [1, 0, 0, 0], 0.5, inputs="y", outputs="yf", name="f"), 1.0),
    "ringing": (ct.tf([0.5], [1, 0.5], 0.5, inputs="y", outputs="yf", name="f"), 1.0 / 3.0),
    "function": (SampledFunction("f", mean, dt=0.5, inputs="y", outputs="yf", state=0.0), 1.0),
    "nonlinear": (
        ct.nlsys(
            lambda t, x, u, p: 0.5 * x + u, lambda t, x, u, p: x**2, inputs="y", outputs="yf", states=1, dt=0.5,
            name="f",
        ), 4.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", SAMPLED)
def test_a_sampled_block_without_a_continuous_twin_is_at_rest_where_its_samples_settle(what):
    block, exact = SAMPLED[what]  # analytic: the value of the transfer function at z = 1
    sources = [Constant("u", 1.0), FirstOrder(1.0, 5.0, inputs="u", outputs="y")]
    assert operating_point(wire([*sources, block]))["yf"] == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("what", ["FIR", "moving mean", "ringing"])
def test_the_linear_model_of_a_filter_without_a_continuous_twin_has_its_gain_at_rest(what):
    block, exact = SAMPLED[what]
    model = linearise(wire([Constant("u", 1.0), FirstOrder(1.0, 5.0, inputs="u", outputs="y"), block]))
    assert float(model.system("u", "yf").dcgain()) == pytest.approx(exact, abs=1e-9)


def test_a_function_that_integrates_comes_to_no_rest():
    total = SampledFunction("sum", lambda state, y: (state + y, state + y), dt=0.5, inputs="y", outputs="yf", state=0.0)
    with pytest.raises(NoOperatingPoint, match="block 'sum' goes on changing its outputs while its inputs stand still"):
        operating_point(wire([Constant("u", 1.0), FirstOrder(1.0, 5.0, inputs="u", outputs="y"), total]))


@pytest.mark.parametrize("sensor", [Sensor, lambda **given: SampledSensor(0.5, **given)], ids=["Sensor", "Sampled"])
def test_a_sensor_without_lag_has_no_state_in_the_linear_model(sensor):
    blocks = [
        Constant("SP", 1.0), FirstOrder(1.0, 10.0, inputs="OP", outputs="y", start=1.0),
        sensor(start=1.0, inputs="y", outputs="PV"), PI(2.0, 5.0, start_op=1.0, high=2.0),
    ]  # fmt: skip
    model = linearise(wire(blocks))
    assert float(model.system("SP", "y").dcgain()) == pytest.approx(1.0, abs=1e-9)  # integral action leaves no error
    assert [pole.made_of() for pole in model.poles] == ["process[PV], controller[z]"]
    assert model.held == () == operating_point(wire(blocks)).held
