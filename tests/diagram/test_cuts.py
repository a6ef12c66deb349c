"""Cut, insert, rewire, segments: what a changed diagram reads is what was asked for, and everything else stays.

Expected numbers are analytic, or those of the diagram before the change, or of one wired by hand.
"""

import control as ct
import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from stickslip.blocks import (
    PI,
    Constant,
    DeadTime,
    FirstOrder,
    Gain,
    IdealValve,
    Noise,
    Ramp,
    SampledPI,
    SampledSensor,
    Sine,
    Step,
    StickSlip,
    Sum,
)
from stickslip.diagram import WiringError, held, interpolated, simulate, wire

from tests.diagram.random_diagrams import random_diagram

SEEDS = range(24)
T = 20.0
EXACT = {"every": 0.37, "rtol": 1e-9, "atol": 1e-11}


def loop(**process):
    return wire([Step("SP", 0.5), PI(0.4, 10.0), IdealValve(), FirstOrder(3.0, 10.0, **process)], name="loop")


def read_signals(diagram):
    return [s for s in diagram.signals if any(s in block.input_labels for block in diagram.blocks)]


def differ(one, other, signals):
    return max(float(np.abs(one.log[s] - other.log[s]).max()) for s in signals)


# --- cut --------------------------------------------------------------------------------------------------
def test_a_cut_opens_the_readers_and_leaves_the_driver():
    opened = loop().cut(["PV", "OP"])
    assert opened.open_inputs == ("PV", "OP")
    assert opened.signals == ("SP", "OP:controller", "MV", "PV:process")
    assert opened["controller"].input_labels == ["SP", "PV"]
    assert opened.cut("PV").open_inputs == ("PV", "OP")  # an open input stays one


def sampled_signal(diagram, rng):
    """Return a signal that stands still between the samples of its block, and its sampling times."""
    found = [s for s in read_signals(diagram) if diagram.blocks[diagram.driven[s][0]].sampled]
    signal = found[rng.integers(len(found))]
    dt = diagram.blocks[diagram.driven[signal][0]].period
    return signal, np.arange(int(T / dt) + 1) * dt


@pytest.mark.parametrize("seed", SEEDS)
def test_feeding_back_what_was_recorded_gives_the_same_run(seed):
    diagram = random_diagram(seed)
    signal, stamps = sampled_signal(diagram, np.random.default_rng(seed))
    whole = simulate(diagram, T, **EXACT)
    record = simulate(diagram, T, times=stamps, rtol=1e-9, atol=1e-11).log
    opened = diagram.cut(signal)
    again = simulate(opened, T, inputs={signal: held(record)}, **EXACT)
    assert differ(whole, again, diagram.signals) < 1e-8
    (driven,) = set(opened.signals) - set(diagram.signals)
    np.testing.assert_allclose(again.log[driven], whole.log[signal], atol=1e-8)
    moved = record.with_signals(**{signal: record[signal] + 0.1})  # what is fed back is what is read
    assert differ(whole, simulate(opened, T, inputs={signal: moved}, **EXACT), diagram.signals) > 0.05


def test_straight_lines_between_the_samples_of_a_smooth_signal_cost_the_square_of_the_interval():
    """Analytic: joining samples h apart is wrong by at most h^2/8 max|PV''|, so half of h is a quarter of the error."""
    smooth = wire([Sine("SP", 0.2, 20.0, mean=0.5), *loop().blocks[1:]])
    whole = simulate(smooth, T, every=0.05, rtol=1e-10, atol=1e-12)
    errors = []
    for h in (0.4, 0.2, 0.1):
        log = simulate(smooth, T, every=h, rtol=1e-10, atol=1e-12).log
        again = simulate(smooth.cut("PV"), T, every=0.05, inputs={"PV": interpolated(log)}, rtol=1e-10, atol=1e-12)
        errors.append(np.abs(again.log["OP"] - whole.log["OP"]).max())
    np.testing.assert_allclose([errors[0] / errors[1], errors[1] / errors[2]], 4.0, rtol=0.1)


