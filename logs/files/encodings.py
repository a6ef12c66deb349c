"""Which encoding text without a mark is in that is no UTF-8: Chinese, Japanese, else Western."""

from __future__ import annotations

import re

__all__ = ["encoding_of"]

_LOOK_BYTES = 1_000_000  # bytes that are looked at
_COMMON_SHARE = 0.8  # share of letters of daily use from which a text is in that encoding
# Full-width letters and the characters of daily use, which each of the two standards puts in front. A pair of
# Western letters, such as those in "Größe", and a Western sign with the letter behind it, as in "°C", are none.
_DAILY = {
    "gb18030": re.compile(rb"[\xa1-\xa3\xb0-\xd7][\xa1-\xfe]"),
    "cp932": re.compile(rb"[\x81-\x83\x88-\x97][\x40-\x7e\x80-\xfc]"),
}


def encoding_of(raw: bytes) -> str:
    """Return the encoding of a text that is not Unicode: "gb18030" (GBK, GB 2312), "cp932" (Shift-JIS) or "cp1252".

    >>> [encoding_of(text.encode(code)) for text, code in (("流量", "gbk"), ("流量", "cp932"), ("Größe °C", "cp1252"))]
    ['gb18030', 'cp932', 'cp1252']
    """
    head = raw[:_LOOK_BYTES] if len(raw) <= _LOOK_BYTES else raw[: raw.rfind(b"\n", 0, _LOOK_BYTES) + 1]
    shares = {code: _share(head, code) for code in _DAILY}
    best = max(shares, key=lambda code: shares[code])
    return best if shares[best] >= _COMMON_SHARE else "cp1252"


def _share(raw: bytes, code: str) -> float:
    """The share of letters of daily use among those beyond ASCII, 0.0 if the bytes are no text of that encoding."""
    try:
        text = raw.decode(code)
    except UnicodeDecodeError:
        return 0.0
    beyond = [char.encode(code) for char in set(text) if ord(char) > 127 and char.isalpha()]
    return sum(_DAILY[code].fullmatch(char) is not None for char in beyond) / len(beyond) if beyond else 0.0
