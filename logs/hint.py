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
    close = close or difflib.get_close_matches(asked, listed, len(listed) or 1, cutoff=0.4)
    close.sort(key=lambda name: (edits(asked, name), name[:1].casefold() != asked[:1].casefold()))
    hint = f"did you mean '{close[0]}'? " if close else ""
    known = ", ".join(listed[:12]) + (", ..." if len(listed) > 12 else "")
    return f"{hint}known: {known or 'none'}"


def edits(wrong: str, right: str) -> int:
    """Return how many letters are to be added, left out, changed or exchanged with their neighbour.

    Upper and lower case are one.  Source: Damerau 1964, in the form that changes no part of a text twice.

    >>> edits("PW", "PV"), edits("PW", "SP"), edits("ab", "BA")
    (1, 2, 1)
    """
    a, b = wrong.casefold(), right.casefold()
    before: list[int] = []
    row = list(range(len(b) + 1))
    for i, letter in enumerate(a, 1):
        last, before, row = before, row, [i]
        for j, other in enumerate(b, 1):
            row.append(min(before[j] + 1, row[-1] + 1, before[j - 1] + (letter != other)))
            if i > 1 and j > 1 and letter == b[j - 2] and a[i - 2] == other:
                row[j] = min(row[j], last[j - 2] + 1)
    return row[-1]
