"""Linearisation: closed forms, python-control's own tools, an independent model of the plant, and invariants."""

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks import PI, Constant, FirstOrder, Integrator, Sum
from stickslip.diagram import wire
from stickslip.diagram.linear import linearise, open_loop, rga
from stickslip.diagram.linear.figures import plot_poles
from stickslip.diagram.linear.gain_arrays import relative_gains
from stickslip.diagram.linear.poles import poles_of, table
from stickslip.diagram.linear.slopes import slopes
from stickslip.plant import SET_B, SETS, production_plant, steady_state
from stickslip.plant.loops import self_regulating_loop

from tests.plant import test_peer as peer

PAIRED = ("LCS11", "PCS11", "LCS21", "PCS21")


def ideal(K=3.0, tau=10.0, K_p=0.4, T_i=10.0):
    """Return K/(tau s + 1) under K_p (T_i s + 1)/(T_i s), valve without dynamics."""
    return wire([Constant("SP", 0.5), PI(K_p, T_i, outputs="MV", start_op=0.2, start_error=0.5), FirstOrder(K, tau)])


def sorted_poles(linear):
    both = []
    for pole in linear.poles:
        if pole.held:  # of no system from signal to signal
            continue
        both += [pole.value] if pole.value.imag == 0.0 else [pole.value, pole.value.conjugate()]
    return np.sort_complex(np.array(both))


# --- closed forms ---------------------------------------------------------------------------------------------


def test_ideal_loop_with_cancelled_pole():
    loop = open_loop(ideal(), "controller")
    for w in (1e-3, 0.12, 7.0):
        assert loop(w) == pytest.approx(0.12 / (1j * w), rel=1e-8)  # analytic: L = K K_p/(T_i s)
    assert loop.crossover == pytest.approx(0.12, rel=1e-8)  # analytic
    assert loop.phase_margin == pytest.approx(90.0, abs=1e-5)  # analytic
    assert loop.delay_margin == pytest.approx(0.5 * np.pi / 0.12, rel=1e-6)  # analytic
    assert (loop.gain_margin, loop.gain_reduction) == (float("inf"), 0.0)
    poles = [pole.value.real for pole in linearise(ideal()).poles]
    assert poles == pytest.approx([-0.12, -0.1], rel=1e-8)  # analytic: crossover and cancelled pole


@settings(max_examples=25)
@given(
    K=st.floats(0.2, 5.0), tau=st.floats(1.0, 50.0), K_p=st.floats(0.05, 2.0), T_i=st.floats(2.0, 80.0),
)  # fmt: skip
def test_loop_is_controller_times_process(K, tau, K_p, T_i):
    loop = open_loop(ideal(K, tau, K_p, T_i), "controller")
    s = 1j * np.array([1e-3, 0.03, 0.4])
    expected = K_p * (T_i * s + 1) / (T_i * s) * K / (tau * s + 1)  # analytic
    np.testing.assert_allclose([loop(w) for w in s.imag], expected, rtol=1e-7)
    characteristic = np.roots([T_i * tau, T_i * (1 + K * K_p), K * K_p])  # analytic: 1 + L = 0
    found = sorted_poles(linearise(ideal(K, tau, K_p, T_i)))
    np.testing.assert_allclose(found, np.sort_complex(characteristic), rtol=1e-4)  # double roots are soft


def test_margins_agree_with_python_control():
    """Dead time and a third-order lag: both margins finite; ct.margin on the same state space."""
    lags = [FirstOrder(1.0, 4.0, name="b", inputs="PV1", outputs="PV2"), FirstOrder(1.0, 2.0, name="c", inputs="PV2")]
    diagram = wire(
        [Constant("SP", 0.0), PI(1.5, 8.0, low=-9, high=9), FirstOrder(2.0, 10.0, inputs="OP", outputs="PV1"), *lags]
    )
    loop = open_loop(diagram, "controller")
    L = ct.tf([1.5 * 8, 1.5], [8, 0]) * ct.tf(2, [10, 1]) * ct.tf(1, [4, 1]) * ct.tf(1, [2, 1])
    gain, phase, at_phase, at_gain = ct.margin(L)
    assert loop.gain_margin == pytest.approx(gain, rel=1e-6)
    assert loop.phase_margin == pytest.approx(phase, rel=1e-6)
    assert loop.phase_crossovers == pytest.approx((at_phase,), rel=1e-6)
    assert loop.crossover == pytest.approx(at_gain, rel=1e-6)


