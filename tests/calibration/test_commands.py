"""``python -m stickslip.calibration train`` from nothing to a model that answers, on a few loops."""

import pytest
from click.testing import CliRunner
from stickslip.calibration.__main__ import calibration
from stickslip.detect.judge.model import FILE, Model

LOOPS = 28  # of a part: every kind is among them


@pytest.fixture
def small(monkeypatch, tmp_path, here):
    """Parts of a few loops."""
    monkeypatch.setattr("stickslip.calibration.records.PART", LOOPS)
    monkeypatch.setattr("stickslip.calibration.records.processes", here)
    return tmp_path


def test_a_model_is_made_from_nothing(small):
    sizes = ["--loops", "112", "--network", "0"]
    places = ["--folder", str(small / "parts"), "--out", str(small / "model.json")]
    done = CliRunner().invoke(calibration, ["train", *sizes, *places], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    made, kept = Model.read(small / "model.json"), Model.read(FILE)
    assert made.kinds == kept.kinds  # what is shipped was made of the kinds that there are
    assert 28 < made.about["fitted_on"] <= 112
    assert 0.0 < made.clear < made.accuse < 1.0 and made.learnt > 0.0
