"""Any python-control system in a diagram: against ``ct.input_output_response`` and exact linear responses."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, BlockError, Constant, FirstOrder, StateSpace, Step, TransferFunction, as_block
from stickslip.blocks.nonlinear_system import NonlinearSystem
from stickslip.diagram import WiringError, drive, ensemble, simulate, wire

T = np.linspace(0.0, 20.0, 201)
TIGHT = {"rtol": 1e-10, "atol": 1e-12, "max_step": 0.1}


def ours(system, u):
    """Return the outputs (l, n) of a system inside a diagram."""
    names = list(system.input_labels)
    given = {name: (T, u[i]) for i, name in enumerate(names)}
    run = simulate(wire([system], inputs=names), T[-1], times=T, inputs=given, rtol=1e-9, atol=1e-12)
    assert run.ok, run.hint
    return np.array([run.log[name] for name in system.output_labels]), run


def waves(count):
    return np.array([np.sin((0.7 + 0.2 * i) * T) for i in range(count)])


LINEAR = {
    "first order": ct.tf([3], [10, 1], inputs="MV", outputs="PV", name="process"),
    "third order": ct.tf([1, 2], [1, 2, 5, 1]),
    "equal degrees": ct.tf([2, 1], [1, 2]),
    "integrator": ct.tf([1, 2], [1, 3, 0]),
    "unstable": ct.tf([1], [1, -0.1]),
    "zpk": ct.zpk([-1], [-2, -3], 5),
    "gain": ct.tf([4], [2]),
    "badly scaled": ct.tf([1e9], [1, 2e3, 4e6, 1e9]),
    "ss": ct.ss([[0, 1], [-1, -0.4]], [[0], [1]], [[1, 0]], [[0.5]], inputs="u", outputs="y"),
    "MIMO ss": ct.ss(
        np.diag([-1.0, -0.3, -2.0]) + np.diag([0.5, 0.4], 1), np.ones((3, 2)), [[1, 0, 2], [0, 1, 0]], [[0, 0], [1, 0]]
    ),
    "sampled tf": ct.tf([1, 0.2], [1, -0.5, 0.1], 0.1),
    "sampled zpk": ct.zpk([0.3], [0.5, 0.9], 0.2, 0.1),
    "sampled MIMO ss": ct.ss(np.diag([0.5, 0.9]), np.ones((2, 2)), np.eye(2), [[0, 0.1], [0, 0]], 0.1),
}


@pytest.mark.parametrize("what", LINEAR)
def test_linear_systems(what):
    """Oracle: python-control's matrix exponential, exact for inputs that are linear between samples."""
    system = LINEAR[what]
    u = waves(system.ninputs)
    exact = np.atleast_2d(ct.forced_response(system, T, u, squeeze=False).outputs)
    y, run = ours(system, u)
    np.testing.assert_allclose(y, exact, atol=1e-6)
    assert run.in_python == () and isinstance(run.diagram.blocks[-1], TransferFunction | StateSpace)


def test_a_transfer_function_with_several_inputs_and_outputs():
    parts = [[([1], [1, 1]), ([1, 1], [1, 2, 3])], [([2, 1], [1, 4]), ([1], [1, 0.3])]]
    num, den = ([[part[k] for part in row] for row in parts] for k in (0, 1))
    u = waves(2)
    y, _ = ours(ct.tf(num, den), u)
    for i in (0, 1):
        exact = sum(ct.forced_response(ct.tf(*parts[i][j]), T, u[j]).outputs for j in (0, 1))
        np.testing.assert_allclose(y[i], exact, atol=1e-6)


def spring(t, x, u, params):
    m = params.get("m", 2.0)
    return np.array([x[1], (u[0] - params["k"] * x[0] - 0.3 * x[1] ** 3) / m])


def by_dictionary(t, x, u, params):
    return spring(t, x, u, dict(params))


NAMED = {"inputs": ["F"], "outputs": ["pos"], "states": ["pos", "v"], "params": {"k": 1.5}}
LAMBDAS = ct.nlsys(lambda t, x, u, params: [x[1], u[0] - params["k"] * x[0]],
                   lambda t, x, u, params: params["k"] * x[0], name="lambdas", **NAMED)  # fmt: skip
