"""Step tests of simulated valves: what the analysis reads is what the valve was made with."""

import numpy as np
import pytest
from stickslip.detect.valve_test import analyse
from stickslip.logs import LogError, LoopRecord

HOLD, DT = 60.0, 0.5
STEPS = [1, 1, -0.5, -0.5, -0.5, 2, 2, -1, -1, -1, 0.25, 0.25, 0.25, 0.25, 0.25, 5, -5, 5, -5, -0.5, -0.5, 0.5, 0.5]


def play(op: np.ndarray, deadband: float, stuck: float = 0.0) -> np.ndarray:
    """A stem with a deadband; with ``stuck`` it also answers no travel below that size in any direction [% of OP]."""
    stem = np.empty(len(op))
    at = op[0]
    for i, u in enumerate(op):
        wanted = min(max(at, u - 0.5 * deadband), u + 0.5 * deadband)
        if abs(wanted - at) >= stuck:
            at = wanted
        stem[i] = at
    return stem


def lagged(x: np.ndarray, tau: float, theta: float) -> np.ndarray:
    """A first-order lag behind a dead time, exact for inputs that are held between samples."""
    late = np.concatenate([np.full(round(theta / DT), x[0]), x])[: len(x)]
    y, a = np.empty(len(x)), np.exp(-DT / tau)
    y[0] = late[0]
    for i in range(1, len(x)):
        y[i] = a * y[i - 1] + (1.0 - a) * late[i - 1]
    return y


def made(deadband=0.0, stuck=0.0, tau=2.0, theta=1.0, gain=1.0, noise=0.0, steps=STEPS, seed=0, **named) -> LoopRecord:
    n = round(HOLD / DT)
    op = np.repeat(50.0 + np.cumsum([0, *steps]), n)
    stem = gain * lagged(play(op, deadband, stuck), tau, theta) + np.random.default_rng(seed).normal(0, noise, len(op))
    t = DT * np.arange(len(op))
    return LoopRecord.from_arrays(t, pv=stem, op=op, name="FIC1", **({"mv": stem} | named))


@pytest.mark.parametrize("deadband", [0.4, 0.8, 1.6])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_the_deadband_lies_in_its_bracket(deadband, noise) -> None:
    found = analyse(made(deadband, noise=noise)).deadband  # analytic: the width of the play
    assert found.low - 0.05 <= deadband <= found.high + 0.05
    assert found.high - found.low <= 1.0 and found.count >= 4


def test_a_valve_without_faults() -> None:
    test = analyse(made())
    assert test.deadband.high <= 0.5  # the smallest step back
    assert test.gain == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("stuck", [0.3, 0.7])
def test_the_resolution_lies_in_its_bracket(stuck) -> None:
    found = analyse(made(stuck=stuck)).resolution  # analytic: no travel below ``stuck`` is answered
    assert found.low <= stuck <= found.high


@pytest.mark.parametrize(("tau", "theta"), [(2.0, 1.0), (5.0, 3.0)])
def test_step_response_of_a_lag_with_dead_time(tau, theta) -> None:
    test = analyse(made(tau=tau, theta=theta, noise=0.005))
    assert len(test.responses) == 6
    times = np.median([response.T86 for response in test.responses])
    # analytic: and 63.2 % after tau log(1 / 0.368)
    sooner = np.median([response.T63 for response in test.responses])
    assert sooner == pytest.approx(theta + tau * np.log(1.0 / 0.368), abs=0.1)
    # analytic: a lag reaches 86.5 % after tau log(1 / 0.135)
    assert times == pytest.approx(theta + tau * np.log(1.0 / 0.135), abs=0.1)
    assert np.median([response.dead_time for response in test.responses]) == pytest.approx(theta, abs=DT)
    assert max(response.overshoot for response in test.responses) < 0.02


def test_pv_stands_in_for_a_stem_that_is_not_logged() -> None:
    test = analyse(made(0.8, gain=3.0, mv=None))
    assert test.answer == "PV" and "No stem is logged" in test.notes[0]
    assert test.deadband.low - 0.05 <= 0.8 <= test.deadband.high + 0.05
    assert test.gain == pytest.approx(3.0, rel=0.01)


