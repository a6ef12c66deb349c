"""The report on one loop and the page of a scan: complete, small, and whole in a browser on any screen."""

import re
import time

import polars as pl
import pytest
from stickslip.cases.stories import EXPORTS
from stickslip.detect import diagnose
from stickslip.logs import read_loop

from stickslip.commands.loop_page import loop_page
from stickslip.commands.scan_page import file_names, scan_page
from tests.stickslip.browser import browser, probed

SECTIONS = ("The answer", "The test that confirms it", "Over time", "The trend", "The evidence",
            "What every method says", "The data")  # fmt: skip
LARGEST = 2_000_000  # bytes a loop
LONGEST = 3.0  # s of processor time to make a report, once matplotlib is loaded


@pytest.fixture(scope="module")
def sticky():
    return diagnose(read_loop(EXPORTS / "FIC101_pi_export.csv"))


@pytest.fixture(scope="module")
def report(sticky, tmp_path_factory):
    file = tmp_path_factory.mktemp("report") / "loop.html"
    file.write_text(loop_page(sticky), encoding="utf-8")
    return file


def text_of(html):
    return re.sub(r"<[^>]+>", " ", re.sub(r"<style.*?</style>|<svg.*?</svg>", " ", html, flags=re.S))


def test_everything_that_a_report_must_say_is_said(report, sticky):
    html = report.read_text(encoding="utf-8")
    words = " ".join(text_of(html).split())
    assert all(section in words for section in SECTIONS)
    assert "STICTION" in words and "Probability of stiction" in words and "valve maintenance" in words
    assert "Detection limit" in words and "90 % interval" in words and "What was read and assumed" in words
    for verdict in sticky.methods:  # each with its reason, also where it abstains
        assert verdict.method.replace("_", " ") in words
        assert " ".join(verdict.reason.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").split()) in words
    assert html.count("<svg") >= 8
    for words in ("estimated MV", "PV behind OP", "frequency", "stem stands while OP moves", "clock time"):
        assert words in html


def test_the_data_are_told_without_codes_or_contradiction(report):
    data = report.read_text(encoding="utf-8").split("<h2>The data<")[1]
    assert "what is wanted" in data and "manual mode" not in data and "which no plant measures" not in data
    assert data.count("works in automatic<") == 1


def test_it_is_small_and_quick_to_make(report, sticky):
    assert report.stat().st_size <= LARGEST
    began = time.process_time()
    loop_page(sticky)
    assert time.process_time() - began <= LONGEST


@pytest.mark.parametrize("name", ["TIC204_decimal_comma.csv", "LIC410_level.csv", "PIC305_long_form.csv"])
def test_reports_on_other_loops_are_whole(name):
    page = loop_page(diagnose(read_loop(EXPORTS / name)))
    assert len(page) <= LARGEST and "The answer" in page and "The data" in page


def test_a_loop_that_cannot_be_judged_has_a_report():
    import numpy as np
    from stickslip.logs import LoopRecord

    t = np.arange(300.0)
    for pv in (0 * t + 4.0, np.full(300, np.nan)):
        words = text_of(loop_page(diagnose(LoopRecord.from_arrays(t, pv=pv, op=50 + np.sin(t / 9), name="FIC1"))))
        assert "NOT APPLICABLE" in words and "The data" in words


@pytest.mark.parametrize("width", [1280, 390])
def test_no_error_no_request_no_overflow(report, tmp_path, width):
    found = probed(report, tmp_path, max(width, 500))  # headless Chromium has no narrower window
    assert found["console"] == [] and found["asked"] == 0
    assert found["needed"] <= found["there"]


def test_the_verdict_is_there_with_scripts_off(report, tmp_path):
    forbidden = "<meta http-equiv='Content-Security-Policy' content=\"script-src 'none'\">"
    blank = "<script>document.body.textContent = ''</script></body>"
    text = report.read_text(encoding="utf-8").replace("<meta charset='utf-8'>", f"<meta charset='utf-8'>{forbidden}")
    still = tmp_path / "still.html"
    still.write_text(text.replace("</body>", blank), encoding="utf-8")
    dom = browser("--dump-dom", still.as_uri()).stdout.decode()
    assert "STICTION" in dom and "The valve looks sticky." in dom, "had a script run, nothing would be left"


def test_night_and_day(report, tmp_path):
    day = probed(report, tmp_path, 1280, "--blink-settings=preferredColorScheme=1")
    night = probed(report, tmp_path, 1280, "--blink-settings=preferredColorScheme=0")

    def light(colour):
        return sum(map(int, re.findall(r"\d+", colour)[:3])) / 3.0

    assert light(day["ground"]) > 200 > 80 > light(night["ground"])
    assert light(day["ink"]) < 80 < 200 < light(night["ink"])
    svg = report.read_text(encoding="utf-8").split("<svg")[1]
    assert "var(--x" in svg and "fill: #ffffff" not in svg, "pictures follow the page"


def test_it_prints(report, tmp_path):
    paper = tmp_path / "page.pdf"
    browser(f"--print-to-pdf={paper}", "--no-pdf-header-footer", report.as_uri())
    pages = len(re.findall(rb"/Type\s*/Page\b", paper.read_bytes()))
    assert 3 <= pages <= 9, "two pictures of the evidence beside each other, not a page for each"


@pytest.fixture(scope="module")
def scanned(tmp_path_factory):
    from click.testing import CliRunner

    from stickslip.commands.cli import cli

    folder = tmp_path_factory.mktemp("scan")
    words = ["scan", str(EXPORTS), "--out", str(folder / "kept"), "--workers", "1", "--html", str(folder / "scan.html"),
             "--reports", "1"]  # fmt: skip
    done = CliRunner().invoke(cli, words, catch_exceptions=False)
    assert done.exit_code == 1
    return folder


def test_the_first_loops_have_pages_of_their_own(scanned):
    html = (scanned / "scan.html").read_text(encoding="utf-8")
    [page] = (scanned / "scan-loops").iterdir()
    assert f"href='scan-loops/{page.name}'" in html and "The answer" in page.read_text(encoding="utf-8")
    linked = re.findall(r"href='#(s\d+)'", html)
    assert len(linked) == 4 and all(f"id='{target}'" in html for target in linked)


def test_rows_are_put_in_order_without_a_script(scanned, tmp_path):
    html = (scanned / "scan.html").read_text(encoding="utf-8")
    assert "<script" not in html
    found = probed(scanned / "scan.html", tmp_path, 1280)
    table = pl.read_parquet(scanned / "kept" / "scan.parquet")
    by_rank, by_name, by_probability, *_ = found["orders"]
    assert by_rank == table.sort("rank")["loop"].to_list()
    assert by_name == sorted(table["loop"])
    assert by_probability == table.sort("probability", descending=True)["loop"].to_list()
    assert found["console"] == [] and found["needed"] <= found["there"]
    narrow = probed(scanned / "scan.html", tmp_path, 500)
    assert narrow["needed"] <= narrow["there"]


def test_tags_are_text_and_their_files_stay_in_the_folder():
    rows = [{"order": 1, "rank": 1, "loop": "../../etc/passwd"}, {"order": 2, "rank": 2, "loop": "<script>"}]
    assert list(file_names(rows).values()) == ["001-etc_passwd.html", "002-script_.html"]


def test_a_hostile_tag_runs_nothing():
    from stickslip.scan import ScanResult
    from stickslip.scan.table import ranked, table_of

    row = {"order": 0, "loop": "<script>alert(1)</script>", "verdict": "stiction", "probability": 0.9}
    html = scan_page(ScanResult(ranked(table_of([row])), "x"), "1 loop")
    assert "<script" not in html and "&lt;script&gt;" in html


def test_the_page_builder_knows_nothing_of_what_it_shows():
    from pathlib import Path

    from stickslip.commands import report

    ours = {"stiction", "valve", "loop", "loops", "verdict", "stem", "detector", "study", "scan", "plant"}
    for file in Path(report.__file__).parent.glob("*.py"):
        words = set(re.findall(r"[a-z]+", file.read_text(encoding="utf-8").lower()))
        assert not words & ours, file.name
        assert not re.search(r"\b(OP|PV|SP|MV)\b", file.read_text(encoding="utf-8")), file.name
