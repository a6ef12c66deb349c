"""In which order the states of a stiff step are eliminated, so that few new entries arise."""

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from stickslip.engine.structure import Pair


@dataclass(frozen=True)
class Elimination:
    """How ``diagonal - J`` is factorised without pivoting: positions in one array of factors, row after row.

    Each row holds its entries left of the diagonal, the (inverse) diagonal and those right of it, in the order
    of elimination.

    ``size``: entries of the factors; ``places[k]``: where Jacobian entry ``k`` goes; ``diagonals[i]`` of state ``i``.
    ``factor``: per row (entries left, then for each: its position, the diagonal of its column, updates, and for each
    update: position changed, position right of that diagonal), the diagonal.
    ``forward``, ``backward``: per row (state, position of the first factor, factors, states).
    """

    size: int
    places: tuple[int, ...]
    diagonals: tuple[int, ...]
    factor: tuple[int, ...]
    forward: tuple[int, ...]
    backward: tuple[int, ...]


def eliminate(n: int, entries: Sequence[Pair]) -> Elimination:
    """Return the elimination of ``n`` states in Markowitz's order: always the one that adds fewest entries next."""
    right: list[set[int]] = [set() for _ in range(n)]
    below: list[set[int]] = [set() for _ in range(n)]
    for i, j in entries:
        if i != j:
            right[i].add(j)
            below[j].add(i)
    left: list[list[int]] = [[] for _ in range(n)]
    order: list[int] = []
    waiting = set(range(n))
    queue = [(len(right[i]) * len(below[i]), i) for i in range(n)]
    heapify(queue)
    while waiting:
        cost, pivot = heappop(queue)
        if pivot not in waiting or cost != len(right[pivot]) * len(below[pivot]):
            continue  # it has changed since it was put there, and stands in the queue again
        waiting.remove(pivot)
        order.append(pivot)
        for i in below[pivot]:
            left[i].append(pivot)
            right[i] |= right[pivot]
            right[i] -= {i, pivot}
        for j in right[pivot]:
            below[j] |= below[pivot]
            below[j] -= {j, pivot}
        for i in right[pivot] | below[pivot]:
            heappush(queue, (len(right[i]) * len(below[i]), i))
    rank = {state: place for place, state in enumerate(order)}
    upper = [sorted(right[i], key=rank.__getitem__) for i in range(n)]
    position: dict[Pair, int] = {}
    for i in order:
        for j in [*left[i], i, *upper[i]]:
            position[i, j] = len(position)
    factor: list[int] = []
    forward: list[int] = []
    for i in order:
        factor.append(len(left[i]))
        for j in left[i]:
            factor += [position[i, j], position[j, j], len(upper[j])]
            for m in upper[j]:
                factor += [position[i, m], position[j, m]]
        factor.append(position[i, i])
        forward += [i, position[i, i] - len(left[i]), len(left[i]), *left[i]]
    backward: list[int] = []
    for i in reversed(order):
        backward += [i, position[i, i], len(upper[i]), *upper[i]]
    return Elimination(
        size=len(position),
        places=tuple(position[pair] for pair in entries),
        diagonals=tuple(position[i, i] for i in range(n)),
        factor=tuple(factor),
        forward=tuple(forward),
        backward=tuple(backward),
    )
