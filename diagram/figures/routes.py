"""From cells to lines: where the ports are, which way each arrow goes, how wide the channels must be [points].

Between two columns (and two rows) of boxes lies a channel.  Arrows turn only in channels, each signal on a track
of its own, so no arrow runs through a box and no two signals share a line.  A channel has zones: what stays
inside a nested diagram turns inside its frame, the rest outside.

    column k | inside the frames that end here | between all frames | inside the frames that begin here | column k + 1
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from stickslip.diagram.figures.placement import Arrow, Grid, Group, common

PORT = 22.0  # between two outputs of a box
SIDE = 0.72  # between two inputs that come round a corner, in PORT
CLEAR = 4.0  # least distance of an input from the line of an output of the box beside
TRACK = 9.0  # between two signals in a channel
PAD = 11.0  # between a frame and what is inside or outside
TITLE = 17.0  # room for the title of a frame
HEAD = 15.0  # room for an arrow's head
LABEL = 9.0  # around a label

Zone = tuple[int, int]  # (side, depth): side -1 ends here, 0 between all, +1 begins here
Point = tuple[float, float]


@dataclass
class Channel:
    """One channel: which signals run in which zone, over which stretch, and once laid out, where."""

    runs: dict[Zone, dict[str, list[float]]] = field(default_factory=dict)
    tracks: dict[tuple[Zone, str], int] = field(default_factory=dict)
    offset: dict[Zone, float] = field(default_factory=dict)
    border: dict[Zone, float] = field(default_factory=dict)
    width: float = 0.0

    def reserve(self, zone: Zone, signal: str, a: float, b: float) -> None:
        """Let a signal run from ``a`` to ``b``."""
        self.runs.setdefault(zone, {}).setdefault(signal, []).extend((a, b))

    def lay_out(self, before: float, after: float, borders: Mapping[Zone, float]) -> None:
        """Give every signal its track: free of others over its stretch, the short stretches nearest."""
        self.width = before
        for zone in sorted({*self.runs, *borders, (0, 0)}, key=_place):
            if zone[0] > 0 and zone in borders:
                self.width += borders[zone]
                self.border[zone] = self.width - borders[zone] + PAD
            self.offset[zone] = self.width
            used: list[list[tuple[float, float]]] = []
            stretches = {signal: (min(ends), max(ends)) for signal, ends in self.runs.get(zone, {}).items()}
            for signal, (a, b) in sorted(stretches.items(), key=lambda run: (run[1][1] - run[1][0], run[1])):
                track = next((k for k, runs in enumerate(used) if all(b < lo or hi < a for lo, hi in runs)), len(used))
                if track == len(used):
                    used.append([])
                used[track].append((a, b))
                self.tracks[zone, signal] = track
            self.width += TRACK * len(used)
            if zone[0] < 0 and zone in borders:
                self.border[zone] = self.width + PAD
                self.width += borders[zone]
        self.width += after

    def at(self, zone: Zone, signal: str) -> float:
        """Return where in the channel a signal runs."""
        return self.offset[zone] + TRACK * (self.tracks[zone, signal] + 0.5)


def _place(zone: Zone) -> tuple[int, int]:
    side, depth = zone
    return side, -depth if side < 0 else depth


@dataclass(frozen=True)
class Box:
    """A node on the paper: centre, width, height [points]."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class Sheet:
    """Everything with its place on the paper, y downwards [points]: ``lines[k]`` belongs to ``grid.arrows[k]``.

    ``near[k]`` tells whether arrow ``k`` goes straight to the next column.  ``frames``: left, top, right, bottom.
    """

    boxes: tuple[Box, ...]
    lines: tuple[tuple[Point, ...], ...]
    near: tuple[bool, ...]
    frames: dict[Group, tuple[float, float, float, float]]
    width: float
    height: float


# One turn of a way: ("v" or "h", channel, zone)
Turn = tuple[str, int, Zone]


