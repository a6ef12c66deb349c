"""Broken and hostile files, made by rule: the same list every time, and as many more as are asked for by a seed.

``files()`` lists them by kind; ``mutated`` breaks a good file at random places.  Nothing here is data of a plant.
"""

import random
from collections.abc import Iterator
from dataclasses import dataclass

from benchmarks.hostile_binary import containers, encodings, parquets, workbooks
from benchmarks.hostile_text import names, shapes, times, values

__all__ = ["Hostile", "files", "mutated"]


@dataclass(frozen=True)
class Hostile:
    """One hostile file: what is wrong with it, its name, its bytes."""

    what: str
    name: str
    content: bytes


def files() -> Iterator[Hostile]:
    """Every hostile file, one kind after the other; the names are unique."""
    for number, (kind, what, content, ending) in enumerate(_all()):
        data = content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content
        yield Hostile(f"{kind}: {what}", f"h{number:03d}.{ending}", data)


def mutated(content: bytes, seed: int) -> bytes:
    """The bytes with one to eight random changes: flipped, cut out, doubled, or replaced by what breaks parsers."""
    draw = random.Random(seed)
    raw = bytearray(content)
    for _ in range(draw.randint(1, 8)):
        place = draw.randrange(len(raw) + 1)
        width = min(draw.choice((1, 1, 2, 8, 64)), len(raw) - place)
        change = draw.randrange(4)
        if change == 0 and place < len(raw):
            raw[place] ^= 1 << draw.randrange(8)
        elif change == 1:
            del raw[place : place + width]
        elif change == 2:
            raw[place:place] = raw[place : place + width] * draw.choice((1, 3))
        else:
            raw[place : place + width] = draw.choice(_SPLINTERS)
        if not raw:
            return bytes(draw.choice(_SPLINTERS))
    return bytes(raw)


_SPLINTERS = (
    b"", b"\0", b"\xff\xfe", b'"', b'""', b"\n", b"\r", b",", b";", b"\t", b"nan", b"inf", b"-1", b"1e999", b"\xc3",
    b"=", b"<b>", b"9" * 400, b"0001-01-01", b"2024-02-30 25:61", b"\xe2\x80\xa8", b"#", b"PAR1", b"\x1f\x8b",
    b"PK\x03\x04",
)  # fmt: skip

Made = Iterator[tuple[str, str, str | bytes, str]]


def _all() -> Made:
    yield from (("container", what, raw, ending) for what, raw, ending in containers())
    yield from (("workbook", what, raw, "xlsx") for what, raw in workbooks())
    yield from (("parquet", what, raw, "parquet") for what, raw in parquets())
    yield from (("encoding", what, raw, "csv") for what, raw in encodings())
    yield from (("shape", what, text, "csv") for what, text in shapes())
    yield from (("value", what, text, "csv") for what, text in values())
    yield from (("time", what, text, "csv") for what, text in times())
    yield from (("name", what, text, "csv") for what, text in names())
