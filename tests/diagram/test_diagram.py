"""A diagram is a value and a python-control system; parts that do not touch each other do not feel each other."""

import copy
import pickle

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, Constant, FirstOrder, IdealValve, Ramp, SampledPI, Sine, Step, StickSlip
from stickslip.diagram import WiringError, drive, simulate, wire
from stickslip.engine import call
from stickslip.engine.entry import advance_to


def loop(F_s=2250.0, name="loop", **process):
    return wire([Step("SP", 0.5), PI(0.4, 10.0), StickSlip(F_s), FirstOrder(3.0, 10.0, **process)], name=name)


def open_loop(name="loop", F_s=2250.0):
    return loop(F_s).without("SP").named(name)


def test_nesting_gives_paths():
    unit = wire([Step("SP", 0.5), open_loop("a"), open_loop("b", 1750.0)], name="unit")
    assert unit.signals == ("SP", "a/OP", "a/MV", "a/PV", "b/OP", "b/MV", "b/PV")
    assert unit["b/valve"].params["F_s"] == 1750.0
    site = wire([unit], name="site")
    assert "unit/a/PV" in site.signals
    run = simulate(site, 20.0, params={"unit/a/valve.F_s": 1750.0})
    assert np.array_equal(run.log["unit/a/PV"], run.log["unit/b/PV"])


def test_open_inputs_are_relabelled():
    unit = wire([Step("SP1", 0.5), Step("SP2", 0.3), loop().without("SP").named("a", SP="SP1"),
                 loop().without("SP").named("b", SP="SP2")])  # fmt: skip
    run = simulate(unit, 400.0)
    assert run.log["a/PV"][-1] == pytest.approx(0.5, abs=0.06)  # analytic: within K S of the set point
    assert run.log["b/PV"][-1] == pytest.approx(0.3, abs=0.06)


def test_two_loops_in_one_diagram_equal_two_runs_bit_for_bit():
    both = wire([Step("SP", 0.5), open_loop("a"), open_loop("b", 1750.0)])
    together = simulate(both, 200.0, every=0.5)
    assert together.statistics.components == 2  # the shared set point does not join them
    for name, F_s in (("a", 2250.0), ("b", 1750.0)):
        alone = simulate(loop(F_s), 200.0, every=0.5)
        for signal in ("OP", "MV", "PV"):
            assert np.array_equal(alone.log[signal], together.log[f"{name}/{signal}"])
        assert [e.t for e in alone.events] == [e.t for e in together.events if e.block == f"{name}/valve"]


def snapshot(diagram):
    return [
        (b.name, b.p.tobytes(), b.x0.tobytes(), b.d0.tobytes(), b.y0.tobytes(), str(b.params)) for b in diagram.blocks
    ]


def test_nothing_changes_a_diagram():
    diagram = loop()
    before = snapshot(diagram), dict(diagram.params), diagram.order, diagram.name
    first = simulate(diagram, 50.0, params={"valve.F_s": 1750.0}, start={"process.PV": 0.2})
    diagram.with_params({"controller.K_p": 1.0})
    diagram.starting_at({"process.PV": 1.0})
    diagram.in_mode("ideal")
    diagram.replace("valve", IdealValve())
    diagram.named("other")
    wire([open_loop("a")], inputs=["SP"])
    first.final.with_params({"controller.K_p": 2.0})
    copy.deepcopy(diagram)
    assert (snapshot(diagram), dict(diagram.params), diagram.order, diagram.name) == before
    one, two = simulate(diagram, 100.0), simulate(diagram, 100.0)
    for signal in one.log.names:
        assert np.array_equal(one.log[signal], two.log[signal])
    assert one.events == two.events


def test_nothing_is_compiled_twice():
    simulate(loop(), 1.0)
    signatures, kernels = len(advance_to.signatures), len(call._known)
    simulate(loop(1750.0), 1.0)
    simulate(wire([Step("SP", 0.1), open_loop("a"), open_loop("b")]), 1.0, rtol=1e-8, method="stiff")
    simulate(loop(theta=1.0), 1.0, params={"process.K": 2.0})
    assert len(advance_to.signatures) == signatures == 1
    assert len(call._known) == kernels


