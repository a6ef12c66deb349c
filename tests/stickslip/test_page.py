"""The page is one file that works offline: read as text, and in a browser where there is one."""

import json
import re
import shutil
from html.parser import HTMLParser

import pytest

from stickslip.commands.report.page import Section, page, table_to_html
from tests.stickslip.browser import browser


class Reader(HTMLParser):
    """Collects tags, attributes and text."""

    def __init__(self):
        super().__init__()
        self.tags, self.ids, self.links, self.words = [], [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "src", "xlink:href", "srcset", "data", "poster", "action", "background"):
                self.links.append(value)

    def handle_data(self, data):
        self.words.append(data)


def read(text):
    reader = Reader()
    reader.feed(text)
    return reader


@pytest.fixture(scope="module")
def demo_page(tmp_path_factory):
    from click.testing import CliRunner

    from stickslip.commands.cli import cli

    folder = tmp_path_factory.mktemp("demo")
    done = CliRunner().invoke(cli, ["demo", "--out", str(folder)], catch_exceptions=False)
    assert done.exit_code == 0
    return folder / "index.html"


def test_no_request_no_script_unique_ids(demo_page):
    text = demo_page.read_text(encoding="utf-8")
    seen = read(text)
    assert "script" not in seen.tags and not {"link", "img", "iframe", "object", "embed"} & set(seen.tags)
    assert seen.links and all(link.startswith("#") for link in seen.links)
    assert {link[1:] for link in seen.links} <= set(seen.ids)
    assert len(set(seen.ids)) == len(seen.ids)
    assert set(re.findall(r"https?://[^\"'\s<]+", text)) <= {
        "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink",
    }  # names of XML, which no browser fetches  # fmt: skip
    assert "@import" not in text and not re.search(r"url\((?!#)", text)
    assert set(re.findall(r"url\(#([^)]+)\)", text)) <= set(seen.ids)
    assert not re.search(r"\son[a-z]+=", text)


def test_verdicts_reasons_and_guide_are_words(demo_page):
    words = " ".join(read(demo_page.read_text(encoding="utf-8")).words)
    for word in ("STICTION", "INCONCLUSIVE", "NO STICTION", "in truth: stiction", "How to read it", "FIC-101"):
        assert word in words
    assert "What was read and assumed" in words


def test_text_is_escaped():
    text = page("<a&b>", "", [Section("<i>", "<b>", "stiction", "1 < 2", "<s>", "<t>", "<l>", ["<n>"])], guide="<g>")
    assert not {"a&b", "i", "b", "s", "t", "l", "n", "g"} & set(read(text).tags)
    assert "1 &lt; 2" in text


def test_numbers_stand_to_the_right_and_words_do_not():
    table = table_to_html(["name", "value", "band", "said"], [["a", "1.5", "1 to 2e-3", "1 of 2"], ["b", "-", "", "x"]])
    assert "<th>name</th><th class='num'>value</th><th class='num'>band</th><th>said</th>" in table
    assert table.count("<td class='num'>") == 4


def test_notes_are_said_once_and_what_is_missed_is_marked():
    rows = [["a", "met"], ["b", "NOT met"], ["c", "met"]]
    table = table_to_html(["name", "verdict"], rows, ["why", "why", ""], [False, True, False])
    assert table.count("<li>why</li>") == 1 and table.count("<sup>1</sup>") == 2
    assert table.count("class='missed'") == 1 and "<td class='mark'>NOT met</td>" in table


def test_a_browser_shows_it(demo_page, tmp_path):
    alone = tmp_path / "one file.html"
    shutil.copy(demo_page, alone)
    done = browser("--virtual-time-budget=2000", "--dump-dom", alone.as_uri())
    dom = done.stdout.decode()
    assert "INCONCLUSIVE" in dom and "NO STICTION" in dom
    assert dom.count("<svg") == dom.count("<figure") >= 5
    assert "Written by stickslip" in dom


def test_a_narrow_window_scrolls_pictures_and_not_the_page(tmp_path):
    wide = table_to_html(["row", *"abcdefgh"], [["a long name of a row", *["1234567 to 1234567"] * 8]])
    section = Section("t", "b", "stiction", "r", figures=[wide])
    probe = "<script>document.title=document.documentElement.scrollWidth+' '+window.innerWidth</script></body>"
    file = tmp_path / "page.html"
    file.write_text(page("t", "", [section]).replace("</body>", probe), encoding="utf-8")
    dom = browser("--window-size=600,900", "--virtual-time-budget=1000", "--dump-dom", file.as_uri()).stdout.decode()
    needed, there = map(int, re.search(r"<title>(\d+) (\d+)</title>", dom).groups())
    assert needed <= there


def test_a_phone_shows_pv_against_op_whole(demo_page, tmp_path):
    probe = """<script>addEventListener('load', () => { document.title = JSON.stringify(
      [...document.querySelectorAll('.grid figure:not(.scroll) svg')].map(one => one.getBoundingClientRect().right));
    })</script></body>"""
    file = tmp_path / "demo.html"
    file.write_text(demo_page.read_text(encoding="utf-8").replace("</body>", probe), encoding="utf-8")
    frame = tmp_path / "phone.html"  # headless Chromium has no window as narrow
    narrow = f"<iframe src='{file.name}' style='width: 390px; height: 900px; border: 0'></iframe>"
    script = "<script>addEventListener('load', () => { document.title = frames[0].document.title })</script>"
    frame.write_text(narrow + script, encoding="utf-8")
    done = browser("--allow-file-access-from-files", "--virtual-time-budget=3000", "--dump-dom", frame.as_uri())
    rights = json.loads(re.search(r"<title>(\[.*?\])</title>", done.stdout.decode()).group(1))
    assert len(rights) >= 5 and max(rights) <= 390.0


def test_on_paper_a_heading_stays_with_its_picture():
    # by its rules: it is seen by no measure which sheet of a PDF a word stands on
    rules = page("t", "", []).rpartition("@media print")[2]
    for selector, rule in (("h2", "break-after: avoid"), ("figure", "break-inside: avoid"), ("figcaption", "before")):
        assert re.search(rf"\b{selector}\b[^{{}}]*{{[^}}]*{rule}", rules), selector


def test_it_prints(demo_page, tmp_path):
    paper = tmp_path / "page.pdf"
    browser(f"--print-to-pdf={paper}", demo_page.as_uri())
    assert len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes())) >= 3
