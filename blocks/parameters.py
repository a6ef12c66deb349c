"""The parameters that python-control sees: a mapping to look at; a value is changed in a copy, by ``with_params``.

Python-control keeps parameters in a dict, ``system.params``.  Blocks and diagrams are values, and what runs is their
array ``p``; a number written into the dict would be heard by nobody.  So it refuses, with the remedy.
"""

from collections.abc import Mapping
from typing import Any, NoReturn


class FixedParams(dict[str, float]):
    """The parameters of one system by name, read-only; python-control joins those of several without mixing them up.

    It collects the parameters of all systems in one dictionary, so that the last ``K`` would hold for all.  Hence a
    copy bears the full names, ``block.K``, and nothing is added to what is collected: the values are ours.
    ``owner``: the block's name; "" in a diagram, whose names are full ones already.

    >>> params = FixedParams({"K": 3.0})
    >>> params["K"] = 4.0
    Traceback (most recent call last):
    ...
    TypeError: params['K'] = 4.0 would change nothing that runs; with_params({'K': 4.0}) returns a changed copy
    >>> FixedParams({"K": 3.0}, "process").copy()
    {'process.K': 3.0}
    >>> {"K": 2.0} | FixedParams({"K": 3.0}, "process")
    {'K': 2.0}
    """

    def __init__(self, values: Mapping[str, float], owner: str = "") -> None:
        super().__init__(values)
        self.prefix = f"{owner}." if owner else ""

    def copy(self) -> dict[str, float]:
        """Return the values under their full names."""
        return {self.prefix + key: value for key, value in self.items()}

    def __ror__(self, other: Any) -> Any:
        return dict(other)

    def refuse(self, what: str, key: object = None, value: object = None) -> NoReturn:
        """Raise ``TypeError``: what was tried, and how to change a parameter."""
        if key is None:
            key, value = next(iter(self.items()), ("K", 1.0))
        remedy = f"{{{key!r}: {value!r}}}" if not self.prefix else f"{key}={value!r}"
        raise TypeError(f"{what} would change nothing that runs; with_params({remedy}) returns a changed copy")

    def __setitem__(self, key: str, value: float) -> None:
        self.refuse(f"params[{key!r}] = {value!r}", key, value)

    def __delitem__(self, key: str) -> None:
        self.refuse(f"del params[{key!r}]")

    def __ior__(self, other: Any) -> NoReturn:  # type: ignore[misc]
        self.refuse(f"params |= {other!r}")

    def update(self, *values: Any, **more: Any) -> None:
        """Refuse, with the remedy."""
        self.refuse("params.update(...)")

    def setdefault(self, key: str, default: Any = None) -> float:
        """Refuse, with the remedy."""
        self.refuse(f"params.setdefault({key!r}, {default!r})", key, default)

    def pop(self, key: str, *default: Any) -> float:
        """Refuse, with the remedy."""
        self.refuse(f"params.pop({key!r})")

    def popitem(self) -> tuple[str, float]:
        """Refuse, with the remedy."""
        self.refuse("params.popitem()")

    def clear(self) -> None:
        """Refuse, with the remedy."""
        self.refuse("params.clear()")

    def __reduce__(self) -> tuple[type["FixedParams"], tuple[dict[str, float], str]]:
        return FixedParams, (dict(self), self.prefix.removesuffix("."))


class Parametrised:
    """A system whose ``params`` are fixed once they are given."""

    _params: FixedParams

    def _owner(self) -> str:
        """Return the name that stands before each parameter; "" where the names are full ones."""
        raise NotImplementedError

    @property
    def params(self) -> FixedParams:
        """Parameters by name, read-only: changed copies come from ``with_params``."""
        return self._params

    @params.setter
    def params(self, values: Mapping[str, float]) -> None:
        if "_params" in self.__dict__:
            self._params.refuse(f"params = {values!r}")
        self._fix_params(values)

    def _fix_params(self, values: Mapping[str, float]) -> None:
        self._params = FixedParams(values, self._owner())
