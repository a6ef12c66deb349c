"""A file that is piped in, ``-`` on the command line: kept as a file while the command runs."""

import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

NAME = "standard input"


@contextmanager
def with_standard_input(files: Sequence[Path]) -> Iterator[tuple[Path, ...]]:
    """Give the files, with what is piped in as a file in place of ``-``; messages name it ``standard input``.

    Raises ``ValueError`` where ``-`` stands twice, nothing is piped in, or more than is read at once.
    """
    from stickslip.logs.files.size import TEXT_MAX, check_text

    asked = [str(file) == "-" for file in files]
    if not any(asked):
        yield tuple(files)
        return
    if sum(asked) > 1:
        raise ValueError("- is given twice, but there is one standard input; give it once")
    if sys.stdin.isatty():
        raise ValueError("- reads what is piped in, and nothing is; name a file, or: command | stickslip check -")
    with tempfile.TemporaryDirectory() as folder:
        kept = Path(folder) / NAME
        content = sys.stdin.buffer.read(TEXT_MAX + 1)
        check_text(len(content))
        kept.write_bytes(content)
        try:
            yield tuple(kept if piped else file for file, piped in zip(files, asked, strict=True))
        except ValueError as fault:
            raise ValueError(str(fault).replace(f"{folder}/", "")) from fault
