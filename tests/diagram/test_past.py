"""A run that goes on where another ended keeps what was under way, whatever is changed, or says what it would lose.

Expected numbers are analytic (a delayed ramp, counted samples) or those of one run without the cut.
"""

import numpy as np
import pytest
from stickslip.blocks import PI, Constant, DeadTime, FirstOrder, Gain, IdealValve, Ramp, SampledPI, SampledSensor, Step
from stickslip.diagram import WiringError, ensemble, simulate, wire
from stickslip.diagram.reference import simulate_reference

CUT = 4.0


def delayed_ramp(theta=3.0, name="ramp"):
    """late(t) = 2 (t - 3), from a ramp, a gain and a dead time."""
    parts = [Ramp("in", slope=1.0), Gain("out", "in", 2.0), DeadTime(theta, inputs="out", outputs="late")]
    return wire(parts, outputs=["late"], name=name)


def scanned():
    """A sampled loop whose samples fall on the cut; a dead time behind it."""
    controller = SampledPI(0.4, 5.0, dt=0.5, inputs={"PV": "PV_m"})
    sensor = SampledSensor(dt=1.0, inputs="PV", outputs="PV_m")
    return wire([Step("SP", 0.5, at=0.2), controller, IdealValve(inputs="OP", outputs="MV"),
                 FirstOrder(2.0, 3.0, 0.7), sensor], name="scanned")  # fmt: skip


CHANGES = {
    "nothing": lambda d: d,
    "a parameter to what it is": lambda d: d.with_params({d.blocks[1].name + "." + d.blocks[1].param_names[0]:
                                                          float(d.blocks[1].p[0])}),
    "a block without memory by its like": lambda d: d.replace(d.blocks[0].name, d.blocks[0]),
    "another name": lambda d: d.named("other"),
    "its source taken out and put back": lambda d: wire(
        [d.blocks[0], d.without(d.blocks[0].name).named("a")], outputs=[f"a/{s}" for s in d.signals[1:]]
    ),
    "parts": lambda d: d.part([b.name for b in d.blocks]),
}  # fmt: skip


@pytest.mark.parametrize("make", [delayed_ramp, scanned])
@pytest.mark.parametrize("change", CHANGES)
def test_a_change_that_is_none_changes_nothing(make, change):
    settings = {"times": [4.0, 4.1, 4.5, 6.0, 9.0], "rtol": 1e-10, "atol": 1e-12}
    whole = simulate(make(), 9.0, **settings)
    final = CHANGES[change](simulate(make(), CUT).final)
    after = simulate(final, 5.0, t0=CUT, **settings)
    for signal in after.log.names:
        np.testing.assert_allclose(after.log[signal], whole.log[signal.removeprefix("a/")], atol=1e-8, err_msg=signal)


def test_what_is_under_way_stays_when_something_else_changes():
    final = simulate(delayed_ramp(), CUT).final
    for changed in (final.with_params({"out.factor": 5.0}), final.replace("out", Gain("x", "y", 5.0))):
        late = simulate(changed, 5.0, t0=CUT, times=[4.0, 6.9, 8.0]).log["late"]
        np.testing.assert_allclose(late, [2.0, 7.8, 25.0], atol=1e-9)  # analytic: 2 (t - 3), from t = 7 on 5 (t - 3)


def test_a_dead_time_may_be_cut_short_or_taken_out_but_not_invented():
    final = simulate(delayed_ramp(), CUT).final
    shorter = simulate(final.with_params({"dead_time.theta": 1.0}), 2.0, t0=CUT, times=[4.5, 5.5]).log["late"]
    np.testing.assert_allclose(shorter, [7.0, 9.0], atol=1e-9)  # analytic: 2 (t - 1)
    none = simulate(final.with_params({"dead_time.theta": 0.0}), 2.0, t0=CUT, times=[4.5]).log["late"]
    np.testing.assert_allclose(none, [9.0], atol=1e-9)
    with pytest.raises(ValueError, match=r"dead_time: the dead time is 5 s, .* kept 3 s .*with_past\(None\)"):
        simulate(final.with_params({"dead_time.theta": 5.0}), 2.0, t0=CUT)
    with pytest.raises(ValueError, match=r"out: the dead time is 1 s, .* kept 0 s"):
        simulate(final.replace("out", DeadTime(1.0)), 2.0, t0=CUT)


def test_a_controller_taken_in_on_the_way():
    running = simulate(scanned(), CUT)
    OP = float(running.log["OP"][-1])
    swapped = running.final.replace("controller", SampledPI(0.4, 5.0, dt=0.5, offset=0.25))
    log = simulate(swapped, 1.0, t0=CUT, times=[4.0, 4.2, 4.3]).log
    assert log["OP"][:2].tolist() == [OP, OP] and log["OP"][2] != OP  # analytic: held until its first sample
    plain = simulate(wire([Constant("SP", 0.5), PI(0.4, 5.0), FirstOrder(2.0, 3.0, inputs="OP")]), CUT).final
    joins = plain.replace("controller", SampledPI(0.4, 5.0, dt=0.5))
    PV = float(plain["process"].x0[0])
    now = simulate(joins, 1.0, t0=CUT, times=[4.0]).log["OP"][0]
    assert now == pytest.approx(0.4 * (0.5 - PV), abs=0.03)  # analytic but for the first integration: it has sampled


@pytest.mark.parametrize("make", [delayed_ramp, scanned])
def test_a_forgotten_start_time_is_refused(make):
    final = simulate(make(), CUT).final
    with pytest.raises(ValueError, match=r"t0 = 0.0, .* ended at 4.0 s, .* give t0=4.0, or .*with_past\(None\)"):
        simulate(final, 1.0)
    with pytest.raises(ValueError, match=r"give t0=4\.0"):
        ensemble(final, 1.0, seeds=[1, 2])
    with pytest.raises(ValueError, match="the reference goes on from no run"):
        simulate_reference(final, 1.0, t0=CUT)
    assert simulate(final.with_past(None), 1.0).ok
    assert simulate(final.with_past(None).with_past(final.past), 1.0, t0=CUT).ok
    assert final.past is not None and make().past is None


def test_where_nothing_is_under_way_any_time_will_do():
    final = simulate(wire([Constant("MV", 1.0), FirstOrder(2.0, 5.0)]), CUT).final
    again = simulate(final, 5.0, every=5.0).log["PV"]
    np.testing.assert_allclose(again, 2.0 * (1.0 - np.exp([-0.8, -1.8])), atol=1e-5)  # analytic


def test_diagrams_with_different_ends_are_not_joined():
    one, two = simulate(delayed_ramp(), 4.0).final, simulate(delayed_ramp(), 5.0).final
    with pytest.raises(WiringError, match="4 and 5 s"):
        wire([one.named("a"), two.named("b")], outputs=["a/late", "b/late"])
    late = simulate(wire([one.named("a"), one.named("b")], outputs=["a/late", "b/late"]), 1.0, t0=4.0).log["b/late"]
    np.testing.assert_allclose(late[[0, -1]], [2.0, 4.0], atol=1e-9)
