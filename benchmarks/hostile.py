"""What the commands do with broken and hostile files: a clear error or a flagged result, and nothing else.

    python -m benchmarks.hostile [--quick] [--mutations N] [--seed N] [--json FILE]

Every file of ``benchmarks.hostile_files`` goes through ``check``, ``scan``, ``valve`` and ``gap``, then random changes
of good files of every form through ``check``.  Allowed memory and time are limited, so that a file that asks for more
is a finding.  tests/stickslip/test_hostile.py runs the listed files in continuous integration.
"""

import argparse
import contextlib
import csv
import io
import json
import os
import random
import re
import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator, Sequence
from html.parser import HTMLParser
from pathlib import Path

from click.testing import CliRunner, Result
from stickslip.logs.time_limit import time_limit

from benchmarks.hostile_binary import sheet_rows, workbook
from benchmarks.hostile_files import files, mutated
from benchmarks.hostile_rows import good_rows, table
from benchmarks.report import Figures, publish
from stickslip.commands.cli import cli

SECONDS = 30  # for one command on one file; the slowest takes 3 s on two quiet cores
MEMORY = 3_000_000_000  # bytes of address space beyond what the process has at the start
FORMULA = re.compile(r"\s*[=+@\t\r\uff1d\uff0b\uff0d\uff20-]")
NUMBER = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?")

# The smallest model, OP moves a valve and the valve PV: a diagnosis with it takes a third of a second. And a model
# that has no signal in common with any file.
MODEL = """
from stickslip.blocks import FirstOrder, IdealValve, Step
from stickslip.diagram import wire


def loop():
    return wire([Step("OP", after=1.0), IdealValve(), FirstOrder(K=1.0, tau=5.0)])


def other():
    return wire([Step("U1"), IdealValve(inputs=["U1"]), FirstOrder(K=1.0, tau=5.0, outputs=["U2"])])
"""

NOTES = {
    "hostile_files": "files made by rule",
    "hostile_runs": "commands run on them",
    "hostile_mutations": "good files changed at random",
    "hostile_faults": "runs with a traceback, hang, script, formula, or error without a remedy (required: at most 0)",
    "hostile_peak_mb": "largest memory of the process [MB] (required: at most 3000)",
    "hostile_slowest_s": "seconds of the slowest run (required: at most 30)",
}


class _Reading(HTMLParser):
    """Finds whatever in a page could run or ask the network."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Judge one element."""
        if tag in ("script", "iframe", "object", "embed", "link", "base", "img", "form"):
            self.found.append(f"<{tag}>")
        for name, value in attributes:
            far = name.split(":")[-1] in ("href", "src", "action", "data") and not (value or "").startswith("#")
            if name.startswith("on") or far or "javascript:" in (value or ""):
                self.found.append(f"{tag} {name}={value}")


def faults_of_page(text: str) -> list[str]:
    """What in an HTML page could run a script or ask the network."""
    reading = _Reading()
    reading.feed(text)
    return [f"the page holds {what}" for what in reading.found]


def faults_of_csv(text: str) -> list[str]:
    """Cells of a CSV file that a spreadsheet would run."""
    cells = (cell for row in csv.reader(io.StringIO(text)) for cell in row)
    return [
        f"the cell {cell[:40]!r} starts a formula"
        for cell in cells
        if FORMULA.match(cell) and not NUMBER.fullmatch(cell)
    ]


@contextlib.contextmanager
def limited(seconds: int = SECONDS, memory: int = MEMORY) -> Iterator[None]:
    """Give the block ``seconds`` [s] and ``memory`` [bytes] more than the process has; raise where it wants more."""
    with open("/proc/self/statm") as statm:
        size = int(statm.read().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (size + memory, hard))
    try:
        with time_limit(seconds, f"more than {seconds} s"):
            yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def run(*arguments: str) -> Result:
    """One command in this process, under limits."""
    with limited(), warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        return CliRunner().invoke(cli, list(arguments))


def faults(result: Result, written: Sequence[Path]) -> list[str]:
    """What is wrong with how a command ended: exit code, message, and the files that it has written or left."""
    found = []
    said = result.output
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        found.append(f"raised {type(result.exception).__name__}: {result.exception}")
    if result.exit_code not in (0, 1, 2):
        found.append(f"exit code {result.exit_code}")
    if "Traceback" in said or "defect of stickslip" in said or "Warning:" in said:
        found.append("blames itself or shows a traceback")
    if "\x1b" in said or "\x07" in said:
        found.append("sends control signs to the terminal")
    if result.exit_code == 2:
        if not re.search(r"Error: .+[;,(] .+", said, re.DOTALL):
            found.append("the error names no remedy")
        if len(result.stderr) > 2000:
            found.append(f"an error of {len(result.stderr)} characters")
        found += [f"left {path.name} behind" for path in written if path.exists()]
        return [*found, *([said.strip()[:300]] if found else [])]
    for path in written:
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".html":
            found += faults_of_page(text)
        elif path.suffix == ".csv":
            found += faults_of_csv(text)
        else:
            json.loads(text)
    return found