def test_linearised_loops():
    plain = loop().part(["controller", "valve", "process"])
    open_ = plain.without("controller")
    stuck = ct.linearize(open_, [0.0, 0.0, 0.0], [0.0])
    assert abs(ct.ss2tf(stuck)(0.3j)).max() < 1e-12  # analytic: a stuck stem passes nothing
    ideal = ct.linearize(open_.in_mode("ideal"), [0.0, 0.0, 0.0], [0.0])
    s = 0.3j
    stem = 52500.0 / (1.36 * s * s + 612.0 * s + 52500.0)  # analytic
    response = np.ravel(ideal(s))
    np.testing.assert_allclose(response, [stem, stem * 3.0 / (10.0 * s + 1.0)], rtol=1e-5)


def test_operating_point_and_start_from_it():
    ideal = loop().without("SP").in_mode("ideal")
    point = ct.find_operating_point(ideal, np.zeros(4), [0.5], y0=None)
    x = np.asarray(point.states if hasattr(point, "states") else point[0])
    rest = ideal.at_state(x)
    run = simulate(rest, 50.0, inputs={"SP": 0.5}, every=5.0)
    np.testing.assert_allclose(run.log["PV"], 0.5, atol=1e-6)  # analytic: integral action leaves no error
    np.testing.assert_allclose(run.log["MV"], 0.5 / 3.0, atol=1e-6)


def test_python_control_simulates_the_same():
    smooth = wire([PI(0.4, 10.0, low=-np.inf, high=np.inf), IdealValve(), FirstOrder(3.0, 10.0)], inputs=["SP"])
    t = np.linspace(0.0, 40.0, 81)
    sp = 0.3 + 0.2 * np.sin(0.4 * t)
    theirs = ct.input_output_response(
        smooth, t, sp[np.newaxis], smooth.x0, solve_ivp_method="DOP853", solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-12}
    )
    ours = simulate(smooth, 40.0, times=t, inputs={"SP": (t, sp)}, rtol=1e-10, atol=1e-12)
    for i, signal in enumerate(smooth.output_labels):
        np.testing.assert_allclose(ours.log[signal], theirs.outputs[i], atol=1e-6)


def test_diagram_of_sources_only_and_of_nothing_that_moves():
    run = simulate(wire([Sine("a", 1.0, 4.0), Constant("b", 2.0)], outputs=["a", "b"]), 4.0, every=1.0)
    np.testing.assert_allclose(run.log["a"], [0.0, 1.0, 0.0, -1.0, 0.0], atol=1e-12)
    assert run.log["b"].tolist() == [2.0] * 5


def test_zero_dead_time_is_no_state_for_python_control():
    late = loop(theta=1.0)
    assert late.with_params({"process.theta": 0.0}).nstates == loop().nstates < late.nstates


def test_a_changed_copy_keeps_the_outputs_declared_even_where_they_are_all_signals():
    loop = wire([Sine("e", amplitude=1.0, period=5.0)], outputs=["e"])
    assert loop.replace("e", Sine("e", amplitude=2.0, period=5.0)).signals == ("e",)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.with_params({"valve.F_s": "big"}), "valve: F_s = 'big', but it must be a single number"),
        (lambda d: d.with_params({"valve.F_s": [1.0, 2.0]}), "but it must be a single number"),
        (lambda d: d.starting_at({"process.PV": np.nan}), "'process.PV' is to start at nan"),
        (lambda d: d.starting_at({"process.PV": None}), "but it must be a single number"),
        (lambda d: d.starting_at({"valve.mode": 7.0}), r"mode = 7.0, but the modes are 0 \(stuck\)"),
        (lambda d: d.replace("valve", d), "'valve' cannot be replaced by Diagram: it is no block"),
        (lambda d: d[0], "no block '0'"),
    ],
)
def test_values_that_are_none_are_refused_with_their_place(change, words):
    with pytest.raises(ValueError, match=words):
        change(loop())


def test_one_name_is_a_part():
    assert loop().part("process").open_inputs == loop().part(["process"]).open_inputs == ("MV",)


