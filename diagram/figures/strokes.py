"""The straight strokes of a drawing's lines, and the points where a signal parts."""

from collections.abc import Sequence
from itertools import pairwise

from stickslip.diagram.figures.placement import Grid
from stickslip.diagram.figures.routes import Sheet

__all__ = ["HEAD_LENGTH", "branches", "strokes"]

HEAD_LENGTH = 7.0


def strokes(plan: Grid, laid: Sheet) -> list[tuple[list[float], list[float]]]:
    """Return the straight strokes of all lines, (x, x) and (y, y); what a signal's arrows share is one stroke."""
    found = []
    levels: dict[tuple[str, bool, float], list[tuple[float, float]]] = {}
    for arrow, line in zip(plan.arrows, laid.lines, strict=True):
        ends = [*line[:-1], (line[-1][0] - HEAD_LENGTH, line[-1][1])]
        for (x1, y1), (x2, y2) in pairwise(ends):
            flat = y1 == y2
            a, b = (x1, x2) if flat else (y1, y2)
            levels.setdefault((arrow.signal, flat, y1 if flat else x1), []).append((min(a, b), max(a, b)))
    for (_, flat, level), stretches in levels.items():
        joined: list[tuple[float, float]] = []
        for a, b in sorted(stretches):
            if joined and a <= joined[-1][1]:
                joined[-1] = joined[-1][0], max(b, joined[-1][1])
            else:
                joined.append((a, b))
        found += [([a, b], [level, level]) if flat else ([level, level], [a, b]) for a, b in joined]
    return found


def branches(plan: Grid, laid: Sheet) -> list[tuple[float, float]]:
    """Return the points where a signal parts: there the drawing has a dot."""
    by_signal: dict[str, list[Sequence[tuple[float, float]]]] = {}
    for arrow, line in zip(plan.arrows, laid.lines, strict=True):
        by_signal.setdefault(arrow.signal, []).append(line)
    found = []
    for lines in by_signal.values():
        for x, y in {point for one in lines for point in one[1:-1]}:
            ways = set()
            for one in lines:
                for (ax, ay), (bx, by) in pairwise(one):
                    if min(ax, bx) <= x <= max(ax, bx) and min(ay, by) <= y <= max(ay, by):
                        ways |= {((ex > x) - (ex < x), (ey > y) - (ey < y)) for ex, ey in ((ax, ay), (bx, by))}
            if len(ways - {(0, 0)}) >= 3:
                found.append((x, y))
    return found
