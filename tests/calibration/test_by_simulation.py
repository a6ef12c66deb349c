"""Stage (b): what is measured of a record, what is simulated for it, and what is read off the simulated loops."""

import math
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from stickslip.calibration import at_record, by_simulation, simulate
from stickslip.calibration.alike import alike
from stickslip.calibration.by_simulation import PIECE, split
from stickslip.calibration.conditions import conditions
from stickslip.calibration.drawing import one
from stickslip.calibration.posterior import SEEN, chances, detection_limit, nearest, read, weighted_quantile
from stickslip.calibration.records import Table
from stickslip.calibration.spec import CAUSES
from stickslip.logs import LoopRecord

BARE = {
    "noise": 0.01, "noise_time": 0.0, "walk": 0.0, "sp_move": 0.0, "door": 0.0, "stale": 0.0, "step_pv": 0.0,
    "step_op": 0.0, "driver_swell": 0.0, "driver_second": 0.0, "points": 20.0, "samples": 600, "span_known": True,
    "sp_logged": True, "process_known": True,
}  # fmt: skip


def record(group: str, stream: tuple[int, int], **changes: object) -> LoopRecord:
    spec = replace(one(group, stream), **{**BARE, **changes})  # type: ignore[arg-type]
    return simulate([spec])[0][0]


def test_the_conditions_are_those_that_were_simulated() -> None:
    stream = (21, 3)
    seen = conditions(record("external_sine", stream))
    assert seen.samples == 600 and seen.points == pytest.approx(20.0, rel=0.05)
    assert seen.op_range == pytest.approx(one("external_sine", stream).swing, rel=0.1)
    assert 0.003 < seen.noise < 0.03 and not seen.compressed and seen.stale == 0.0 and seen.sp == "still"
    assert conditions(record("external_sine", stream, noise=0.1)).noise == pytest.approx(0.1, rel=0.4)
    assert conditions(record("external_sine", stream, step_pv=10.0)).step_pv == pytest.approx(10.0, rel=0.2)
    assert conditions(record("external_sine", stream, door=0.05)).compressed
    stale = conditions(record("external_sine", stream, stale=0.3, stale_hold=10.0))
    assert stale.stale == pytest.approx(0.3, abs=0.12) and stale.stale_hold == pytest.approx(10.0, rel=0.6)
    assert conditions(record("external_sine", stream, sp_move=1.0, sp_hold=5.0)).sp == "moves"
    assert conditions(record("external_sine", stream, sp_logged=False)).sp == "none"


def test_conditions_do_not_depend_on_units() -> None:
    loop = record("excited", (22, 1))
    other = LoopRecord.from_arrays(
        loop.t * 60.0, pv=4.0 - 30.0 * loop.pv, op=loop.op, sp=4.0 - 30.0 * loop.sp, process=loop.process
    )
    a, b = conditions(loop), conditions(other)
    assert a.points == b.points and a.noise == pytest.approx(b.noise, rel=1e-6) and a.sp_move == b.sp_move == 0.0
    assert b.dt == pytest.approx(60.0 * a.dt)


def test_a_record_that_shows_nothing_is_refused() -> None:
    t = np.arange(100.0)
    with pytest.raises(ValueError, match="OP does not move"):
        at_record(LoopRecord.from_arrays(t, pv=np.sin(t), op=0 * t + 50))
    with pytest.raises(ValueError, match="20 good samples"):
        at_record(LoopRecord.from_arrays(t[:20], pv=np.sin(t[:20]), op=np.cos(t[:20])))


def test_loops_alike_have_the_conditions_of_the_record() -> None:
    seen = conditions(record("cycling", (23, 4), step_pv=12.0))
    specs = alike(seen, 60, seed=1)
    assert sum(spec.cause == "stiction" for spec in specs) == 30
    assert {spec.samples for spec in specs} == {600} and specs == alike(seen, 60, seed=1)
    again = [conditions(loop) for loop, _ in simulate(specs)]
    assert np.median([one.points for one in again]) == pytest.approx(seen.points, rel=0.3)
    assert np.median([one.op_range for one in again]) == pytest.approx(seen.op_range, rel=0.3)
    assert np.mean([one.step_pv > 0.0 for one in again]) > 0.8
    sizes = np.array([spec.S / seen.op_range for spec in specs if spec.cause == "stiction"])
    assert sizes.min() < 0.35 and sizes.max() > 0.7  # so that the smallest stick that shows can be told


