"""docs/schemas.md is what the commands write."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
QUICK = ("check", "valve", "table --cards", "simulate --list", "linearise", "blocks", "scan")


@pytest.fixture(scope="module")
def page():
    spec = importlib.util.spec_from_file_location("docs_schemas", ROOT / "docs" / "schemas.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_what_the_quick_commands_write(page):
    text = page.PAGE.read_text()
    assert text.startswith(page.HEAD)
    for name, section in page.sections(QUICK).items():
        assert section.strip() in text, f"{name}: run python docs/schemas.py"


def test_every_command_and_every_schema_of_the_command_line_is_on_the_page(page):
    from stickslip.commands.cli import COMMANDS

    text = page.PAGE.read_text()
    assert {line[0] for lines in page.LINES.values() for line in lines} == set(COMMANDS)
    results = [ROOT / "scan" / "result.py", ROOT / "gap" / "answers" / "report.py"]
    sources = [*(ROOT / "stickslip" / "commands").glob("*.py"), *results]
    named = set(re.findall(r"\"(stickslip\.[a-z-]+/\d+)\"", " ".join(file.read_text() for file in sources)))
    kept = {"stickslip.scan-simulated/1", "stickslip.scan-costs/1"}  # of files in the scan's folder
    assert len(named) >= 8 and all(f"`{schema}`" in text for schema in named - kept)
    assert text.count("\n## ") == len(page.LINES)
