"""``python -m stickslip.calibration train`` from nothing to a model that answers, on a few loops."""

import numpy as np
import pytest
from click.testing import CliRunner
from stickslip.calibration.__main__ import calibration
from stickslip.detect.judge.model import FILE, Model

LOOPS = 28  # of a part: every kind is among them


@pytest.fixture
def small(monkeypatch, tmp_path, here):
    """Parts of a few loops."""
    pytest.importorskip("sklearn", reason="scikit-learn (extra calibration) is not installed")
    monkeypatch.setattr("stickslip.calibration.records.PART", LOOPS)
    monkeypatch.setattr("stickslip.calibration.records.processes", here)
    return tmp_path


def test_a_model_is_made_from_nothing(small):
    sizes = ["--loops", "112", "--holding", "56", "--network", "0", "--trees", "20"]
    places = ["--folder", str(small / "parts"), "--out", str(small / "model.npz")]
    done = CliRunner().invoke(calibration, ["train", *sizes, *places], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    made, kept = Model.read(small / "model.npz"), Model.read(FILE)
    assert made.names == kept.names  # what is shipped was made from the features that there are
    assert set(made.causes) == set(kept.causes)
    assert made.about["fitted_on"] <= 196 and made.about["calibrated_on"] <= 56
    p, others = made.probabilities(np.zeros((1, len(made.names))))
    assert p + others.sum(axis=1) == pytest.approx([1.0])
