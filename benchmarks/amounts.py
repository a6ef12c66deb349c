"""Stated amounts against true ones: every method that gives S or J, on loops whose valve is known.

    python -m benchmarks.amounts [--write] [--quick] [--json FILE]

The stems of four blocks in four places: OP as a triangle in open loop, a PI on a flow and on a lag, a PI on a level.
``StickSlip`` in every size without noise and with little, the three sampled valves in two sizes without noise.
An amount counts where the method calls stiction, because only then it states one.  ``--write`` makes the tables of
``docs/evidence/amounts.md`` again, which ``tests/benchmarks/test_amounts.py`` holds to what is measured.
"""

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from stickslip.blocks import PI, ChoudhuryValve, FirstOrder, HeValve, Integrator, KanoValve, Step, StickSlip, Triangle
from stickslip.blocks.block import Block
from stickslip.detect.judge.answer import answer
from stickslip.detect.methods import (
    bicoherence,
    change_no_change,
    dead_travel,
    hagglund2011,
    hammerstein,
    high_passed_pv,
    parallelogram,
    play_fit,
    qualitative_movements,
    segmentation,
    shifted_pv,
    stem_play,
    window_tests,
)
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.verdict import Verdict
from stickslip.diagram import simulate, wire
from stickslip.logs import LoopRecord

from benchmarks.report import Figures, options, publish

PAGE = Path(__file__).parents[1] / "docs" / "evidence" / "amounts.md"
SIZES = ((4.0, 0.0), (4.0, 1.0), (4.0, 2.0), (4.0, 4.0), (2.0, 1.0), (8.0, 4.0))  # S, J [% of OP]
NOISE = 0.02  # [% of span], on PV and on the stem
PLACES = {"ramp": "OP up and down", "flow": "flow loop", "lag": "slow loop", "level": "level"}
CONTROLLERS = {"flow": (0.3, 4.0, 2.0), "lag": (0.5, 10.0, 10.0), "level": (1.2, 120.0, 50.0)}  # K_p, T_i, tau or T
SECONDS, SETTLED = 3000, 600
STEMS = (stem_play, parallelogram, change_no_change, qualitative_movements, window_tests)
OTHERS = (play_fit, dead_travel, hammerstein, bicoherence, segmentation, hagglund2011, high_passed_pv, shifted_pv)
GIVE_J = ("stem_play", "qualitative_movements", "hammerstein")


class Case(NamedTuple):
    """One valve in one place: name of its block, S and J [% of OP], standard deviation of the noise [% of span]."""

    place: str
    valve: str
    S: float
    J: float
    noise: float


class Stated(NamedTuple):
    """What a method stated of a case: S and J [% of OP], None where it gives none."""

    case: Case
    method: str
    S: float | None
    J: float | None


def cases(place: str) -> Iterator[Case]:
    """Every valve in a place."""
    for noise in (0.0, NOISE):
        yield from (Case(place, "StickSlip", S, J, noise) for S, J in SIZES)
    for valve in ("Kano", "Choudhury", "He"):
        yield from (Case(place, valve, S, J, 0.0) for S, J in SIZES[2:4])


def _valve(case: Case, middle: float) -> Block:
    S, J, start = case.S / 100.0, case.J / 100.0, middle
    limits = {"low": middle - 0.5, "high": middle + 0.5}
    if case.valve == "StickSlip":
        return StickSlip.from_bands(S, J, start=start, **limits)
    if case.valve == "He":
        return HeValve.from_bands(S, J, 1.0, start=start, **limits)
    return {"Kano": KanoValve, "Choudhury": ChoudhuryValve}[case.valve](S, J, 1.0, start=start, **limits)


def record(case: Case, stem: bool) -> LoopRecord:
    """The loop as it is logged once a second, with its stem or without, in % of span."""
    level = case.place == "level"
    middle = 0.0 if level else 0.5
    if case.place == "ramp":
        feed: list[Block] = [Triangle("OP", mean=0.5, amplitude=max(0.06, 0.01 * case.S), period=200.0)]
        tau = 3.0
    else:
        K_p, T_i, tau = CONTROLLERS[case.place]
        feed = [Step("SP", middle + 0.013), PI(K_p, T_i, start_op=middle, low=middle - 0.5, high=middle + 0.5)]
    process = Integrator(K=1.0, T=tau) if level else FirstOrder(K=1.0, tau=tau, start=0.5)
    log = simulate(wire([*feed, _valve(case, middle), process]), float(SECONDS), every=1.0).log
    rng = np.random.default_rng(0)
    pv, mv, op = (100.0 * log[name][SETTLED:] for name in ("PV", "MV", "OP"))
    pv, mv = (x + case.noise * rng.normal(size=len(x)) for x in (pv, mv))
    sp = np.full(len(pv), 50.0 if case.place == "ramp" else 100.0 * middle + 1.3)
    return LoopRecord.from_arrays(
        np.arange(float(len(pv))), pv=pv, op=op, sp=sp, mv=mv if stem else None, name="LIC1" if level else "FIC1",
        op_span=(100.0 * (middle - 0.5), 100.0 * (middle + 0.5)), process="integrating" if level else "self_regulating",
    )  # fmt: skip


