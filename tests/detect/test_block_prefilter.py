"""The prefilter in the loop equals the filter on the logged samples; python-control sees a wire."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, BlockError, FirstOrder, SampledSensor, Step, StickSlip
from stickslip.detect.blocks import PrefilterBlock
from stickslip.detect.signals import prefilter
from stickslip.diagram import simulate, wire

WINDOW, SD = 128, 0.002


def loop(window, **more):
    return wire(
        [
            Step("SP", 0.55),
            PI(K_p=0.6, T_i=8.0, start_op=0.42),
            StickSlip.from_bands(S=0.06, J=0.03, start=0.40),
            FirstOrder(K=1.3, tau=5.0, theta=1.0, start=0.52),
            SampledSensor(dt=1.0, sd=SD, seed=11),
            PrefilterBlock(1.0, inputs="PV_m", window=window, **more),
        ]
    )


def test_with_given_noise_it_equals_the_filter():
    log = simulate(loop(0, noise_std=SD, q=1e-5), 300.0, every=1.0).log
    offline = prefilter.filter(prefilter.Params(SD, 1e-5), log.t, log["PV_m"])
    np.testing.assert_array_equal(log["PV_f"], offline.level)
    np.testing.assert_array_equal(log["noise"], SD)


def test_it_learns_the_noise_window_by_window():
    log = simulate(loop(WINDOW), 600.0, every=1.0).log
    params = prefilter.Params(0.01, 1e-6)
    state, start, level, noise = prefilter.init(params), 0, [], []
    for k in range(len(log)):
        if k + 1 - start == WINDOW:
            params = prefilter.estimate(log.t[start : k + 1], log["PV_m"][start : k + 1])
            start = k + 1
        state = prefilter.update(params, state, float(log.t[k]), float(log["PV_m"][k]))
        level.append(state.x[0])
        noise.append(params.noise_std)
    np.testing.assert_array_equal(log["PV_f"], level)
    np.testing.assert_array_equal(log["noise"], noise)
    assert set(np.round(log["noise"][: WINDOW - 1], 12)) == {0.01}  # as given, until the window is full
    assert log["noise"][-1] == pytest.approx(SD, rel=0.35)  # the true noise, from 128 samples of a moving signal


def test_it_filters():
    log = simulate(loop(0, noise_std=SD, q=1e-6), 600.0, every=1.0).log
    rough = np.std(np.diff(log["PV_m"], 2))
    assert np.std(np.diff(log["PV_f"], 2)) < 0.5 * rough


@pytest.mark.parametrize("level", [0.0, 0.5])
def test_a_loop_at_rest_does_not_upset_it(level):
    """A window without any noise must not set the noise to zero."""
    run = simulate(wire([Step("PV", level), PrefilterBlock(1.0, window=32)]), 100.0, every=1.0)
    assert run.ok
    np.testing.assert_allclose(run.log["PV_f"], level, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(run.log["noise"], 0.01)


def test_bad_samples_before_the_first_good_one_give_nan():
    host = PrefilterBlock(1.0, window=32).host
    state, none = host.init(np.zeros(0)), np.zeros(0)
    for t in range(40):  # longer than a window
        state, out = host.step(float(t), state, np.array([np.nan]), none)
        assert np.isnan(out[0]) and out[1] == 0.01
    state, out = host.step(40.0, state, np.array([0.3]), none)
    assert out[0] == 0.3
    state, out = host.step(41.0, state, np.array([np.nan]), none)
    assert out[0] == pytest.approx(0.3)  # predicted over the gap


def test_python_control_samples_it_at_its_own_steps():
    block = PrefilterBlock(1.0, inputs="PV", outputs=["PV_f", "noise"])
    closed = wire(
        [Step("SP", 0.5), PI(K_p=0.4, T_i=10.0, inputs={"PV": "PV_f"}), FirstOrder(K=3.0, tau=10.0, inputs="OP"), block]
    )
    assert isinstance(closed, ct.InterconnectedSystem)
    t = np.linspace(0.0, 20.0, 21)
    theirs = ct.input_output_response(closed, t, 0.0, closed.x0, solve_ivp_kwargs={"max_step": 0.1})
    ours = simulate(closed, 20.0, every=1.0).log
    rows = {name: theirs.outputs[i] for i, name in enumerate(closed.output_labels)}
    np.testing.assert_allclose(rows["PV_f"], ours["PV_f"], rtol=0, atol=0.02)
    assert np.ptp(rows["PV"]) > 0.1
    assert np.abs(rows["PV_f"] - rows["PV"]).max() > 1e-3  # it filters, it is no wire


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"dt": 0.0}, r"dt = 0\.0.*give seconds"),
        ({"dt": -2.0}, r"dt = -2\.0"),
        ({"dt": 1.0, "window": 5}, r"window = 5.*give 0 or >= 32"),
    ],
)
def test_refusals(options, words):
    with pytest.raises(BlockError, match=words):
        PrefilterBlock(**options)


def test_a_noise_that_is_not_positive_is_refused():
    with pytest.raises(ValueError, match=r"noise_std = -1"):
        PrefilterBlock(1.0, noise_std=-1)