def sheet(
    g: Grid, size: Callable[[int, float], tuple[float, float]], label: Callable[[Arrow], float],
    entry: Callable[[Arrow], float],
) -> Sheet:  # fmt: skip
    """Lay out a grid.

    ``size(node, least)`` returns width and height of a node that needs at least the height ``least`` for its ports;
    ``label`` and ``entry`` return the widths of the labels where an arrow begins and where it ends.
    """
    ways, ins, outs, near = _ways(g)
    n_columns, n_rows = max(g.column) + 1, max(g.row) + 1
    across = [Channel() for _ in range(n_columns + 1)]  # vertical channels: across[k + 1] lies behind column k
    down = [Channel() for _ in range(n_rows + 1)]
    for arrow, way, k in zip(g.arrows, ways, range(len(ways)), strict=True):
        here = g.row[arrow.source] + outs[k] / 1000.0
        along = float(g.column[arrow.source])
        for step, (direction, channel, zone) in enumerate(way):
            if direction == "v":
                last = step == len(way) - 1
                there = g.row[arrow.target] + ins[k] / 1000.0 if last else way[step + 1][1] + 0.5
                across[channel + 1].reserve(zone, arrow.signal, here, there)
                along = channel + 0.5
            else:
                down[channel + 1].reserve(zone, arrow.signal, along, way[step + 1][1] + 0.5)
                here = channel + 0.5
    least = [0.0] * len(g.nodes)
    for k, arrow in enumerate(g.arrows):
        least[arrow.source] = max(least[arrow.source], 2 * abs(outs[k]) + 14.0)
        least[arrow.target] = max(least[arrow.target], 2 * abs(ins[k]) + 14.0)
    sizes = [size(v, least[v]) for v in range(len(g.nodes))]
    wide = [
        max(s[0] for s, c in zip(sizes, g.column, strict=True) if c == k) if k in g.column else 0.0
        for k in range(n_columns)
    ]
    high = [
        max(s[1] for s, r in zip(sizes, g.row, strict=True) if r == k) if k in g.row else 0.0 for k in range(n_rows)
    ]
    for k in range(-1, n_columns):
        leaving = [label(a) for a in g.arrows if g.column[a.source] == k]
        coming = [
            entry(a) for a, close in zip(g.arrows, near, strict=True) if g.column[a.target] == k + 1 and not close
        ]
        ends = {(-1, len(f)): 2 * PAD for f, (_, right, _, _) in g.frames.items() if right == k}
        begins = {(1, len(f)): 2 * PAD for f, (left, _, _, _) in g.frames.items() if left == k + 1}
        room = max(leaving, default=0.0) + LABEL if leaving else 0.0
        ahead = HEAD + max(coming, default=0.0) if coming or leaving else 0.0
        across[k + 1].lay_out(room, ahead, ends | begins)
    for k in range(-1, n_rows):
        ends = {(-1, len(f)): 2 * PAD for f, (_, _, _, bottom) in g.frames.items() if bottom == k}
        begins = {(1, len(f)): PAD + TITLE for f, (_, _, top, _) in g.frames.items() if top == k + 1}
        down[k + 1].lay_out(PAD if k >= 0 else 0.0, PAD if k < n_rows - 1 else 0.0, ends | begins)
    x0, y0 = _starts(across, wide), _starts(down, high)  # where channel k - 1 begins
    centre_x = [x0[k + 1] - wide[k] / 2 for k in range(n_columns)]
    centre_y = [y0[k + 1] - high[k] / 2 for k in range(n_rows)]
    boxes = tuple(Box(centre_x[c], centre_y[r], *s) for c, r, s in zip(g.column, g.row, sizes, strict=True))
    lines = []
    for k, (arrow, way) in enumerate(zip(g.arrows, ways, strict=True)):
        source, target = boxes[arrow.source], boxes[arrow.target]
        x, y = source.x + source.width / 2, source.y + outs[k]
        points = [(x, y)]
        for direction, channel, zone in way:
            if direction == "v":
                x = x0[channel + 1] + across[channel + 1].at(zone, arrow.signal)
            else:
                y = y0[channel + 1] + down[channel + 1].at(zone, arrow.signal)
            points.append((x, y))
        if points[-1][1] != target.y + ins[k]:
            points.append((x, target.y + ins[k]))
        lines.append((*points, (target.x - target.width / 2, target.y + ins[k])))
    frames = {}
    for f, (left, right, top, bottom) in g.frames.items():
        depth = len(f)
        frames[f] = (
            x0[left] + across[left].border[1, depth], y0[top] + down[top].border[1, depth] - PAD + 3.0,
            x0[right + 1] + across[right + 1].border[-1, depth], y0[bottom + 1] + down[bottom + 1].border[-1, depth],
        )  # fmt: skip
    return Sheet(boxes, tuple(lines), near, frames, x0[-1] + across[-1].width, y0[-1] + down[-1].width)


def _starts(channels: Sequence[Channel], between: Sequence[float]) -> list[float]:
    """Return where each channel begins, the first at 0."""
    found = [0.0]
    for channel, length in zip(channels, between, strict=False):
        found.append(found[-1] + channel.width + length)
    return found


def _ways(g: Grid) -> tuple[list[list[Turn]], list[float], list[float], tuple[bool, ...]]:
    """Return for each arrow its turns, where it enters and leaves (from the centre of the box), and if it is near."""
    outs = _leave(g)
    ins: list[float | None] = [None] * len(g.arrows)
    ways: list[list[Turn]] = [[] for _ in g.arrows]
    taken: dict[tuple[int, int], object] = dict(g.taken)
    near = []
    for k, arrow in enumerate(g.arrows):  # straight ones first: they keep their line, the others go round
        c1, r1, c2, r2 = g.column[arrow.source], g.row[arrow.source], g.column[arrow.target], g.row[arrow.target]
        cells = [(c, r1) for c in range(c1 + 1, c2)]
        straight = r1 == r2 and c1 < c2 and all(taken.get(cell, arrow.signal) == arrow.signal for cell in cells)
        free = all(ins[j] != outs[k] for j, a in enumerate(g.arrows) if a.target == arrow.target)
        near.append(straight and free and c2 == c1 + 1)
        if straight and free:
            ins[k] = outs[k]
            taken |= dict.fromkeys(cells, arrow.signal)
    for k, arrow in enumerate(g.arrows):
        if ins[k] is None:
            ways[k] = _way(g, arrow, taken)
    _enter(g, ins, outs)
    return ways, [i or 0.0 for i in ins], outs, tuple(near)