COMPILED = {
    "spring": ct.nlsys(spring, lambda t, x, u, params: x[0], name="spring", **NAMED),
    "no output function": ct.nlsys(spring, None, name="states", **NAMED | {"outputs": ["pos", "v"]}),
    "lambdas": LAMBDAS,
    "scalar": ct.nlsys(lambda t, x, u, params: -(x**3) + u, inputs=1, outputs=1, states=1, name="cubic"),
    "static": ct.nlsys(None, lambda t, x, u, params: np.tanh(u), inputs=1, outputs=1, name="tanh"),
    "sampled": ct.nlsys(lambda t, x, u, params: 0.5 * x + np.tanh(u), lambda t, x, u, params: x + u, inputs=1,
                        outputs=1, states=1, dt=0.1, name="sampled"),
    "two inputs": ct.nlsys(lambda t, x, u, params: u[0] * u[1] - x[0], lambda t, x, u, params: [x[0], u[1]], inputs=2,
                           outputs=2, states=1, name="product"),
}  # fmt: skip
IN_PYTHON = {
    "params as a whole": ct.nlsys(by_dictionary, lambda t, x, u, params: x[0], name="whole", **NAMED),
    "method": ct.nlsys(np.vectorize(lambda t, x, u, params=None: u - x, excluded=["params"]).__call__,
                       inputs=1, outputs=1, states=1, name="method"),
    "interconnected": ct.interconnect(
        [ct.nlsys(spring, lambda t, x, u, params: x[0], name="inner", **NAMED | {"inputs": ["e"]}),
         ct.summing_junction(["r", "-pos"], "e")], inputs="r", outputs="pos", name="joined"),
    "sampled": ct.nlsys(lambda t, x, u, params: 0.5 * x + u * len({**params, 1: u}), lambda t, x, u, params: x,
                        inputs=1, outputs=1, states=1, dt=0.1, name="sampled"),
}  # fmt: skip


def response(system, u):
    if system.dt:
        return np.atleast_2d(ct.input_output_response(system, T, u).outputs)
    return np.atleast_2d(ct.input_output_response(system, T, u, solve_ivp_kwargs=TIGHT).outputs)


@pytest.mark.parametrize("what", COMPILED)
def test_nonlinear_systems_are_compiled(what):
    u = waves(COMPILED[what].ninputs)
    y, run = ours(COMPILED[what], u)
    np.testing.assert_allclose(y, response(COMPILED[what], u), atol=1e-6)
    assert run.in_python == ()


@pytest.mark.parametrize("what", IN_PYTHON)
def test_nonlinear_systems_that_cannot_be_compiled_run_in_python(what):
    system = IN_PYTHON[what]
    u = waves(system.ninputs)
    y, run = ours(system, u)
    np.testing.assert_allclose(y, response(system, u), atol=1e-6)
    assert run.in_python and all(system.name in entry.blocks and entry.reason for entry in run.in_python)


def test_parameters_are_read_by_name_and_can_be_varied():
    block = as_block(COMPILED["spring"])
    assert dict(zip(block.param_names, block.p, strict=True)) == {"k": 1.5, "m": 2.0, "dt": 0.0}
    compiled = lambda t, x, u, params: u - params["k"] * x  # noqa: E731
    whole = lambda t, x, u, params: u - dict(params)["k"] * x  # noqa: E731
    for update in (compiled, whole):
        source = ct.nlsys(update, None, inputs=["F"], outputs=["x"], states=["x"], params={"k": 1.5}, name="lag")
        diagram = wire([source], inputs=["F"])
        many = ensemble(diagram, 40.0, inputs={"F": 3.0}, params={"lag.k": [1.0, 2.0]}, every=40.0)
        assert many.values["x"][:, -1] == pytest.approx([3.0, 1.5], abs=1e-5)  # analytic: rests at F/k


@pytest.mark.parametrize("later", [False, True])
def test_a_parameter_may_be_an_integer(later):
    def stages(t, x, u, params):
        total = 0.0
        for _ in range(params["n"]):
            total = total + u[0]
        return [total - x[0]]

    system = ct.nlsys(stages, None, inputs=["u"], outputs=["y"], states=["y"], params={"n": 2}, name="stages")
    diagram = wire([system], inputs=["u"])
    if later:
        diagram = diagram.with_params({"stages.n": 3})
    run = simulate(diagram, 40.0, every=40.0, inputs={"u": 1.0})
    assert run.log["y"][-1] == pytest.approx(3.0 if later else 2.0, abs=1e-6)  # analytic: rests at n u
    with pytest.raises(TypeError) as caught:
        simulate(diagram, 1.0, inputs={"u": 1.0}, params={"stages.n": 2.5})
    notes = " ".join(caught.value.__notes__)
    assert "'stages'" in notes and "n = 2.5" in notes and "whole number" in notes


