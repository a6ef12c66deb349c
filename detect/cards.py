"""The cards of the methods as one table: what each reads, assumes, finds and costs, as in thesis tables 2.1 and 2.2."""

from __future__ import annotations

from collections.abc import Sequence

from detect.card import Card
from detect.method import Method

__all__ = ["CARD_COLUMNS", "card_rows"]

CARD_COLUMNS = (
    "method", "title", "source", "signals", "process", "assumes", "finds", "streams", "cost", "pros", "cons",
)  # fmt: skip


def card_rows(methods: Sequence[Method] | None = None) -> list[list[str]]:
    """One row of text a method, as in ``CARD_COLUMNS``; by default of all of ``detect.METHODS``.

    >>> from detect.methods import area_ratio
    >>> card_rows([area_ratio])[0][3:5]
    ['SP, PV', 'self-regulating']
    """
    if methods is None:
        from detect import METHODS

        methods = METHODS
    return [_row(method.CARD) for method in methods]


def _row(card: Card) -> list[str]:
    return [
        card.name,
        card.title,
        card.source,
        ", ".join(card.signals),
        ", ".join(card.process).replace("_", "-"),
        "; ".join(card.assumes),
        card.finds,
        card.streams,
        card.cost,
        "; ".join(card.pros),
        "; ".join(card.cons),
    ]