def stated(case: Case) -> list[Stated]:
    """What every method states of a case; those that read the stem are asked with it and without."""
    logged, bare = (Prepared(record(case, stem)) for stem in (True, False))
    found = [_of(case, f"{method.CARD.name}, stem logged", method.detect(logged)) for method in STEMS]
    found += [_of(case, f"{method.CARD.name}, PV alone", method.detect(bare)) for method in STEMS[1:]]
    for method in OTHERS:
        known: tuple[Any, ...] = ()
        if method is hagglund2011 and case.place in ("flow", "lag"):
            K_p, T_i, _ = CONTROLLERS[case.place]
            known = (hagglund2011.Params(K=K_p, T_i=T_i, K_p=1.0),)
        found.append(_of(case, method.CARD.name, method.detect(bare, *known)))
    said = answer(bare)
    sizes = (None if size is None else size.value for size in (said.S, said.J))
    return [*found, Stated(case, "verdict of check, PV alone", *sizes)]


def _of(case: Case, row: str, v: Verdict) -> Stated:
    J = v.evidence.get("J") if v.amount_percent_op is not None and v.method in GIVE_J else None
    return Stated(case, row, v.amount_percent_op, None if J is None else float(np.asarray(J)))


@cache
def measured(place: str) -> tuple[Stated, ...]:
    """What is stated of every valve in a place."""
    return tuple(one for case in cases(place) for one in stated(case))


def _cell(found: Sequence[Stated], size: str) -> str:
    """Least to largest stated size over the true one [%], and in how many of the cases it was stated."""
    asked = [one for one in found if getattr(one.case, size) > 0.0]
    shares = [100.0 * getattr(one, size) / getattr(one.case, size) for one in asked if getattr(one, size) is not None]
    if not shares:
        return f"none of {len(asked)}"
    low, high = round(min(shares)), round(max(shares))
    return f"{low} to {high} % ({len(shares)} of {len(asked)})"


def column(place: str) -> dict[str, dict[str, str]]:
    """The cells of a place: for S and J, by the name of the row."""
    found = measured(place)
    rows = dict.fromkeys(one.method for one in found)
    of = {row: [one for one in found if one.method == row] for row in rows}
    return {
        size: {row: _cell(of[row], size) for row in rows if size == "S" or row.startswith((*GIVE_J, "verdict"))}
        for size in ("S", "J")
    }


def tables(columns: Mapping[str, Mapping[str, Mapping[str, str]]]) -> dict[str, str]:
    """The tables of the page, in Markdown."""
    written = {}
    for size in ("S", "J"):
        lines = [f"| method | {' | '.join(PLACES[place] for place in columns)} |", "|" + "---|" * (len(columns) + 1)]
        for row in next(iter(columns.values()))[size]:
            lines.append(f"| {row} | {' | '.join(of[size][row] for of in columns.values())} |")
        written[size] = "\n".join(lines)
    return written


def main() -> None:
    """Measure, print, and write the page where asked."""
    write = "--write" in sys.argv
    sys.argv = [arg for arg in sys.argv if arg != "--write"]
    chosen = options(__doc__ or "")
    places = ("flow",) if chosen.quick else tuple(PLACES)
    columns = {place: column(place) for place in places}
    figures: Figures = {}
    for place, of in columns.items():
        for size, rows in of.items():
            figures |= {f"{size} {place} {row}": cell for row, cell in rows.items()}
    publish(figures, {}, chosen.json, chosen.quick)
    if write and not chosen.quick:
        page = PAGE.read_text()
        for size, table in tables(columns).items():
            begin = f"<!-- {size} -->\n"
            page = re.sub(f"{begin}.*?<!-- end -->", f"{begin}{table}\n<!-- end -->", page, flags=re.S)
        PAGE.write_text(page)


if __name__ == "__main__":
    main()
