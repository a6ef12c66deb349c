"""The ten systems of ``docs/examples.md``, beside python-control and PathSim: numbers compared, time ratios.

    python -m benchmarks.examples [--quick] [--json FILE]

The code is that of the page.  Timed is its last run, with all that ``stickslip.diagram.simulation`` does, once the
functions are compiled; peers build and run their system once.  Both work at rtol 1e-8.
"""

import ast
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.report import Figures, median_seconds, options, publish

PAGE = Path(__file__).resolve().parents[1] / "docs" / "examples.md"
QUICK = ("Steering, linearised", "Hares and lynxes", "A bouncing ball")
NOTES = {
    "in_python_us_per_call": "a function that cannot be compiled, with the call [us]",
    "in_python_over_compiled": "the same run, its rates called in Python, over the compiled one",
    "control_over_in_python": "python-control over the run with its rates called in Python",
}
Peers = dict[str, tuple[str, Callable[[Any], Any]]]


def sections() -> dict[str, str]:
    """Return heading -> code of the page."""
    found = {}
    for section in re.split(r"^## ", PAGE.read_text(), flags=re.M)[1:]:
        if code := re.search(r"```python\n(.*?)```", section, re.S):
            found[section.splitlines()[0]] = code[1]
    return found


def last_run(code: str) -> str | None:
    """Return the statement of an example that makes ``run``."""
    for node in reversed(ast.parse(code).body):
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "run":
            return ast.unparse(node)
    return None


def peers() -> dict[str, Peers]:
    """Return the peers that are installed."""
    from benchmarks.peers import examples_control

    found: dict[str, Peers] = {"control": examples_control.PEERS}
    try:
        from benchmarks.peers import examples_pathsim
    except ImportError as reason:
        print(f"PathSim is SKIPPED: {reason}; install the extra 'bench'", file=sys.stderr)
    else:
        found["pathsim"] = examples_pathsim.PEERS
    return found


def short(heading: str) -> str:
    """Return a heading as the beginning of a figure's name."""
    return re.sub(r"\W+", "_", heading.lower().replace("'", ""))


def compare(quick: bool, repeats: int = 9) -> Figures:
    """Return for every example and peer the largest difference and how many times longer the peer takes."""
    session: dict[str, Any] = {"print": lambda *_: None}
    figures: Figures = {}
    others = peers()
    for heading, code in sections().items():
        exec(compile(code, PAGE.name, "exec"), session)
        again = last_run(code)
        if again is None or (quick and heading not in QUICK):
            continue
        statement = compile(again, PAGE.name, "exec")
        log = session["run"].log
        ours = median_seconds(lambda statement=statement: exec(statement, session), repeats)
        figures[f"{short(heading)}_ms"] = 1e3 * ours
        for peer, examples in others.items():
            if heading in examples:
                signal, solve = examples[heading]
                begin = time.perf_counter()
                theirs = solve(np.array(log.t))
                seconds = time.perf_counter() - begin
                figures[f"{short(heading)}_{peer}_difference"] = float(np.max(np.abs(theirs - log[signal])))
                figures[f"{short(heading)}_{peer}_over_ours"] = seconds / ours
    return figures


def called_in_python(repeats: int = 9) -> Figures:
    """Return what it costs if the functions of an example cannot be compiled."""
    from stickslip.blocks import Equations
    from stickslip.diagram import simulate, wire

    from benchmarks.peers.examples_control import hares

    def rate(H, L):
        eaten = 3.2 * H * L / (50.0 + H)
        return 1.6 * H * (1.0 - H / 125.0) - eaten, 0.6 * eaten - 0.56 * L

    def rate_with_words(H, L):
        return {"rate": rate(H, L), 0: "mixed keys do not compile"}["rate"]

    taken = {}
    for name, der in (("compiled", rate), ("python", rate_with_words)):
        loop = wire([Equations(name, states={"H": 20.0, "L": 30.0}, der=der)], outputs=["H"])
        taken[name] = median_seconds(lambda loop=loop: simulate(loop, 70.0, every=0.1, rtol=1e-8), repeats)
    run = simulate(loop, 70.0, every=0.1, rtol=1e-8)
    control = median_seconds(lambda: hares(np.array(run.log.t)), 2)
    return {
        "in_python_us_per_call": 1e6 * (taken["python"] - taken["compiled"]) / run.in_python[0].calls,
        "in_python_over_compiled": taken["python"] / taken["compiled"],
        "control_over_in_python": control / taken["python"],
    }


def main() -> None:
    """Compare everything and print it."""
    chosen = options(__doc__.splitlines()[0])
    publish(compare(chosen.quick) | called_in_python(), NOTES, chosen.json)


if __name__ == "__main__":
    main()
