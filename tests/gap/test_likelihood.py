"""The filter whose prediction is the diagram's own run, beside the exact filter of what is linear and scanned."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import PI, SampledPI, Staircase, Sum
from stickslip.cases.models import level_loop, second_order_flow, site_flow
from stickslip.diagram import Diagram, simulate
from stickslip.diagram.inputs import close
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.switches import with_switches
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import read
from stickslip.logs import Log

from tests.gap.root_tank import framed, logged, tank

STEADY = 120  # rows after which a filter has forgotten how it began
FLOWS = [1.5, 1.8, 1.35, 1.6]
SAME = 1e-6  # nats a row by which two programs for one filter may differ


def site_log(model: Diagram, levels: list[float], every: float) -> Log:
    """Return a log of a site's loop in four digits."""
    at = [600.0 * k for k in range(len(levels))]
    run = simulate(close(model, {"SP": Staircase("SP", at=at, levels=levels)}), 2400.0, every=every)
    return Log(run.log.t, {s: np.round(run.log[s], 4) for s in ("SP", "PV", "OP")})


@pytest.mark.parametrize(
    ("model", "levels"),
    [(site_flow(), FLOWS), (second_order_flow(), FLOWS), (level_loop(), [0.5, 0.505, 0.495, 0.5])],
    ids=["first order", "second order with dead time", "integrating"],
)  # fmt: skip
def test_linear_scanned_loops_have_the_likelihood_of_their_exact_filter(model: Diagram, levels: list[float]) -> None:
    # analytic: what is linear between scans has an exact filter, made from matrices without the engine
    opened, record = read(model, site_log(model, levels, 5.0))
    f = frame_of(opened, record)
    assert f is not None
    exact, mine = Hypothesis(f).filtered({}), Hypothesis(f).filtered({}, joined=True)
    assert exact.gains is None and mine.gains is not None
    later = f.counted & (np.arange(len(f.Y)) >= STEADY)  # rows at a limit do not count
    assert later.mean() > 0.7
    assert np.abs(mine.losses - exact.losses)[later].max() < SAME


@pytest.mark.parametrize("scanned", [True, False], ids=["scanned", "continuous"])
@pytest.mark.parametrize("every", [5.0, 7.3])
def test_a_nonlinear_loop_leaves_white_innovations_of_unit_size(scanned: bool, every: float) -> None:
    found = with_switches(Hypothesis(framed(tank(scanned), logged(tank(scanned), 1, every))).filtered({}))
    e = found.judged
    assert np.nanstd(e, axis=0) == pytest.approx([1.0, 1.0], abs=0.1)  # 700 rows or more: 3.7 standard deviations
    after = np.nanmean(e[1:] * e[:-1], axis=0)
    assert np.abs(after).max() < 0.12  # 3.2 standard deviations


def test_other_noise_needs_no_other_run() -> None:
    known = with_switches(Hypothesis(framed(tank(), logged(tank(), 2))).filtered({}))
    one = known.hypothesis
    other = {"feed.sd": 0.02, "feed.correlation_time": 40.0, "sensor.sd": 0.006}
    assert one.noisier(known, {}).nll == pytest.approx(known.nll, abs=1e-6)
    assert one.noisier(known, other).nll == pytest.approx(one.filtered(other).nll, abs=0.1)


def test_the_mean_alone_follows_with_known_gains() -> None:
    one = Hypothesis(framed(tank(False), logged(tank(False), 3)))
    known = one.filtered({})
    assert one.filtered({}, known).nll == pytest.approx(known.nll, abs=1e-6)


@pytest.mark.parametrize("scanned", [True, False], ids=["scanned", "continuous"])
def test_hardly_any_dead_time_is_none(scanned: bool) -> None:
    # OP is in %, the inflow that is late is not, and no log has it: the delay starts with what the model has there
    law = (
        SampledPI(200.0, 120.0, dt=2.0, high=100.0, start_op=50.0)
        if scanned
        else PI(200.0, 120.0, high=100.0, start_op=50.0)
    )
    model = tank(scanned).replace("controller", law)
    model = model.replace("inflow", Sum("F", {"MV": 0.01, "load": 1.0}, name="inflow"))
    frame = framed(model, logged(model, 4, duration=1800.0))
    (late,) = (one for one in CATALOGUE if one.name == "dead_time")
    one = Hypothesis(frame, late, "tank")
    hardly = one.filtered({"theta": 0.05})
    assert one.changed["tank:dead_time"].params["theta_start"] == pytest.approx(0.5, abs=0.05)  # 50 at first, before
    assert hardly.nll == pytest.approx(Hypothesis(frame).filtered({}).nll, abs=30.0)


def test_a_wave_that_moves_a_linear_loop_leaves_its_slopes() -> None:
    # analytic: slopes of a linear loop do not depend on what moves it; stops differ by what samples on the way
    opened, record = read(site_flow(), site_log(site_flow(), FLOWS, 5.0))
    sine = next(e for e in CATALOGUE if e.name == "sine_disturbance")
    one = Hypothesis(Frame(Given(opened), record), sine, sine.places(opened)[0])
    sizes = {"amplitude": 0.2, "period": 90.0, "phase": 0.3}
    found = one.filtered(sizes, joined=True)
    assert found.path is not None
    assert len(found.path.slopes[0]) < 0.05 * len(one.frame.stops[0])


@pytest.mark.parametrize(
    ("name", "sizes"),
    [
        ("sine_disturbance", {"amplitude": 0.02, "period": 140.0, "phase": 0.3}),
        ("slug", {"amplitude": 0.02, "period": 90.0, "phase": 0.3}),
        ("step_disturbance", {"amplitude": 0.06, "time": 3400.3}),
    ],
)
def test_a_planned_load_in_a_linear_loop_is_an_input_of_the_exact_filter(name: str, sizes: dict[str, float]) -> None:
    # oracle: the filter across runs of the engine; they differ by what a load does within a scan
    opened, record = read(site_flow(), site_log(site_flow(), FLOWS, 5.0))
    (load,) = (e for e in CATALOGUE if e.name == name)
    one = Hypothesis(Frame(Given(opened), record), load, load.places(opened)[0])
    exact = one.filtered(sizes)
    assert exact.gains is None
    assert exact.nll == pytest.approx(one.filtered(sizes, joined=True).nll, abs=0.2)


def test_a_dead_time_passes_its_states_on_in_each_kind_of_stop() -> None:
    opened, record = read(second_order_flow(), site_log(second_order_flow(), FLOWS, 5.0))
    one = Hypothesis(Frame(Given(opened), record))
    path = one.filtered({}, joined=True).path
    assert path is not None
    chain = [k for k, name in enumerate(one.names) if "late" in name and "u_" in name]
    A = path.slopes[0][:, chain][:, :, chain]
    shift, hold = np.eye(len(chain), k=-1), np.eye(len(chain))
    assert len(chain) > 2
    assert all(np.allclose(a, shift, atol=1e-6) or np.allclose(a, hold, atol=1e-6) for a in A)
    assert np.allclose(A[-1], A[-1].round(), atol=1e-12)


def test_a_filter_is_not_run_twice_for_other_rows_that_count() -> None:
    one = Hypothesis(framed(tank(), logged(tank(), 2)))
    known = one.filtered({})
    apart = one.of(replace(one.frame, apart=True))
    assert apart.filtered({}).gains is known.gains
    assert apart.filtered({}).hypothesis is apart
    assert one.filtered({"feed.sd": 0.02}).gains is not known.gains
