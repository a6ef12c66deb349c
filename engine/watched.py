"""A check that names still stand for the same values.  It is made before each run, so it is quick."""

from collections.abc import Callable, Iterable
from operator import is_
from typing import Any

Rows = tuple[list[Any], list[str], list[Any]]  # where, under which name, what stood there


class Watched:
    """Names of modules and attributes of objects with what stood there; of several such lists what they hold together.

    >>> names = {"gain": 2.0}
    >>> watched = Watched()
    >>> watched.look(names, ["gain"]), watched.changed()
    ([2.0], False)
    >>> names["gain"] = 3.0
    >>> watched.changed(), Watched([watched]).changed()
    (True, True)
    """

    def __init__(self, parts: "Iterable[Watched]" = ()) -> None:
        self.of_dicts: Rows = ([], [], [])
        self.of_objects: Rows = ([], [], [])
        self.held: list[tuple[Callable[[Any], str], Any, str]] = []  # what can change in place, and its contents
        known = set()
        for part in parts:
            self.held += part.held
            for own, rows in ((self.of_dicts, part.of_dicts), (self.of_objects, part.of_objects)):
                for where, name, value in zip(*rows, strict=True):
                    if (id(where), name, id(value)) not in known:
                        known.add((id(where), name, id(value)))
                        _add(own, where, [name], [value])

    def look(self, where: Any, names: Iterable[str]) -> list[Any]:
        """Return what stands under the names in a dictionary (None: nothing) or an object, and keep it.

        Raises ``AttributeError`` for an attribute that is not there.
        """
        names = [*names]
        in_dict = type(where) is dict
        values = [where.get(name) if in_dict else getattr(where, name) for name in names]
        _add(self.of_dicts if in_dict else self.of_objects, where, names, values)
        return values

    def hold(self, value: Any, digest: Callable[[Any], str]) -> None:
        """Keep what a value contains now, as its ``digest``."""
        self.held.append((digest, value, digest(value)))

    def changed(self) -> bool:
        """Return whether a name stands for another object now, or one of them has changed in place."""
        try:
            for get, (places, names, values) in ((dict.get, self.of_dicts), (getattr, self.of_objects)):
                if not all(map(is_, map(get, places, names), values)):
                    return True
        except (AttributeError, ValueError):  # it is there no more
            return True
        return any(digest(value) != before for digest, value, before in self.held)


def _add(rows: Rows, where: Any, names: list[str], values: list[Any]) -> None:
    for column, more in zip(rows, ([where] * len(names), names, values), strict=True):
        column += more
