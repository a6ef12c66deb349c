"""Noise: the generator against published numbers, statistics against theory, streams reproducible and independent."""

import math

import numpy as np
import pytest
from scipy import stats
from stickslip.blocks.noise import Noise, seeded, uniform
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sensor import SampledSensor
from stickslip.blocks.sources import Constant
from stickslip.diagram import simulate, wire

N = 20_000


def draw(noise, n=N):
    return simulate(wire([noise], outputs=[noise.output_labels[0]]), float(n), times=np.arange(n) * noise.period).log[
        noise.output_labels[0]
    ]


def test_generator_gives_the_published_first_numbers():
    # published: output of L'Ecuyer's MRG32k3a from the state (12345, ..., 12345)
    state = np.full(6, 12345.0)
    assert [uniform(state, 0) for _ in range(5)] == pytest.approx(
        [0.12701112204657714, 0.3185275653967945, 0.3091860155832701, 0.8258468629271136, 0.2216299157820229], abs=1e-16
    )


def test_generator_is_exact_in_doubles():
    # analytic: the same recurrence in Python's unlimited integers
    seeds = [int(v) for k, v in seeded(99).items() if k != "w"]
    state = np.array(seeds, dtype=float)
    a, b = seeds[:3], seeds[3:]
    for _ in range(2000):
        uniform(state, 0)
        a = [a[1], a[2], (1403580 * a[1] - 810728 * a[0]) % 4294967087]
        b = [b[1], b[2], (527612 * b[2] - 1370589 * b[0]) % 4294944443]
    assert state.tolist() == [float(v) for v in a + b]


def test_white_noise_is_normal_with_the_given_mean_and_sd():
    y = draw(Noise("D", sd=0.3, dt=1.0, mean=2.0, seed=11))
    assert np.mean(y) == pytest.approx(2.0, abs=4 * 0.3 / math.sqrt(N))  # four standard errors
    assert np.std(y) == pytest.approx(0.3, rel=4 / math.sqrt(2 * N))
    assert stats.kstest((y - 2.0) / 0.3, "norm").pvalue > 1e-3
    w = y - np.mean(y)
    for lag in (1, 2, 5):
        assert abs(np.mean(w[lag:] * w[:-lag]) / np.var(y)) < 4 / math.sqrt(N)


def test_coloured_noise_has_the_autocorrelation_of_its_correlation_time():
    y = draw(Noise("D", sd=0.5, dt=1.0, correlation_time=5.0, seed=12))
    effective = N / 10.0  # N dt / (2 T_c) independent values
    assert np.std(y) == pytest.approx(0.5, rel=4 / math.sqrt(effective))
    w = y - np.mean(y)
    for lag in (1, 3, 5, 10):
        r = np.mean(w[lag:] * w[:-lag]) / np.var(y)
        assert r == pytest.approx(math.exp(-lag / 5.0), abs=4 / math.sqrt(effective))


def test_coloured_noise_is_stationary_from_its_first_sample():
    noise = Noise("D", sd=1.0, dt=1.0, correlation_time=100.0)
    first = [float(noise.reseeded(seed).output(0.0, noise.reseeded(seed).d0, [])[0]) for seed in range(1500)]
    assert np.std(first) == pytest.approx(1.0, rel=4 / math.sqrt(2 * 1500))
    assert np.mean(first) == pytest.approx(0.0, abs=4 / math.sqrt(1500))


def test_equal_seeds_repeat_and_different_seeds_are_independent():
    noise = Noise("D", sd=1.0, dt=1.0, seed=7)
    y = draw(noise)
    np.testing.assert_array_equal(y, draw(noise))
    np.testing.assert_array_equal(y, draw(noise.reseeded(1).reseeded(7)))
    for other in (8, (7, 1), (7, 2)):
        assert abs(np.corrcoef(y, draw(noise.reseeded(other)))[0, 1]) < 4 / math.sqrt(N)


def test_compiled_and_interpreted_draws_are_the_same():
    noise = Noise("D", sd=1.0, dt=1.0, correlation_time=2.0, seed=3)
    compiled = draw(noise, 200)
    memory, interpreted = noise.d0, []
    for k in range(200):
        interpreted.append(float(noise.output(float(k), memory, [])[0]))
        memory = noise.dynamics(float(k), memory, [])
    np.testing.assert_allclose(compiled, interpreted, rtol=0, atol=1e-12)


def test_simulating_does_not_use_up_the_block():
    noise = Noise("D", sd=1.0, dt=1.0, seed=3)
    before = noise.d0.copy()
    draw(noise, 50)
    np.testing.assert_array_equal(noise.d0, before)


def test_python_control_sees_the_mean():
    assert float(Noise("D", sd=1.0, dt=1.0, mean=4.0).smooth().output(0.0, [], [])[0]) == 4.0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Noise("D", sd=-1.0, dt=1.0), ["sd = -1.0", "negative"]),
        (lambda: Noise("D", sd=1.0, dt=0.0), ["dt = 0.0", "positive"]),
        (lambda: Noise("D", sd=1.0, dt=1.0, correlation_time=-2.0), ["correlation_time = -2.0", "0 for white"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)


# --- seeds that follow from names ----------------------------------------------------------------------------------


def two_sensors():
    sensors = [SampledSensor(dt=1.0, sd=1.0, name=name, inputs="PV", outputs=f"{name}_m") for name in ("A", "B")]
    return wire([Constant("PV", 0.0), *sensors])


def test_two_default_sensors_draw_different_numbers():
    log = simulate(two_sensors(), 2000.0, every=1.0).log
    assert abs(np.corrcoef(log["A_m"], log["B_m"])[0, 1]) < 4.0 / math.sqrt(2000)  # analytic: 0 +- 1/sqrt(n)
    again = simulate(two_sensors(), 2000.0, every=1.0).log
    assert np.array_equal(log["A_m"], again["A_m"])


def test_nested_copies_of_one_loop_draw_different_numbers():
    loop = two_sensors()
    plant = wire([loop.named("a"), wire([loop.named("b")], name="c")])
    log = simulate(plant, 500.0, every=1.0).log
    noises = [log[f"{where}_m"] for where in ("a/A", "a/B", "c/b/A", "c/b/B")]
    assert len({noise.tobytes() for noise in noises}) == 4
    # the seed follows from the full name, whichever way the block came to it
    direct = Noise("c/b/A", sd=1.0, dt=1.0)
    assert np.array_equal(plant["c/b/A"].d0[:7], direct.d0[:7])


def test_a_given_seed_stays_when_the_name_changes():
    noise = Noise("D", sd=1.0, dt=1.0, seed=5)
    assert np.array_equal(noise.relabelled("a/D", [], ["a/D"]).d0, noise.d0)
    drawn = Noise("D", sd=1.0, dt=1.0).reseeded(5)
    assert np.array_equal(drawn.relabelled("a/D", [], ["a/D"]).d0, noise.d0)


def test_the_end_of_a_run_keeps_its_numbers_when_it_is_nested():
    end = simulate(two_sensors(), 10.0, every=1.0).final
    assert not np.array_equal(end["A"].d0, two_sensors()["A"].d0)
    assert np.array_equal(wire([end.named("later")])["later/A"].d0, end["A"].d0)


@pytest.mark.parametrize("seed", ["x", -1, 1.5, [1, -2]])
def test_a_seed_that_is_none_is_refused(seed):
    with pytest.raises(BlockError) as refusal:
        Noise("D", sd=1.0, dt=1.0, seed=seed)
    for word in (f"seed = {seed!r}", "whole number", "seed=7"):
        assert word in str(refusal.value)
