"""The catalogue: one file an effect.  ``CATALOGUE`` lists them all; a name bears one effect, ``effect("stiction")``."""

from collections.abc import Iterable

from blocks.ports import nearest
from gap.effect import Effect, EffectError
from gap.effects.dead_time import DeadTime
from gap.effects.stiction import Stiction

CATALOGUE: tuple[Effect, ...] = (Stiction(), DeadTime())


def effect(name: str, catalogue: Iterable[Effect] = CATALOGUE) -> Effect:
    """Return an effect by name; raise ``EffectError`` with the nearest name if there is none.

    >>> effect("dead_time")
    <Effect dead_time at a process: theta [s]>
    """
    known = {one.name: one for one in catalogue}
    if name not in known:
        raise EffectError(f"there is no effect '{name}'; {nearest(name, list(known))}")
    return known[name]