def _leave(g: Grid) -> list[float]:
    """Return where each arrow leaves its box: the output that goes straight on in the middle, the others beside."""
    ports: dict[int, list[int]] = {}
    for arrow in g.arrows:
        if arrow.out not in ports.setdefault(arrow.source, []):
            ports[arrow.source].append(arrow.out)
    slots: dict[tuple[int, int], float] = {}
    for v, found in ports.items():

        def lean(port: int, v: int = v) -> tuple[float, int]:
            rows = [
                g.row[a.target] - g.row[v]
                for a in g.arrows
                if a.source == v and a.out == port and g.column[a.target] > g.column[v]
            ]
            return (sum(rows) / len(rows) if rows else 0.5), port

        ordered = sorted(found, key=lean)
        main = min(range(len(ordered)), key=lambda i: abs(lean(ordered[i])[0]))
        for i, port in enumerate(ordered):
            slots[v, port] = (i - main) * PORT
    return [slots[arrow.source, arrow.out] for arrow in g.arrows]


def _enter(g: Grid, ins: list[float | None], outs: Sequence[float]) -> None:
    """Choose where the arrows that turn enter their box: from above or below of those that come straight."""
    for v in range(len(g.nodes)):
        coming = [k for k, a in enumerate(g.arrows) if a.target == v and ins[k] is None]
        fixed = [offset for k, a in enumerate(g.arrows) if a.target == v and (offset := ins[k]) is not None]
        if not coming:
            continue

        def behind(k: int, v: int = v) -> bool:
            return g.column[g.arrows[k].source] >= g.column[v]

        def above(k: int, v: int = v) -> bool:
            return not behind(k) and g.row[g.arrows[k].source] < g.row[v]

        upper = sorted(filter(above, coming), key=lambda k: g.row[g.arrows[k].source])
        lower = sorted((k for k in coming if not above(k)), key=lambda k: (behind(k), g.row[g.arrows[k].source]))
        if fixed:
            offsets = [min(fixed) - SIDE * PORT * (i + 1) for i in reversed(range(len(upper)))]
            offsets += [max(fixed) + SIDE * PORT * (i + 1) for i in range(len(lower))]
        else:
            offsets = [SIDE * PORT * (i - (len(coming) - 1) / 2) for i in range(len(coming))]
        left = [g.taken[c, g.row[v]] for c in range(g.column[v]) if (c, g.row[v]) in g.taken]
        lines = {outs[k] for k, a in enumerate(g.arrows) if left and a.source == left[-1]}
        while any(abs(offset - line) < CLEAR for offset in offsets for line in lines):
            offsets = [offset + CLEAR for offset in offsets]
        for k, offset in zip(upper + lower, offsets, strict=True):
            ins[k] = offset


def _way(g: Grid, arrow: Arrow, taken: dict[tuple[int, int], object]) -> list[Turn]:
    """Return the turns of an arrow that cannot go straight."""
    c1, r1, c2, r2 = g.column[arrow.source], g.row[arrow.source], g.column[arrow.target], g.row[arrow.target]
    home = common(g.nodes[arrow.source].group, g.nodes[arrow.target].group)
    first, last = c1, c2 - 1
    if last == first:
        return [_vertical(g, first, home)]
    if c2 > c1:
        for cells, channel in (
            ([(c, r1) for c in range(c1 + 1, c2)], last),
            ([(c, r2) for c in range(c1 + 1, c2)], first),
        ):
            if all(taken.get(cell, arrow.signal) == arrow.signal for cell in cells) and r1 != r2:
                taken.update(dict.fromkeys(cells, arrow.signal))
                return [_vertical(g, channel, home)]
        row = r1 - 1 if r1 >= r2 else r1
    else:
        row = min(r1, r2)
    return [_vertical(g, first, home), _horizontal(g, row, home), _vertical(g, last, home)]


def _vertical(g: Grid, channel: int, home: Group) -> Turn:
    return (
        "v",
        channel,
        _zone(home, [f[1] == channel for f in _outer(g, home)], [f[0] == channel + 1 for f in _outer(g, home)]),
    )


def _horizontal(g: Grid, channel: int, home: Group) -> Turn:
    return (
        "h",
        channel,
        _zone(home, [f[3] == channel for f in _outer(g, home)], [f[2] == channel + 1 for f in _outer(g, home)]),
    )


def _outer(g: Grid, home: Group) -> list[tuple[int, int, int, int]]:
    return [g.frames[home]] if home else []


def _zone(home: Group, ends: list[bool], begins: list[bool]) -> Zone:
    """Return the zone inside the frame that begins or ends here, else the one between all frames."""
    if any(ends):
        return -1, len(home)
    return (1, len(home)) if any(begins) else (0, 0)
