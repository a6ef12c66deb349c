"""Loops of a scan that share an oscillation, found from a few numbers kept of each.

    z_k = mean over stretch k of (PV - mean) exp(-i 2 pi tau / P)       k = 1 .. ``STRETCHES``, tau the clock time

of every loop that oscillates with period P.  Two loops share an oscillation if their periods agree to within the
resolution of the record, P / cycles, and their z move together:

    c = |sum z_k conj(w_k) exp(i 2 pi (1/P_z - 1/P_w) tau_k)|^2 / (sum |z_k|^2 sum |w_k|^2)  >= ``COHERENT``

Two limit cycles of their own drift against each other and have a small c, unless both are as regular as clocks.
Records share their time if the clock says so.  Seconds without a clock begin anew in every file: then only the loops of
one file share it.  The likely source of a group is the loop with the largest probability of stiction in it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import polars as pl

__all__ = ["STRETCHES", "grouped", "phasors"]

STRETCHES = 24
COHERENT = 0.7
SAME_START_S = 30.0  # s: starts of two records this close are one start

Values = npt.NDArray[np.float64]


def phasors(t: Values, pv: Values, period: float) -> list[float] | None:
    """Real and imaginary parts of z_k, (2 ``STRETCHES``,), scaled to a mean square of one; None without a wave.

    ``t`` (n,) [s], ``pv`` (n,), ``period`` [s].

    >>> t = np.arange(2400.0)
    >>> z = phasors(t, np.cos(2 * np.pi * t / 50.0), 50.0)
    >>> len(z), round(z[0], 3), abs(round(z[1], 3))
    (48, 1.0, 0.0)
    """
    good = np.isfinite(pv)
    if good.sum() < 4 * STRETCHES:
        return None
    t, pv = t[good], pv[good]
    turned = (pv - pv.mean()) * np.exp(-2j * math.pi * t / period)
    edges = np.linspace(0, len(t), STRETCHES + 1).astype(np.int64)
    z = np.add.reduceat(turned, edges[:-1]) / np.diff(edges)
    size = float(np.sqrt(np.mean(np.abs(z) ** 2)))
    if size == 0.0:
        return None
    return [float(part) for value in z / size for part in (value.real, value.imag)]


def grouped(table: pl.DataFrame) -> list[str | None]:
    """Return for every row the name of its group, or None for a loop on its own.

    A group is named after the loop that is its likely source.

    ``table`` has the columns loop, probability, period_s, hours, start (null without clock time), source (what tells
    files apart) and phasors.
    """
    rows = table.select("loop", "probability", "period_s", "hours", "start", "source", "phasors").to_dicts()
    waves = [i for i, row in enumerate(rows) if row["period_s"] and row["phasors"]]
    waves.sort(key=lambda i: rows[i]["period_s"])
    joined = list(range(len(rows)))

    def head(i: int) -> int:
        while joined[i] != i:
            i = joined[i]
        return i

    for a, i in enumerate(waves):
        for j in waves[a + 1 :]:
            P, Q, hours = rows[i]["period_s"], rows[j]["period_s"], rows[i]["hours"]
            if P * P / (3600.0 * hours) < Q - P:
                break
            if _same_time(rows[i], rows[j]) and _coherence(rows[i], rows[j]) >= COHERENT:
                joined[head(j)] = head(i)
    by_head: dict[int, list[int]] = {}
    for i in waves:
        by_head.setdefault(head(i), []).append(i)
    names: list[str | None] = [None] * len(rows)
    for found in by_head.values():
        if len(found) > 1:
            source = rows[_source(rows, found)]["loop"]
            for i in found:
                names[i] = source
    return names


def _source(rows: Sequence[dict[str, Any]], found: Sequence[int]) -> int:
    return max(found, key=lambda i: (rows[i]["probability"] or 0.0, -i))


def _same_time(one: dict[str, Any], other: dict[str, Any]) -> bool:
    if one["start"] is None or other["start"] is None:
        at_once = one["start"] is other["start"] and one["source"] == other["source"]
    else:
        at_once = abs(one["start"] - other["start"]) <= SAME_START_S
    return bool(at_once and abs(one["hours"] - other["hours"]) <= 0.02 * one["hours"])


def _coherence(one: dict[str, Any], other: dict[str, Any]) -> float:
    z, w = (np.reshape(row["phasors"], (STRETCHES, 2)) @ np.array([1.0, 1j]) for row in (one, other))
    middle = (np.arange(STRETCHES) + 0.5) / STRETCHES * 3600.0 * one["hours"]
    drift = np.exp(2j * math.pi * (1.0 / one["period_s"] - 1.0 / other["period_s"]) * middle)
    cross = abs(np.sum(z * np.conj(w) * drift)) ** 2
    return float(cross / (np.sum(np.abs(z) ** 2) * np.sum(np.abs(w) ** 2)))
