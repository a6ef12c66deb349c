"""Trends of runs and spreads of ensembles: what is drawn where; how they look is judged by eye."""

from itertools import pairwise

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, Gain, Integrator, Ramp, Sine, Step, StickSlip
from stickslip.diagram import simulate, wire
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.figures.panels import main_signals
from stickslip.diagram.figures.spread import plot_ensemble
from stickslip.diagram.figures.trends import modes_over_time, plot_run
from stickslip.plant.loops import self_regulating_loop

LOOP = self_regulating_loop()


@pytest.fixture(scope="module")
def cycling():
    """The run of the sticky loop that most of these pictures show."""
    return simulate(LOOP, 600.0, every=0.5)


def drawn(ax):
    return {line.get_label(): line for line in ax.lines}


def test_set_point_goes_with_measurement_and_controller_output_with_valve(cycling):
    axes = plot_run(cycling).axes
    assert [set(drawn(ax)) for ax in axes] == [{"SP", "PV"}, {"OP", "MV"}]
    line = drawn(axes[0])["PV"]
    assert np.array_equal(line.get_ydata(), cycling.log["PV"])
    assert np.allclose(line.get_xdata(), cycling.log.t / 60.0)
    assert axes[-1].get_xlabel() == "time [min]"


@pytest.mark.parametrize(
    ("duration", "unit", "seconds"), [(60.0, "s", 1.0), (7200.0, "min", 60.0), (86400.0, "h", 3600.0)]
)
def test_time_is_told_in_the_unit_that_fits(duration, unit, seconds):
    run = simulate(wire([Ramp("F", slope=1.0)], outputs=["F"]), duration)
    ax = plot_run(run).axes[0]
    assert ax.get_xlabel() == f"time [{unit}]"
    assert ax.get_xlim() == pytest.approx((0.0, duration / seconds))


def test_stuck_is_shaded_on_the_axis_of_the_valve(cycling):
    upper, lower = plot_run(cycling).axes
    assert "stuck" not in upper.get_legend_handles_labels()[1]
    shade = next(c for c in lower.collections if c.get_label() == "stuck")
    shaded = sorted((path.get_extents().x0 * 60.0, path.get_extents().x1 * 60.0) for path in shade.get_paths())
    stuck = [(a, b) for a, b, mode in modes_over_time(LOOP["valve"], cycling) if mode == "stuck" and b > a]
    assert np.allclose(shaded, stuck)
    assert len(stuck) > 5
    moving = np.abs(np.diff(cycling.log["MV"])) > 1e-9  # independent of the events: a stuck stem does not move
    inside = [any(a <= t0 and t1 <= b for a, b in stuck) for t0, t1 in pairwise(cycling.log.t)]
    assert not np.any(moving & np.array(inside))
    assert np.mean(inside) > 0.9


def test_modes_cover_the_run_without_gaps(cycling):
    stretches = modes_over_time(LOOP["valve"], cycling)
    assert stretches[0][0] == 0.0 and stretches[-1][1] == 600.0
    assert all(a[1] == b[0] and a[2] != b[2] for a, b in pairwise(stretches))
    still = simulate(LOOP, 10.0, params={"SP.after": 0.0})
    assert modes_over_time(LOOP["valve"], still) == [(0.0, 10.0, "stuck")]


def test_other_events_are_ticks():
    saturating = wire([Step("SP", 5.0), PI(K_p=1.0, T_i=5.0), FirstOrder(K=1.0, tau=5.0, inputs="OP")])
    run = simulate(saturating, 60.0)
    assert run.events, "the controller reaches its limit"
    ax = next(ax for ax in plot_run(run).axes if "OP" in drawn(ax))
    ticks = next(c for c in ax.collections if "controller" in c.get_label())
    assert np.allclose([segment[0][0] for segment in ticks.get_segments()], [event.t for event in run.events])


def test_one_unit_one_axis_if_the_ranges_are_alike():
    parts = [Ramp("a", slope=1.0, unit="bar"), Gain("b", "a", 2.0, unit="bar"), Gain("c", "a", 100.0, unit="bar"),
             Gain("d", "a", 1.0, unit="K"), Gain("e", "a", 1.0), Gain("f", "a", 1.0)]  # fmt: skip
    run = simulate(wire(parts, outputs=["a"]), 10.0)
    axes = plot_run(run).axes
    assert [set(drawn(ax)) for ax in axes] == [{"a", "b"}, {"c"}, {"d"}, {"e"}, {"f"}]
    assert [ax.get_ylabel() for ax in axes] == ["a, b [bar]", "c [bar]", "d [K]", "e", "f"]


