"""The ports of a block: textbook names with units, and the labels under which a diagram knows them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from stickslip.logs.hint import nearest

__all__ = [
    "BlockError", "Labels", "Port", "check_names", "labelled", "nearest", "number", "require", "shortened",
]  # fmt: skip

Labels = str | Sequence[str] | Mapping[str, str] | None


@dataclass(frozen=True)
class Port:
    """One input or output: its textbook name and its unit ("" fits every unit)."""

    name: str
    unit: str = ""


class BlockError(ValueError):
    """A block was asked for something it cannot be: the message gives the value, the rule and the remedy."""


def check_names(block: str, inputs: Sequence[Port], outputs: Sequence[Port], starts: Sequence[str]) -> None:
    """Raise ``BlockError`` if two ports, or two states or memories, that a caller may mean have one name."""
    unit: dict[str, str] = {}
    for side in (inputs, outputs):
        names = [port.name for port in side]
        for port in side:
            if names.count(port.name) > 1 or unit.get(port.name, port.unit) != port.unit:
                raise BlockError(
                    f"block '{block}' has two ports called '{port.name}'; ports of one block must differ: rename one, "
                    "and give it the signal as label"
                )
        unit |= {port.name: port.unit for port in side}
    for key in starts:
        if starts.count(key) > 1:
            raise BlockError(f"block '{block}' has a state and a memory called '{key}'; rename one of them")


SCREEN = 1500  # characters


def shortened(text: str) -> str:
    """Return a text cut to what a screen shows at a glance.

    >>> len(shortened("long " * 9999))
    1500
    """
    return text if len(text) <= SCREEN else text[: SCREEN - 4] + "...>"


def labelled(block: str, side: str, ports: Sequence[Port], given: Labels) -> list[str]:
    """Return the labels of all ports: their own names unless the caller gave others.

    ``given`` is one label (for a single port), one label per port in order, or a mapping from port to label.
    Raises ``BlockError`` for a port that is not there, a label too many or too few, or one given twice.
    """
    labels = _labels(block, side, ports, given)
    for label in labels:
        if labels.count(label) > 1:
            raise BlockError(
                f"block '{block}' has two {side}s labelled '{label}'; labels of one block must differ: "
                f"give the signal a second name with a Gain block"
            )
        if "." in label:
            plain = label.replace(".", "_")
            raise BlockError(
                f"block '{block}': {side} '{label}' has a dot, which no name in a diagram may have; call it '{plain}', "
                f"and say --signal {plain}={label} (log.renamed in Python) where a log calls it so"
            )
    return labels


def _labels(block: str, side: str, ports: Sequence[Port], given: Labels) -> list[str]:
    names = [port.name for port in ports]
    if given is None:
        return names
    if isinstance(given, str):
        given = [given]
    listed = list(given.values()) if isinstance(given, Mapping) else given
    if not isinstance(listed, list | tuple) or not all(isinstance(label, str) for label in listed):
        raise BlockError(
            f"{block}: {side}s = {given!r}, but signals have texts for names; give one, a list of them, or a mapping "
            f"such as {{'{names[0] if names else 'X'}': 'new label'}}"
        )
    if isinstance(given, Mapping):
        for key in given:
            if key not in names:
                raise BlockError(f"block '{block}' has no {side} '{key}'; {nearest(key, names)}")
        return [given.get(name, name) for name in names]
    if len(listed) != len(names):
        raise BlockError(
            f"block '{block}' has {len(names)} {side}s ({', '.join(names)}), but {len(given)} labels were given; "
            f"give one label per {side}, or a mapping such as {{'{names[0] if names else 'X'}': 'new label'}}"
        )
    return list(given)


def require(rule: bool, block: str, name: str, value: object, text: str, remedy: str) -> None:
    """Raise a ``BlockError`` that states value, rule and remedy unless ``rule`` holds."""
    if not rule:
        raise BlockError(f"{block}: {name} = {value!r}, but {text}; {remedy}")


def number(block: str, name: str, value: object) -> float:
    """Return a value as a float; raise a ``BlockError`` if it is no single number.

    >>> number("valve", "F_s", "big")
    Traceback (most recent call last):
    ...
    stickslip.blocks.ports.BlockError: valve: F_s = 'big', but it must be a single number; give one
    """
    try:
        if not isinstance(value, str):
            return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        pass
    raise BlockError(f"{block}: {name} = {value!r}, but it must be a single number; give one")
