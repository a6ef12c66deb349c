"""The request of a study as plain values.  Requests with equal values are the same; differences have names."""

import hashlib
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from stickslip.diagram.diagram import Diagram
from stickslip.logs.files import resumable
from stickslip.study.axes import Axis

from stickslip import blocks, engine, plant

SCHEMA = "stickslip.study-folder/1"
PACKAGES = (blocks, engine, plant)
PHRASES = {
    "code": "stickslip itself has changed since",
    "fingerprint": "the diagram itself (its blocks, wiring or numbers) has changed",
}


def fingerprint(diagram: Diagram) -> str:
    """Return a hash of all blocks of a diagram: kinds, names, wiring and every number.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> one, two = self_regulating_loop(), self_regulating_loop(F_s=1750.0)
    >>> fingerprint(one) == fingerprint(self_regulating_loop()), fingerprint(one) == fingerprint(two)
    (True, False)
    """
    digest = hashlib.sha256()
    for block in diagram.blocks:
        digest.update(
            repr(
                (type(block).__qualname__, block.name, block.input_labels, block.output_labels, block.param_names)
            ).encode()
        )
        for numbers in (block.p, block.x0, block.d0, block.y0):
            digest.update(numbers.tobytes())
    return digest.hexdigest()[:16]


@lru_cache(maxsize=1)
def code() -> str:
    """Return a hash of the sources that make the numbers: rows of two versions must not stand in one table."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        folder = Path(package.__path__[0])
        for path in sorted(folder.rglob("*.py")):
            digest.update(str(path.relative_to(folder)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def spelt(axes: Sequence[Axis]) -> dict[str, dict[str, object]]:
    """Return the axes as plain values, by kind."""
    found: dict[str, dict[str, object]] = {}
    for axis in axes:
        found.setdefault(axis.kind, {})[axis.name] = axis.spelt()
    return found


def differences(wanted: Mapping[str, Any], found: Mapping[str, Any]) -> list[str]:
    """Return what differs between a new request and one that a folder holds, a phrase each.

    >>> differences({"seed": 1, "vary": {"a.x": [1.0]}}, {"seed": 2, "vary": {}})
    ['seed: there 2, now 1', 'vary a.x: there not given, now [1.0]']
    """
    phrases = resumable.differences(wanted, found, PHRASES)
    if not phrases and list(_flat(wanted)) != list(_flat(found)):
        phrases.append("the order of the axes")
    return phrases


def _flat(request: Mapping[str, Any]) -> list[str]:
    return [key for kind in ("vary", "plant", "start") for key in request.get(kind, {})]
