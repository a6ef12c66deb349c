"""The network of convolutions (``stickslip.detect.judge.features.network``), fitted by PyTorch (extra "training").

loss      -ln share of the right kind - ln share of the right side, sticky or not, which a deadband is spared
          + ``SIZED`` (|ln S - s| / w + ln w), w estimated with s, J alike, of the sticky loops
begun     a network to go on from: what its layers were normed by stays, and the rate is ``SLOWER``
steps     AdamW on ``BATCH`` loops of about one length; half of them are cut to 40 to 100 % of it, half change sign;
          the rate rises over ``RISE`` loops and falls as half a cosine
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.signals import Examples
from stickslip.detect.judge.features.network import CHANNELS, FLIPPED, KERNEL, LAYERS, POOLED, STICKY, STRIDE, Network

__all__ = ["MISSING", "fit"]

Say = Callable[[str], None]

WIDTHS = {"stem": 64, "b1": 72, "b2": 72, "b3": 96, "b4": 96, "b5": 120, "b6": 120}  # channels
HEADS, INNER = 4, 144  # weighted means over time; numbers f
PASSES, BATCH, GROUP = 9, 64, 48  # over the loops; loops of a step; steps that loops are sorted by length in
RATE, RISE, DECAY, DROPPED, SIZED = 2.5e-3, 15_000, 0.03, 0.1, 0.2
SLOWER = 0.5  # of the rate, where a network goes on
NEITHER = "deadband"  # dead travel without a jump: neither sticky nor sound
CUT, LONG = 0.4, 200  # least share of a record that is kept, of records of so many points
MISSING = 'PyTorch fits the networks: pip install "stickslip[training]", or give --network 0 to keep the shipped ones'


def fit(
    loops: Examples, say: Say = print, seed: int = 0, passes: int = PASSES, begun: Network | None = None
) -> Network:
    """The network of simulated loops, from random numbers of ``seed`` or going on from ``begun``; ``say`` gets the loss
    of each pass.

    Raises ``ImportError`` where PyTorch is not installed, ``ValueError`` where ``begun`` knows no such kind of loop.
    """
    try:
        import torch
    except ImportError:
        raise ImportError(MISSING) from None
    torch.manual_seed(seed)
    kinds = tuple(np.unique(loops.group).tolist()) if begun is None else begun.kinds
    if unknown := sorted(set(loops.group.tolist()) - set(kinds)):
        raise ValueError(f"the network to go on from knows no {', '.join(unknown)}; fit one from nothing")
    sticky = torch.from_numpy(np.isin(kinds, STICKY))
    either = torch.from_numpy(np.array(kinds) != NEITHER)
    target = torch.from_numpy(np.searchsorted(kinds, loops.group))
    size = torch.from_numpy(np.clip(loops.size, np.log(0.02), np.log(5.0)))
    model = untrained(len(kinds))
    if begun is not None:
        go_on(model, begun)
    rate = RATE if begun is None else SLOWER * RATE
    steps = torch.optim.AdamW(model.parameters(), rate, weight_decay=DECAY)
    rng, done, whole = np.random.default_rng(seed), 0, passes * len(loops)
    for number in range(passes):
        losses = []
        for which, x, length in _batches(loops, rng):
            for group in steps.param_groups:
                group["lr"] = rate * min(1.0, (done + BATCH) / RISE) * 0.5 * (1.0 + np.cos(np.pi * done / whole))
            with torch.autocast("cpu", torch.bfloat16):
                z, sizes = (y.float() for y in model(torch.from_numpy(x), torch.from_numpy(length)))
            loss = _loss(z, sizes, target[which], size[which], sticky, either)
            steps.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(model.parameters(), 5.0)
            steps.step()
            losses.append(loss.item())
            done += len(which)
        say(f"network: pass {number + 1} of {passes} over {len(loops)} loops, loss {np.mean(losses):.3f}")
    return taken(model, kinds)


def _loss(z: Any, sizes: Any, target: Any, size: Any, sticky: Any, either: Any) -> Any:
    import torch
    from torch.nn import functional

    odds = torch.logsumexp(z[:, sticky], 1) - torch.logsumexp(z[:, ~sticky], 1)
    bad = sticky[target]
    sides = functional.binary_cross_entropy_with_logits(odds, bad.float(), weight=either[target].float())
    loss = functional.cross_entropy(z, target) + sides
    if not bad.any():
        return loss
    width = sizes[bad, 2:].clamp(-4.0, 2.0)
    return loss + SIZED * ((size[bad] - sizes[bad, :2]).abs() * torch.exp(-width) + width).mean()


def _batches(
    loops: Examples, rng: np.random.Generator
) -> Iterator[tuple[npt.NDArray[np.intp], npt.NDArray[np.float32], npt.NDArray[np.int64]]]:
    """Loops of one pass by number, their channels and their lengths, batch by batch."""
    order, lengths = rng.permutation(len(loops)), loops.length
    for many in np.array_split(order, max(len(order) // (BATCH * GROUP), 1)):
        whole = lengths[many]
        share = np.where((rng.random(len(many)) < 0.5) | (whole < LONG), 1.0, rng.uniform(CUT, 1.0, len(many)))
        length = (whole * share).astype(np.int64)
        first = (rng.random(len(many)) * (whole - length + 1)).astype(np.int64)
        batches = np.array_split(np.argsort(length, kind="stable"), max(len(many) // BATCH, 1))
        for k in rng.permutation(len(batches)):
            own = batches[k]
            x = np.zeros((len(own), CHANNELS, -(-int(length[own].max()) // STRIDE) * STRIDE), dtype=np.float32)
            for i, j in enumerate(own):
                x[i, :, : length[j]] = loops.x[many[j]][:, first[j] : first[j] + length[j]]
            x[:, FLIPPED] *= rng.choice((-1.0, 1.0), (len(own), 1, 1))
            yield many[own], x, length[own]


def untrained(kinds: int) -> Any:
    """The network of ``stickslip.detect.judge.features.network`` as a module; the layers are called as its weights
    are.
    """
    import torch
    from torch import nn

    class Convolutions(nn.Module):  # type: ignore[misc,unused-ignore]  # PyTorch may be absent where types are checked
        def __init__(self) -> None:
            super().__init__()
            width, pooled = CHANNELS, 0
            for name, stride, spread, _ in LAYERS:
                taps = KERNEL.get(name, 5)
                convolution = nn.Conv1d(
                    width, WIDTHS[name], taps, stride, padding=taps // 2 * spread, dilation=spread, bias=False
                )
                width = WIDTHS[name]
                pooled += width if name in POOLED else 0
                self.add_module(name, nn.Sequential(convolution, nn.BatchNorm1d(width)))
            self.att = nn.Conv1d(width, HEADS, 1)
            self.fc = nn.Linear(pooled + (2 + HEADS) * width, INNER)
            self.out, self.size = nn.Linear(INNER, kinds), nn.Linear(INNER, 4)

        def forward(self, x: Any, length: Any) -> tuple[Any, Any]:
            h, every, found = x, 1, []
            for name, stride, _, added in LAYERS:
                every *= stride
                there = (torch.arange(x.shape[2] // every)[None] * every < length[:, None])[:, None].float()
                own = torch.relu(getattr(self, name)(h)) * there
                h = h + own if added else own
                if name in POOLED:
                    found.append((h * there).sum(2) / there.sum(2))
            h = h.float()
            mean = (h * there).sum(2) / there.sum(2)
            spread = (((h - mean[:, :, None]) ** 2 * there).sum(2) / there.sum(2) + 1e-6).sqrt()
            share = torch.softmax(self.att(h).float() - 1e4 * (1.0 - there), 2)
            weighted = torch.einsum("bkn,bcn->bkc", share, h).flatten(1)
            pooled = torch.cat([*found, mean, spread, weighted], 1).float()
            f = torch.relu(self.fc(nn.functional.dropout(pooled, DROPPED, self.training)))
            return self.out(f), self.size(f)

    return Convolutions()


def go_on(model: Any, begun: Network) -> None:
    """Put the numbers of a network into an untrained module: its layers were normed before and stay so."""
    import torch

    own = dict(model.named_modules())
    with torch.no_grad():
        for name in (*(name for name, *_ in LAYERS), "att", "fc", "out", "size"):
            normed = name in WIDTHS
            part = own[f"{name}.0" if normed else name]
            part.weight.copy_(torch.from_numpy(begun.weights[f"{name}/w"]).reshape(part.weight.shape))
            bias = torch.from_numpy(begun.weights[f"{name}/b"])
            if not normed:
                part.bias.copy_(bias)
                continue
            norm = own[f"{name}.1"]
            norm.bias.copy_(bias)
            norm.running_var.fill_(1.0 - norm.eps)
            norm.eval()  # for as long as ``train`` is not called


def taken(model: Any, kinds: tuple[str, ...]) -> Network:
    """The numbers of a fitted module; what its layers are normed by is in their weights."""
    kept = {name: value.double().numpy() for name, value in model.state_dict().items()}
    weights = {}
    for name, *_ in LAYERS:
        gain = kept[f"{name}.1.weight"] / np.sqrt(kept[f"{name}.1.running_var"] + 1e-5)
        w = kept[f"{name}.0.weight"] * gain[:, None, None]
        weights[f"{name}/w"] = w.reshape(len(w), -1)
        weights[f"{name}/b"] = kept[f"{name}.1.bias"] - kept[f"{name}.1.running_mean"] * gain
    for name in ("att", "fc", "out", "size"):
        w = kept[f"{name}.weight"]
        weights |= {f"{name}/w": w.reshape(len(w), -1), f"{name}/b": kept[f"{name}.bias"]}
    return Network({name: w.astype(np.float32) for name, w in weights.items()}, kinds)