def test_a_cut_loop_is_its_loop_transfer():
    opened = wire([PI(0.4, 10.0, start_op=0.5), IdealValve(), FirstOrder(3.0, 10.0)], inputs=["SP"]).cut("PV")
    L = -ct.linearize(opened, opened.x0, [0.0, 0.0])  # SP, PV -> OP, MV, PV:process
    i, j = opened.output_labels.index("PV:process"), opened.input_labels.index("PV")
    for omega in (0.01, 0.12, 1.0):
        s = 1j * omega
        expected = 0.4 * (1.0 + 1.0 / (10.0 * s)) * 3.0 / (10.0 * s + 1.0)  # analytic, an ideal valve is a gain of 1
        np.testing.assert_allclose(np.atleast_2d(L(s))[i, j], expected, rtol=1e-6)


def test_a_cut_keeps_outputs_inputs_values_units_and_what_is_under_way():
    unit = wire([PI(0.4, 10.0), IdealValve(), FirstOrder(3.0, 10.0, theta=2.0, start=0.3, units={"PV": "bar"})],
                inputs=["SP"], outputs=["PV", "OP"], name="unit")  # fmt: skip
    opened = unit.cut("PV")
    assert opened.open_inputs == ("SP", "PV")
    assert opened.declared_outputs == ("PV:process", "OP")
    assert opened.params == unit.params and opened["process"].x0.tolist() == [0.3]
    assert opened.input_units["PV"] == opened.signal_units["PV:process"] == "bar"
    final = simulate(unit, 10.0, inputs={"SP": 0.5}).final.without("SP")
    ahead = simulate(final, 1.9, t0=10.0, every=0.1, inputs={"SP": 0.5})  # what comes is in the dead time
    cut = simulate(final.cut("PV"), 1.9, t0=10.0, every=0.1, inputs={"SP": 0.5, "PV": 0.0})
    np.testing.assert_allclose(cut.log["PV:process"], ahead.log["PV"], atol=1e-7)


def test_a_source_that_is_cut_goes_on_alone():
    opened = loop().cut("SP")
    run = simulate(opened, 1.0, inputs={"SP": 0.2}, every=1.0)  # a block is called SP already
    assert run.log["SP:SP"][-1] == 0.5 and run.log["SP"][-1] == 0.2


def test_nested_diagrams_go_by_their_full_names():
    site = wire([Step("SP", 0.5), loop().without("SP").named("a"), loop().without("SP").named("b")], name="site")
    opened = site.cut("a/PV")
    assert opened.open_inputs == ("a/PV",) and "a/PV:process" in opened.signals and "b/PV" in opened.signals
    inside = wire([loop().cut("PV").named("a"), Constant("PV", 0.1)])
    assert "a/PV:process" in inside.signals and inside["a/controller"].input_labels == ["a/SP", "PV"]
    biased = site.insert("a/PV", Gain("bias", "x", 1.0, offset=0.1))
    assert biased["bias"].input_labels == ["a/PV:process"] and biased["a/controller"].input_labels == ["SP", "a/PV"]
    crossed = site.rewire("a/controller", "PV", "b/PV")
    assert crossed["a/controller"].input_labels == ["SP", "b/PV"]


# --- insert -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("seed", SEEDS)
def test_a_gain_of_one_changes_nothing(seed):
    diagram, rng = random_diagram(seed), np.random.default_rng(seed)
    found = read_signals(diagram)
    signal = found[rng.integers(len(found))]
    reading = [block.name for block in diagram.blocks if signal in block.input_labels]
    whole = simulate(diagram, T, **EXACT)
    for readers in (None, reading, reading[:1]):
        same = simulate(diagram.insert(signal, Gain("unit", "x", 1.0), readers), T, **EXACT)
        assert same.ok and differ(whole, same, diagram.signals) < 1e-12
        one = simulate(diagram.insert(signal, Gain("unit", "x", 1.0, offset=0.1), readers), T, **EXACT)
        assert differ(whole, one, diagram.signals) > 1e-3


def test_where_a_bias_is_put_says_who_sees_it():
    """Analytic: with an integral part what the controller reads settles at SP."""
    rest = {"duration": 400.0, "every": 400.0}
    bias = Gain("bias", "in", 1.0, offset=0.1)
    in_sensor = simulate(loop().insert("PV", bias), **rest).log  # whoever logs PV sees the bias
    assert in_sensor["PV"][-1] == pytest.approx(0.5) and in_sensor["PV:process"][-1] == pytest.approx(0.4)
    in_input = simulate(loop().insert("PV", bias, readers="controller"), **rest).log  # the controller alone
    assert in_input["PV"][-1] == pytest.approx(0.4) and in_input["PV:bias"][-1] == pytest.approx(0.5)


