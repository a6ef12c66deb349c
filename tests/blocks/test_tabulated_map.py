"""Compressor maps from curves: made-up families with known answers, real design curves, files."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from stickslip.blocks.ports import BlockError
from stickslip.blocks.tabulated_map import TabulatedMap, read_curves

DATA = Path(os.environ.get("STICKSLIP_DATA", Path(__file__).parents[3] / "shared" / "data")) / "compressor"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason=f"the compressor curves are not at {DATA}: NOT TESTED")


def bent(n=3):
    """Return curves of a made-up family that follows the fan laws exactly: V = n V_1, h = n^2 h_1."""
    V = np.linspace(10.0, 20.0, 21)
    h, eta = 100.0 - 0.2 * (V - 10.0) ** 2, 0.8 - 0.002 * (V - 14.0) ** 2
    speeds = np.linspace(0.8, 1.1, n)
    return {s: (s * V, s**2 * h) for s in speeds}, {s: (s * V, eta) for s in speeds}


def test_table_of_a_family_that_obeys_the_fan_laws():
    head, eta = bent()
    shape = TabulatedMap.from_curves(head, eta, speed=1.0, flow=14.0, head_at=96.8)
    for n in (0.8, 0.9, 1.03, 1.1, 1.3):
        for V in (10.0, 11.7, 14.0, 17.3, 20.0):
            q = V / 14.0
            assert shape.psi(q, n) == pytest.approx((100.0 - 0.2 * (V - 10.0) ** 2) / 96.8, rel=1e-3)  # analytic
            efficiency = shape.psi(q, n) / shape.work(q, n)
            assert efficiency == pytest.approx(0.8 - 0.002 * (V - 14.0) ** 2, rel=1e-3)
    assert shape.psi(1.0, 1.0) == pytest.approx(1.0, rel=1e-3)
    assert shape.surge(0.93) == pytest.approx(10.0 / 14.0, rel=1e-12)


def test_table_beyond_its_curves():
    head, eta = bent()
    shape = TabulatedMap.from_curves(head, eta, speed=1.0, flow=14.0, head_at=96.8, valley=0.75)
    q_s = shape.surge(1.0)
    top = shape.psi(q_s, 1.0)
    assert shape.psi(0.0, 1.0) == pytest.approx(0.75 * top, rel=1e-12)  # analytic: the valley
    assert shape.psi(q_s - 1e-9, 1.0) == pytest.approx(top, rel=1e-6)  # continuous at surge
    assert shape.psi(-0.1, 1.0) > shape.psi(0.0, 1.0)  # reverse flow meets resistance
    end = 20.0 / 14.0
    assert shape.psi(end + 1e-9, 1.0) == pytest.approx(shape.psi(end, 1.0), rel=1e-6)
    assert shape.psi(end + 0.2, 1.0) < shape.psi(end + 0.1, 1.0) < shape.psi(end, 1.0)
    assert shape.work(0.1, 1.0) == shape.work(q_s, 1.0)
    assert shape.work(end + 0.5, 1.0) == pytest.approx(shape.work(end, 1.0), rel=1e-12)


def test_one_curve_is_enough():
    V, h = [10.0, 15.0, 20.0], [100.0, 90.0, 60.0]
    shape = TabulatedMap.from_curves({1.0: (V, h)}, {1.0: (V, [0.7, 0.8, 0.7])}, speed=1.0, flow=15.0, head_at=90.0)
    assert shape.psi(1.0, 0.7) == pytest.approx(shape.psi(1.0, 1.3), rel=1e-12)


@needs_data
def test_real_design_curves_come_back():
    head, eta = read_curves(DATA / "head.csv"), read_curves(DATA / "efficiency.csv")
    assert sorted(head) == [6882.0, 7865.0, 8848.0, 9831.0, 10322.0]  # published: the table's speeds
    at = float(PchipInterpolator(*head[9831.0])(22000.0))
    shape = TabulatedMap.read(DATA / "head.csv", DATA / "efficiency.csv", speed=9831.0, flow=22000.0)
    assert shape.psi(1.0, 1.0) * at == pytest.approx(at, rel=2e-3)  # analytic: scaled to 1 at the point given
    for speed, (V, h) in head.items():
        n = speed / 9831.0
        found = [shape.psi(v / 22000.0 / n, n) * n**2 * at for v in V]
        np.testing.assert_allclose(found, h, rtol=0.02)  # published points; the last ones fall like a wall
        np.testing.assert_allclose(found[:-4], h[:-4], rtol=0.006)
        V_eta, values = eta[speed]
        inside = (V_eta > V[0]) & (V_eta < V[-1])
        back = [shape.psi(v / 22000.0 / n, n) / shape.work(v / 22000.0 / n, n) for v in V_eta[inside]]
        np.testing.assert_allclose(back, values[inside], rtol=0.02)
    assert shape.surge(10322 / 9831) > shape.surge(6882 / 9831)  # these curves do not obey the fan laws


def test_files_are_read_in_any_order(tmp_path):
    (tmp_path / "h.csv").write_text("speed,flow,head\n1,20,5\n1,10,9\n")
    (tmp_path / "bare.csv").write_text("\ufeff1,20,5\n\n1,10,9\n")  # no header, but a byte-order mark
    for name in ("h.csv", "bare.csv"):
        V, h = read_curves(tmp_path / name)[1.0]
        assert V.tolist() == [10.0, 20.0] and h.tolist() == [9.0, 5.0]


def test_one_line_from_files(tmp_path):
    """Without a point given, q = n = psi = 1 halfway between surge and choke on the fastest curve."""
    rows = [f"{n},{n * V},{n * n * (100.0 - 0.2 * (V - 10.0) ** 2)}" for n in (0.9, 1.0) for V in np.arange(10.0, 20.5)]
    (tmp_path / "h.csv").write_text("\n".join(["speed,flow,head", *rows]))
    shape = TabulatedMap.read(tmp_path / "h.csv", 0.78)
    assert shape.speeds.tolist() == [0.9, 1.0]
    assert shape.psi(1.0, 1.0) == pytest.approx(1.0, rel=1e-3)  # analytic
    assert (shape.surge(1.0), float(shape.q_c[1])) == pytest.approx((10.0 / 15.0, 20.0 / 15.0), rel=1e-12)
    for q in (0.8, 1.0, 1.2):
        assert shape.psi(q, 0.95) / shape.work(q, 0.95) == pytest.approx(0.78, rel=1e-12)
    chosen = TabulatedMap.read(tmp_path / "h.csv", 0.78, speed=0.9, flow=12.6)
    assert chosen.psi(1.0, 1.0) == pytest.approx(1.0, rel=1e-3)  # analytic: V = 14 on the curve of speed 1
    assert chosen.psi(15.0 / 14.0, 1.1) == pytest.approx((100.0 - 0.2 * 25.0) / 96.8, rel=1e-3)


def test_misuse_is_explained(tmp_path):
    V, h = [10.0, 15.0], [100.0, 90.0]
    with pytest.raises(BlockError, match=r"no efficiency curve at speed 1.0"):
        TabulatedMap.from_curves({1.0: (V, h)}, {}, speed=1.0, flow=15.0, head_at=90.0)
    with pytest.raises(BlockError, match=r"head curve at speed 1.0 has 1 flows"):
        TabulatedMap.from_curves({1.0: ([1.0], [2.0])}, {1.0: (V, h)}, speed=1.0, flow=15.0, head_at=90.0)
    with pytest.raises(BlockError, match=r"speeds = .*but speeds are positive and increase"):
        TabulatedMap(np.array([1.0, 0.9]), np.ones(2), 2 * np.ones(2), np.ones((2, 3)), np.ones((2, 3)))
    (tmp_path / "bad.csv").write_text("speed,flow,head\n1,x,5\n")
    with pytest.raises(BlockError, match=r"bad.csv, line 2: .* is not speed, flow, value"):
        read_curves(tmp_path / "bad.csv")
    with pytest.raises(BlockError, match=r"efficiency = 78, but it is a fraction"):
        TabulatedMap.from_curves({1.0: (V, h)}, 78)
    with pytest.raises(BlockError, match=r"efficiency = 80.0, but it is a fraction; divide percent by 100"):
        TabulatedMap.from_curves({1.0: (V, h)}, {1.0: (V, [80.0, 70.0])})
    with pytest.raises(BlockError, match=r"speed = 2.0, but there are curves at 1"):
        TabulatedMap.from_curves({1.0: (V, h)}, 0.8, speed=2.0)
    with pytest.raises(BlockError, match=r"flow = 20.0, but the curve at speed 1 goes from 10 to 15"):
        TabulatedMap.from_curves({1.0: (V, h)}, 0.8, flow=20.0)
    with pytest.raises(BlockError, match=r"head_at = -1.0, but it must be positive"):
        TabulatedMap.from_curves({1.0: (V, h)}, 0.8, flow=12.0, head_at=-1.0)
    with pytest.raises(BlockError, match=r"a map needs a curve"):
        TabulatedMap.from_curves({}, 0.8)
    (tmp_path / "empty.csv").write_text("speed,flow,head\n")
    with pytest.raises(BlockError, match=r"empty.csv has no row of three numbers"):
        read_curves(tmp_path / "empty.csv")
    (tmp_path / "latin.csv").write_bytes(b"1,10,5\n# caf\xe9\n")
    with pytest.raises(BlockError, match=r"latin.csv is not UTF-8 text; save it as CSV, UTF-8"):
        read_curves(tmp_path / "latin.csv")
    for row in ("1,nan,5", "1,10,inf", "1;10;5", "1,10"):
        (tmp_path / "bad.csv").write_text(f"speed,flow,head\n1,9,6\n{row}\n")
        with pytest.raises(BlockError, match=r"bad.csv, line 3: .* is not speed, flow, value; .* between commas"):
            read_curves(tmp_path / "bad.csv")
    with pytest.raises(BlockError, match=r"the curve at speed 1 ends rising; check the columns"):
        TabulatedMap.from_curves({1.0: (V, [90.0, 100.0])}, 0.8)
    with pytest.raises(
        BlockError, match=r"efficiency = \(100.0, 150.0\), but the head curve at speed 1 goes from 10 to 15"
    ):
        TabulatedMap.from_curves({1.0: (V, h)}, {1.0: ([100.0, 150.0], [0.8, 0.7])})
    for curve in ((10.0, 90.0), (V, [90.0]), ([10.0, np.inf], h), ([10.0, 10.0], h)):
        with pytest.raises(BlockError, match=r"at least two points of increasing flow and positive value, all finite"):
            TabulatedMap.from_curves({1.0: curve}, 0.8)


def test_a_point_given_twice_counts_once_and_must_agree(tmp_path):
    file = tmp_path / "h.csv"
    file.write_text("1,10,5\n1,12,4\n1,10,5\n")
    assert read_curves(file)[1.0][0].tolist() == [10.0, 12.0]
    file.write_text("1,10,5\n1,12,4\n1,10,5.5\n")
    with pytest.raises(BlockError, match=r"line 3: at speed 1 and flow 10 stood 5, now 5.5; keep one"):
        read_curves(file)


def test_efficiency_may_be_any_number(tmp_path):
    (tmp_path / "h.csv").write_text("1,10,100\n1,20,60\n")
    shape = TabulatedMap.read(tmp_path / "h.csv", np.float32(0.5))
    assert shape.work(1.0) == pytest.approx(2.0, rel=1e-6)  # analytic: psi/efficiency
