"""The points of a study: grammar, grid, Latin hypercube, refusals."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.study import StudyError, loguniform, normal, parse, uniform
from stickslip.study.axes import Law, axes_of
from stickslip.study.design import design

lists = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=4, unique=True)


@given(st.lists(lists, min_size=0, max_size=3), st.integers(1, 3))
def test_listed_axes_form_the_grid_and_every_point_has_its_kicks(values, kicks):
    axes = axes_of("vary", {f"block.p{i}": v for i, v in enumerate(values)})
    plan = design(axes, None, 0, kicks)
    # oracle: itertools.product, the first axis slowest
    assert [plan.at(point) for point in range(plan.points)] == [tuple(c) for c in product(*values)]
    assert len(plan) == plan.points * kicks


def test_hypercube_has_one_point_in_every_slice_of_every_axis():
    axes = axes_of("vary", {"a.x": uniform(0.0, 50.0), "a.y": loguniform(1.0, 2.0**50), "a.z": normal(0.0, 1.0)})
    plan = design(axes, 50, 3, None)
    points = np.array([plan.at(point) for point in range(50)])
    # analytic: 50 equally likely slices, one point in each
    assert sorted(np.floor(points[:, 0])) == list(range(50))
    assert sorted(np.floor(np.log2(points[:, 1]))) == list(range(50))
    from scipy.special import ndtr

    assert sorted(np.floor(50 * ndtr(points[:, 2]))) == list(range(50))


def test_hypercube_follows_its_seed():
    axes = axes_of("vary", {"a.x": uniform(0.0, 1.0), "a.y": uniform(0.0, 1.0)})
    assert design(axes, 8, 1, None) == design(axes, 8, 1, None)
    assert design(axes, 8, 1, None).drawn != design(axes, 8, 2, None).drawn


def test_random_points_repeat_at_every_grid_point():
    axes = axes_of("vary", {"a.x": [1.0, 2.0], "a.y": uniform(0.0, 1.0), "a.z": [5.0, 6.0]})
    plan = design(axes, 3, 1, None)
    points = [plan.at(point) for point in range(plan.points)]
    assert [p[0] for p in points] == [1.0] * 6 + [2.0] * 6
    assert [p[2] for p in points] == [5.0, 5.0, 5.0, 6.0, 6.0, 6.0] * 2
    assert [p[1] for p in points] == [p[1] for p in points[:3]] * 4


def test_ranges():
    assert parse("a.b=1:2:3")[1] == [1.0, 1.5, 2.0]
    assert np.allclose(parse("a.b=1:100:3:log")[1], [1.0, 10.0, 100.0], rtol=1e-15)
    assert parse("a.b = 1, 2")[1] == [1.0, 2.0]
    assert parse("a.b=normal(3,0.5)")[1] == Law("normal", 3.0, 0.5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("VPCS1.F_s", "is not NAME=VALUES"),
        ("=3", "is not NAME=VALUES"),
        ("a.b=1:2", "low:high:count"),
        ("a.b=1:2:1", "at least 2"),
        ("a.b=1:2:2.5", "whole number"),
        ("a.b=1:1:3", "different, finite ends"),
        ("a.b=-1:1:3:log", "positive ends"),
        ("a.b=1:x:3", "no number"),
        ("a.b=1,,2", "empty value"),
        ("a.b=uniform(1)", "two numbers"),
        ("a.b=uniform(2,1)", "exchange them"),
        ("a.b=unifrom(1,2)", "did you mean 'uniform'"),
        ("a.b=loguniform(0,1)", "take uniform"),
        ("a.b=normal(1,0)", "must be positive"),
        ("a.b=uniform(1,inf)", "finite"),
    ],
)
def test_what_is_spelt_wrong_is_refused(text, words):
    with pytest.raises(StudyError, match=words.replace("(", r"\(")):
        parse(text)


@pytest.mark.parametrize(
    ("axes", "samples", "kicks", "words"),
    [
        ({"a.x": uniform(0, 1)}, None, None, "how many points"),
        ({"a.x": [1.0]}, 5, None, "no axis is random"),
        ({"a.x": uniform(0, 1)}, 0, None, "can be drawn"),
        ({"a.x": [1.0]}, None, -1, "0 .at rest. or more"),
        ({"a.x": range(2000), "a.y": range(1000)}, None, None, "2000 of a.x x 1000 of a.y are 2,000,000 runs"),
    ],
)
def test_designs_that_make_no_sense_are_refused(axes, samples, kicks, words):
    with pytest.raises(StudyError, match=words):
        design(axes_of("vary", axes), samples, 1, kicks)


@pytest.mark.parametrize(
    ("values", "words"),
    [([], "no values"), ([1.0, 1.0], "twice"), (["high"], "is no number"), ([float("nan")], "nan")],
)
def test_values_that_make_no_sense_are_refused(values, words):
    with pytest.raises(StudyError, match=words):
        axes_of("vary", {"a.x": values})
