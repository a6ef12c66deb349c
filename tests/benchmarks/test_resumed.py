"""Rows of a benchmark that goes on where it was stopped."""

from dataclasses import dataclass
from pathlib import Path

from benchmarks.resumed import resumed


@dataclass(frozen=True)
class Named:
    """A run that has nothing but a name."""

    key: str


def test_who_reads_a_file_of_rows_sees_whole_ones(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"

    def made(run: Named) -> dict[str, str]:
        return {"key": run.key}

    list(resumed([Named("a")], made, file, 1.0))
    with file.open() as reader:
        list(resumed([Named("a"), Named("b")], made, file, 1.0))
        assert reader.read() == '{"key": "a"}\n'  # the file that it opened; the longer one has taken its place
    assert file.read_text() == '{"key": "a"}\n{"key": "b"}\n'