def commands(file: Path, out: Path, pages: bool, model: str = "loop") -> Iterator[tuple[list[str], list[Path]]]:
    """Command lines on one file, each with what it writes into ``out``; ``model`` is a function of ``MODEL``."""
    program = out / "model.py"
    program.write_text(MODEL)
    page = [out / "page.html"] if pages else []
    html = ["--html", str(page[0])] if pages else []
    yield ["check", str(file), "--json", str(out / "check.json"), *html], [out / "check.json", *page]
    yield ["valve", str(file), "--json", str(out / "valve.json"), *html], [out / "valve.json", *page]
    yield ["gap", str(file), "--model", f"{program}:{model}", "--json", str(out / "gap.json")], [out / "gap.json"]
    listed = out / "scan.csv"
    yield (
        ["scan", str(file), "--out", str(out / "scan"), "--fresh", "--workers", "1", "--csv", str(listed), *html],
        [listed, *page],
    )


def tried(
    file: Path, out: Path, pages: bool, only: Sequence[str] = (), model: str = "loop"
) -> Iterator[tuple[str, float, list[str]]]:
    """Command, seconds and faults of each command on one file."""
    for line, written in commands(file, out, pages, model):
        if only and line[0] not in only:
            continue
        for path in written:
            path.unlink(missing_ok=True)
        begin = time.perf_counter()
        found = faults(run(*line), written)
        yield line[0], time.perf_counter() - begin, found


def good_files() -> dict[str, bytes]:
    """One good file of every form, to be changed at random."""
    import gzip

    import polars as pl

    rows = good_rows(60)
    columns = {"time": range(60), "PV": [float(pv) for _, pv, _ in rows], "OP": [float(op) for _, _, op in rows]}
    parquet = io.BytesIO()
    pl.DataFrame(columns).write_parquet(parquet)
    text = table(rows=rows).encode()
    stamped = table(
        ("Datum", "FIC1.PV [m3/h]", "FIC1.OP"),
        [(f"06.05.2024 07:{i:02d}:00", pv.replace(".", ","), op) for i, (_, pv, op) in enumerate(rows)],
        ";",
    )
    long = "tag,time,value,quality\n" + "".join(f"FIC1.PV,{t},{pv},Good\nFIC1.OP,{t},{op},Good\n" for t, pv, op in rows)
    return {
        "csv": text, "txt": stamped.encode(), "tsv": long.encode(), "dat": stamped.encode("utf-16"),
        "csv.gz": gzip.compress(text, mtime=0), "parquet": parquet.getvalue(),
        "xlsx": workbook(sheet_rows([("time", "PV", "OP"), *rows])),
    }  # fmt: skip


def main() -> None:
    """Run everything and print the figures and the faults."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="no gap, no pages, 50 mutations")
    parser.add_argument("--mutations", type=int, default=2000, help="how many good files are changed (default 2,000)")
    parser.add_argument("--seed", type=int, default=1, help="of the random changes (default 1)")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    asked = parser.parse_args()
    only = ("check", "scan", "valve") if asked.quick else ()
    count, runs, slowest, all_faults = 0, 0, 0.0, 0
    with tempfile.TemporaryDirectory() as temporary:
        folder, out = Path(temporary) / "in", Path(temporary) / "out"
        folder.mkdir()
        out.mkdir()
        os.chdir(out)

        def every() -> Iterator[tuple[str, Path, bool, Sequence[str]]]:
            for hostile in files():
                yield hostile.what, _written(folder / hostile.name, hostile.content), not asked.quick, only
            good, draw = good_files(), random.Random(asked.seed)
            for number in range(50 if asked.quick else asked.mutations):
                ending = draw.choice(list(good))
                seed = draw.randrange(2**31)
                file = _written(folder / f"m{number}.{ending}", mutated(good[ending], seed))
                yield f"mutation {seed} of {ending}", file, False, ("check",)

        for what, file, pages, these in every():
            count += not what.startswith("mutation")
            for command, seconds, found in tried(file, out, pages, these):
                runs, slowest, all_faults = runs + 1, max(slowest, seconds), all_faults + bool(found)
                for fault in found:
                    print(f"{what}: {command}: {fault}", file=sys.stderr)
                if seconds > 0.3 * SECONDS:
                    print(f"{what}: {command}: {seconds:.1f} s", file=sys.stderr)
            file.unlink()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    figures: Figures = {
        "hostile_files": count, "hostile_runs": runs, "hostile_mutations": 50 if asked.quick else asked.mutations,
        "hostile_faults": all_faults, "hostile_peak_mb": peak, "hostile_slowest_s": slowest,
    }  # fmt: skip
    sys.exit(0 if publish(figures, NOTES, asked.json, asked.quick) else 1)


def _written(path: Path, content: bytes) -> Path:
    path.write_bytes(content)
    return path


if __name__ == "__main__":
    main()
