"""The random-diagram search: its C program against closed forms, its judge against planted mistakes, its options."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest
from stickslip.blocks import (
    Biquad,
    Constant,
    DeadTime,
    DeadZone,
    Equations,
    FirstOrder,
    Gain,
    Lookup1D,
    MaxSelect,
    MinSelect,
    Noise,
    Quantiser,
    QuasiStaticStem,
    RateLimiter,
    Recorded,
    Relay,
    ResetIntegrator,
    SampledPI,
    SecondOrder,
    Step,
    StickSlip,
    Switch,
    VariableDelay,
    ZeroOrderHold,
)  # fmt: skip
from stickslip.blocks.sources import Ramp
from stickslip.diagram import simulate, wire

from benchmarks.torture import judge as judging
from benchmarks.torture.__main__ import options
from benchmarks.torture.c_program import NoCompiler, covers, program, solve
from benchmarks.torture.draw import Drawn, _swing, draw

CLEAN = 22  # a seed whose diagram has no sampled block: everybody agrees on it


@pytest.fixture(autouse=True)
def compiler():
    try:
        program()
    except NoCompiler as reason:
        pytest.skip(str(reason))


def c(diagram, times, share=1.0 / 60.0):
    rows = solve(diagram, float(times[-1]) + 1.0, np.asarray(times, dtype=float), share)
    return dict(zip(diagram.signals, rows.T, strict=True))


def test_the_c_program_solves_a_lag_behind_a_dead_time():
    loop = wire([Step("MV", 1.0, at=0.7), FirstOrder(K=2.0, tau=5.0, theta=1.3)])
    t = np.linspace(0.1, 19.9, 67)
    exact = np.where(t > 2.0, 2.0 * (1.0 - np.exp(-(t - 2.0) / 5.0)), 0.0)  # analytic
    assert np.abs(c(loop, t)["PV"] - exact).max() < 1e-9


def test_the_c_program_sticks_and_slips():
    # analytic: f_s = 0.045 and f_c = 0.015 of travel; on a ramp of 0.01/s it breaks away at 4.5 s and slides behind
    valves = [
        Ramp("OP", 0.01),
        QuasiStaticStem(S=0.06, J=0.03, name="massless", outputs="a"),
        StickSlip.from_bands(S=0.06, J=0.03, name="stem", outputs="b"),
    ]
    t = np.array([1.0, 4.4, 4.6, 6.0, 9.0])
    found = c(wire(valves), t)
    assert found["a"] == pytest.approx(np.where(t < 4.5, 0.0, 0.01 * t - 0.015), abs=1e-9)
    behind = 0.01 * 612.0 / 52500.0  # analytic: F_v v / k
    assert found["b"][[0, 1, 3, 4]] == pytest.approx(found["a"][[0, 1, 3, 4]] - [0.0, 0.0, behind, behind], abs=1e-7)


def test_the_c_program_draws_the_numbers_of_the_generator():
    # the same stream in whole numbers; the engine has it in doubles.  Logged on its scans, where both are right
    noise = wire([Noise("D", sd=2.0, dt=0.5, mean=1.0, correlation_time=3.0, seed=4)], outputs=["D"])
    t = np.arange(100) * 0.5
    assert np.abs(c(noise, t)["D"] - simulate(noise, 60.0, times=t).log["D"]).max() < 1e-12


def test_the_c_program_scans():
    # analytic: P-only on a pure dead time, OP_k = 0.5 (1 - OP of 2 scans ago), as the dead time holds 1.5 scans
    pi = SampledPI(0.5, math.inf, dt=1.0, anti_windup="none", outputs="OP")
    loop = wire([Step("SP", 1.0), pi, DeadTime(1.5, inputs="OP", outputs="PV")])
    op = [0.5, 0.5]
    while len(op) < 12:
        op.append(0.5 * (1.0 - op[-2]))
    assert c(loop, np.arange(12) + 0.3)["OP"] == pytest.approx(op, abs=1e-12)


def test_the_c_program_begins_with_the_modes_that_the_inputs_call_for():
    # analytic, at 0.25 s: a = 5, b = 1, held by h since 0 s; each switch as its docstring says
    switches = {
        "low": (MinSelect("low", ["a", "b"]), 1.0),
        "high": (MaxSelect("high", ["b", "a"]), 5.0),
        "zone": (DeadZone("zone", "a", -1.0, 2.0), 3.0),
        "table": (Lookup1D("table", "a", [0.0, 1.0, 4.0, 6.0], [0.0, 9.0, 3.0, 1.0]), 2.0),
        "steps": (Quantiser("steps", "a", 2.0), 6.0),
        "chosen": (Switch("chosen", "a", above="b", below="c", switch_on=2.0), 1.0),
        "relay": (Relay("relay", "a", 2.0, high=1.0, low=9.0), 1.0),
    }
    for name, (switch, value) in switches.items():
        made = [ResetIntegrator("r", "b", name, threshold=0.5, to=-7.0), Relay("latch", name, 4.0, -99.0)]
        made += [RateLimiter("slow", name, 0.1), VariableDelay("late", name, "c", dt=0.5, longest=3.0)]
        sources = [Constant("a", 5.0), Constant("b", 1.0), Constant("c", 0.0)]
        read = [Gain(f"{s}_2", s, 1.0) for s in "abc"]
        found = c(wire([*made, ZeroOrderHold("h", name, 0.5), *read, switch, *sources]), np.array([0.25]))
        assert [found[s][0] for s in (name, "h", "slow", "late")] == pytest.approx([value] * 4)
        assert found["latch"][0] == (value > 4.0) and found["r"][0] == pytest.approx(-7.0 + 0.25)


def test_the_c_program_sees_the_new_mode_where_a_step_meets_a_sample():
    # analytic: a steps from 0 to 5 at 1 s, when h and y sample; the latch needs more than 4, which the lowest never is
    made = [MinSelect("low", ["a", "b"]), Relay("latch", "low", 4.0, -99.0), ZeroOrderHold("h", "low", 0.5)]
    made += [Switch("chosen", "a", above="b", below="c", switch_on=2.0), ZeroOrderHold("y", "chosen", 0.5)]
    sources = [Step("a", 5.0, at=1.0), Constant("b", 1.0), Constant("c", 0.25)]
    found = c(wire([*made, *[Gain(f"{s}_2", s, 1.0) for s in "abc"], *sources]), np.array([0.9, 1.1]))
    assert [found[s].tolist() for s in ("h", "y", "latch")] == [[0.0, 1.0], [0.25, 1.0], [0.0, 0.0]]


def test_the_c_program_filters_and_follows_a_function_of_time():
    values = {"mean": 1.0, "amplitude": 0.5, "omega": 2.0, "bump": 3.0, "centre": 4.0, "width": 0.5}
    swing = Equations("u", out=_swing, outputs="u", params=values)
    smooth = Biquad("y", "u", [0.2, 0.3, 0.1], [-0.6, 0.2], 0.5, start=1.0)
    found = c(wire([swing, smooth]), np.arange(20) * 0.5 + 0.25)

    def u(t):  # its docstring
        return 1.0 + 0.5 * math.sin(2.0 * t) + 3.0 * math.exp(-(((t - 4.0) / 0.5) ** 2))

    y, before = [1.0, 1.0], [1.0, 1.0]  # analytic: settled at 1, then the difference equation
    for k in range(20):
        now = u(0.5 * k)
        y.append(0.2 * now + 0.3 * before[-1] + 0.1 * before[-2] + 0.6 * y[-1] - 0.2 * y[-2])
        before.append(now)
    assert found["u"] == pytest.approx([u(0.5 * k + 0.25) for k in range(20)], abs=1e-12)
    assert found["y"] == pytest.approx(y[2:], abs=1e-12)


def test_seeds_draw_the_same_diagrams_again_and_every_kind_of_block():
    kinds: set[str] = set()
    for seed in range(40):
        drawn, again = draw(seed), draw(seed)
        assert [b.params for b in drawn.diagram.blocks] == [b.params for b in again.diagram.blocks]
        assert np.array_equal(drawn.times, again.times)
        kinds |= {type(block).__name__ for block in drawn.diagram.blocks}
    assert kinds >= {
        "Constant", "Step", "Ramp", "Sine", "Square", "Noise", "Sum", "Gain", "Saturation", "DeadTime", "FirstOrder",
        "SecondOrder", "Integrator", "PI", "PID", "SampledPI", "StickSlip", "QuasiStaticStem", "Deadband", "KanoValve",
        "Sensor", "SampledSensor", "MinSelect", "MaxSelect", "DeadZone", "Lookup1D", "Quantiser", "Switch", "Relay",
        "RateLimiter", "ResetIntegrator", "ZeroOrderHold", "SampledFilter", "VariableDelay", "Biquad", "Equations",
    }  # fmt: skip


def small(**changes):
    loop = wire([Step("MV", 1.0), SecondOrder(K=1.0, omega=1.0, zeta=0.5), Gain("twice", "PV", 2.0)])
    return Drawn(0, loop.with_params(changes), 10.0, np.linspace(0.05, 9.9, 50))


def test_the_judge_agrees_where_the_engine_is_right():
    assert judging.judge(small()).verdict == "agree"


@pytest.mark.parametrize("oracle", ["c", "reference"])
@pytest.mark.parametrize("planted", [{"twice.factor": 2.001}, {"process.omega": 1.001}])
def test_the_judge_finds_a_planted_mistake(planted, oracle, monkeypatch):
    monkeypatch.setattr(judging, "simulate", lambda diagram, *a, **k: simulate(diagram.with_params(planted), *a, **k))
    if oracle == "reference":
        monkeypatch.setattr(judging, "covers", lambda diagram: "asked for")
    found = judging.judge(small())
    assert (found.verdict, found.oracle) == ("finding", oracle)
    assert "twice" in found.why and ("outputs of states are right" in found.why) == ("twice.factor" in planted)


def test_an_engine_that_raises_or_stops_is_a_finding(monkeypatch):
    monkeypatch.setattr(judging, "STEPS", 3)
    assert "TOO_MANY_STEPS" in judging.judge(small()).why
    monkeypatch.setattr(judging, "simulate", lambda *a, **k: 1 / 0)
    assert "ZeroDivisionError" in judging.judge(small()).why


def test_a_diagram_on_which_an_oracle_differs_from_itself_is_undecided(monkeypatch):
    monkeypatch.setattr(judging, "SHARES", (0.9, 0.45))  # steps far too long
    found = judging.judge(small())
    assert found.verdict == "undecided" and "oracle differs from itself" in found.why


def test_every_block_of_the_search_has_an_oracle():
    # what the C program does not know goes to stickslip.diagram.reference
    asked = {covers(draw(seed).diagram) for seed in [*range(20), *range(24, 240, 8)]}
    assert asked == {"", "PI with conditional integration"}


def run(*arguments):
    command = [sys.executable, "-m", "benchmarks.torture", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


def test_the_command_repeats_a_seed_and_writes_json(tmp_path):
    file = tmp_path / "found.json"
    done = run("--seed", str(CLEAN), "--json", str(file))
    assert done.returncode == 0, done.stderr
    assert f"seed {CLEAN}: agree" in done.stderr and "site1/n0/process" in done.stderr
    figures = json.loads(file.read_text())
    assert figures["diagrams"] == figures["agree"] == 1 and figures["next_seed"] == CLEAN + 1
    assert figures["judgements"] == []


@pytest.mark.parametrize("arguments", [["--minutes", "0"], ["--minutes", "x"], ["--from", "-1"], ["--to", "-3"]])
def test_bad_arguments_end_with_2_and_a_word(arguments, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["benchmarks.torture", *arguments])
    with pytest.raises(SystemExit) as ended:
        options()
    assert ended.value.code == 2 and "error" in capsys.readouterr().err


def test_recorded_blocks_are_known_to_no_c_program():
    assert covers(wire([Recorded("MV", [0.0, 1.0], [0.0, 1.0]), FirstOrder(K=1.0, tau=1.0)])) == "Recorded"
