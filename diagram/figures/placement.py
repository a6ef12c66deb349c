"""Where the blocks of a drawing stand: columns in signal-flow order, rows by what they are joined to.

Columns: an order of the blocks with the least weight of backward arrows (measured values, arrows into what plays
the PV, are the cheapest to turn back), then the longest path.  Rows: each block, and each nested diagram as a whole,
moves to the free row where its arrows are shortest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from stickslip.diagram.wired import Wired

Group = tuple[str, ...]
PASSES = 20


@dataclass(frozen=True)
class Node:
    """A block (``block`` is its index), a unit of blocks, or an oval for an open input or an output (``signal``)."""

    kind: str  # "block", "input", "output"
    name: str
    block: int = -1
    group: Group = ()
    inner: tuple[str, ...] = ()  # names of the blocks of a unit


@dataclass(frozen=True)
class Arrow:
    """One signal from the port ``out`` of a node to the port ``into`` of another; nodes by index."""

    signal: str
    source: int
    out: int
    target: int
    into: int
    weight: float  # what it costs to turn the arrow back


@dataclass(frozen=True)
class Grid:
    """Nodes and arrows with the cells they stand in."""

    nodes: tuple[Node, ...]
    arrows: tuple[Arrow, ...]
    column: tuple[int, ...]
    row: tuple[int, ...]

    @cached_property
    def frames(self) -> dict[Group, tuple[int, int, int, int]]:
        """Group -> (first column, last column, first row, last row), outer groups first."""
        groups = {node.group[:depth] for node in self.nodes for depth in range(1, len(node.group) + 1)}
        found = {}
        for group in sorted(groups, key=lambda g: (len(g), g)):
            inside = [n for n, node in enumerate(self.nodes) if node.group[: len(group)] == group]
            columns, rows = [self.column[n] for n in inside], [self.row[n] for n in inside]
            found[group] = (min(columns), max(columns), min(rows), max(rows))
        return found

    @cached_property
    def taken(self) -> dict[tuple[int, int], int]:
        """(column, row) -> node."""
        return {(c, r): n for n, (c, r) in enumerate(zip(self.column, self.row, strict=True))}


def common(a: Group, b: Group) -> Group:
    """Return the innermost group that holds both.

    >>> common(("unit", "loop1"), ("unit", "loop2"))
    ('unit',)
    """
    depth = 0
    while depth < min(len(a), len(b)) and a[depth] == b[depth]:
        depth += 1
    return a[:depth]


def grid(diagram: Wired, units: Mapping[str, Sequence[str]] | None = None) -> Grid:
    """Place the blocks of a diagram, and ovals for open inputs, declared outputs and signals nobody reads.

    ``units``: name -> blocks that stand in one box; what runs inside it is not drawn.
    """
    nodes, arrows = _graph(diagram)
    if units:
        nodes, arrows = _folded(diagram, nodes, arrows, units)
    order = _order(len(nodes), arrows)
    column = _columns(nodes, arrows, order)
    row = _rows(nodes, arrows, column)
    return Grid(tuple(nodes), tuple(arrows), tuple(column), tuple(row))


def wrapped(plan: Grid, bands: int) -> Grid:
    """Return the grid cut into that many bands of about equally many columns, one below the other, as lines of a text.

    No nested diagram is cut, and outputs alone make no band; rows of a band that are empty are left out.
    """
    columns = max(plan.column) + 1
    last = max((c for c, node in zip(plan.column, plan.nodes, strict=True) if node.kind == "block"), default=0)
    frames = plan.frames.values()
    whole = [c for c in range(1, last + 1) if not any(left < c <= right for left, right, _, _ in frames)]
    wanted = [round(columns * k / bands) for k in range(1, bands)]
    cuts = [0, *sorted({min(whole, key=lambda c: abs(c - at)) for at in wanted if whole}), columns]
    column, row, below = list(plan.column), list(plan.row), 0
    for first, end in pairwise(cuts):
        inside = [n for n, c in enumerate(plan.column) if first <= c < end]
        used = sorted({plan.row[n] for n in inside})
        for n in inside:
            column[n], row[n] = plan.column[n] - first, below + used.index(plan.row[n])
        below += len(used)
    return Grid(plan.nodes, plan.arrows, tuple(column), tuple(row))


def _graph(diagram: Wired) -> tuple[list[Node], list[Arrow]]:
    blocks = diagram.blocks
    nodes = [Node("block", block.name.rpartition("/")[2], b, tuple(block.name.split("/")[:-1]))
             for b, block in enumerate(blocks)]  # fmt: skip
    read = {signal for block in blocks for signal in block.input_labels}
    declared = diagram.declared_outputs
    shown = [s for s in diagram.signals if s not in read] if declared is None else declared
    arrows: list[Arrow] = []
    driven = dict(diagram.driven)
    for signal in diagram.open_inputs:
        driven[signal] = (len(nodes), 0)
        nodes.append(Node("input", signal))
    for b, block in enumerate(blocks):
        measured = block.loop_signal("PV")
        for i, signal in enumerate(block.input_labels):
            source, out = driven[signal]
            arrows.append(Arrow(signal, source, out, b, i, 1.0 if signal == measured else 4.0))
    for signal in shown:
        source, out = driven[signal]
        arrows.append(Arrow(signal, source, out, len(nodes), 0, 1.0))
        nodes.append(Node("output", signal))
    return nodes, arrows


def _folded(
    diagram: Wired, nodes: Sequence[Node], arrows: Sequence[Arrow], units: Mapping[str, Sequence[str]]
) -> tuple[list[Node], list[Arrow]]:
    """One node for each unit, and the arrows between units: one for each signal and pair, ports in the order met."""
    place = {block.name: b for b, block in enumerate(diagram.blocks)}
    folded: list[Node] = []
    at: dict[int, int] = {}  # old node -> new node
    for name, inner in units.items():
        at |= {place[block]: len(folded) for block in inner}
        folded.append(Node("block", name, inner=tuple(inner)))
    for v, node in enumerate(nodes):
        if node.kind == "block" and v not in at:
            at[v] = len(folded)
            folded.append(node)
    outs: dict[tuple[int, str], int] = {}
    ins: dict[tuple[int, str], int] = {}
    found: dict[tuple[int, int, str], Arrow] = {}
    for arrow in arrows:
        if nodes[arrow.source].kind != "block" or nodes[arrow.target].kind != "block":
            continue  # open ends and outputs would fill the sheet again
        a, b = at[arrow.source], at[arrow.target]
        if a == b:
            continue
        out = outs.setdefault((a, arrow.signal), sum(node == a for node, _ in outs))
        into = ins.setdefault((b, arrow.signal), sum(node == b for node, _ in ins))
        key = a, b, arrow.signal
        if key not in found:
            found[key] = Arrow(arrow.signal, a, out, b, into, arrow.weight)
    return folded, list(found.values())


def _order(n: int, arrows: Sequence[Arrow]) -> list[int]:
    """Return the nodes in an order with little weight of backward arrows."""
    weight: dict[tuple[int, int], float] = {}
    after: dict[int, list[int]] = {v: [] for v in range(n)}
    for arrow in arrows:
        if arrow.source != arrow.target:
            pair = arrow.source, arrow.target
            weight[pair] = weight.get(pair, 0.0) + arrow.weight
            after[arrow.source].append(arrow.target)
    fed = {v for _, v in weight}
    order: list[int] = []
    seen: set[int] = set()
    for root in [v for v in range(n) if v not in fed] + list(range(n)):
        trail = [(root, iter(after[root]))] if root not in seen else []
        seen.add(root)
        while trail:  # depth first; a node is done when all behind it are
            v, rest = trail[-1]
            w = next((w for w in rest if w not in seen), None)
            if w is None:
                order.insert(0, trail.pop()[0])
            else:
                seen.add(w)
                trail.append((w, iter(after[w])))
    for _ in range(PASSES):
        before = list(order)
        for v in range(n):
            order.remove(v)
            cost, best, best_at = 0.0, 0.0, 0
            costs = [0.0]
            for w in order:  # moving v behind w turns the arrow v -> w back and w -> v forward
                cost += weight.get((v, w), 0.0) - weight.get((w, v), 0.0)
                costs.append(cost)
            here = before.index(v) if order == [w for w in before if w != v] else None
            best = min(costs)
            best_at = here if here is not None and costs[here] == best else costs.index(best)
            order.insert(best_at, v)
            before = list(order)
        if _back_weight(order, weight) == 0.0:
            break
    return order


def _back_weight(order: Sequence[int], weight: Mapping[tuple[int, int], float]) -> float:
    place = {v: i for i, v in enumerate(order)}
    return sum(w for (a, b), w in weight.items() if place[a] > place[b])


def _columns(nodes: Sequence[Node], arrows: Sequence[Arrow], order: Sequence[int]) -> list[int]:
    """Return the longest path to each node; sources move right to stand before the first that reads them."""
    place = {v: i for i, v in enumerate(order)}
    ahead = [(a.source, a.target) for a in arrows if place[a.source] < place[a.target]]
    column = [0] * len(nodes)
    for v in order:
        column[v] = max((column[a] + 1 for a, b in ahead if b == v), default=0)
    fed = {arrow.target for arrow in arrows}
    for v in order:
        if v not in fed:
            column[v] = min((column[b] for a, b in ahead if a == v), default=1) - 1
    for arrow in arrows:
        if nodes[arrow.target].kind == "output":  # behind the whole nested diagram it comes from
            outer = nodes[arrow.source].group[:1]
            column[arrow.target] = 1 + max(
                [column[arrow.source]]
                + [column[v] for v, node in enumerate(nodes) if outer and node.group[:1] == outer]
            )
    first = min(column)
    return [c - first for c in column]


@dataclass
class _Item:
    """A part that moves as one: a node or a nested diagram, a rectangle of cells with the rows of its nodes inside."""

    rows: dict[int, int]
    left: int
    right: int
    height: int
    at: int = 0

    def meets(self, other: "_Item", at: int) -> bool:
        return (
            self.left <= other.right
            and other.left <= self.right
            and at < other.at + other.height
            and other.at < at + self.height
        )


def _rows(nodes: Sequence[Node], arrows: Sequence[Arrow], column: Sequence[int]) -> list[int]:
    placed = _arrange((), nodes, arrows, column)
    return [placed.rows[v] for v in range(len(nodes))]


def _arrange(group: Group, nodes: Sequence[Node], arrows: Sequence[Arrow], column: Sequence[int]) -> _Item:
    """Place what stands directly in a group, nested groups first, and return it as one item."""
    depth = len(group)
    items: list[_Item] = []
    nested: set[Group] = set()
    for v, node in enumerate(nodes):
        if node.group == group:
            items.append(_Item({v: 0}, column[v], column[v], 1))
        elif node.group[:depth] == group and node.group[: depth + 1] not in nested:
            nested.add(node.group[: depth + 1])
            items.append(_arrange(node.group[: depth + 1], nodes, arrows, column))
    fed = {arrow.target for arrow in arrows}
    # nested diagrams make the plan into which single blocks fit, and the main line goes before its sources
    items.sort(key=lambda item: (-len(item.rows), not (item.rows.keys() & fed)))
    for k, item in enumerate(items):
        item.at = next(at for at in range(10**6) if not any(item.meets(other, at) for other in items[:k]))
    _settle(items, arrows, column)
    top = min(item.at for item in items)
    rows = {v: r + item.at - top for item in items for v, r in item.rows.items()}
    return _Item(
        rows,
        min(item.left for item in items),
        max(item.right for item in items),
        max(item.at + item.height for item in items) - top,
    )


def _settle(items: list[_Item], arrows: Sequence[Arrow], column: Sequence[int]) -> None:
    """Move every item to the free row where its arrows are shortest, until none moves."""
    owner = {v: k for k, item in enumerate(items) for v in item.rows}
    joined: dict[int, list[tuple[int, int, int, float]]] = {k: [] for k in range(len(items))}
    fed = {arrow.target for arrow in arrows}
    for arrow in arrows:
        a, b = owner.get(arrow.source), owner.get(arrow.target)
        if a is None or b is None or a == b:
            continue
        reach = column[arrow.target] - column[arrow.source]
        weight = 0.3 if reach < 1 else 0.5 if reach > 1 or arrow.source not in fed else 1.0
        joined[a].append((arrow.source, b, arrow.target, weight))
        joined[b].append((arrow.target, a, arrow.source, weight))
    for _ in range(PASSES):
        moved = False
        for k, item in reversed(list(enumerate(items))):
            others = [other for other in items if other is not item]
            low = min(other.at for other in items) - item.height
            high = max(other.at + other.height for other in items)

            def cost(at: int, k: int = k, item: _Item = item) -> float:
                return sum(
                    w * abs(at + item.rows[v] - items[other].at - items[other].rows[u]) for v, other, u, w in joined[k]
                )

            free = [at for at in range(low, high + 1) if at == item.at or not any(item.meets(o, at) for o in others)]
            best = min(free, key=lambda at: (cost(at), abs(at - item.at)))
            if cost(best) < cost(item.at) - 1e-9:
                item.at, moved = best, True
        if not moved:
            break
