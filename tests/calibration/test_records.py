"""Simulated records: the same again, no cause told by a lone number, and every defect really there."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.stats import rankdata
from stickslip.calibration import LoopSpec, draw, simulate
from stickslip.calibration.__main__ import calibration
from stickslip.calibration.chunks import read, write
from stickslip.calibration.defects import DEFECTS, names
from stickslip.calibration.drawing import OTHERS, one


def test_equal_specs_give_equal_records_whatever_runs_beside_them() -> None:
    specs = draw(24, seed=2)
    together = simulate(specs, workers=2)
    for i in (0, 5, 11, 23):
        (alone, truth), (loop, other) = simulate([specs[i]], workers=1)[0], together[i]
        assert loop.pv.tolist() == alone.pv.tolist() and loop.op.tolist() == alone.op.tolist()
        assert repr(truth) == repr(other)


def test_specs_are_plain_and_a_set_may_be_drawn_in_parts() -> None:
    specs = draw(30, seed=3)
    assert [LoopSpec(**json.loads(json.dumps(asdict(spec)))) for spec in specs] == specs
    assert draw(10, seed=3, first=20) == specs[20:]
    assert draw(30, seed=4) != specs and draw(30, seed=3, setting="other_physics") != specs


def test_most_of_the_sticky_loops_are_moved_by_something_else_where_that_is_asked_for() -> None:
    usual, moved = draw(520, seed=3), draw(520, seed=3, kinds="moved")
    for specs, share in ((usual, 0.2), (moved, 0.8)):
        sticky = [spec.group for spec in specs if spec.cause == "stiction"]
        assert len(sticky) == 260 and sticky.count("excited") == share * 260
    assert [a for a in usual if a.group in OTHERS] == [b for b in moved if b.group in OTHERS]


def test_a_level_with_a_deadband_cycles_and_is_no_stiction() -> None:
    truths = [truth for _, truth in simulate(draw(40, seed=3, kinds="levels"), workers=1)]
    assert {truth.cause for truth in truths} == {"deadband"} and {truth.process for truth in truths} == {"integrating"}
    assert all(np.isnan(truth.S) or truth.J == 0.0 for truth in truths)
    assert sum(truth.cycling for truth in truths) > 10


def test_bad_requests_are_refused() -> None:
    with pytest.raises(ValueError, match="kinds = 'all'"):
        draw(1, 1, kinds="all")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="n = 0, seed = 1"):
        draw(0, 1)
    with pytest.raises(ValueError, match="setting = 'lab'"):
        draw(1, 1, "lab")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="group = 'sticky'"):
        one("sticky", (1, 2))


def area(positive: np.ndarray, negative: np.ndarray) -> float:
    """Return the area under the curve of hits over false alarms of one number as a detector."""
    ranks = rankdata(np.concatenate([positive, negative]))
    n, m = len(positive), len(negative)
    return float((ranks[:n].sum() - n * (n + 1) / 2) / (n * m))


def test_no_lone_amplitude_length_or_period_tells_stiction() -> None:
    drawn = draw(500, seed=31)
    specs = [replace(spec, valve="kano") for spec in drawn]  # the quickest law; numbers of the draw are what counts
    found = simulate(specs)
    sticky = np.array([truth.cause == "stiction" for _, truth in found])
    numbers = {
        "range of OP": [truth.op_range for _, truth in found],
        "range of OP as logged": [np.ptp(loop.op) for loop, _ in found],
        "range of PV": [np.ptp(loop.pv) for loop, _ in found],
        "standard deviation of PV": [np.std(loop.pv) for loop, _ in found],
        "mean of PV": [abs(np.mean(loop.pv)) for loop, _ in found],
        "samples": [len(loop) for loop, _ in found],
        "sampling interval": [loop.dt for loop, _ in found],
        "period": [truth.period / loop.dt if truth.period > 0.0 else len(loop) for loop, truth in found],
        "number of defects": [len(truth.defects) for _, truth in found],
    }
    # with 250 of each the standard error of an area of 0.5 is 0.026
    areas = {name: area(np.array(values)[sticky], np.array(values)[~sticky]) for name, values in numbers.items()}
    assert {name: value for name, value in areas.items() if not 0.42 <= value <= 0.58} == {}


def test_every_group_meets_every_defect() -> None:
    specs = draw(2600, seed=5)
    groups = {"cycling", "excited", *OTHERS}
    assert {spec.group for spec in specs} == groups
    for defect in DEFECTS:
        if defect != "coarse_transmitter":  # the cause of one group
            assert {spec.group for spec in specs if defect in names(spec)} == groups, defect


BARE = {
    "noise": 0.0, "coarse": 0.0, "walk": 0.0, "sp_move": 0.0, "step_pv": 0.0, "step_op": 0.0, "door": 0.0, "stale": 0.0,
    "sp_logged": True, "process_known": True, "span_known": True, "points": 20.0, "samples": 1500,
}  # fmt: skip


def pair(**change: object) -> tuple:
    """Return a record without defects and the same with one."""
    bare = replace(one("external_sine", (3, 4)), **BARE)  # type: ignore[arg-type]
    (a, clean), (b, defects) = simulate([bare, replace(bare, **change)])  # type: ignore[arg-type]
    assert clean.defects == ()
    return a, b, defects.defects


def test_each_defect_is_really_there() -> None:
    clean, noisy, defects = pair(noise=0.1)
    size = np.ptp(clean.pv)
    assert defects == ("noise",) and 0.05 * size < np.std(np.diff(noisy.pv) - np.diff(clean.pv)) < 0.3 * size
    clean, rough, defects = pair(step_pv=8.0)
    assert defects == ("rounded_pv",) and len(np.unique(rough.pv.round(9))) <= 11 < len(np.unique(clean.pv))
    clean, rough, defects = pair(step_op=8.0)
    assert defects == ("rounded_op",) and len(np.unique(rough.op.round(9))) <= 11
    clean, rough, defects = pair(coarse=3.0)
    assert defects == ("coarse_transmitter",) and len(np.unique(rough.pv.round(9))) <= 8
    clean, pressed, defects = pair(door=0.05)
    straight = np.abs(np.diff(pressed.pv, 2)) < 1e-9 * size
    assert (
        defects == ("compressed",) and straight.mean() > 0.5 > 0.1 > np.abs(pressed.pv - clean.pv).max() / size - 0.05
    )
    clean, stale, defects = pair(stale=0.3)
    held = (np.diff(stale.pv) == 0.0) & (np.diff(stale.op) == 0.0)
    assert defects == ("stale",) and 0.15 < held.mean() < 0.45
    clean, moved, defects = pair(sp_move=1.0, sp_hold=5.0)
    assert defects == ("sp_moves",) and np.ptp(clean.sp) == 0.0 < np.ptp(moved.sp)
    clean, walked, defects = pair(walk=1.0)
    slow = np.convolve(walked.op - clean.op, np.ones(50) / 50.0, "valid")
    assert defects == ("walking_load",) and np.ptp(slow) > 0.2 * np.ptp(clean.op)
    _, lost, defects = pair(sp_logged=False)
    assert defects == ("no_sp",) and lost.sp is None
    _, lost, defects = pair(process_known=False)
    assert defects == ("unknown_process",) and lost.process == "unknown"
    clean, lost, defects = pair(span_known=False)
    assert defects == ("unknown_span",) and lost.op_span is None and np.corrcoef(lost.op, clean.op)[0, 1] > 1.0 - 1e-9
    _, _, defects = pair(points=5.5)
    assert defects == ("few_points",)


def test_a_set_is_kept_in_chunks_and_taken_up_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stickslip.calibration.chunks.CHUNK", 4)
    assert write(tmp_path, 10, seed=6, progress=False) == 10
    whole = {file.name: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    (tmp_path / "parts" / "000000004.parquet").unlink()
    assert write(tmp_path, 10, seed=6, progress=False) == 4
    assert {file.name: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()} == whole
    made = simulate(draw(10, seed=6))
    for (spec, loop, truth), (there, known), drawn in zip(read(tmp_path), made, draw(10, seed=6), strict=True):
        assert spec == drawn and repr(truth) == repr(known)
        assert loop.pv.tolist() == there.pv.tolist() and loop.op.tolist() == there.op.tolist()
        assert (loop.sp is None) == (there.sp is None) and loop.process == there.process
        assert loop.op_span == there.op_span
    with pytest.raises(ValueError, match="holds another set"):
        write(tmp_path, 11, seed=6, progress=False)


def test_a_folder_without_loops_says_how_to_make_them(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="calibration simulate"):
        next(read(tmp_path))


def test_the_command_writes_a_set_and_refuses_another_in_its_place(tmp_path: Path) -> None:
    ask = ["simulate", "3", "--seed", "8", "--out", str(tmp_path / "loops")]
    first = CliRunner().invoke(calibration, ask)
    assert first.exit_code == 0 and "3 loops simulated, 0 were there already" in first.output
    assert "0 loops simulated, 3 were there already" in CliRunner().invoke(calibration, ask).output
    other = CliRunner().invoke(calibration, [*ask, "--setting", "other_physics"])
    assert other.exit_code == 2 and "holds another set" in other.output
    assert len(list(read(tmp_path / "loops"))) == 3
