"""Sampled PID: both forms beside difference equations in plain numpy, and beside SampledPI and the continuous PID."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks import PI, PID, FirstOrder, GapPI, SampledPI, SampledPID, SecondOrder, Sine, Staircase, Step
from stickslip.diagram import drive, simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}
TUNING = {"K_p": 1.4, "T_i": 9.0, "T_d": 2.5}


def acting(SP, PV, *, T_d, T_f, dt, b, c, sign):
    """Return P and D as a textbook has them: the derivative by its last value, the last sample, and this one."""
    P, D, last, before = sign * (b * SP - PV), [], 0.0, 0.0
    for q in sign * (c * SP - PV):
        last = T_f / (T_f + dt) * last + T_d / (T_f + dt) * (q - before)
        before = q
        D.append(last)
    return P, np.array(D)


def positional(SP, PV, *, K_p, T_i, low, high, dt, sign, present, anti_windup="none", T_t=math.inf, start=0.0, **rest):
    """Independent reference: the positional form, from equations alone."""
    P, D = acting(SP, PV, dt=dt, sign=sign, **rest)
    total, OP = start, []
    for now, e in zip(P + D, sign * (SP - PV), strict=True):
        more = K_p * dt / T_i * e
        wanted = K_p * now + total + (more if present else 0.0)
        OP.append(min(max(wanted, low), high))
        pushes = (wanted >= high and e > 0.0) or (wanted <= low and e < 0.0)
        if not (anti_windup == "conditional" and pushes):
            total += more
        if anti_windup == "back_calculation":
            total += min(dt / T_t, 1.0) * (OP[-1] - wanted)
    return np.array(OP)


def velocity(SP, PV, *, K_p, T_i, low, high, dt, sign, present, start=0.0, **rest):
    """Independent reference: the velocity form, which knows increments only."""
    P, D = acting(SP, PV, dt=dt, sign=sign, **rest)
    e, OP = sign * (SP - PV), [start]
    for k in range(len(e)):
        by_error = e[k] if present else e[k - 1] if k else 0.0
        moved = P[k] + D[k] - (P[k - 1] + D[k - 1] if k else 0.0)
        OP.append(min(max(OP[-1] + K_p * moved + K_p * dt / T_i * by_error, low), high))
    return np.array(OP[1:])


def run_of(block, SP, PV, dt):
    """Return OP of a block that reads these samples."""
    times = dt * np.arange(len(SP))
    diagram = wire([block], inputs=["SP", "PV"])
    return simulate(diagram, times[-1], times=times, inputs={"SP": (times, SP), "PV": (times, PV)}).log["OP"]


def stepped(n=160, dt=0.5):
    """Return a set point with large steps, which drive OP into both limits, and a PV that wanders."""
    t = dt * np.arange(n)
    SP = np.select([t < 15.0, t < 35.0, t < 60.0], [0.0, 0.9, -0.6], 0.2)
    return SP, 0.2 * np.sin(t / 3.0) + 0.1 * np.sin(t / 0.9 + 1.0)


@pytest.mark.parametrize("integral", ["previous", "present"])
@pytest.mark.parametrize("action", ["reverse", "direct"])
@pytest.mark.parametrize(("b", "c"), [(1.0, 0.0), (0.3, 0.0), (1.0, 1.0), (0.0, 0.5)])
@pytest.mark.parametrize("kind", ["none", "conditional", "back_calculation", "velocity"])
def test_it_computes_its_difference_equations(kind, b, c, action, integral):
    (SP, PV), dt = stepped(), 0.5
    law = {"low": -0.4, "high": 0.8, "b": b, "c": c}
    form = {"form": "velocity"} if kind == "velocity" else {"anti_windup": kind}
    tracking = {"T_t": 4.0} if kind == "back_calculation" else {}
    pid = SampledPID(
        **TUNING, **law, **form, **tracking, T_f=0.8, dt=dt, action=action, integral=integral, start_op=0.1
    )
    reference = velocity if kind == "velocity" else positional
    named = {} if kind == "velocity" else {"anti_windup": kind, **tracking}
    expected = reference(
        SP, PV, **TUNING, **law, **named, T_f=0.8, dt=dt, sign=1.0 if action == "reverse" else -1.0,
        present=integral == "present", start=0.1,
    )  # fmt: skip
    np.testing.assert_allclose(run_of(pid, SP, PV, dt), expected, atol=1e-12)
    assert {-0.4, 0.8} < set(expected)  # both limits were met


@settings(max_examples=80)
@given(
    K_p=st.floats(0.05, 20.0), T_i=st.floats(0.5, 200.0), T_d=st.floats(0.0, 20.0), T_f=st.floats(0.0, 5.0),
    dt=st.floats(0.05, 10.0), b=st.floats(0.0, 1.0), c=st.floats(0.0, 1.0), present=st.booleans(),
    kind=st.sampled_from(["none", "conditional", "back_calculation", "velocity"]), direct=st.booleans(),
    samples=st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), min_size=1, max_size=25),
)  # fmt: skip
def test_whatever_its_tuning_it_follows_the_equations_within_its_limits(
    K_p, T_i, T_d, T_f, dt, b, c, present, kind, direct, samples
):
    SP, PV = np.array(samples).T
    form = {"form": "velocity"} if kind == "velocity" else {"anti_windup": kind}
    form |= {"integral": "present" if present else "previous", "action": "direct" if direct else "reverse"}
    pid = SampledPID(K_p, T_i, T_d, T_f=T_f, dt=dt, b=b, c=c, low=-0.2, high=0.7, **form)
    memory, OP = pid.d0, []
    for u in zip(SP, PV, strict=True):
        kept = memory.copy()
        OP.append(pid.output(0.0, memory, u)[0])
        after = pid.dynamics(0.0, memory, u)
        np.testing.assert_array_equal(memory, kept)
        memory = after
    lag = T_f if T_d > 0.0 else T_d / 10.0
    law = {"K_p": K_p, "T_i": T_i, "T_d": T_d, "T_f": lag, "dt": dt, "b": b, "c": c, "low": -0.2, "high": 0.7,
           "sign": -1.0 if direct else 1.0, "present": present}  # fmt: skip
    tracked = {"anti_windup": kind, "T_t": T_i}
    expected = velocity(SP, PV, **law) if kind == "velocity" else positional(SP, PV, **law, **tracked)
    size = K_p * (1.0 + T_d / dt) * (1.0 + dt / T_i) * len(SP)
    assert np.all((np.array(OP) >= -0.2) & (np.array(OP) <= 0.7))
    if kind != "conditional":  # whose switch may fall on either side of a limit that is met to the last digit
        np.testing.assert_allclose(OP, expected, atol=1e-12 * (1.0 + size))


@pytest.mark.parametrize("anti_windup", ["none", "conditional", "back_calculation"])
@pytest.mark.parametrize("integral", ["previous", "present"])
def test_without_a_derivative_it_is_the_sampled_pi_to_the_last_digit(anti_windup, integral):
    SP, PV = stepped()
    law = {"K_p": 1.4, "T_i": 9.0, "dt": 0.5, "integral": integral, "anti_windup": anti_windup, "start_op": 0.4}
    np.testing.assert_array_equal(run_of(SampledPID(**law), SP, PV, 0.5), run_of(SampledPI(**law), SP, PV, 0.5))


def test_the_derivative_of_a_ramp_is_its_slope_times_the_derivative_time():
    K_p, T_d, T_f, dt, slope = 0.5, 4.0, 2.0, 0.5, 0.3
    PV = slope * dt * np.arange(60)
    pid = SampledPID(K_p, T_d=T_d, T_f=T_f, dt=dt, action="direct", **WIDE)
    k = np.arange(60)
    D = T_d * slope * (1.0 - (T_f / (T_f + dt)) ** k)  # analytic
    np.testing.assert_allclose(run_of(pid, 0.0 * PV, PV, dt), K_p * (PV + D), atol=1e-12)
    sharp = SampledPID(K_p, T_d=T_d, N=math.inf, dt=dt, action="direct", **WIDE)  # from the second scan on
    np.testing.assert_allclose(run_of(sharp, 0.0 * PV, PV, dt)[1:], K_p * (PV[1:] + T_d * slope), atol=1e-12)


def test_weights_keep_a_set_point_step_out_of_the_derivative_and_of_the_gain():
    SP, PV = np.where(np.arange(9) < 3, 0.0, 1.0), np.zeros(9)
    first = {
        (b, c): run_of(SampledPID(2.0, T_d=3.0, T_f=0.5, dt=1.0, b=b, c=c, **WIDE), SP, PV, 1.0)[3]
        for b, c in ((1.0, 1.0), (1.0, 0.0), (0.25, 0.0), (0.0, 0.0))
    }
    kick = 2.0 * 3.0 / (0.5 + 1.0)  # K_p T_d/(T_f + dt)   [analytic]
    assert first == pytest.approx({(1.0, 1.0): 2.0 + kick, (1.0, 0.0): 2.0, (0.25, 0.0): 0.5, (0.0, 0.0): 0.0})


@pytest.mark.parametrize(("b", "c", "low"), [(1.0, 0.0, -9.0), (0.4, 1.0, -9.0), (0.6, 0.0, 0.0)])
def test_it_approaches_the_continuous_pid_with_first_order(b, c, low):
    law = {"K_p": 1.5, "T_i": 6.0, "T_d": 1.2, "N": 5.0, "b": b, "c": c, "low": low, "high": 0.9, "T_t": 5.0}
    signals = {"SP": Sine("SP", 0.5, 31.4), "PV": Sine("PV", 0.2, 17.3)}
    times = np.arange(1, 51) * 1.6

    def driven(block):
        diagram = wire([*signals.values(), block])
        return simulate(diagram, 80.0, times=times, rtol=1e-9, atol=1e-11).log["OP"]

    exact = driven(PID(**law))
    errors = [np.sqrt(np.mean((driven(SampledPID(**law, dt=dt)) - exact) ** 2)) for dt in (0.1, 0.05, 0.025, 0.0125)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 1.0) < 0.2), orders  # analytic: first order
    assert low < 0.0 or exact.min() == 0.0  # a limit was met


def test_the_velocity_form_does_not_wind_up():
    # e = 0.5 for 100 scans, then -0.1: OP leaves its limit at that scan, by K_p x 0.6 and K_p dt/T_i x e
    SP = Staircase("SP", [0.5, -0.1], dwell=100.0)
    own = {"K_p": 1.0, "T_i": 10.0, "T_d": 0.0, "dt": 1.0}
    OP = {
        name: drive(SampledPID(**own, **form), 600.0, every=1.0, SP=SP, PV=0.0).log["OP"]
        for name, form in {"velocity": {"form": "velocity"}, "positional": {"anti_windup": "none"}}.items()
    }
    assert OP["velocity"][99] == 1.0
    assert OP["velocity"][100] == pytest.approx(1.0 - 0.6 + 0.05)  # analytic: e of the scan before
    assert np.flatnonzero(OP["positional"][100:] < 1.0 - 1e-9)[0] == 391  # analytic: z = 5 - 0.01 k


def test_per_cent_are_fractions_times_a_hundred():
    SP, PV = stepped()
    law = {"T_i": 9.0, "T_d": 2.5, "dt": 0.5, "form": "velocity"}
    fraction = run_of(SampledPID(1.4, start_op=0.3, **law), SP, PV, 0.5)
    percent = run_of(SampledPID(140.0, start_op=30.0, high=100.0, **law), SP, PV, 0.5)
    np.testing.assert_allclose(percent, 100.0 * fraction, atol=1e-10)


@pytest.mark.parametrize("form", ["positional", "velocity"])
def test_it_starts_without_a_bump_and_scans_from_its_offset(form):
    pid = SampledPID(0.8, 20.0, 4.0, dt=2.0, offset=1.0, b=0.5, c=0.2, form=form, high=100.0, start_op=37.0,
                     start_SP=61.0, start_PV=61.0)  # fmt: skip
    assert drive(pid, 10.0, every=1.0, SP=61.0, PV=61.0).log["OP"].tolist() == pytest.approx([37.0] * 11, abs=1e-12)
    moved = drive(pid, 4.0, every=1.0, SP=61.0, PV=61.5).log["OP"]
    assert moved[0] == 37.0 and moved[1] == moved[2] < moved[3]  # the derivative's kick at 1 s, which fades at 3 s


def test_the_derivative_damps_a_loop_that_scans():
    loop = [Step("SP", after=0.5), SecondOrder(K=1.0, omega=0.2, zeta=0.2, inputs=["OP"])]
    overshoot = [
        simulate(wire([*loop, SampledPID(0.5, 10.0, T_d, dt=0.5, **WIDE)]), 200.0, every=0.5).log["PV"].max() - 0.5
        for T_d in (0.0, 10.0)
    ]
    assert overshoot[1] < 0.3 * overshoot[0]


def test_python_control_has_it_as_a_discrete_system_and_its_continuous_twin_in_a_loop():
    pid = SampledPID(1.2, 5.0, 1.5, dt=0.5, start_op=0.5, b=0.7, c=0.4)
    t = np.arange(80) * 0.5
    SP = 0.3 * np.sin(t / 4.0)
    response = ct.input_output_response(pid, t, [SP, 0 * t], pid.d0)
    np.testing.assert_allclose(response.outputs[0], run_of(pid, SP, 0 * t, 0.5), atol=1e-12)
    loop = wire([pid, FirstOrder(1.5, 10.0, inputs="OP")], inputs=["SP"], outputs=["PV"])
    fine = wire([PID(1.2, 5.0, 1.5, b=0.7, c=0.4, T_t=5.0), *loop.blocks[1:]], inputs=["SP"], outputs=["PV"])
    models = [ct.linearize(d, d.starting_at({"controller.z": 0.5}).x0, [0.0]) for d in (loop, fine)]
    for w in (0.01, 0.3, 2.0):
        assert complex(models[0](1j * w)) == pytest.approx(complex(models[1](1j * w)), rel=1e-6)


@pytest.mark.parametrize(("T_d", "N"), [(1.5, 8.0), (1.5, math.inf), (0.0, 10.0)])
def test_its_twin_has_its_settings(T_d, N):
    pid = SampledPID(1.2, 5.0, T_d, N=N, dt=0.5, action="direct", low=-1.0, high=3.0, start_op=0.7, start_PV=0.2,
                     name="LC", inputs={"SP": "LSP", "PV": "L"}, outputs="LOP", units={"PV": "m"})  # fmt: skip
    twin = pid.smooth()
    assert isinstance(twin, PID)
    assert (twin.name, twin.input_labels, twin.output_labels) == ("LC", ["LSP", "L"], ["LOP"])
    assert (twin.units, twin.spans) == (pid.units, {"OP": (-1.0, 3.0)})
    for key in ("K_p", "T_i", "low", "high", "action", "b", "c"):
        assert twin.params[key] == pid.params[key]
    assert twin.x0.tolist() == pid.d0.tolist() == [0.7 - 1.2 * 0.2, -0.2]
    assert twin.params["T_d"] == pytest.approx(T_d, abs=2e-3 * 0.5)
    own = SampledPI(1.2, 5.0, dt=0.5)
    assert isinstance(own.smooth(), PI) and not isinstance(own.smooth(), PID)


@pytest.mark.parametrize(
    "block",
    [
        SampledPI(1.3, 7.0, dt=1.0, action="direct", high=100.0),
        GapPI(1.3, 7.0, dt=1.0, high=100.0),
        SampledPID(1.3, 7.0, 2.0, dt=1.0, b=0.2, c=0.5, high=100.0),
        SampledPID(1.3, 7.0, 2.0, dt=1.0, form="velocity", action="direct", high=100.0),
    ],
    ids=["PI", "gap", "positional", "velocity"],
)
def test_settled_it_gives_its_output_and_goes_on_giving_it(block):
    u = [80.0, 80.0]
    ready = block.settled(np.array(u), np.array([40.0]))
    assert ready.output(0.0, ready.d0, u)[0] == pytest.approx(40.0, abs=1e-9)
    np.testing.assert_allclose(ready.dynamics(0.0, ready.d0, u), ready.d0, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=0.0), ["dt = 0.0", "positive"]),
        (lambda: SampledPID(0.0, 5.0, 1.0, dt=1.0), ["K_p = 0.0", "positive"]),
        (lambda: SampledPID(1.0, 5.0, -1.0, dt=1.0), ["T_d = -1.0", "0 for none"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, N=0.0), ["N = 0.0", "8 to 20"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, N=8.0, T_f=0.1), ["N = 8.0", "one of the two"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, T_f=-0.1), ["T_f = -0.1", "0 for none"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, b=-0.1), ["b = -0.1", "0 to 1"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, form="speed"), ["form = 'speed'", "positional"]),
        (
            lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, form="velocity", anti_windup="conditional"),
            ["anti_windup = 'conditional'", "leave it out"],
        ),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, form="velocity", T_t=3.0), ["T_t = 3.0", "leave it out"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, integral="next"), ["integral = 'next'", "previous"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0, start_op=1.2), ["start_op = 1.2", "within"]),
        (lambda: SampledPID(1.0, 5.0, 1.0, dt=1.0).with_params(T_d=-2.0), ["T_d = -2.0", "0 for none"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)