def test_a_large_plant_shows_its_loops_first_and_says_what_is_missing():
    extra = [Gain(f"x{i}", "MV", 1.0) for i in range(30)]
    run = simulate(wire([*LOOP.blocks, *extra], name="large"), 10.0)
    figure = plot_run(run)
    assert {name for ax in figure.axes for name in drawn(ax)} == {"SP", "PV", "OP", "MV"}
    assert "30 more signals" in figure.axes[0].get_title(loc="left")
    fifty = simulate(wire([self_regulating_loop(name=f"loop{i}") for i in range(13)]), 10.0)
    figure = plot_run(fifty)
    assert len(figure.axes) == 8
    assert figure.axes[0].get_ylabel() == "loop0\nSP, PV"


def test_names_choose(cycling):
    figure = plot_run(cycling, ["MV", "PV"])
    assert [set(drawn(ax)) for ax in figure.axes] == [{"MV"}, {"PV"}]
    with pytest.raises(ValueError, match="did you mean 'PV'"):
        plot_run(cycling, ["PVs"])
    with pytest.raises(ValueError, match="no signal to plot"):
        plot_run(cycling, [])


def with_far_set_point():
    safety = PI(K_p=1e-9, T_i=1.0, action="direct", name="safety", inputs=["far", "p"], outputs="OP_safety")
    main = PI(K_p=1e-9, T_i=1.0, action="direct", name="main", inputs=["near", "p"], outputs="OP_main")
    far, near = (Gain(name, "PV", 0.0, offset=at, unit="Pa") for name, at in (("far", 40e5), ("near", 30.2e5)))
    p = Gain("p", "PV", 1e5, offset=30e5, unit="Pa")
    return wire([*LOOP.blocks, far, near, p, main, safety])


def test_a_set_point_far_off_does_not_flatten_what_moves():
    run = simulate(with_far_set_point(), 60.0, every=1.0)
    figure = plot_run(run)
    ax = next(ax for ax in figure.axes if "p" in drawn(ax))
    assert set(drawn(ax)) == {"near", "p"}
    assert figure.axes[0].get_title(loc="left") == "at rest far off the scale: far"
    chosen = plot_run(run, ["far", "p"]).axes  # who asks for it gets it
    assert {name for ax in chosen for name in drawn(ax)} == {"far", "p"}


def test_the_only_set_point_is_shown_however_far():
    missed = wire([Step("SP", 5.0), PI(K_p=0.01, T_i=5e3), FirstOrder(K=1.0, tau=5.0, inputs="OP")])
    figure = plot_run(simulate(missed, 60.0))
    assert {"SP", "PV"} <= set(drawn(figure.axes[0])) and figure.axes[0].get_title(loc="left") == ""


def test_pressures_are_told_in_bar():
    run = simulate(with_far_set_point(), 60.0, every=1.0)
    ax = next(ax for ax in plot_run(run).axes if "p" in drawn(ax))
    assert ax.get_ylabel() == "near, p [bar]"
    assert np.allclose(drawn(ax)["p"].get_ydata(), run.log["p"] / 1e5)


def test_panels_that_move_come_before_panels_that_rest():
    loops = [self_regulating_loop(name=f"loop{i}") for i in range(7)]
    rest = [self_regulating_loop(name=f"rest{i}").with_params({"SP.after": 0.0}) for i in range(7)]
    run = simulate(wire([*rest, *loops]), 600.0, every=1.0)
    shown = {name for ax in plot_run(run).axes for name in drawn(ax)}
    assert not any(name.startswith("rest") for name in shown)


def test_a_nested_diagram_keeps_its_colour():
    from stickslip.cases import find

    run = find("own_map").run()
    colours = {}
    for ax in plot_run(run, ["guarded/m", "bare/m", "guarded/p_out", "bare/p_out"]).axes:
        for name, line in drawn(ax).items():
            colours.setdefault(name.partition("/")[0], set()).add(line.get_color())
    assert all(len(own) == 1 for own in colours.values()) and colours["guarded"] != colours["bare"]


