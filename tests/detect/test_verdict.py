import json
import pickle

import numpy as np
import pytest
from stickslip.detect.verdict import Verdict, VerdictError


def test_refusal_never_carries_an_index():
    v = Verdict.not_applicable("area_ratio", "too_few_cycles", "2 cycles, 3 needed.")
    assert (v.index, v.interval, v.code, v.applicable) == (None, None, "too_few_cycles", False)
    with pytest.raises(VerdictError, match="leave index"):
        Verdict("area_ratio", "not_applicable", 1.0, None, "why", code="quantised")


@pytest.mark.parametrize(
    "word, code, match",
    [
        ("maybe", None, "give one of"),
        ("stiction", "quantised", "needs a code"),
        ("not_applicable", None, "needs a code"),
        ("not_applicable", "tired", "give one of"),
    ],
)
def test_contradictions_are_refused(word, code, match):
    with pytest.raises(VerdictError, match=match):
        Verdict("area_ratio", word, None, None, "why", code=code)


@pytest.mark.parametrize("index", [float("nan"), float("inf")])
def test_index_is_finite(index):
    with pytest.raises(VerdictError, match="finite"):
        Verdict("area_ratio", "stiction", index, 1.25, "why")


def test_reason_is_needed():
    with pytest.raises(VerdictError, match="reason"):
        Verdict("area_ratio", "inconclusive", None, None, " ")


def test_evidence_cannot_be_changed():
    mine = np.arange(3.0)
    v = Verdict("area_ratio", "stiction", 2.0, 1.25, "why", evidence={"e": mine, "R": 2.0})
    mine[0] = 9
    assert v.array("e")[0] == 0
    with pytest.raises(ValueError):
        v.array("e")[0] = 1
    with pytest.raises(TypeError):
        v.evidence["e"] = 1  # type: ignore[index]
    assert v.array("absent").shape == (0,)


def test_survives_pickle_and_json():
    v = Verdict("area_ratio", "stiction", 2.0, 1.25, "why", interval=(1.5, 2.5), evidence={"e": np.arange(3.0)})
    again = pickle.loads(pickle.dumps(v))
    assert again.to_dict() == v.to_dict()
    assert json.loads(json.dumps(v.to_dict(), allow_nan=False))["interval"] == [1.5, 2.5]