def test_an_insertion_is_the_diagram_wired_by_hand():
    by_hand = wire([Step("SP", 0.5), PI(0.4, 10.0, inputs=["SP", "PV_f"]), IdealValve(), FirstOrder(3.0, 10.0),
                    FirstOrder(1.0, 2.0, name="filter", inputs="PV", outputs="PV_f")])  # fmt: skip
    made = loop().insert("PV", FirstOrder(1.0, 2.0, name="filter"), readers=["controller"])
    expected, run = simulate(by_hand, 60.0, rtol=1e-9).log, simulate(made, 60.0, rtol=1e-9).log
    np.testing.assert_allclose(run["PV:filter"], expected["PV_f"], atol=1e-12)
    np.testing.assert_allclose(run["PV"], expected["PV"], atol=1e-12)


def test_one_insertion_after_another():
    twice = loop().insert("PV", Gain("a", "x", 2.0)).insert("PV", Gain("b", "x", 3.0))
    assert [twice[name].input_labels for name in ("a", "b", "controller")] == [["PV:process"], ["PV:a"], ["SP", "PV"]]
    log = simulate(twice, 5.0).log
    np.testing.assert_allclose(log["PV"], 6.0 * log["PV:process"], atol=1e-12)


def test_an_insertion_at_an_open_input_and_at_a_signal_that_nobody_reads():
    filtered = loop().without("SP").insert("SP", FirstOrder(1.0, 5.0, name="filter"))
    assert filtered.open_inputs == ("SP",) and filtered["controller"].input_labels == ["SP:filter", "PV"]
    rig = wire([Constant("u", 1.0), FirstOrder(2.0, 1.0, inputs="u", outputs="y")])
    scaled = simulate(rig.insert("y", Gain("percent", "x", 100.0)), 30.0).log
    assert scaled["y"][-1] == pytest.approx(200.0) and scaled["y:process"][-1] == pytest.approx(2.0)


def test_several_blocks_are_inserted_as_a_diagram():
    leak = wire([Ramp("drift", slope=0.01), Sum("out", {"in": 1.0, "drift": 1.0})], inputs=["in"], outputs=["out"],
                name="leak")  # fmt: skip
    log = simulate(loop().insert("PV", leak), 10.0, every=1.0).log
    np.testing.assert_allclose(log["PV"] - log["PV:process"], 0.01 * log.t, atol=1e-12)  # analytic
    assert "leak/drift" in log


def test_a_system_of_python_control_is_inserted_as_it_is():
    made = loop().insert("PV", ct.tf([1.0], [2.0, 1.0], name="lag"), readers=["controller"])
    like = loop().insert("PV", FirstOrder(1.0, 2.0, name="lag"), readers=["controller"])
    expected, run = simulate(like, 30.0, rtol=1e-9).log, simulate(made, 30.0, rtol=1e-9).log
    np.testing.assert_allclose(run["PV:lag"], expected["PV:lag"], atol=1e-8)
    assert made.driven.keys() == like.driven.keys()


def test_of_several_ports_the_one_of_the_name_lies_in_the_path():
    loaded = loop().insert("MV", Sum("MV", {"MV": 1.0, "D": -1.0}, name="load"), inputs=["D"])
    assert loaded.open_inputs == ("D",) and loaded["load"].input_labels == ["MV:valve", "D"]
    log = simulate(loaded, 400.0, inputs={"D": 0.1}, every=400.0).log
    assert log["PV"][-1] == pytest.approx(0.5)
    assert log["MV:valve"][-1] - log["MV"][-1] == pytest.approx(0.1)  # analytic: rest


def test_an_insertion_keeps_outputs_random_numbers_and_what_is_under_way():
    noisy = wire([*loop(theta=2.0).named("loop").blocks[:3], FirstOrder(3.0, 10.0, 2.0, outputs="P"),
                  Noise("D", 0.01, dt=0.5), Sum("PV", {"P": 1.0, "D": 1.0})], outputs=["PV", "OP"])  # fmt: skip
    made = noisy.insert("P", Gain("unit", "x", 1.0))
    assert made.declared_outputs == ("PV", "OP") and made.blocks[4].name == "D"  # streams go by a block's place
    final = simulate(noisy, 10.0).final
    expected = simulate(final, 5.0, t0=10.0, every=0.1).log["PV"]
    run = simulate(final.insert("P", Gain("unit", "x", 1.0)), 5.0, t0=10.0, every=0.1)
    np.testing.assert_allclose(run.log["PV"], expected, atol=1e-12)