def test_a_failed_run_says_so(cycling):
    run = simulate(LOOP, 600.0, every=0.5, max_steps=50)
    assert not run.ok
    figure = plot_run(run)
    assert figure.axes[0].get_title(loc="left").startswith("TOO_MANY_STEPS: the step budget is spent")
    figure.canvas.draw()
    assert plot_run(cycling).axes[0].get_title(loc="left") == ""


def test_main_signals_are_those_of_controllers_and_valves():
    plant = wire(
        [Step("SP", 0.5), PI(K_p=0.4, T_i=10.0), StickSlip(), FirstOrder(K=3.0, tau=10.0), Gain("x", "PV", 2.0)]
    )
    assert main_signals(plant) == {"SP", "PV", "OP", "MV"}


def test_the_spread_is_that_of_the_variants():
    gains = np.linspace(0.0, 100.0, 101)
    result = ensemble(wire([Step("F", 1.0), Gain("y", "F", 1.0)]), 10.0, params={"y.factor": gains}, every=1.0)
    ax = result.plot("y").axes[0]
    lines = drawn(ax)
    assert np.allclose(
        lines["variant 50, of median swing"].get_ydata(), 50.0
    )  # analytic: none swings, 50 is the middle
    band = ax.collections[0].get_paths()[0].get_extents()
    assert (band.y0, band.y1) == pytest.approx((5.0, 95.0))
    assert "12 of 101 variants" in lines


def test_cycles_out_of_step_are_no_flat_line():
    phases = 0.1 * np.arange(40.0)
    result = ensemble(wire([Sine("y", 1.0, 4.0)], outputs=["y"]), 40.0, params={"y.phase": phases}, every=0.1)
    shown = next(line for name, line in drawn(result.plot("y").axes[0]).items() if name.endswith("of median swing"))
    assert np.ptp(shown.get_ydata()) == pytest.approx(2.0, rel=1e-2)  # analytic: each swings by 2, their median by none


def test_failed_variants_are_not_in_the_spread():
    result = ensemble(LOOP, 600.0, params={"SP.after": [0.0, 0.5]}, every=1.0, max_steps=100)
    figure = plot_ensemble(result, "PV")
    assert figure.axes[0].get_title(loc="left").startswith("1 variants not shown")
    assert np.array_equal(drawn(figure.axes[0])["variant 0, of median swing"].get_ydata(), np.zeros(601))
    with pytest.raises(ValueError, match="did you mean 'PV'"):
        plot_ensemble(result, "pv")
    failed = ensemble(LOOP, 600.0, params={"SP.after": [0.5]}, every=1.0, max_steps=100)
    with pytest.raises(ValueError, match="no variant reached its end"):
        failed.plot("PV")


def test_what_swings_too_often_is_a_band_with_its_last_cycles_beside():
    from stickslip.blocks import Sine

    fast = simulate(wire([Sine("F", amplitude=2.0, period=1.0)], outputs=["F"]), 200.0, every=0.02)
    whole, close = plot_run(fast).axes
    assert not drawn(whole) and np.ptp(whole.collections[0].get_paths()[0].vertices[:, 1]) == pytest.approx(
        4.0, rel=1e-2
    )
    assert np.ptp(close.get_xlim()) == pytest.approx(6.0, rel=0.02)
    slow = simulate(wire([Sine("F", amplitude=2.0, period=20.0)], outputs=["F"]), 200.0, every=0.02)
    assert len(plot_run(slow).axes) == 1


def test_the_title_says_what_is_found():
    from stickslip.blocks import Sine

    def title(parts, duration=200.0):
        return plot_run(simulate(wire(parts, outputs=["F"], name="case"), duration, every=0.05)).get_suptitle()

    assert title([Sine("F", amplitude=2.0, period=20.0)]) == "case: F oscillates, period 20 s, amplitude 2"
    assert title([Ramp("F", slope=0.1)]) == "case: F goes from 0 to 20"
    assert title([Step("F", 5.0, before=5.0)]) == "case: at rest: nothing moves"


def test_a_stem_that_never_moves_is_stuck_throughout():
    still = simulate(LOOP, 10.0, params={"SP.after": 0.0})
    assert "stuck throughout" in plot_run(still).axes[1].get_legend_handles_labels()[1]


