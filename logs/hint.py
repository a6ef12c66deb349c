"""The hint for an unknown name: the nearest known name, and the list of all.

It stands in ``logs``, which imports nothing of the house and which all other rooms may import, so that every message
of the house has its hint from here.
"""

import difflib
from collections.abc import Iterable


def nearest(wrong: object, names: Iterable[str]) -> str:
    """Return a hint that names the most similar known name, and all of them when they are few.

    >>> nearest("F_S", ["F_s", "F_c"])
    "did you mean 'F_s'? known: F_s, F_c"
    """
    asked, listed = str(wrong), list(names)  # also what is no name at all, such as None, gets the list
    close = [n for n in listed if n.casefold() == asked.casefold()]
    close = close or difflib.get_close_matches(asked, listed, 1, cutoff=0.4)
    hint = f"did you mean '{close[0]}'? " if close else ""
    known = ", ".join(listed[:12]) + (", ..." if len(listed) > 12 else "")
    return f"{hint}known: {known or 'none'}"
