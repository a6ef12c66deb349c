"""docs/evidence/tried.md: its examples run and print what it says; the files and options it names exist."""

import contextlib
import io
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "evidence" / "tried.md").read_text()


def test_examples_run_and_print_what_the_page_says():
    session: dict[str, object] = {}
    printed = []
    for code in re.findall(r"```python\n(.*?)```", PAGE, re.S):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(code, "docs/evidence/tried.md", "exec"), session)
        printed.append(out.getvalue().strip())
    stem, calls, coarse = printed
    assert f"`{stem}`" in PAGE and f"```\n{calls}\n```" in PAGE and f"`{coarse}`" in PAGE


def test_what_the_page_names_exists():
    for file in re.findall(r"`(tests/.*?\.py)`", PAGE):
        assert (ROOT / file).is_file(), file
    for option in re.findall(r"benchmarks\.torture (--\w+)", PAGE):
        assert f'"{option}"' in (ROOT / "benchmarks" / "torture" / "__main__.py").read_text()