def test_an_output_that_does_not_mention_the_input_does_not_follow_it_at_once():
    feeds = {name: as_block(system).kernels.feeds for name, system in {**COMPILED, **IN_PYTHON}.items()}
    assert feeds == {
        "spring": False, "no output function": False, "lambdas": False, "scalar": False, "static": True,
        "sampled": False, "two inputs": True, "params as a whole": False, "method": False, "interconnected": False,
    }  # fmt: skip
    assert as_block(COMPILED["sampled"]).kernels.feeds
    through = ct.interconnect([COMPILED["static"], COMPILED["spring"]], inplist=["tanh.u[0]"], outlist=["tanh.y[0]"],
                              inputs=1, outputs=1, name="through", warn_duplicate=False)  # fmt: skip
    assert as_block(through).kernels.feeds


def test_systems_stand_beside_blocks_in_a_loop():
    process = ct.tf([3], [10, 1], inputs="OP", outputs="PV", name="process")
    mixed = wire([Step("SP", 0.5), PI(0.4, 10.0), process])
    plain = wire([Step("SP", 0.5), PI(0.4, 10.0), FirstOrder(3.0, 10.0, inputs="OP")])
    a, b = (simulate(loop, 60.0, rtol=1e-9, atol=1e-12).log["PV"] for loop in (mixed, plain))
    np.testing.assert_allclose(a, b, atol=1e-8)
    replaced = plain.replace("process", ct.tf([1], [1, 1]))
    assert simulate(replaced, 600.0).log["PV"][-1] == pytest.approx(0.5, abs=0.02)
    assert mixed.named("a").leaves()[2].name == "a/process"


def test_a_sampled_controller_of_python_control_runs_at_its_period():
    """Oracle: python-control on the loop sampled as a whole (the process with a zero-order hold)."""
    process = ct.tf([2], [5, 1], inputs="u", outputs="y", name="process")
    controller = ct.tf([0.8, -0.7], [1, -1], 0.5, inputs="e", outputs="u", name="controller")
    junction = ct.summing_junction(["r", "-y"], "e", name="sum")
    log = simulate(wire([Constant("r", 1.0), junction, controller, process]), 20.0, every=0.5, rtol=1e-9).log
    L = ct.c2d(ct.tf([2], [5, 1]), 0.5) * ct.tf([0.8, -0.7], [1, -1], 0.5)
    exact = ct.step_response(ct.feedback(L, 1), np.arange(41) * 0.5).outputs
    np.testing.assert_allclose(log["y"], exact, atol=1e-7)


def test_start_states_have_the_labels_of_the_system():
    system = ct.ss([[-1.0]], [[1.0]], [[1.0]], [[0.0]], states=["level"], name="tank", inputs="q", outputs="h")
    run = simulate(wire([system], inputs=["q"]), 1.0, every=1.0, inputs={"q": 0.0}, start={"tank.level": 2.0})
    assert run.log["h"][-1] == pytest.approx(2.0 * np.exp(-1.0), abs=1e-5)
    loop = wire([LAMBDAS], inputs=["F"])
    assert loop.at_state([0.4, 0.6]).blocks[0].x0.tolist() == [0.4, 0.6]
    unnamed = ct.ss([[-1.0]], [[1.0]], [[1.0]], [[0.0]], inputs="q", outputs="h")  # sys[3] with the state x[0]
    assert wire([unnamed], inputs=["q"]).at_state([0.7]).blocks[0].x0.tolist() == [0.7]


REFUSALS = {
    "improper": (lambda: wire([ct.tf([1, 0, 0], [1, 1], name="PD")], inputs=["u[0]"]), ["PD", "improper", "filter"]),
    "dt": (lambda: wire([ct.tf([1], [1, 0.5], True, name="z")], inputs=["u[0]"]), ["z: dt = True", "seconds"]),
    "dt of nlsys": (
        lambda: as_block(ct.nlsys(lambda t, x, u, params: x, states=1, inputs=1, outputs=1, dt=True)), ["dt = True"],
    ),
    "frequency response": (lambda: as_block(ct.frd([1, 2], [1, 2])), ["frequency response", "transfer function"]),
    "nothing of the kind": (lambda: as_block("tf"), ["'tf'", "neither a block"]),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSALS)
def test_refusals(refuses, what):
    refuses(*REFUSALS[what])


def test_one_block_of_a_system():
    block = NonlinearSystem(COMPILED["spring"])
    assert drive(block, 1.0, every=1.0, F=0.0).log["pos"].tolist() == [0.0, 0.0]
    seen = ct.linearize(block, [0.0, 0.0], [0.0])
    np.testing.assert_allclose(seen.A, [[0.0, 1.0], [-0.75, 0.0]], atol=1e-6)  # analytic


