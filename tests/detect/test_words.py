import re
from pathlib import Path
from typing import get_args

import pytest
from stickslip.detect.words import WORDS, Kind, Word
from stickslip.logs.style import PAGE

ROOT = Path(__file__).resolve().parents[2]


def test_every_word_has_its_wording():
    assert set(WORDS) == set(get_args(Word))
    for attribute in ("spoken", "of_several", "sentence", "number", "letter", "colour"):
        assert len({getattr(said, attribute) for said in WORDS.values()}) == len(WORDS), attribute
    assert all(re.fullmatch(r"[A-Z].*\.", said.sentence) and len(said.letter) == 1 for said in WORDS.values())
    assert all(said.spoken == word.replace("_", " ") for word, said in WORDS.items())


def test_numbers_are_those_of_the_docs_of_the_block():
    listed = re.search(r"verdict  (.+)\n", (ROOT / "detect/blocks/detector.py").read_text())
    assert listed is not None
    said = {float(number): word for number, word in re.findall(r"(\d) ([a-z ]+)", listed[1])}
    assert said == {word.number: word.spoken for word in WORDS.values()}


def test_kinds_are_those_that_a_page_and_a_terminal_know():
    from stickslip.commands.console import COLOUR_OF
    from stickslip.commands.report.page import CSS

    assert set(COLOUR_OF) == set(get_args(Kind))
    assert all(kind in PAGE and f".{kind} " in CSS for kind in get_args(Kind))


def test_nobody_changes_them():
    with pytest.raises(TypeError):
        WORDS["stiction"] = WORDS["inconclusive"]  # type: ignore[index]
