"""The study of noise and compression: conditions are made as they say, curves survive their file."""

import numpy as np
import pytest
from stickslip.calibration import simulate
from stickslip.detect.methods import cross_correlation, relay_fit

from benchmarks import tolerance
from benchmarks.tolerance import (
    AGAINST,
    CONDITIONS,
    CYCLES,
    NOISE,
    POINTS,
    Point,
    clean,
    figure,
    measure,
    read_csv,
    to_csv,
)


def test_the_clean_state_has_no_defect_but_one_percent_of_noise():
    specs = clean(8)
    assert [spec.group for spec in specs[::2]] == ["cycling"] * 4 and {s.group for s in specs[1::2]} == set(AGAINST)
    for spec in specs:
        assert (spec.noise, spec.points, spec.samples) == (NOISE, POINTS, POINTS * CYCLES)
        assert spec.step_pv == spec.step_op == spec.door == spec.stale == spec.walk == spec.coarse == 0.0
    assert clean(8) == specs  # the same loops whenever they are drawn


@pytest.fixture(scope="module")
def one():
    return clean(2)[:1]


def made(name, level, one):
    (condition,) = [condition for condition in CONDITIONS if condition.name == name]
    ((record, truth),) = simulate([condition.spec(one[0], level)])
    return condition.record(record, truth, level)


def test_each_condition_does_what_it_says(one):
    quantised = made("quantisation", 8.0, one).pv
    assert len(np.unique(quantised)) <= 12 < len(np.unique(made("quantisation", 1000.0, one).pv))
    for level in (3.0, 8.0):
        thinned = made("sampling", level, one)
        mean = thinned.op.mean()
        crossed = int(np.sum((thinned.op[:-1] < mean) & (thinned.op[1:] >= mean)))  # cycles in the record
        assert len(thinned) / crossed == pytest.approx(level, rel=0.25)
    short, whole = made("length", 5.0, one), made("length", 40.0, one)
    assert short.t[-1] == whole.t[-1] and len(short) < 0.3 * len(whole)

    def straight(record):  # share of samples on the line between their neighbours: what a swinging door draws
        bend = np.abs(np.diff(record.pv, 2))
        return float(np.mean(bend < 1e-9 * np.ptp(record.pv)))

    assert straight(made("compression", 0.25, one)) > 0.5 > straight(made("compression", 0.0, one))
    # third differences: what noise adds from sample to sample, without the cycle
    rough = [float(np.std(np.diff(made("noise", level, one).pv, 3))) for level in (0.01, 0.25)]
    assert rough[1] > 1.5 * rough[0]  # noise is kept to what the controller would be left with


def test_curves_of_two_methods(monkeypatch):
    monkeypatch.setattr(tolerance, "TESTED", [cross_correlation, relay_fit])
    points = measure(clean(2), [CONDITIONS[-1]])
    assert len(points) == 2 * len(CONDITIONS[-1].levels)
    for point in points:
        assert point.sticky == point.others == 1 and 0 <= point.found <= 1 and 0 <= point.undecided <= 2
    shortest = [point for point in points if point.level == CONDITIONS[-1].levels[-1]]
    assert all(point.undecided == 2 for point in shortest)  # three cycles decide nothing
    assert read_csv(to_csv(points)) == points
    picture = figure(points, CONDITIONS[-1])
    picture.canvas.draw()
    assert [line.get_ydata()[0] for line in picture.axes[0].lines] == [points[0].found, points[0].false_alarms]


def test_the_kept_curves_are_whole():
    from pathlib import Path

    kept = read_csv((Path(__file__).parents[2] / "docs" / "images" / "tolerance" / "tolerance.csv").read_text())
    assert {point.condition for point in kept} == {condition.name for condition in CONDITIONS}
    for condition in CONDITIONS:
        assert {p.level for p in kept if p.condition == condition.name} == set(condition.levels)
    assert all(isinstance(point, Point) and point.sticky == point.others for point in kept)
