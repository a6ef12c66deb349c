"""The README's Python examples run, in order, in one session, and print what the text says."""

import contextlib
import io
import re
from pathlib import Path

README = (Path(__file__).resolve().parent.parent / "README.md").read_text()


def test_examples_run_and_print_what_the_text_says() -> None:
    session: dict[str, object] = {}
    printed = []
    for code in re.findall(r"```python\n(.*?)```", README, re.S):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(code, "README.md", "exec"), session)
        printed.append(out.getvalue().strip())
    assert printed[0] == "0.5154 22"  # snapshot, and stated in the text
    assert "`0.5154 22`" in README
    assert printed[2] == "(20, 601)"
    assert printed[3] == "True"
    assert printed[4] == "stiction 2.5"
    assert "`stiction 2.5`" in README