def test_two_by_two_relative_gains_in_closed_form():
    """Two mixed lags: lambda = 1/(1 - g12 g21/(g11 g22)), whatever the tuning."""
    mixed = wire(
        [
            Constant("SP1", 0.0), Constant("SP2", 0.0),
            PI(0.3, 5.0, low=-9, high=9, name="C1", inputs=["SP1", "PV1"], outputs="OP1"),
            PI(0.3, 5.0, low=-9, high=9, name="C2", inputs=["SP2", "PV2"], outputs="OP2"),
            Sum("u1", {"OP1": 2.0, "OP2": 0.5}), Sum("u2", {"OP1": -0.8, "OP2": 1.0}),
            FirstOrder(1.0, 10.0, name="P1", inputs="u1", outputs="PV1"),
            FirstOrder(1.0, 30.0, name="P2", inputs="u2", outputs="PV2"),
        ]
    )  # fmt: skip
    expected = 1.0 / (1.0 + 0.5 * 0.8 / 2.0)  # analytic
    found = rga(mixed)
    assert found.controllers == ("C1", "C2")
    np.testing.assert_allclose(found.values.real, [[expected, 1 - expected], [1 - expected, expected]], atol=1e-8)
    assert found.number == pytest.approx(4 * (1 - expected), abs=1e-7)  # analytic
    np.testing.assert_allclose(rga(mixed, frequency=0.3).values, found.values, atol=1e-7)  # lags divide out by rows


def test_relative_gain_of_integrating_levels_is_finite():
    tanks = wire(
        [
            Constant("SP1", 0.0), Constant("SP2", 0.0),
            PI(0.3, 50.0, low=-9, high=9, name="C1", inputs=["SP1", "L1"], outputs="OP1"),
            PI(0.3, 50.0, low=-9, high=9, name="C2", inputs=["SP2", "L2"], outputs="OP2"),
            Sum("net1", {"OP1": 1.0, "OP2": 0.4}), Sum("net2", {"OP1": 0.6, "OP2": 1.0}),
            Integrator(1.0, 10.0, name="T1", inputs="net1", outputs="L1"),
            Integrator(1.0, 20.0, name="T2", inputs="net2", outputs="L2"),
        ]
    )  # fmt: skip
    expected = 1.0 / (1.0 - 0.24)  # analytic
    assert rga(tanks).values[0, 0].real == pytest.approx(expected, abs=1e-8)


@settings(max_examples=50)
@given(st.integers(0, 10**6), st.integers(1, 5))
def test_relative_gains_sum_to_one_and_ignore_units(seed, n):
    rng = np.random.default_rng(seed)
    G = rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n)) + 2.0 * np.eye(n)
    values = relative_gains(G)
    np.testing.assert_allclose(values.sum(axis=0), 1.0, atol=1e-8)  # analytic
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-8)
    units = np.diag(10.0 ** rng.uniform(-5, 5, n))
    np.testing.assert_allclose(relative_gains(units @ G @ units), values, rtol=1e-6, atol=1e-8)


def test_participation_of_a_chain():
    """In a chain of lags each pole belongs to its own lag alone, since left and right eigenvectors are triangular."""
    A = np.array([[-1.0, 0.0, 0.0], [3.0, -0.1, 0.0], [0.0, 5.0, -0.02]])
    poles = poles_of(A, ["a", "b", "c"], np.array([1.0, 1e6, 1e-3]))
    assert [(pole.value.real, pole.states[0]) for pole in poles] == [
        (pytest.approx(-1.0), ("a", pytest.approx(1.0))), (pytest.approx(-0.1), ("b", pytest.approx(1.0))),
        (pytest.approx(-0.02), ("c", pytest.approx(1.0))),
    ]  # fmt: skip
    assert [pole.time_constant for pole in poles] == pytest.approx([1.0, 10.0, 50.0])
    assert table(poles)[1] == ("-0.1", "10", "1", "b")


def test_oscillating_pair_has_damping():
    (pole,) = poles_of(np.array([[0.0, 1.0], [-4.0, -0.8]]), ["x", "v"], np.ones(2))
    assert (pole.frequency, pole.damping) == pytest.approx((2.0, 0.2))  # analytic
    assert sum(share for _, share in pole.states) == pytest.approx(1.0)


# --- the plant ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["A", "B"])
def test_jacobian_of_an_independent_model(name):
    """Central differences of the plant written again in plain numpy give the same A."""
    plant = production_plant(name, F_s="high")
    found = slopes(plant.in_mode("ideal"))
    labels = [f"{b}[{s}]" for b, s in (key.split(".") for key in peer.ORDER)]
    at = [found.states.index(label) for label in labels]
    A = found.joined()[0][np.ix_(at, at)]
    y, design = peer.start(plant), steady_state(SETS[name]).design
    for j, value in enumerate(y):
        step = 1e-5 * abs(value) if value else 1e-5
        up, down = y.copy(), y.copy()
        up[j] += step
        down[j] -= step
        column = (np.array(peer.rates(0.0, up, design)) - np.array(peer.rates(0.0, down, design))) / (2 * step)
        scale = np.abs(A * np.where(y == 0.0, 1.0, y)).max(axis=1) / (abs(value) or 1.0)
        np.testing.assert_allclose(A[:, j] / scale, column / scale, atol=2e-6, err_msg=labels[j])


