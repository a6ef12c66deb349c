"""All methods side by side: what each says of every loop, with its number, its reason and its time."""

import csv
import io
import os
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, TypeAlias, runtime_checkable

from stickslip.detect.diagnosis import ask
from stickslip.detect.judge.over_days import answer_over_days
from stickslip.detect.method import Method
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.verdict import Figure, Verdict
from stickslip.detect.words import WORDS, Word
from stickslip.logs import LogError, LoopRecord, ReadError, read_loops
from stickslip.logs.files.frames import frame_kind
from stickslip.logs.hint import nearest
from stickslip.logs.processes import one_thread
from stickslip.logs.shown import Shown
from stickslip.logs.tags import Process

SCHEMA = "stickslip.table/1"
COLUMNS = ("loop", "method", "on trial", "verdict", "index", "threshold", "amount [% OP]", "time [ms]", "reason")
FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")  # the last four are the wide forms of the first
ENDINGS = (".csv", ".txt", ".tsv", ".parquet")


@runtime_checkable
class HasLoops(Protocol):
    """A log, a case, or whatever else gives its loops when asked."""

    def loop_records(self) -> Sequence[LoopRecord]:
        """Every loop."""
        ...


Source: TypeAlias = LoopRecord | Prepared | HasLoops | str | os.PathLike[str]


@dataclass(frozen=True, eq=False)
class Judged:
    """One loop before all methods.

    combined : as in ``Verdict``; the verdict of ``diagnose`` on the loop, whichever methods stand beside it
    verdicts : tuple of Verdict, in the order of the methods
    milliseconds : wall time of each method on the prepared record [ms]
    preparation : wall time of what the methods share: facts, oscillation, even grid, waves, half waves [ms]
    """

    loop: str
    combined: Word
    verdicts: tuple[Verdict, ...]
    milliseconds: tuple[float, ...]
    preparation: float
    samples: int

    def rows(self) -> list[list[str]]:
        """One row of text a method, as in ``COLUMNS``."""
        return [
            [
                self.loop,
                v.method,
                "yes" if v.experimental else "no",
                WORDS[v.verdict].spoken,
                _number(v.index),
                _number(v.threshold),
                _number(v.amount_percent_op),
                f"{spent:.1f}",
                v.reason,
            ]
            for v, spent in zip(self.verdicts, self.milliseconds, strict=True)
        ]


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Shown):
    """The result of ``compare``.

    skipped : tuple of (file, reason); files of a folder that hold no loop
    """

    loops: tuple[Judged, ...]
    skipped: tuple[tuple[str, str], ...] = ()

    @property
    def headline(self) -> str:
        """The result in one line."""
        verdicts = ", ".join(f"{judged.loop} {WORDS[judged.combined].spoken}" for judged in self.loops)
        methods = max((len(judged.verdicts) for judged in self.loops), default=0)
        return f"{methods} methods on {len(self.loops)} loop{'s' * (len(self.loops) != 1)}: {verdicts}"

    def rows(self) -> list[list[str]]:
        """One row of text a loop and method, as in ``COLUMNS``."""
        return [row for judged in self.loops for row in judged.rows()]

    def to_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold, schema "stickslip.table/1"."""
        return {
            "schema": SCHEMA,
            "loops": [
                {
                    "loop": judged.loop,
                    "combined": judged.combined,
                    "samples": judged.samples,
                    "preparation_ms": judged.preparation,
                    "methods": [
                        v.to_dict() | {"milliseconds": spent}
                        for v, spent in zip(judged.verdicts, judged.milliseconds, strict=True)
                    ],
                }
                for judged in self.loops
            ],
            "skipped": [{"file": file, "reason": reason} for file, reason in self.skipped],
        }

    def csv(self) -> str:
        """The rows as CSV; a text that a spreadsheet would run as a formula gets an apostrophe in front."""
        return csv_text(COLUMNS, self.rows())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write ``csv()`` to a file, in UTF-8."""
        Path(path).write_text(self.csv(), encoding="utf-8")

    def plot(self) -> Figure:
        """The verdict of every method on every loop, with the time that the method took."""
        from stickslip.detect.figures.comparison import plot_comparison

        return plot_comparison(self)