def test_a_block_inserted_on_the_way_samples_at_once():
    """Also if a block of its name was there before, and its samples or dead time are still known."""
    sensor = SampledSensor(dt=2.0, inputs="PV", outputs="m", name="sensor")
    controller = SampledPI(0.4, 5.0, dt=0.5, inputs={"PV": "m"})
    final = simulate(wire([Constant("SP", 0.5), controller, FirstOrder(2.0, 3.0, inputs="OP"), sensor]), 4.0).final
    gone = final.without("sensor").rewire("controller", "m", "PV")
    back = gone.insert("PV", SampledSensor(dt=2.0, name="sensor"), readers=["controller"])
    log = simulate(back, 0.5, t0=4.0, times=[4.0, 4.2]).log
    assert log["PV:sensor"][-1] == pytest.approx(log["PV"][0], abs=1e-9)
    delayed = wire([Ramp("a", 1.0), DeadTime(2.0, inputs="a", outputs="b"), Gain("c", "b", 1.0)])
    gone = simulate(delayed, 5.0).final.rewire("c", "b", "a").without("dead_time")
    with pytest.raises(ValueError, match="dead_time: the dead time is 2 s, but the run before kept 0 s"):
        simulate(gone.insert("a", DeadTime(2.0)), 1.0, t0=5.0)


# --- rewire -----------------------------------------------------------------------------------------------
def test_rewiring_there_and_back_is_no_change():
    whole = simulate(loop(), 30.0).log
    there = loop().rewire("process", "MV", "OP")
    assert there["process"].input_labels == ["OP"] and "MV" in there.signals
    back = simulate(there.rewire("process", "OP", "MV"), 30.0).log  # by its label, too
    for signal in whole.names:
        assert (back[signal] == whole[signal]).all()


def test_rewiring_to_an_open_input_and_away_from_one():
    open_ = loop().without("SP")
    cascade = open_.rewire("controller", "SP", "r", inputs=["r"])
    assert cascade.open_inputs == ("r",) and cascade["controller"].input_labels == ["r", "PV"]
    alone = wire([Step("SP", 0.5), FirstOrder(1.0, 5.0, inputs="SP"), Gain("y", "PV", 2.0)]).rewire(
        "process", "SP", "y"
    )
    assert alone.signals == ("SP", "PV", "y")  # the source stays, read by nobody


# --- segments ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("seed", SEEDS)
def test_segments_are_the_blocks_that_other_signals_join(seed):
    diagram, rng = random_diagram(seed), np.random.default_rng(seed)
    logged = [str(s) for s in rng.permutation(diagram.signals)[: rng.integers(1, len(diagram.signals) + 1)]]
    found = diagram.segments(logged)
    names = [block.name for block in diagram.blocks]
    assert sorted(name for segment in found for name in segment.blocks) == sorted(names)  # each block once
    pairs = [(diagram.driven[s][0], b) for b, block in enumerate(diagram.blocks)
             for s in block.input_labels if s not in logged]  # fmt: skip
    table = coo_array((np.ones(len(pairs)), tuple(np.array(pairs, dtype=int).reshape(-1, 2).T)), (len(names),) * 2)
    label = connected_components(table, directed=False)[1]
    assert {frozenset(s.blocks) for s in found} == {
        frozenset(np.array(names)[label == k].tolist()) for k in range(label.max() + 1)
    }
    driven = [signal for segment in found for signal in segment.drives]
    assert sorted(driven) == sorted(logged)
    for segment in found:
        assert set(segment.reads) <= set(logged)
        assert segment.diagram.open_inputs == segment.reads
        if segment.drives:
            assert [s.split(":")[0] for s in segment.diagram.output_labels] == list(segment.drives)
        assert [block.name for block in segment.diagram.blocks] == list(segment.blocks)


@pytest.mark.parametrize("seed", SEEDS[:8])
def test_each_segment_runs_on_the_log_as_it_runs_in_the_whole(seed):
    diagram = random_diagram(seed)
    signal, stamps = sampled_signal(diagram, np.random.default_rng(seed))
    record = simulate(diagram, T, times=stamps, rtol=1e-9, atol=1e-11).log
    whole = simulate(diagram, T, **EXACT).log
    for segment in diagram.segments([signal]):
        log = simulate(segment.diagram, T, inputs=record if segment.reads else None, **EXACT).log
        for driven in log.names:
            expected = whole[driven if driven in whole else signal]
            np.testing.assert_allclose(log[driven], expected, atol=1e-8, err_msg=driven)