# Published: notes section 4, the fast poles of set A; those of set B there are with K_p_speed = 80000.
FAST = {"A": (-2000.0, -810.0, -480.0, -140.0, -88.0, -31.0, -13.0, -3.6, -2.3), "B": (-4000.0, -1460.0, -396.0)}


@pytest.mark.parametrize("name", ["A", "B"])
def test_poles_of_the_notes(name):
    plant = SET_B.changed(K_p_speed=80000.0) if name == "B" else name
    linear = linearise(production_plant(plant, F_s="high"))
    found = [pole.value.real for pole in linear.poles[: len(FAST[name])]]
    np.testing.assert_allclose(found, FAST[name], rtol=0.03)  # published with two digits
    slowest = linear.poles[-3]
    assert slowest.value.real == pytest.approx(-5e-4, rel=0.15) and slowest.made_of().startswith("SC002[z]")
    assert linear.at_rest and linear.stable
    assert linear.poles[0].value.real == pytest.approx(
        -(80000.0 if name == "B" else 40000.0) / 20.0, rel=5e-3
    )  # analytic: speed controller on its shaft, K_p/J
    assert linear.poles[0].made_of() == "shaft[w]"


def test_held_integrators_are_zeros_of_their_own():
    """The notes count four exact zeros; here anti-surge tracks its valve (-1/T_i each), and the flares are left."""
    linear = linearise(production_plant("B"))
    held = [pole.made_of() for pole in linear.poles if pole.held]
    assert held == ["PCS12[z]", "PCS22[z]"] == list(linear.held)
    of_asc = {pole.made_of(): pole.value.real for pole in linear.poles if pole.made_of().startswith("ASC")}
    assert of_asc == {"ASC2[z]": pytest.approx(-1 / 3.0), "ASC3[z]": pytest.approx(-1 / 12.0)}  # analytic
    assert "PCS12" not in linear.controllers and "ASC2" not in linear.controllers