@one_thread
def compare(
    source: Source | Iterable[Source],
    methods: Sequence[Method] | None = None,
    process: Process | None = None,
    loops: Sequence[str] | None = None,
) -> Comparison:
    """Put every method to one loop or to many.

    Parameters: ``source`` a record or a prepared one; anything with ``loop_records()``, as a log and a case of
    ``cases`` have; a file or a data frame (pandas, polars, pyarrow) with one loop or several; a folder, whose CSV, text
    and Parquet files are read; or several of these. ``methods`` as for ``diagnose``; ``process`` the kind
    of process behind loops that are read from files and frames; ``loops`` the tags of those to take, by default all.

    Raises ReadError for a file that cannot be read, a folder without any loop and a tag that no loop has, TypeError for
    what is none of these or no method. A file of a folder that cannot be read is skipped and listed.

    >>> import numpy as np
    >>> from stickslip.detect.methods import area_ratio
    >>> t = np.arange(1000.0)
    >>> loop = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t, name="FIC211")
    >>> [row[:4] for row in compare(loop, [area_ratio]).rows()]
    [['FIC211', 'area_ratio', 'no', 'inconclusive']]
    """
    if methods is None:
        from stickslip.detect import METHODS

        methods = METHODS
    records, skipped = _records(source, process)
    if loops is not None:
        records = _named(records, loops)
    for module in ("optimize", "special"):  # loaded here, or the first method would be charged with it
        import_module(f"scipy.{module}")

    return Comparison(tuple(_judged(record, methods) for record in records), skipped)


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Rows of text as CSV, each cell ``harmless``."""
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow(columns)
    writer.writerows([harmless(cell) for cell in row] for row in rows)
    return out.getvalue()


def harmless(cell: str) -> str:
    """A cell that no spreadsheet takes for a formula.

    >>> harmless("=1+1"), harmless("-0.5"), harmless("FIC1")
    ("'=1+1", '-0.5', 'FIC1')
    """
    if not cell.lstrip().startswith(FORMULA) and not cell.startswith(("\t", "\r", "\n")):
        return cell
    try:
        float(cell)
    except ValueError:
        return cell if cell == "-" else f"'{cell}"
    return cell


def _judged(record: LoopRecord | Prepared, methods: Sequence[Method]) -> Judged:
    began = time.perf_counter()
    loop = Prepared(record) if isinstance(record, LoopRecord) else record
    _prepare(loop)
    preparation = 1e3 * (time.perf_counter() - began)
    verdicts, spent = [], []
    for method in methods:
        began = time.perf_counter()
        verdicts.append(ask(method, loop))
        spent.append(1e3 * (time.perf_counter() - began))
    name = loop.record.name or "loop"
    word = answer_over_days(loop).word
    return Judged(name, word, tuple(verdicts), tuple(spent), preparation, len(loop.record))


def _prepare(loop: Prepared) -> None:
    """Work out what methods share, so that none of them is charged with it."""
    _ = loop.facts, loop.gate, loop.cycles, loop.whole
    if len(loop.stretch):
        for name in ("OP", "PV"):
            loop.half_waves(name)


def _records(source: Any, process: Process | None) -> tuple[list[LoopRecord | Prepared], tuple[tuple[str, str], ...]]:
    if isinstance(source, LoopRecord | Prepared):
        return [source], ()
    if frame_kind(source):
        return list(read_loops(source, process=process)), ()
    if isinstance(source, HasLoops):
        return list(source.loop_records()), ()
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        return _folder(path, process) if path.is_dir() else (list(read_loops(path, process=process)), ())
    if not isinstance(source, Iterable):
        raise TypeError(
            f"{type(source).__name__} is no loop; give a LoopRecord, a log, a case, a file, a folder or a list of these"
        )
    parts = [_records(part, process) for part in source]
    if not parts:
        raise ReadError("no loop is given; give at least one")
    return [record for found, _ in parts for record in found], tuple(entry for _, more in parts for entry in more)


def _named(records: list[LoopRecord | Prepared], loops: Sequence[str]) -> list[LoopRecord | Prepared]:
    """The records of these tags; the loop of a case with several is called by case and tag, and found by its tag."""
    names = [(loop if isinstance(loop, LoopRecord) else loop.record).name for loop in records]
    chosen = []
    for tag in loops:
        fitting = [k for k, name in enumerate(names) if name == tag or name.endswith(f" {tag}")]
        if not fitting:
            raise ReadError(f"no loop {tag!r}; {nearest(tag, names)}")
        chosen += fitting
    return [records[k] for k in dict.fromkeys(chosen)]


def _folder(folder: Path, process: Process | None) -> tuple[list[LoopRecord | Prepared], tuple[tuple[str, str], ...]]:
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in ENDINGS and path.is_file())
    records: list[LoopRecord | Prepared] = []
    skipped: list[tuple[str, str]] = []
    for path in files:
        try:
            records += read_loops(path, process=process)
        except (ReadError, LogError) as fault:
            skipped.append((path.name, str(fault).removeprefix(f"{path}: ")))
    if not records:
        why = f": {skipped[0][0]}: {skipped[0][1]}" if skipped else f"; its files must end in {', '.join(ENDINGS)}"
        raise ReadError(f"{folder} holds no loop that can be read{why}")
    return records, tuple(skipped)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
