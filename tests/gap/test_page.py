"""The page of effects is that of the catalogue, and its example prints what it says."""

import re
from pathlib import Path

from stickslip.gap.effects import CATALOGUE
from stickslip.gap.page import page

ROOT = Path(__file__).resolve().parents[2]


def test_every_effect_has_a_row_with_its_file():
    rows = dict(re.findall(r"^\| \[(\w+)\]\(\.\./(.*?)\)", page(), re.M))
    assert list(rows) == [one.name for one in CATALOGUE]
    for name, file in rows.items():
        assert f'name = "{name}"' in (ROOT / file).read_text()


def test_the_example_prints_what_the_page_says(capsys):
    (code,) = re.findall(r"```python\n(.*?)```", page(), re.S)
    exec(compile(code, "effects", "exec"), {})
    assert capsys.readouterr().out.strip() in page()
