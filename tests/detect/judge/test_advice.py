from typing import get_args

import pytest
from stickslip.detect.judge.advice import ADVICE, advice
from stickslip.detect.verdict import Code, Word


def test_every_verdict_and_every_code_has_a_sentence():
    assert set(ADVICE) == {*get_args(Word), *get_args(Code)}


@pytest.mark.parametrize("code", get_args(Code))
def test_a_refusal_gets_the_sentence_of_its_code(code):
    said = advice("not_applicable", {code}, stem_logged=False)
    assert said.endswith(".") and "{" not in said
    assert said == advice("not_applicable", {code, "wrong_process_type"}, stem_logged=False)


def test_a_verdict_comes_before_the_refusals_of_other_methods():
    assert advice("stiction", {"constant_signal"}, stem_logged=True).startswith("To prove it and size it: see where")
    assert "log the stem position" in advice("inconclusive", {"wrong_process_type"}, stem_logged=False)


def test_what_is_wrong_with_the_record_comes_before_the_open_question():
    assert advice("inconclusive", {"compressed"}, stem_logged=False).startswith("To settle it: log raw values")
