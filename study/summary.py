"""A study in sentences: how many runs oscillate, which signal swings most, and from which value on."""

import math

import numpy as np
from stickslip.study.findings import Findings
from stickslip.study.groups import Group, groups
from stickslip.study.growth import chosen, numbers

__all__ = ["summary"]

HALF = 0.5  # of the runs: from there on a point is said to oscillate


def summary(result: Findings) -> dict[str, str]:
    """Return a sentence for the whole study ("") and for each of its pictures, by name."""
    swings = result.swings()
    ok, moving = result.counts()["ok"], int(swings.sum())
    if not moving:
        rest = f"None of the {ok} runs oscillates: all come to rest."
        return {"": rest, "spread": rest, "growth": rest, "map": rest}
    said = {"": f"{moving} of {ok} runs oscillate{'; the others come to rest' if moving < ok else ''}."}
    said["spread"] = _along(result, Group("", math.nan, swings))
    growth, where = _over(result), _where(result)
    return said | ({"growth": growth} if growth else {}) | ({"map": where} if where else {})


def _along(result: Findings, moving: Group) -> str:
    medians = {signal: moving.band(result.percent(signal)).median for signal in result.signals}
    known = {signal: value for signal, value in medians.items() if math.isfinite(value)}
    if len(known) < 2:
        return ""
    high, low = max(known, key=lambda s: known[s]), min(known, key=lambda s: known[s])
    last = result.signals[-1]
    at_end = (
        f"; at the end of the chain, {last}, {known[last]:.2g} %" if last in known and last not in (high, low) else ""
    )
    return f"Most at {high}, {known[high]:.2g} % in the median, least at {low}, {known[low]:.2g} %{at_end}."


def _over(result: Findings) -> str:
    """From which value of the first axis of numbers on most runs oscillate, and how the first signal grows."""
    axis = next((axis for axis in result.varied() if numbers(axis, 3)), None)
    if axis is None:
        return ""
    swings = result.swings()
    steps = [group for group in groups(result, axis) if group.runs.any()]
    share = [float(np.mean(swings[group.runs])) for group in steps]
    most = [s >= HALF for s in share]
    if not any(most):
        return f"At no value of {axis.name} do half of the runs oscillate."
    if all(most):
        said = f"At every value of {axis.name} half of the runs or more oscillate"
    elif most == sorted(most):
        said = f"From {axis.name} = {steps[most.index(True)].label} on half of the runs or more oscillate"
    elif most == sorted(most, reverse=True):
        said = f"Up to {axis.name} = {steps[most.index(False) - 1].label} half of the runs or more oscillate"
    else:
        where = ", ".join(step.label for step, oscillates in zip(steps, most, strict=True) if oscillates)
        said = f"Half of the runs or more oscillate at {axis.name} = {where}"
    signal = chosen(result.signals)[0]
    ends = [Group(g.label, g.at, g.runs & swings) for g, s in zip(steps, share, strict=True) if s > 0.0]
    first, last = (g.band(result.percent(signal)).median for g in (ends[0], ends[-1]))
    if len(ends) < 2 or not (math.isfinite(first) and math.isfinite(last)):
        return f"{said}."
    return f"{said}; {signal} swings by {first:.2g} % at {ends[0].label} and {last:.2g} % at {ends[-1].label}."


def _where(result: Findings) -> str:
    """Where on the first two axes of numbers the last signal swings most."""
    two = [axis for axis in result.varied() if numbers(axis, 2)][:2]
    if len(two) < 2:
        return ""
    signal, swings = result.signals[-1], result.swings()
    cells = [
        (Group("", math.nan, a.runs & b.runs & swings).band(result.percent(signal)).median, a.label, b.label)
        for a in groups(result, two[0]) for b in groups(result, two[1]) if (a.runs & b.runs & swings).any()
    ]  # fmt: skip
    known = [cell for cell in cells if math.isfinite(cell[0])]
    if not known:
        return ""
    most = max(known)
    return f"{signal} swings most, {most[0]:.2g} %, at {two[0].name} = {most[1]}, {two[1].name} = {most[2]}."
