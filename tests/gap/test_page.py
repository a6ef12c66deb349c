"""The page of effects is that of the catalogue."""

from pathlib import Path

from stickslip.gap.page import page


def test_the_page_is_up_to_date():
    written = (Path(__file__).parents[2] / "docs" / "effects.md").read_text()
    assert written == page(), "python -m stickslip.gap.page > docs/effects.md"