def test_routine_moves_of_a_logged_stem() -> None:
    t = np.arange(3000.0)
    rng = np.random.default_rng(1)
    op = 50.0 + 4.0 * np.sin(t / 60.0) + np.cumsum(rng.normal(0, 0.02, len(t)))
    stem = play(op, 1.5)
    test = analyse(LoopRecord.from_arrays(t, pv=stem, op=op, mv=stem, name="FIC1"))
    assert test.source == "routine moves"
    assert test.deadband.value == pytest.approx(1.5, abs=0.2)


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (made(op_span=None), "--op-span"),
        (made(steps=[1, 1], mv=None), "has 2 steps of OP and no stem position"),
    ],
)
def test_refusals(record, words) -> None:
    with pytest.raises(LogError, match=words):
        analyse(record)


def test_a_test_in_one_direction_does_not_tell_the_deadband() -> None:
    test = analyse(made(0.5, steps=[1] * 8))
    assert test.deadband is None
    assert "step OP back after a move" in " ".join(test.notes)


def test_a_dead_valve() -> None:
    record = made()
    still = np.full(len(record.t), 50.0)
    test = analyse(LoopRecord.from_arrays(record.t, pv=still, op=record.op, mv=still))
    assert test.deadband is None and test.resolution is None and test.responses == ()
    assert "no step was answered" in " ".join(test.notes)


def test_plain_values_and_the_picture() -> None:
    import json

    test = analyse(made(0.8))
    assert json.loads(json.dumps(test.to_dict()))["deadband"]["unit"] == "% OP"
    assert test.plot().get_suptitle().startswith("FIC1: Deadband 0.")


def routine(moves, tau=4.0, theta=2.0, deadband=0.0, noise=0.0, wander=0.05, seed=3):
    """Six hours of OP that wanders as a controller makes it, with some moves that stand alone; (record, times)."""
    rng = np.random.default_rng(seed)
    n = 20_000
    op = 50.0 + wander * np.cumsum(rng.normal(0.0, 0.1, n))
    times = []
    for k, size in enumerate(moves):
        at = 2000 + 2500 * k
        op[at - 200 : at] = op[at - 200]  # an operator waits, moves and waits
        op[at : at + 400] = op[at - 1] + size
        op[at + 400 :] += op[at + 399] - op[at + 400]
        times.append(DT * at)
    stem = lagged(play(op, deadband), tau, theta) + rng.normal(0.0, noise, n)
    return LoopRecord.from_arrays(DT * np.arange(n), pv=stem, op=op, mv=stem, name="FIC1"), times


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_step_responses_are_found_in_a_long_log(noise) -> None:
    record, times = routine([4.0, -3.0, 5.0, -6.0], noise=noise)
    test = analyse(record)
    assert test.source == "routine moves"
    assert [response.time for response in test.responses] == pytest.approx(times)
    assert [response.size for response in test.responses] == pytest.approx([4.0, -3.0, 5.0, -6.0], abs=0.05)
    for response in test.responses:  # analytic, as above
        assert pytest.approx(2.0 + 4.0 * np.log(1.0 / 0.368), abs=0.25) == response.T63
        assert pytest.approx(2.0 + 4.0 * np.log(1.0 / 0.135), abs=0.35) == response.T86
        assert response.dead_time == pytest.approx(2.0, abs=DT + 0.1)
    assert any("T63" in sentence for sentence in test.words)
    assert test.plot_responses() is not None


def test_one_reversal_tells_no_deadband() -> None:
    test = analyse(routine([4.0, -3.0, 5.0, -6.0], deadband=1.0, noise=0.02)[0])
    assert test.deadband is None and test.slip_jump is None
    assert "4 are needed" in " ".join(test.notes)


def test_moves_that_are_not_held_are_no_steps() -> None:
    record, _ = routine([])
    test = analyse(record)
    assert test.responses == () and "No step response" in " ".join(test.notes)
    t = np.arange(4000.0)
    fast = 50.0 + 5.0 * np.sign(np.sin(t / 2.0))  # OP moves far, but is never held
    assert analyse(LoopRecord.from_arrays(t, pv=fast, op=fast + 1e-6 * t, mv=fast)).responses == ()


def test_pv_alone_tells_the_response_to_moves_that_stand_alone() -> None:
    record, times = routine([4.0, -3.0])
    bare = LoopRecord.from_arrays(record.t, pv=record.pv, op=record.op, name="FIC1")
    test = analyse(bare)
    assert test.answer == "PV" and len(test.responses) == len(times) and test.deadband is None
    assert "No stem is logged" in " ".join(test.notes)