def test_a_long_record_is_looked_at_in_pieces() -> None:
    t = np.arange(2600.0)
    pieces = split(LoopRecord.from_arrays(t, pv=np.sin(t / 9), op=np.cos(t / 9)))
    assert [len(piece) for piece in pieces] == [PIECE] * 4
    assert pieces[0].t[0] == 0.0 and pieces[-1].t[-1] == 2599.0


def test_a_clear_stick_and_a_clear_disturbance_are_told_apart() -> None:
    sticky = record("cycling", (25, 0), J=8.0, S=10.0)
    other = record("external_sine", (25, 2))
    a = at_record(sticky, loops=300, seed=1, workers=1)  # of 160 the interval of S is ragged
    b = at_record(other, loops=100, seed=1, workers=1)
    assert a.probability > 0.8 > 0.4 > b.probability
    assert sum(a.causes.values()) == pytest.approx(1.0, abs=1e-9) and max(a.causes, key=a.causes.get) == "stiction"
    assert a.S.low < 10.0 < a.S.high and a.S.low < a.S.value < a.S.high
    assert a.loops > 280 and a.area > 0.7 and a.false_alarms <= 0.07
    content = a.to_dict()
    assert content["amount"]["S"]["unit"] == "% of OP" and set(content) >= {"causes", "detection_limit", "loops"}
    assert "loops were simulated under the conditions of this record" in a.sentences[0]


def test_chances_are_found_from_known_odds() -> None:
    # analytic: two normal classes one standard deviation apart have log odds x - 1/2
    r = np.random.default_rng(3)
    yes = np.arange(8000) % 2 == 1
    x = (r.normal(size=8000) + yes)[:, None]
    a, b = chances(x, yes, np.ones(8000), np.zeros(2))
    assert b == pytest.approx(1.0, abs=0.1) and a == pytest.approx(-0.5, abs=0.1)
    # analytic: a loop of double weight counts as two loops
    weights = 1.0 + (np.arange(8000) < 3000)
    twice = np.r_[np.arange(8000), np.arange(3000)]
    np.testing.assert_allclose(
        chances(x, yes, weights, np.zeros(2)), chances(x[twice], yes[twice], np.ones(11_000), np.zeros(2)), atol=1e-4
    )


def test_the_limit_is_where_nine_of_ten_are_found_though_never_all_are() -> None:
    # analytic: the chance rises from 0 to 0.95 and is 0.9 at a size of 0.6; a stick beyond the travel is never found
    r = np.random.default_rng(5)
    size = np.exp(r.uniform(math.log(0.1), math.log(2.0), 20_000))
    chance = np.where(size > 1.0, 0.0, np.minimum(0.9 * size / 0.6, 0.95))
    found = r.random(20_000) < chance
    assert detection_limit(size, found) == pytest.approx(0.6, rel=0.05)
    assert math.isnan(detection_limit(size, r.random(20_000) < 0.9 * chance))  # at most 0.855
    assert math.isnan(detection_limit(size[size > 0.9][:20], found[size > 0.9][:20]))  # too few
    assert math.isnan(detection_limit(np.full(50, 2.0), np.ones(50, dtype=bool)))  # none within the travel


def test_neighbours_and_quantiles_carry_their_weights() -> None:
    points = np.linspace(0.0, 1.0, 101)[:, None]
    weights = nearest(points, np.array([0.2]), count=20.0)
    assert np.argmax(weights) == 20 and weights[90] < 1e-6 * weights[20]
    at = weighted_quantile(points[:, 0], weights, np.array([0.05, 0.5, 0.95]))
    assert at[0] < 0.2 < at[2] and at[1] == pytest.approx(0.2, abs=0.02)