def test_a_hint_names_some_blocks_not_all():
    chain = [FirstOrder(1.0, 1.0, name=f"p{i}", inputs=f"y{i}", outputs=f"y{i + 1}") for i in range(9)]
    run = simulate(wire([Constant("y0", 1.0), *chain]), 10.0, max_steps=1)
    assert not run.ok and run.hint.endswith("in y0, p0, p1, p2, p3, p4 and 4 more)")


# --- params are to be looked at -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "change",
    [
        lambda loop: loop.params.__setitem__("process.K", 2.0),
        lambda loop: loop.params.update({"process.K": 2.0}),
        lambda loop: loop.params.pop("process.K"),
        lambda loop: loop.params.__ior__({"process.K": 2.0}),
        lambda loop: setattr(loop, "params", {"process.K": 2.0}),
        lambda loop: loop["process"].params.__setitem__("K", 2.0),
        lambda loop: loop["process"].params.clear(),
        lambda loop: loop.with_params({"process.K": 1.0}).params.__setitem__("process.K", 2.0),
    ],
)
def test_a_parameter_written_into_params_is_refused_with_the_remedy(change):
    loop = wire([Step("MV"), FirstOrder(K=3.0, tau=10.0)])
    with pytest.raises(TypeError, match="with_params") as refusal:
        change(loop)
    assert "would change nothing" in str(refusal.value)
    assert loop.params["process.K"] == 3.0 == loop["process"].params["K"]


def test_python_control_copies_and_pickle_work_with_fixed_params():
    free = PI(K_p=0.4, T_i=10.0, low=-np.inf, high=np.inf, outputs="MV")
    loop = wire([free, FirstOrder(K=3.0, tau=10.0)], inputs=["SP"], outputs=["PV"])
    for twin in (copy.copy(loop.params), copy.deepcopy(loop.params), pickle.loads(pickle.dumps(loop.params))):
        assert twin == loop.params and type(twin) is type(loop.params)
    assert type(loop.params | {}) is type({} | loop.params) is type(loop.params.copy()) is dict
    # analytic: s^2 + (1 + 3 K_p)/10 s + 3 K_p/100 with the other gain given for one call only
    poles = ct.linearize(loop, loop.x0, [0.0], params={"process.K": 2.0}).poles()
    assert np.prod(poles).real == pytest.approx(0.4 * 2.0 / 100.0, rel=1e-5)
    for system in (loop.copy("twin"), ct.series(loop, ct.tf([1.0], [1.0, 1.0])), ct.feedback(loop, 1.0)):
        assert system.nstates >= 2
    assert copy.deepcopy(loop).with_params({"process.K": 5.0}).params["process.K"] == 5.0


def test_a_part_keeps_the_outputs_declared_that_it_drives():
    declared = wire([*loop().blocks], outputs=["PV", "OP"])
    assert declared.part(["process", "valve"]).output_labels == ["PV"]
    assert declared.without("controller").output_labels == ["PV"]
    assert declared.part(["controller"]).declared_outputs == ("OP",)
    assert declared.part(["valve"]).output_labels == ["MV"]  # none of those declared: all, as by default
    assert loop().part(["process"]).declared_outputs is None


def test_a_source_may_stand_alone_where_it_is_no_slip_of_the_pen():
    ramp = Ramp("F", slope=2.0)
    assert drive(ramp, 3.0, every=1.0).log["F"].tolist() == [0.0, 2.0, 4.0, 6.0]  # analytic: 2 t
    assert loop().part(["SP"]).signals == ("SP",)
    with pytest.raises(WiringError, match="no block reads 'F' from source 'F'"):
        wire([*loop().blocks, ramp])


def test_a_printed_diagram_lists_its_blocks_not_the_twins_that_python_control_sees():
    blocks = [SampledPI(1.0, 10.0, dt=1.0, name="TC"), FirstOrder(1.0, 10.0, inputs="OP", outputs="PV")]
    assert str(wire(blocks, inputs=["SP"], name="loop")).splitlines() == [
        "Diagram 'loop' of 2 blocks, open inputs SP",
        "  SampledPI 'TC': SP, PV -> OP",
        "  FirstOrder 'process': OP -> PV",
    ]
