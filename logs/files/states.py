"""Words that stand in a number column when there is no number: digital states of historians and blanks."""

from __future__ import annotations

import re

__all__ = ["is_blank", "is_state", "quality_is_good"]

_BLANKS = {
    "", "nan", "null", "none", "na", "n/a", "#n/a", "\\n", "<null>", "(null)", "missing", "n.a.", "<no data>",
}  # fmt: skip

# Without case and without the spaces and underscores that come and go between versions.
_STATES = {
    "badinput", "bad", "iotimeout", "i/otimeout", "nodata", "shutdown", "scanoff", "scantimeout",
    "configure", "ptcreated", "pointcreated", "intfshut", "intfshutdown", "notconnect", "notconnected",
    "noresult", "calcoff", "calcfailed", "calccrash", "calcoverflow", "commfail", "commfailure", "comfail",
    "error", "outofserv", "outofservice", "overrange", "underrange", "overrng", "underrng", "inactive",
    "invalid", "invaliddata", "invalidfloat", "badquality", "baddata", "badvalue", "badtotal", "badcal",
    "equipfail", "devicefailure", "sensorfailure", "failed", "doubtful", "failure", "accessdenied",
    "arcoffline", "archiveoffline", "noalarm", "nolab", "nosample", "unitdown", "snapfix", "filterfail",
    "inputfailure", "lastknownvalue", "waitingforinitialdata", "uncertain", "disconnected", "stale",
    "nogooddata", "nogooddataforcalculation", "pointnotfound", "tagnotfound", "dcsfailed",
    "#value!", "#ref!", "#num!", "#div/0!", "#name?", "inf", "+inf", "-inf", "infinity", "-infinity",
    "1.#qnan", "-1.#qnan", "1.#ind", "-1.#ind", "1.#inf", "-1.#inf", "questionable", "substituted",
    "connectionlost", "timeout", "notavailable", "unavailable", "unknown", "offline", "undefined",
}  # fmt: skip

_GOOD = {"ok", "true", "valid", "g", "normal", "nrm", "accepted", "gut", "bon", "bueno"}
_NOT_GOOD = ("bad", "uncer", "questionable", "substitut", "doubt", "schlecht", "unsicher", "mauvais", "malo")
_ERROR_NUMBER = re.compile(r"^\[-\d+\]\s*")


def is_blank(text: str) -> bool:
    """Whether ``text`` says that there is simply no value.

    >>> is_blank(" "), is_blank("NaN"), is_blank("0")
    (True, True, False)
    """
    word = text.strip().casefold()
    return word in _BLANKS or not word.strip("*?-#.")  # "****" and "####": a number too wide for its cell


def is_state(text: str) -> bool:
    """Whether ``text`` is a digital state that we know, by which a historian says why there is no number.

    >>> is_state("I/O Timeout"), is_state("[-11059] No Good Data For Calculation"), is_state("twelve")
    (True, True, False)
    """
    word = text.strip().casefold()
    if _ERROR_NUMBER.match(word):
        return True  # the negative number is the historian's own error code; its words vary
    return re.sub(r"[\s_]+", "", word).rstrip(".") in _STATES


def quality_is_good(text: str) -> bool | None:
    """Whether a quality word means good; None when it is not a quality word. Uncertain is not good.

    >>> [quality_is_good(text) for text in ("Good", "GOOD, non-specific", "Uncertain", "bad", "17 m3")]
    [True, True, False, False, None]
    """
    word = text.strip().casefold()
    if word.startswith("good") or word in _GOOD:
        return True
    if word.startswith(_NOT_GOOD):
        return False
    if word in {"false", "invalid", "b", "u", "error", "stale"} or is_state(word):
        return False
    return None
