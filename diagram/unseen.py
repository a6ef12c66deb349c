"""Say once per kind of block what python-control's own simulator does not see of it, and what does."""

import warnings
from collections.abc import Iterable

from stickslip.blocks.block import Block

WARNED: set[type[Block]] = set()


class UnseenWarning(UserWarning):
    """Python-control simulates less than the block is."""


def warn_of_unseen(blocks: Iterable[Block]) -> None:
    """Warn (``UnseenWarning``) of every kind of block of which python-control loses something, once per process."""
    for block in blocks:
        lost = "" if type(block) in WARNED else block.unseen()
        if lost:
            WARNED.add(type(block))
            warnings.warn(
                f"python-control does not see {lost} of {type(block).__name__} '{block.name}'; "
                "stickslip.diagram.simulate(diagram, duration) does",
                UnseenWarning,
                stacklevel=5,
            )