@pytest.mark.parametrize("controller", [*PAIRED, "SC002", "SC001"])
def test_closed_poles_are_those_of_the_loop_fed_back(controller):
    linear = linearise(production_plant("B"))
    closed = ct.feedback(linear.loop(controller).L, 1).poles()
    np.testing.assert_allclose(np.sort_complex(closed), sorted_poles(linear), rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("controller", PAIRED)
def test_loop_is_the_plant_without_its_controller_times_the_controller(controller):
    """Python-control linearises the diagram from which the controller block was taken out."""
    plant = production_plant("B", sticky=())
    block, rest = plant[controller], plant.without(controller, f"SP_{controller}")
    OP, PV = block.output_labels[0], block.input_labels[1]
    start = slopes(plant)
    u = [float(start.s[start.signals.index(name)]) for name in rest.open_inputs]
    G = ct.linearize(rest, rest.x0, u, eps=1e-4)
    row, column = rest.output_labels.index(PV), list(rest.open_inputs).index(OP)
    K_p, T_i = block.params["K_p"], block.params["T_i"]
    loop = linearise(plant).loop(controller)
    for w in (0.003, 0.05, 0.8):
        s = 1j * w
        expected = -K_p * (1 + 1 / (T_i * s)) * G(s)[row, column]  # direct action: OP rises with PV
        assert loop(w) == pytest.approx(expected, rel=2e-2)  # differences of a whole diagram keep few digits


def test_gain_from_a_set_point_is_one_at_rest():
    linear = linearise(production_plant("B"))
    step = linear.system(["SP_PCS11", "SP_LCS11"], ["p_1", "V_1"])
    G = step(1e-9)
    np.testing.assert_allclose(np.diag(G.real), 1.0, atol=1e-5)  # analytic: integral action
    assert abs(G[0, 1].real) < 1.0 and abs(G[1, 0].real) < 1e-9  # Pa per m3, m3 per Pa
    assert step.input_labels == ["SP_PCS11", "SP_LCS11"] and step.state_labels[0] == "S1[N_oil]"


def test_gain_of_the_feed_is_that_of_two_steady_states():
    """dF_L1/dF_in from the linear model against the difference of two rests from the recipe."""
    up, down = (steady_state(SET_B, 8000.0 + d) for d in (4.0, -4.0))
    linear = linearise(production_plant("B"))
    G = linear.system("F_in", ["F_L1", "OP_VLCS1", "p_in2"])(1e-10).real
    expected = [(up.S1.F_L - down.S1.F_L) / 8, (up.VLCS1 - down.VLCS1) / 8, (up.C2.p_in - down.C2.p_in) / 8]
    np.testing.assert_allclose(np.ravel(G), expected, rtol=1e-4)


def test_relative_gains_of_the_plant():
    found = rga(production_plant("B"), PAIRED)
    np.testing.assert_allclose(found.values.sum(axis=0), 1.0, atol=1e-8)  # analytic
    np.testing.assert_allclose(found.values.sum(axis=1), 1.0, atol=1e-8)
    assert found.PVs == ("V_1", "p_1", "V_2", "p_2") and found.OPs == ("OP_VLCS1", "OP_VPCS1", "OP_VLCS2", "OP_VPCS2")
    assert np.all(np.diag(found.values).real > 0.5)  # the thesis pairs them as one should
    default = rga(production_plant("B"))
    assert default.controllers == (*PAIRED, "SC001")  # SC002 commands SC001: an outer loop


def test_recycle_loop_where_it_is_open():
    plant = production_plant("A", Z_I=0.25)
    linear = linearise(plant)
    assert "ASC2" in linear.controllers and linear.loop("ASC2").PV == "q_2"
    with pytest.raises(ValueError, match=r"controller 'ASC3' is at a limit here, OP = 0"):
        linear.loop("ASC3")


# --- friction, kinks, names, pictures ---------------------------------------------------------------------------


def test_stuck_valves_pass_nothing_but_for_friction_false():
    loop = self_regulating_loop()
    assert abs(linearise(loop).loop("controller")(0.01)) == pytest.approx(12.0, rel=1e-3)  # analytic: 0.12/w
    assert abs(linearise(loop, friction=True).loop("controller")(0.01)) == 0.0


def test_full_stem_adds_its_own_modes():
    poles = [pole.value.real for pole in linearise(self_regulating_loop()).poles]
    assert poles[:2] == pytest.approx([-335.0, -115.0], rel=0.01)  # published: notes 1.7, stem modes


def test_a_kink_counts_with_its_steeper_side():
    from stickslip.blocks.control_valve_flow import ControlValveFlow

    at_zero = wire(
        [Constant("p_up", 2e5), Constant("p_down", 1e5), Constant("MV", 0.0), ControlValveFlow(2.0)], outputs=["F"]
    )
    found = slopes(at_zero)
    assert found.kinks == ("body",)
    gain = linearise(at_zero).system("MV", "F").D[0, 0]
    assert gain == pytest.approx(2.0 * np.sqrt(1e5), rel=1e-6)  # analytic: opening, not half of it


def test_a_pole_has_one_time_constant():
    """Analytic: 1/|Re p|, in the table as in the picture; sqrt(0.5) of damping makes 1/|p| another number."""
    A = np.array([[-0.1, 0.1, 0.0, 0.0, 0.0], [-0.1, -0.1, 0.0, 0.0, 0.0], [0.0, 0.0, -3.0, 0.0, 0.0],
                  [0.0, 0.0, 0.0, 0.0, 2.0], [0.0, 0.0, 0.0, -2.0, 0.0]])  # fmt: skip
    poles = poles_of(A, list("abcde"), np.ones(5))
    damping = [float(row[1]) for row in table(poles)]
    assert damping == [pytest.approx(1 / 3, rel=1e-3), float("inf"), pytest.approx(10.0)]
    axes = plot_poles(poles).axes[0]
    dots = [float(line.get_xdata()[0]) for line in axes.lines if line.get_marker() == "o"]
    assert dots == [pytest.approx(1 / 3), pytest.approx(10.0)]
    assert any(text.get_text() == "d, e   undamped, 2 rad/s" for text in axes.texts)


def test_pictures_show_what_was_found():
    linear = linearise(production_plant("B"))
    words = [text.get_text() for text in linear.plot().axes[0].texts]
    assert len(words) == len(linear.poles) and "shaft[w]" in words and "PCS12[z]   held" in words
    figure = linear.bode(["PCS11", "LCS11"])
    gain = figure.axes[0]
    labels = [text.get_text() for text in gain.get_legend().get_texts()]
    assert labels[0].startswith("PCS11: 0.474 rad/s, phase margin 90")  # snapshot
    crossing = [line for line in gain.lines if len(line.get_xdata()) == 1]
    assert float(crossing[0].get_xdata()[0]) == pytest.approx(linear.loop("PCS11").crossover)
    array = linear.rga(PAIRED).plot().axes[0]
    assert [label.get_text() for label in array.get_xticklabels()] == ["OP_VLCS1", "OP_VPCS1", "OP_VLCS2", "OP_VPCS2"]


def test_python_control_goes_on_from_here():
    loop = open_loop(ideal(), "controller")
    response = ct.step_response(ct.feedback(loop.L, 1), T=np.linspace(0.0, 50.0, 51))
    np.testing.assert_allclose(response.outputs, 1.0 - np.exp(-0.12 * response.time), atol=1e-6)  # analytic
