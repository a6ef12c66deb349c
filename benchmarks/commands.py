"""What commands cost the processor, byte code and lists kept as usual: each figure is the least of several processes.

    python -m benchmarks.commands [--quick] [--json FILE]         exit code 1 if a requirement is missed

Seconds of the processor, of the process and of all that it starts, because other work on the machine disturbs them less
than wall time.  The record that ``check`` judges is a simulated loop whose valve sticks: 7,200 rows of CSV.
"""

import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from benchmarks.report import Figures, options, publish

SEED = 91_003  # of the record; nothing is fitted to it
ROWS = 7_200
COMMANDS = {"help": ("--help",), "blocks": ("blocks",), "cases": ("simulate", "--list"), "check": ("check",)}

NOTES = {
    "help_processor_s": "stickslip --help [s] (required: at most 0.3)",
    "blocks_processor_s": "stickslip blocks, its list kept [s] (required: at most 0.4)",
    "cases_processor_s": "stickslip simulate --list, its list kept [s] (required: at most 0.4)",
    "check_processor_s": "stickslip check of a loop of 7,200 rows, all compiled before [s] (required: at most 1.5)",
}


def main() -> None:
    """Measure the commands and print their figures."""
    chosen = options(__doc__.splitlines()[0])
    repeats = 2 if chosen.quick else 9
    figures: Figures = {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "loop.csv"
        write_record(file)
        for name, words in COMMANDS.items():
            given = [*words, str(file)] if name == "check" else [*words]
            processor_seconds(given)  # compiles and keeps
            figures[f"{name}_processor_s"] = min(processor_seconds(given) for _ in range(repeats))
    raise SystemExit(0 if publish(figures, NOTES, chosen.json, chosen.quick) else 1)


def write_record(file: Path) -> None:
    """Write the loop that is judged."""
    from stickslip.calibration import simulate
    from stickslip.calibration.drawing import one

    spec = replace(one("cycling", (SEED, 0, 1), "other_physics"), samples=ROWS)
    ((record, _),) = simulate([spec])
    record.log.to_csv(file)


def processor_seconds(words: list[str]) -> float:
    """Return the processor time of one command [s], user and system.

    Raises ``RuntimeError`` for one that fails; that stiction is found is no failure.
    """
    env = {**os.environ}
    env.pop("PYTHONDONTWRITEBYTECODE", None)
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, "-m", "stickslip", *words], capture_output=True, env=env, check=False)
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"stickslip {' '.join(words)} failed: {done.stderr.decode()}")
    return end.ru_utime - begin.ru_utime + end.ru_stime - begin.ru_stime


if __name__ == "__main__":
    main()