def test_a_segment_that_reads_what_it_drives_is_cut_there():
    sticky = wire([Step("SP", 0.5), PI(0.4, 10.0), StickSlip(), FirstOrder(3.0, 10.0)])
    (source, rest) = sticky.segments(["SP", "PV"])
    assert rest.blocks == ("controller", "valve", "process")
    assert (rest.reads, rest.drives) == (("SP", "PV"), ("PV",)) and rest.diagram.output_labels == ["PV:process"]
    assert repr(source) == "<Segment SP: reads nothing, drives SP>"
    (whole,) = sticky.without("SP").segments("SP")
    assert whole.reads == ("SP",) and whole.drives == () and whole.diagram.output_labels == ["OP", "MV", "PV"]


# --- refusals ---------------------------------------------------------------------------------------------
TWO = Sum("y", {"a": 1.0, "b": 1.0})
PAIR = wire([FirstOrder(1.0, 1.0, name="f", inputs="in", outputs="x"), Gain("y", "x", 1.0)], inputs=["in"], name="pair")
REFUSED = {
    "unknown signal": (lambda d: d.cut("PVV"), "no signal 'PVV'; did you mean 'PV'"),
    "no text": (lambda d: d.cut([3]), "signals = .3., but it must be a list of texts"),
    "no list": (lambda d: d.cut(3), "3 is no list"),
    "read by nobody": (lambda d: d.part(["process"]).cut("PV"), "no block reads 'PV', so there is nothing to cut"),
    "logged": (lambda d: d.segments(["OPP"]), "no signal 'OPP'; did you mean 'OP'"),
    "nowhere": (lambda d: d.insert("X", Gain("g", "x", 1.0)), "no signal 'X'"),
    "no block": (lambda d: d.insert("PV", "gain"), "'gain' is neither a block nor a diagram"),
    "no reader": (lambda d: d.insert("PV", Gain("g", "x", 1.0), "valve"), "'valve' does not read 'PV'; known: c"),
    "unknown reader": (lambda d: d.insert("PV", Gain("g", "x", 1.0), ["valv"]), "no block 'valv'; did you mean"),
    "no readers": (lambda d: d.insert("PV", Gain("g", "x", 1.0), []), "readers = .. names no reader of 'PV'"),
    "name taken": (lambda d: d.insert("PV", Gain("valve", "x", 1.0)), "two blocks are called 'valve'"),
    "two inputs": (lambda d: d.insert("PV", TWO), "'y' has 2 inputs .a, b., so which one lies in the path of 'PV'"),
    "two outputs": (lambda d: d.insert("PV", PAIR), "'pair' has 2 outputs .x, y., so .* label that one 'PV'"),
    "not driven": (lambda d: d.insert("a", TWO, inputs=["b"]), "no signal 'a'"),
    "algebraic": (lambda d: d.rewire("valve", "OP", "MV"), "algebraic loop"),
    "unknown block": (lambda d: d.rewire("valv", "OP", "PV"), "no block 'valv'; did you mean 'valve'"),
    "unknown port": (lambda d: d.rewire("controller", "PVV", "MV"), "'controller' has no input 'PVV'; did you mean"),
    "nothing drives": (lambda d: d.rewire("controller", "PV", "PX"), "reads signal 'PX', which nothing drives"),
    "twice": (lambda d: d.rewire("controller", "PV", "SP"), "two inputs labelled 'SP'"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_is_refused_with_the_remedy(what):
    change, words = REFUSED[what]
    with pytest.raises(ValueError, match=words):
        change(loop())


def test_a_name_that_is_taken_is_refused():
    again = loop().cut("PV").named("x")
    closed = wire([*again.blocks, Gain("PV", "PV:process", 1.0, name="process:1")])
    assert closed.cut("PV").open_inputs == ("PV",)  # PV:process:1, not PV:process
    taken = wire([*loop().blocks, Gain("PV:process", "PV", 1.0)])
    with pytest.raises(WiringError, match="'PV' as block 'process' gives it would be called 'PV:process', but"):
        taken.cut("PV")
