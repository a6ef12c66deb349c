"""How to integrate, as one value: tolerances, method, budget and bound of steps, which all that simulates takes alike.

``settings=Settings(rtol=1e-8)`` says it for many calls; for one, the fields can be given by name, ``rtol=1e-8``.
"""

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any, TypedDict

import numpy as np
from stickslip.blocks.ports import nearest, number
from stickslip.engine.run import METHODS, Settings

__all__ = ["Changes", "Settings", "settings_of"]

NAMES = tuple(field.name for field in fields(Settings))


class Changes(TypedDict, total=False):
    """Fields of ``Settings`` given by name: ``rtol``, ``atol`` [-], [unit of each state], ``method``, ``max_steps``,
    ``max_step`` [s].
    """

    rtol: float
    atol: float
    method: str
    max_steps: int
    max_step: float | None


def settings_of(called: Callable[..., Any], given: Settings | None, changes: Mapping[str, Any]) -> Settings:
    """Return the settings ``given`` to a function (None: the default ones) with some fields changed, checked.

    Raises ``TypeError`` for a name that is neither a field nor an argument of the function ``called``, ``ValueError``
    for tolerances, methods, budgets and steps that make no sense.

    >>> settings_of(settings_of, None, {"rtol": 1e-8})
    Settings(rtol=1e-08, atol=1e-09, method='auto', max_steps=20000000, max_step=None)
    """
    for name in changes:
        if name not in NAMES:
            known = [*(called.__kwdefaults__ or {}), *NAMES]
            raise TypeError(f"{called.__name__} has no argument '{name}'; {nearest(name, known)}")
    if given is not None and not isinstance(given, Settings):
        raise ValueError(f"settings = {given!r:.60} are none; give Settings(rtol=1e-8), or rtol=1e-8 alone")
    return _checked(replace(given or Settings(), **changes))


def _checked(s: Settings) -> Settings:
    budget = number("simulate", "max_steps", s.max_steps)
    if not (budget >= 1.0 and (budget == np.inf or budget % 1.0 == 0.0)):
        raise ValueError(
            f"max_steps = {s.max_steps!r}, but a step budget is a whole number of at least 1; leave it out"
        )
    rtol, atol = number("simulate", "rtol", s.rtol), number("simulate", "atol", s.atol)
    if not (isinstance(s.method, str) and s.method in METHODS):
        raise ValueError(f"method = {s.method!r}; {nearest(s.method, list(METHODS))}")
    if not (1e-13 <= rtol <= 0.1 and 0.0 < atol < np.inf):
        raise ValueError(
            f"rtol = {rtol!r}, atol = {atol!r}, but 1e-13 <= rtol <= 0.1 and a finite atol > 0 are "
            "needed; leave them out for 1e-6 and 1e-9"
        )
    longest = None if s.max_step is None else number("simulate", "max_step", s.max_step)
    if longest is not None and not longest > 0.0:
        raise ValueError(
            f"max_step = {s.max_step!r}, but the largest step is above 0 s; leave it out to let functions of time "
            "be probed, or give math.inf for no bound"
        )
    return Settings(rtol, atol, s.method, int(min(budget, 2.0**62)), longest)