def test_the_independent_simulator_agrees_on_a_loop_of_all_kinds():
    from stickslip.diagram.reference import simulate_reference

    loop = wire([
        Step("r", 1.0, at=1.0),
        ct.summing_junction(["r", "-y"], "e", name="sum"),
        ct.tf([0.8, -0.7], [1, -1], 0.5, inputs="e", outputs="u", name="controller"),
        ct.nlsys(lambda t, x, u, params: u - params["k"] * x**3, None, inputs=["u"], outputs=["q"], states=["q"],
                 params={"k": 0.4}, name="valve"),
        ct.ss([[0, 1], [-1, -2]], [[0], [1]], [[1, 0]], [[0]], inputs="q", outputs="z", name="tank"),
        ct.nlsys(by_name_only, lambda t, x, u, params: x[0], inputs=["z"], outputs=["y"], states=1, name="sensor"),
    ])  # fmt: skip
    run = simulate(loop, 15.0, every=0.5, rtol=1e-9, atol=1e-12)
    reference = simulate_reference(loop, 15.0, every=0.5, rtol=1e-9, atol=1e-12)
    for signal in loop.signals:
        np.testing.assert_allclose(run.log[signal], reference.log[signal], atol=1e-7)
    assert {name for entry in run.in_python for name in entry.blocks} == {"sensor"}
    assert loop.plot().axes


def by_name_only(t, x, u, params):
    return [u[0] - x[0] + 0.0 * len({**params, 1: u})]


def test_a_class_and_a_system_without_labels_are_refused_with_what_to_do():
    with pytest.raises(BlockError, match=r"PI is a class and no block; call it with its parameters: PI\(...\)"):
        wire([Step("SP", 1.0), PI])
    with pytest.raises(
        WiringError, match=r"reads signal 'u\[0\]'.*joined by its labels: give it inputs=, outputs= and name="
    ):
        wire([Step("OP", 1.0), ct.tf([1], [1, 1])])


class Called:
    """A function that cannot be read, so it is called in Python."""

    def __init__(self, function):
        self.function = function

    def __call__(self, t, x, u, params):
        return self.function(t, x, u, params)


@pytest.mark.parametrize("kind", [lambda f: f, Called], ids=["compiled", "in Python"])
@pytest.mark.parametrize("dt", [0, 0.5])
@pytest.mark.parametrize(
    ("update", "output", "sizes", "said"),
    [
        (lambda t, x, u, p: [-x[0] + u[0], 99 * u[0]], lambda t, x, u, p: x[0], (1, 1), "update .* 2 values, but 1 is"),
        (lambda t, x, u, p: [-x[0] + u[0]], lambda t, x, u, p: x[0], (2, 1), "update .* 1 value, but 2 are needed"),
        (lambda t, x, u, p: -x[0] + u[0], lambda t, x, u, p: x[0], (2, 1), "update .* 1 value, but 2 are needed"),
        (lambda t, x, u, p: -x[0] + u[0], lambda t, x, u, p: [x[0], 7.0], (1, 1), "output .* 2 values, but 1 is"),
        (lambda t, x, u, p: -x[0] + u[0], lambda t, x, u, p: x[0], (1, 2), "output .* 1 value, but 2 are needed"),
    ],
)
def test_a_function_with_another_number_of_values_is_refused(kind, dt, update, output, sizes, said):
    states, outputs = [f"x{i}" for i in range(sizes[0])], [f"y{i}" for i in range(sizes[1])]
    w = ct.nlsys(kind(update), kind(output), inputs=["u"], outputs=outputs, states=states, name="w", dt=dt)
    with pytest.raises(BlockError, match=f"w: the {said}"):
        simulate(wire([Constant("u", 1.0), w]), 10.0, every=1.0)


@pytest.mark.parametrize("kind", [lambda f: f, Called], ids=["compiled", "in Python"])
@pytest.mark.parametrize("shape", [float, lambda v: [v], lambda v: np.array([[v]])], ids=["scalar", "list", "column"])
def test_one_state_takes_one_value_of_any_shape(kind, shape):
    w = ct.nlsys(kind(lambda t, x, u, p: shape(-x[0] + u[0])), None, inputs=["u"], outputs=["y"], states=["x"])
    run = simulate(wire([Constant("u", 1.0), w]), 10.0, every=1.0)
    np.testing.assert_allclose(run.log["y"], 1.0 - np.exp(-np.arange(11.0)), atol=1e-5)  # analytic
