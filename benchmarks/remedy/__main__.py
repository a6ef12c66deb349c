"""Fits and remedies on hidden plants: ``python -m benchmarks.remedy [--apart | --shaken] [--loops N] [--first SEED]``.

The plants are those of ``benchmarks.remedy.plants``, or of ``benchmarks.remedy.apart``: their stems, processes and
loads are not the fit's, and their simulation (``benchmarks.remedy.running``) shares nothing with it.  The fit sees OP,
PV and SP alone.  Every remedy of the advice is then tried on the hidden plant under the load that the record had, and
so is doing nothing.  Seeds 0 to 19 served to make the fit, and 0 to 59 apart; what is measured stands on others.

S, J, K, K J     error of the value over the truth, and how often the 90 % interval holds the truth
lags             sum of all lags and dead time, in the same way
controller       K_p and T_i as read
sd predicted     of SP - PV with each remedy, over what the hidden plant gives, where neither runs away
regret           true score of what is recommended until the shutdown, or of none, over that of the truly best, less 1
                 best: up to 5 %;  bold: of the least score foretold, sure or not;  known: the same, where the fit has
                 the true valve and process, by He's law of stick or Chen's;  near tie: the next best is within 3 %
harm             recommended, and swings more than none on the hidden plant
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.remedy import Advice, FitError, fit, remedies
from stickslip.remedy.advice import TRAVEL, score
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.process import Loop, beside, predicted, start_noise
from stickslip.remedy.size import size_of, widened
from stickslip.remedy.trial import NOTHING, outcomes

from benchmarks.remedy import apart
from benchmarks.remedy.plants import LAWS, Plant
from benchmarks.remedy.rows import appended, kept

KEYS = ("S", "J", "K", "KJ", "lags")
BEST, TIE = 0.05, 0.03  # regret


def row(plant: Plant) -> dict[str, Any]:
    """What a loop showed."""
    began = time.process_time()
    found: dict[str, Any] = {"seed": plant.seed, "law": plant.law, "integrating": plant.integrating}
    try:
        one = fit(plant.record())
    except FitError as fault:
        return found | {"refused": str(fault)}
    took = time.process_time()
    found |= {"fit_s": took - began, "sticks": one.sticks, "gain": one.gain, "kind": one.best.integrating}
    if not one.sticks or plant.law == "sound":
        return found
    if one.best.integrating == plant.integrating:
        found |= _sizes(plant, one)
    try:
        advice = remedies(one)
    except FitError as fault:
        return found | {"untried": str(fault)}
    return found | {"remedy_s": time.process_time() - took} | _judged(plant, advice)


def _sizes(plant: Plant, one: LoopFit) -> dict[str, Any]:
    lags = size_of(np.array([own.tau_2 + own.theta + (0.0 if own.integrating else own.tau) for own in one.loops]))
    sizes = {"S": one.S, "J": one.J, "K": one.K, "KJ": one.KJ, "lags": lags}
    return {key: [size.value, size.low, size.high, plant.truth[key]] for key, size in sizes.items()} | {
        "middle": {key: float(np.median([getattr(own, key) for own in one.loops])) for key in ("S", "J", "K")},
        "each": {
            key: [float(getattr(own, key)) for own in one.loops] for key in ("S", "J", "K", "tau", "tau_2", "theta")
        },
        "free": one.free_error,
        "step": one.one_step_error,
        "follows": one.best.follows,
    }


def _judged(plant: Plant, advice: Advice) -> dict[str, Any]:
    sd, rms, travel = plant.measured_as_it_is
    true = {}
    for one in advice.tried:
        own = plant.measured(one.outcome.setting)
        true[one.name] = (own[0], own[1] / rms + TRAVEL * own[2] / travel, own[1])
    true_sd = [*(true[one.name][0] for one in advice.tried), sd]
    ratios = [
        [*(float(x) for x in np.percentile(widened(one.outcome.pv_sd), [50.0, 5.0, 95.0], method="nearest")), own]
        for one, own in zip((*advice.tried, advice.none), true_sd, strict=True)
    ]
    now = {name: value for name, value in true.items() if not advice[name].at_shutdown}
    best = min(now, key=lambda name: now[name][1])
    chosen = advice.until_shutdown
    scores = {name: value[1] for name, value in now.items()} | {"none": 1.0 + TRAVEL}
    regrets = {name: score / min(scores.values()) - 1.0 for name, score in scores.items()}
    bold = min(scores, key=lambda name: advice.none.score if name == "none" else advice[name].score)
    return {
        "sd": ratios, "names": [one.name for one in advice.tried] + ["none"], "chosen": chosen, "best": best,
        "regret": regrets[chosen or "none"], "next": sorted(regrets.values())[1], "bold": regrets[bold],
        "known": [regrets[name] for name in _best_where_known(plant, advice)],
        "harm": chosen is not None and now[chosen][2] > rms, "true": {k: v[0] / sd for k, v in true.items()},
        "scores": {k: v[1] for k, v in true.items()}, "foretold": {one.name: one.score for one in advice.tried},
        "ratios": {one.name: sorted(one.outcome.pv_sd / advice.none.outcome.pv_sd) for one in advice.tried},
    }  # fmt: skip


def _best_where_known(plant: Plant, advice: Advice) -> list[str]:
    """Which remedy a fit would take that has the true valve and process, by each law of stick that it knows."""
    fit, n = advice.fit, plant.numbers
    tried, found = [one for one in advice.tried if not one.at_shutdown], []
    for follows in (False, True):
        true = Loop(follows, n.S, n.J, plant.integrating, n.K, max(n.T_1, plant.dt), n.T_2 + n.T_3, n.theta + n.air)
        now = beside(fit.days, true, start_noise(fit.days, plant.integrating))
        for _ in range(3):
            now = beside(fit.days, true, now.noises)
        (path,) = predicted(fit.days, true, now.noises).shown
        lefts = ((fit.days[0].pv[: path.shape[1]] - n.K * path[1],),)
        settings = [NOTHING, *(one.outcome.setting for one in tried)]
        scores = {"none": 1.0 + TRAVEL}
        try:
            none, *given = outcomes(replace(fit, loops=(true,), lefts=lefts, begun=path[0, :1]), settings)
            scores |= {one.name: score(own, none) for one, own in zip(tried, given, strict=True)}
        except FitError:  # it does not swing as the log does
            pass
        found.append(min(scores, key=lambda name: scores[name]))
    return found


def summary(rows: Sequence[dict[str, Any]]) -> list[str]:
    """The table of all loops."""
    fitted = [r for r in rows if "refused" not in r]
    sticky = [r for r in fitted if r["law"] != "sound"]
    sound = [r for r in fitted if r["law"] == "sound"]
    seen = [r for r in sticky if r["sticks"]]
    lines = [
        f"loops {len(rows)}, refused {len(rows) - len(fitted)}",
        f"sticky loops in which stick is seen: {len(seen)} of {len(sticky)}; sound ones accused: "
        f"{sum(r['sticks'] for r in sound)} of {len(sound)}",
        f"kind of process right: {sum(r['kind'] == r['integrating'] for r in seen)} of {len(seen)}",
        f"no remedy is tried in {sum('untried' in r for r in seen)}",
    ]
    for key in KEYS:
        own = np.array([[math.nan if x is None else x for x in r[key]] for r in seen if key in r])
        if len(own):
            given = own[np.isfinite(own[:, 0])]
            error = np.abs(given[:, 0] / given[:, 3] - 1.0)
            holds = np.mean((own[:, 1] <= own[:, 3]) & (own[:, 3] <= own[:, 2]))
            lines.append(
                f"{key}: median error {100 * np.median(error):.0f} % of {len(given)} known of {len(own)}; the 90 % "
                f"interval holds {100 * holds:.0f} %"
            )
    pairs = np.array([pair for r in seen for pair in r.get("sd", [])])
    if len(pairs):
        ends = np.isfinite(pairs[:, [0, 3]]).all(axis=1)
        error = np.abs(pairs[ends, 0] / pairs[ends, 3] - 1.0)
        holds = np.mean((pairs[:, 1] <= pairs[:, 3]) & (pairs[:, 3] <= pairs[:, 2]))
        lines += [
            f"predicted sd: median error {100 * np.median(error):.0f} % of {ends.sum()} that end",
            f"the interval of all {len(pairs)} holds {100 * holds:.0f} %",
        ]
        judged = [r for r in seen if "regret" in r]
        within = ", ".join(
            f"{100 * most:.0f} %: {sum(r['regret'] <= most for r in judged)}" for most in (BEST, 0.1, 0.2)
        )
        lost = [r for r in judged if r["regret"] > BEST]
        known = [
            f"{sum(r['known'][i] <= BEST for r in judged)} by {law}" for i, law in enumerate(("He's law", "Chen's"))
        ]
        lines += [
            f"regret within {within} of {len(judged)}; of the {len(lost)} that are not best, nothing is recommended in "
            f"{sum(r['chosen'] is None for r in lost)}; near ties {sum(r['next'] <= TIE for r in judged)}",
            f"best where the least score foretold is taken, sure or not: {sum(r['bold'] <= BEST for r in judged)}; "
            f"where valve and process are known: {', '.join(known)}",
        ]
        chosen = [r for r in judged if r["chosen"]]
        lines.append(f"recommended: {len(chosen)}; though worse than none: {sum(r['harm'] for r in chosen)}")
    took, tried = [r["fit_s"] for r in fitted], [r["remedy_s"] for r in seen if "sd" in r]
    lines.append(f"processor time, median: fit {np.median(took):.1f} s (most {max(took):.1f})")
    return [*lines, *([f"remedies {np.median(tried):.1f} s"] if tried else [])]


def by_kind(rows: Sequence[dict[str, Any]]) -> list[str]:
    """A line for each law of friction and kind of process."""
    lines = []
    for law in (*LAWS, *(law for law in apart.LAWS if law not in LAWS)):
        for integrating in (False, True):
            own = [r for r in rows if (r["law"], r["integrating"]) == (law, integrating) and "refused" not in r]
            judged = [r for r in own if "regret" in r]
            if not own:
                continue
            S = [abs(r["S"][0] / r["S"][3] - 1.0) for r in judged if r.get("S", [None])[0] is not None]
            lines.append(
                f"{law:18} {'integrating' if integrating else 'self-regulating':15} {len(own):3} loops, sticky "
                f"{sum(r['sticks'] for r in own)}, kind right {sum(r['kind'] == r['integrating'] for r in judged)} of "
                f"{len(judged)}, S off by {100 * np.median(S) if S else math.nan:.0f} %, best remedy "
                f"{sum(r['regret'] <= BEST for r in judged)}, harm {sum(r['harm'] for r in judged)}"
            )
    return lines


def main() -> None:
    """Run the loops that the file does not have yet, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--loops", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--apart", action="store_true", help="loops of benchmarks.remedy.apart")
    parser.add_argument("--shaken", action="store_true", help="sound loops that a sticky neighbour shakes")
    parser.add_argument("--quick", action="store_true", help="five loops")
    parser.add_argument("--json", type=Path, help="append each row to this file; what it has is not run again")
    given = parser.parse_args()
    rows, of = kept(given.json), apart.shaken if given.shaken else apart.drawn if given.apart else Plant.drawn
    done = {r["seed"] for r in rows}
    for seed in range(given.first, given.first + (5 if given.quick else given.loops)):
        if seed not in done:
            rows += appended(given.json, [row(of(seed))])
    print("\n".join([*summary(rows), *by_kind(rows)]))


if __name__ == "__main__":
    main()
