"""What the shipped model is worth, on a small set of fresh loops: no figure of docs/verdict.md can rot unseen."""

import numpy as np
from stickslip.calibration import draw, simulate
from stickslip.calibration.records import Table, kept_table, table
from stickslip.calibration.scoring import auc, score
from stickslip.detect.judge.model import FILE, calibrated

LOOPS = 120  # half sticky; the standard error of AUC is 0.024, that of the share found 0.05


def test_the_shipped_model_is_worth_what_the_page_says() -> None:
    features = table(simulate(draw(LOOPS, seed=61)))
    found = score(calibrated(), features)
    assert found["auc"] > 0.92
    assert found["coverage"] > 0.75
    # snapshot 4 of 60, before 1; of 600 (seeds 61 and 34061) 5.7 % are called, 5.0 by the network before
    assert found["false_alarm"] < 0.08
    assert found["calibration_error"] < 0.13  # snapshot 0.122: the odds are those of crossed loops, too modest here
    assert found["s_error"] < 0.15 and found["j_error"] < 0.25
    seen = features.rows(features.seen)
    assert auc(seen.x[:, seen.names.tolist().index("network_sticky")], seen.sticky) > 0.9  # the network by itself


def test_the_model_file_is_small() -> None:
    assert FILE.stat().st_size < 1_500_000


def test_features_are_kept_part_by_part(tmp_path, monkeypatch, here) -> None:
    monkeypatch.setattr("stickslip.calibration.records.PART", 4)  # read when a part is made, in this process
    monkeypatch.setattr(
        "stickslip.calibration.records.made_part",
        lambda folder, setting, seed, kinds: table(simulate(draw(4, seed, setting, kinds=kinds))),
    )
    monkeypatch.setattr("stickslip.calibration.records.processes", here)
    two = kept_table(tmp_path, "training", 5, 2)
    parts = sorted((tmp_path / "training_5" / "parts").iterdir())
    assert len(two) == 8 and [part.stem for part in parts] == ["000000000", "000000004"]
    parts[1].unlink()
    again = kept_table(tmp_path, "training", 5, 2)
    assert same(two, again)
    assert same(two.rows(np.arange(8) < 4), kept_table(tmp_path, "training", 5, 1))  # fewer of the same
    assert two.sticky.sum() == 4


def same(a: Table, b: Table) -> bool:
    """Whether two tables are equal."""
    truth = all(np.array_equal(a.truth[k], b.truth[k], equal_nan=a.truth[k].dtype.kind == "f") for k in a.truth)
    return truth and a.names.tolist() == b.names.tolist() and np.array_equal(a.x, b.x, equal_nan=True)
