"""The pages for users are written in short sentences, and the tool that measures them counts rightly."""

import doctest
import importlib.util
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

spec = importlib.util.spec_from_file_location("docs_words", ROOT / "docs" / "words.py")
assert spec is not None and spec.loader is not None
words = importlib.util.module_from_spec(spec)
spec.loader.exec_module(words)

PLAIN = (  # a page that is rewritten is added here, and stays so
    "CONTRIBUTING.md", "README.md", "SECURITY.md", "docs/README.md", "docs/choose.md", "docs/ci.md", "docs/engine.md",
    "docs/examples.md", "docs/exports.md", "docs/gap.md", "docs/gap_found.md", "docs/licences.md",
    "docs/linearise.md", "docs/machines.md", "docs/methods.md", "docs/own.md", "docs/python_control.md",
    "docs/reading.md", "docs/releases/0.2.0.md", "docs/remedy.md", "docs/replay.md", "docs/scan.md",
    "docs/schemas.md", "docs/start.md", "docs/stiction.md", "docs/study.md", "docs/topologies.md", "docs/valve.md",
    "docs/verdict.md", "docs/vocabulary.md",
    *(str(script.relative_to(ROOT)) for script in sorted((ROOT / "docs").glob("*/*.py"))),
)  # fmt: skip


def test_sentences_of_the_pages_for_users_are_short() -> None:
    pages = {name: text for name, text in words.pages().items() if name in PLAIN}
    assert set(pages) == set(PLAIN)
    long = {name: [s for s in words.sentences(text) if words.length(s) > words.LIMIT] for name, text in pages.items()}
    assert {name: found for name, found in long.items() if found} == {}


def test_pages_for_users_are_no_diaries() -> None:
    """A page of a thousand words is read; what is counted and with which seed is evidence."""
    found = {name: words.plainness(text) for name, text in words.pages().items() if name in PLAIN}
    assert max(page.words for page in found.values()) <= 1500
    assert sum(page.own for page in found.values()) <= 5  # words that only this house uses so


def test_the_pages_for_users_are_at_most_twelve_thousand_words() -> None:
    pages = {name: text for name, text in words.pages().items() if not name.startswith("docs/evidence/")}
    assert {"README.md", "CONTRIBUTING.md", "docs/verdict.md", "docs/tutorials/2_a_plant.py"} <= set(pages)
    assert sum(words.plainness(text).words for text in pages.values()) <= 12_000


def test_the_tool_counts_rightly() -> None:
    assert doctest.testmod(words) == (0, 4)
    page = "A valve that sticks is found. " + "Word " * 26 + ".\n\n```\nnot counted\n```\n\n| nor | this |\n"
    assert [words.length(sentence) for sentence in words.sentences(page)] == [6, 26]  # analytic
    assert words.plainness(page).passive == 50.0
