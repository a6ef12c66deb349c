"""`stickslip reproduce`: the document, the page, and folders that cannot be."""

import html
import json
import re
from pathlib import Path

import pytest
from stickslip.cases.starts import Fresh
from stickslip.cases.tables import Row

from stickslip.commands import reproduce
from stickslip.commands.captions import CAPTIONS
from stickslip.commands.cli import COMMANDS


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    from click.testing import CliRunner

    from stickslip.commands.cli import cli

    folder = tmp_path_factory.mktemp("reproduce") / "pages"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reproduce, "QUICK", 2)
        arguments = ["reproduce", "--quick", "--out", str(folder), "--json", "-"]
        result = CliRunner().invoke(cli, arguments, catch_exceptions=False)
    return result, folder / "index.html"


def test_document(done):
    result, page = done
    assert result.exit_code == 0
    answer = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(word))
    assert answer["schema"] == "stickslip.reproduce/1" and answer["quick"] is True and answer["page"] == str(page)
    for row in answer["rows"]:
        assert list(row)[:3] == ["table", "row", "unit"]
        assert {"published", "reproduced", "low", "high", "within", "tolerance", "note"} < set(row)
        assert row["within"] in (True, False, None)
        if row["within"] is False:
            assert row["note"], row["row"]  # what is missed is explained
    tables = {row["table"] for row in answer["rows"]}
    assert tables == {"5.4", "6.1", "6.2", "case 2", "ideal"}
    rows = {row["row"]: row for row in answer["rows"]}
    assert rows["pressure amplitude, high"]["published"] == 0.44  # published: table 5.4
    assert rows["level amplitude, none"]["within"] is True  # published: no oscillation
    assert len({(row["table"], row["row"]) for row in answer["rows"]}) == len(answer["rows"])


def test_the_headline_says_what_holds_on_fresh_starts(done):
    result, page = done
    answer = json.loads(result.stdout)
    plants = [row for row in answer["rows"] if row["within"] is not None and row["table"] != "ideal"]
    first = answer["headline"][0]
    met = sum(row["within"] for row in plants)  # one set of starts: its count is that of the rows
    assert "starts that were not used to find it" in first and f"{met} of the plant's {len(plants)} rows" in first
    assert first[0].upper() + first[1:] in html.unescape(page.read_text()) and first in result.stderr.replace("\n", " ")
    assert all(row["held"] is None for row in plants)


def test_headline_of_several_sets_counts_the_rows_that_tell_them_apart():
    def row(table, name, within):
        return Row(table, name, "s", 1.0, 1.0, 0.5, 1.5, within, "median within 10 %", "")

    found = [row("5.4", "a", True), row("5.4", "b", True), row("5.4", "c", False), row("ideal", "i", False)]
    found += [row("5.4, set A", name, within) for name, within in (("a", True), ("b", False), ("c", False))]
    keys = [("5.4", name) for name in "abc"]
    sets = tuple(dict(zip(keys, one, strict=True)) for one in ((1, 1, 0), (1, 0, 0), (1, 1, 1)))
    said = reproduce._headline(found, Fresh(tuple(found[:3]), sets, 100))
    assert "2 of the plant's 3 rows" in said[0] and "the median of 3 sets of 100 (1 to 3)" in said[0]
    assert said[1].startswith("1 of these rows every set of parameters meets and 1 none; of the 1 that tell them apart")
    assert said[1].endswith("E meets 1 (0 to 1), A 0")
    assert said[2] == "ideal loops: 0 of 1 rows with a tolerance are met"


def test_columns_say_what_a_band_is():
    assert "± 1 s.d." in reproduce._columns("ideal") and "5 to 95 %" in reproduce._columns("5.4")
    assert reproduce._cells(Row("ideal", "x", "s", 1.0, 2.0, 2.0, 2.0, None))[3] == "-"  # one number has no band


def test_what_is_not_drawn_is_not_promised(done):
    """No claim of every table and figure: table 6.3 and figure 6.2 are of data that were never published."""
    _, page = done
    text = " ".join(page.read_text().split())
    assert "Table 6.3 and figure 6.2 are of real data that were never published" in text
    root = Path(__file__).parents[2]
    for file in [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("stickslip/*.py")]:
        if file.name not in ("CHANGELOG.md", "history.md"):
            assert not re.search(r"every (table|figure|picture)[^.;]{0,30}thesis", file.read_text(), re.I), file.name


def test_page_has_tables_and_pictures_and_needs_no_network(done):
    _, page = done
    text = page.read_text()
    for number in ("5.1", "5.2", "5.3", "5.4", "5.5", "5.6", "6.1", "7.1", "7.2", "7.3", "B.1", "B.2", "B.3", "B.4"):
        assert text.count(f"Figure {number}:") == 1
    assert "Table 5.4: periods and amplitudes" in text and "NOT met" in text
    assert "<script" not in text and "src=" not in text


def test_page_begins_with_what_is_not_met(done):
    result, page = done
    text = page.read_text()
    first = text[text.index("<article id='s0'>") : text.index("<article id='s1'>")]
    missed = [row for row in json.loads(result.stdout)["rows"] if row["within"] is False]
    assert "What is not met, and why" in first
    assert all(row["row"] in first for row in missed) and first.count("<tr>") == 1 + len(missed)


def test_every_picture_has_its_sentence(done):
    _, page = done
    assert page.read_text().count("<figcaption>") == sum(map(len, reproduce.FIGURES.values())) - 1  # choice: --scan
    assert set(CAPTIONS) == {number for numbers in reproduce.FIGURES.values() for number in numbers}


def test_sets_stand_beside_each_other():
    def row(table, within, value):
        return Row(table, "pressure amplitude, high", "bar", 0.44, value, 0.1, 0.5, within, "median within 25 %", "why")

    found = [row("5.4", True, 0.389), row("5.4, set A", False, 0.329), row("ideal", False, 3.0)]
    section = reproduce._sets(found)
    assert section.badge == "E 1, A 0 of 1 met"
    assert "<td class='num'>0.389</td><td class='num'>0.329 ✗</td>" in section.figures[0]
    assert "within 25 %" in section.figures[0] and "ideal" not in section.figures[0]


def test_what_is_missed_is_said(done):
    result, _ = done
    answer = json.loads(result.stdout)
    missed = [row for row in answer["rows"] if row["within"] is False]
    assert missed and result.stderr.count("not met:") == len(missed)


def test_folder_that_is_a_file_is_refused_before_the_work(call, tmp_path, monkeypatch):
    monkeypatch.setattr(reproduce, "_rows", lambda *_: pytest.fail("worked before it looked"))
    file = tmp_path / "file"
    file.write_text("")
    result = call("reproduce", "--out", file)
    assert result.exit_code == 2 and "name a folder" in result.stderr


def test_it_is_listed(call):
    assert "reproduce" in COMMANDS and "reproduce" in call("--help").stdout


@pytest.mark.parametrize(
    ("value", "text"), [(None, "-"), (float("nan"), "-"), (1e-12, "0"), (0.3004, "0.3"), (1234.5, "1234")]
)
def test_numbers_are_short(value, text):
    assert reproduce.show(value) == text
