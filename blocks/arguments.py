"""Checks of a block's arguments, made where they come in, before any block computes with them.

A constructor says in its annotations what it wants: ``float`` is a single number of any kind, ``str`` a text.  Every
``Block`` subclass gets this check in front of its ``__init__``, so that a text where a number belongs is refused with
the value, the rule and the remedy, whatever the constructor would have done with it.  An argument that is missing,
unknown or too many is a ``TypeError`` that shows how the block is called.
"""

import functools
import inspect
from collections.abc import Callable, Mapping, Sequence
from types import UnionType
from typing import Any, get_args

from stickslip.blocks.ports import BlockError, number
from stickslip.logs.hint import edits


def checked(init: Callable[..., None]) -> Callable[..., None]:
    """Return a constructor that takes numbers of any kind as floats and refuses what is none.

    >>> def init(self, K: float, name: str = "process"): print(name, K)
    >>> checked(init)(None, 3)
    process 3.0
    >>> checked(init)(None, "3")
    Traceback (most recent call last):
    ...
    stickslip.blocks.ports.BlockError: process: K = '3', but it must be a single number; give one
    """
    signature = inspect.signature(init)
    wanted = {p.name: _kinds(p.annotation) for p in signature.parameters.values()}
    wanted = {
        name: kinds for name, kinds in wanted.items() if kinds - {type(None)} in (frozenset([float]), frozenset([str]))
    }
    default = signature.parameters["name"].default if "name" in signature.parameters else ""

    @functools.wraps(init)
    def door(self: Any, *args: Any, **keywords: Any) -> None:
        try:
            given = signature.bind(self, *args, **keywords)
        except TypeError as fault:
            said = _misspelt(keywords, signature) or str(fault)
            raise TypeError(_shown_call(type(self), said)) from None
        names = [keywords.get("name"), given.arguments.get("name"), given.arguments.get("signal"), default]
        block = next((name for name in names if isinstance(name, str) and name), type(self).__name__)
        for name, kinds in wanted.items():
            if name in given.arguments:
                given.arguments[name] = _as(kinds, block, name, given.arguments[name])
        try:
            init(*given.args, **given.kwargs)
        except TypeError as fault:
            _, found, unknown = str(fault).partition("Block.__init__() got an unexpected keyword argument")
            if not found:
                raise
            raise TypeError(_shown_call(type(self), f"got an unexpected keyword argument{unknown}")) from None

    return door


def _misspelt(keywords: Mapping[str, Any], signature: inspect.Signature) -> str:
    """Return which argument is misspelt, and the one that was meant; "" if none is near."""
    known = [p.name for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD][1:]
    if len(known) < len(signature.parameters) - 1:
        return ""
    for given in keywords:
        if given not in known:
            meant = min(known, key=lambda name: edits(given, name))
            if edits(given, meant) <= len(given) // 2:
                return f"got an unexpected keyword argument '{given}' (did you mean {meant}?)"
    return ""


def _shown_call(kind: type, words: str) -> str:
    """Return what is wrong with a call, and how the block is called."""
    parts, star = [], ""
    for p in list(inspect.signature(kind.__init__).parameters.values())[1:]:  # type: ignore[misc]
        if p.kind is p.VAR_KEYWORD:
            parts.append("inputs=, outputs=, units=, spans=")
            continue
        if p.kind is p.KEYWORD_ONLY and not star:
            star = "*"
            parts.append(star)
        parts.append(p.name if p.default is p.empty else f"{p.name}={p.default!r}")
    return f"{kind.__name__}: {words}; call it as {kind.__name__}({', '.join(parts)})"


def _kinds(annotation: Any) -> frozenset[Any]:
    return frozenset(get_args(annotation)) if isinstance(annotation, UnionType) else frozenset([annotation])


def _as(kinds: frozenset[Any], block: str, name: str, value: Any) -> Any:
    if value is None and type(None) in kinds:
        return None
    return number(block, name, value) if float in kinds else text(block, name, value)


def text(block: str, name: str, value: Any) -> str:
    """Return a text; raise ``BlockError`` for anything else."""
    if not isinstance(value, str):
        raise BlockError(f"{block}: {name} = {value!r}, but it must be a text; give one in quotation marks")
    return value


def texts(block: str, name: str, values: Any) -> tuple[str, ...]:
    """Return texts as a tuple, a single one as one; raise ``BlockError`` for anything else."""
    if isinstance(values, str):
        return (values,)
    if not isinstance(values, Sequence | set | frozenset | Mapping) or not all(isinstance(v, str) for v in values):
        raise BlockError(f"{block}: {name} = {values!r}, but it must be a list of texts; give e.g. {name}=['SP']")
    return tuple(values)


def by_name(block: str, what: str, given: Any, example: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a mapping whose keys are texts; raise ``BlockError`` with the example for anything else.

    >>> by_name("diagram", "params", ["valve.F_s"], {"valve.F_s": 1750.0})
    Traceback (most recent call last):
    ...
    stickslip.blocks.ports.BlockError: diagram: params = ['valve.F_s'], but ... given by name; give e.g. {'valve.F_s':
    1750.0}
    """
    if not isinstance(given, Mapping) or not all(isinstance(key, str) for key in given):
        raise BlockError(f"{block}: {what} = {given!r}, but values are given by name; give e.g. {dict(example)}")
    return given
