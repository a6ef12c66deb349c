"""docs/linearise.md: its examples run and print what it says, its pictures exist."""

import contextlib
import io
import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "linearise.md").read_text()


def test_examples_run_and_print_what_the_page_says():
    session: dict[str, object] = {}
    printed = []
    for code in re.findall(r"```python\n(.*?)```", PAGE, re.S):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(code, "docs/linearise.md", "exec"), session)
        printed.append(out.getvalue().strip())
    assert len(printed) == 6
    rest, refusal, poles, loop, array, _ = printed
    assert f"`{rest}`" in PAGE and f"`{loop}`" in PAGE
    assert f"```\n{poles}\n```" in PAGE and f"```\n{array}\n```" in PAGE
    assert "LCS11 misses its set point by -15.2 with OP = 1 at its limit" in refusal


def test_pictures_exist():
    for picture in re.findall(r"!\[.*?\]\((.*?)\)", PAGE):
        assert (DOCS / picture).is_file(), picture