README = [Step("SP", after=0.5), PI(K_p=0.4, T_i=10.0), StickSlip(F_s=2250.0, F_c=1250.0), FirstOrder(K=3.0, tau=10.0)]


def test_a_short_start_up_does_not_squeeze_the_cycle():
    run = simulate(wire(README), 600.0, every=0.1)
    for ax, signal in zip(plot_run(run).axes, ("PV", "OP"), strict=True):
        low, high = ax.get_ylim()
        late = run.log[signal][run.log.t >= 300.0]
        assert low < late.min() < late.max() < high and np.ptp(late) > 0.6 * (high - low), "the cycle fills the panel"
        assert low > 0.0 and any(text.get_text().startswith("start-up goes down to 0") for text in ax.texts)


def test_nor_the_cycles_of_an_ensemble():
    result = ensemble(wire(README), 600.0, params={"valve.F_s": np.linspace(2250.0, 2400.0, 3)}, every=0.5)
    (ax,) = result.plot("PV").axes
    low, high = ax.get_ylim()
    late = result.values["PV"][:, result.t >= 300.0]
    assert low < late.min() < late.max() < high and np.ptp(late) > 0.6 * (high - low), "the cycles fill the panel"
    assert any(text.get_text().startswith("start-up goes down to 0") for text in ax.texts)


def test_what_happens_in_the_middle_of_a_run_is_no_start_up():
    ax = plot_run(simulate(wire([Step("SP", after=0.5, at=200.0), *README[1:]]), 600.0, every=0.1)).axes[0]
    assert ax.get_ylim()[0] < 0.0 and not ax.texts


def test_a_cycle_is_named_with_what_makes_it():
    # published: period and amplitude as in the thesis's ideal loop with high stiction, 117 s
    title = plot_run(simulate(wire(README), 600.0, every=0.1)).get_suptitle()
    assert title == "MV sticks: the loop cycles with a period of 117 s, PV with an amplitude of 0.0283"
    ideal = simulate(wire(README).in_mode("ideal"), 600.0, every=0.1)
    assert "sticks" not in plot_run(ideal).get_suptitle()


def test_a_set_point_that_swings_is_what_the_loop_follows():
    source = Sine("SP", mean=1.0, amplitude=0.05, period=63.0)
    loop = wire([source, PI(K_p=0.4, T_i=10.0), FirstOrder(K=3.0, tau=10.0, inputs="OP")])
    s = 2j * np.pi / 63.0
    forward = 0.4 * (1.0 + 1.0 / (10.0 * s)) * 3.0 / (10.0 * s + 1.0)
    ratio = forward / (1.0 + forward)  # analytic: the closed loop at this frequency
    later = -np.angle(ratio) * 63.0 / (2.0 * np.pi)
    title = plot_run(simulate(loop, 1260.0, every=0.1)).get_suptitle()
    follows = f"PV follows {later:.2g} s later, {abs(ratio):.2g} times as far"
    assert title == f"SP swings by itself with a period of 63 s; {follows}"


def test_a_loop_that_does_not_follow_its_set_point_is_said_to_stand():
    run = simulate(wire([Sine("SP", amplitude=0.1, period=60.0), *README[1:]]), 600.0, every=0.1)
    assert plot_run(run).get_suptitle() == "SP swings by itself with a period of 60 s; PV stands and MV is stuck"


def test_an_oscillation_that_dies_out_is_said_to():
    # analytic: s^2 + 2 zeta w s + w^2 with w = 1 rad/s and zeta = 0.02 shrinks to a third in 55 s
    loop = [Step("SP", after=0.5), PI(K_p=0.04, T_i=0.04, low=-10.0, high=10.0), Integrator(K=1.0, T=1.0, inputs="OP")]
    title = plot_run(simulate(wire(loop), 60.0, every=0.1)).get_suptitle()
    assert title.startswith("PV oscillates and dies out, period 6.3")


def test_rest_is_told_with_the_largest_move():
    parts = [Sine("a", mean=5.0, amplitude=1e-13, period=3.0, unit="bar"), Step("b", 2.0, before=2.0, unit="bar")]
    title = plot_run(simulate(wire(parts, outputs=["a", "b"]), 60.0, every=0.1)).get_suptitle()
    assert title == "at rest: nothing moves by more than 2e-13 bar"