def test_the_posterior_of_known_normal_classes_is_told_with_its_sizes() -> None:
    # analytic: where z_odds is the true log odds, the posterior at z = 0.8 is 1/(1 + exp(-0.8)); S is read off the
    # sticky loops about the record, J is never more than S, and a cause that no loop about the record has is improbable
    r = np.random.default_rng(8)
    n = 6000
    sticky = np.arange(n) % 2 == 0
    odds = 2.0 * (r.normal(size=n) + np.where(sticky, 1.0, -1.0))
    size = r.normal(-1.0, 0.5, n)
    scores = np.column_stack([odds, size, size - 0.5])
    others = np.where(odds > 0.0, "deadband", "healthy")
    truth = {
        "cause": np.where(sticky, "stiction", others),
        "S": np.where(sticky, np.exp(size + r.normal(0.0, 0.2, n)), np.nan),
        "J": np.where(sticky, np.exp(size - 0.5), np.nan),
    }
    known = Table(np.array(SEEN), scores, np.ones(n), truth)
    said = read(known, np.array([[0.8, -1.0, -1.5]]))
    assert said.causes["stiction"] == pytest.approx(1.0 / (1.0 + math.exp(-0.8)), abs=0.05)
    assert sum(said.causes.values()) == pytest.approx(1.0) and set(said.causes) == set(CAUSES)
    assert said.causes["deadband"] > 2.0 * said.causes["healthy"] and said.causes["drift"] > 0.0
    assert said.S[0] == pytest.approx(math.exp(-1.0), rel=0.1) and said.S[1] < said.S[0] < said.S[2]
    assert all(j <= s for j, s in zip(said.J, said.S, strict=True))
    far = read(known, np.array([[0.8, -1.0, -1.5], [-4.0, -1.0, -1.5], [-4.4, -1.0, -1.5]]))  # the median piece counts
    assert far.causes["stiction"] < 0.1 and far.causes["healthy"] > 5.0 * far.causes["deadband"]


def test_of_the_loops_only_the_network_is_asked_and_shares_that_show_nothing_are_left_out(monkeypatch) -> None:
    specs = alike(conditions(record("cycling", (31, 1))), 6, seed=4)
    made = by_simulation.made_of(specs)
    assert set(SEEN) < set(made.names.tolist()) and all(name.startswith("network_") for name in made.names.tolist())
    plain = by_simulation.made_of
    monkeypatch.setattr(by_simulation, "SHARE", 3)
    nothing = replace(made.rows(np.arange(6) < 3), names=np.array([]), x=np.zeros((3, 0)), unit=np.full(3, np.nan))
    monkeypatch.setattr(by_simulation, "made_of", lambda share: nothing if share[0] == specs[0] else plain(share))
    left = by_simulation.simulated(specs, workers=1)
    np.testing.assert_array_equal(left.x, made.x[3:])
    monkeypatch.setattr(by_simulation, "made_of", lambda share: nothing)
    assert not by_simulation.simulated(specs, workers=1).seen.any()


def test_where_it_is_stopped_the_processes_are_told(monkeypatch) -> None:
    left = []

    class Waiting:
        def submit(self, *_: object) -> "Future[object]":
            return Future()

    @contextmanager
    def waiting(count: int):
        try:
            yield Waiting()
        except BaseException as fault:
            left.append((count, fault))
            raise

    def stopped(share: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(by_simulation, "OWN_PROCESS", 5)
    monkeypatch.setattr(by_simulation, "SHARE", 3)
    monkeypatch.setattr(by_simulation, "processes", waiting)
    monkeypatch.setattr(by_simulation, "made_of", stopped)
    with pytest.raises(KeyboardInterrupt):
        by_simulation.simulated(alike(conditions(record("cycling", (31, 1))), 12, seed=4), workers=2)
    assert [(count, type(fault)) for count, fault in left] == [(1, KeyboardInterrupt)]


def test_several_processes_make_the_loops_that_one_makes_in_the_same_order(monkeypatch) -> None:
    monkeypatch.setattr(by_simulation, "OWN_PROCESS", 5)
    monkeypatch.setattr(by_simulation, "SHARE", 3)
    specs = alike(conditions(record("cycling", (31, 1))), 23, seed=4)
    one, two = (by_simulation.simulated(specs, workers) for workers in (1, 2))
    assert one.names.tolist() == two.names.tolist()
    np.testing.assert_array_equal(one.x, two.x)
    assert one.sticky.tolist() == two.sticky.tolist() and one.truth["group"].tolist() == two.truth["group"].tolist()
