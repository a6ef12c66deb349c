"""The methods as tables: thesis tables 2.1 and 2.2 from the cards, with measured columns, and published shares next to
ours.
"""

from collections.abc import Mapping, Sequence

from stickslip.detect.card import Card
from stickslip.detect.method import Method
from stickslip.detect.published import PUBLISHED, THESIS, ThesisRow, interval_words
from stickslip.detect.rates import COMBINED, Rate, rates

CARD_COLUMNS = (
    "method", "title", "source", "signals", "process", "assumes", "finds", "streams", "cost", "pros", "cons",
)  # fmt: skip
OUTLINE_COLUMNS = ("no.", "principle", "reference", "method")
RATE_COLUMNS = (
    "no.", "method", "load (thesis)", "hit rate", "false alarms", "abstentions", "delay [periods]", "us a sample",
)  # fmt: skip
PUBLISHED_COLUMNS = ("published", "share", "90 % interval", "loops", "source", "kind", "ours on simulated loops")


def card_rows(methods: Sequence[Method] | None = None) -> list[list[str]]:
    """One row of text a method, as in ``CARD_COLUMNS``; by default of all of ``stickslip.detect.METHODS``.

    >>> from stickslip.detect.methods import area_ratio
    >>> card_rows([area_ratio])[0][3:5]
    ['SP, PV', 'self-regulating']
    """
    return [_card_row(method.CARD) for method in _all(methods)]


def outline_rows() -> list[list[str]]:
    """Thesis table 2.1, as in ``OUTLINE_COLUMNS``: number, principle, reference, and our module for it.

    >>> outline_rows()[2]
    ['iii', 'Half period integral ratio', 'Singhal et al. 2005', 'area_ratio']
    """
    return [[row.number, row.principle, row.reference, ", ".join(row.methods)] for row in THESIS]


def rate_rows(methods: Sequence[Method] | None = None, measured: Mapping[str, Rate] | None = None) -> list[list[str]]:
    """The measured columns of thesis table 2.2, as in ``RATE_COLUMNS``: methods of the thesis, the others, the verdict.

    ``measured`` as of ``rates()``, which is the default. A share is "-" where nothing was measured. Times are those of
    the machine that measured.
    """
    measured = rates() if measured is None else measured
    names = [method.CARD.name for method in _all(methods)]
    thesis = {name: row for row in THESIS for name in row.methods}
    ordered = [name for name in thesis if name in names] + [name for name in names if name not in thesis]
    if COMBINED in measured and methods is None:
        ordered.append(COMBINED)
    return [_rate_row(name, thesis.get(name), measured.get(name)) for name in ordered]


def published_rows(measured: Mapping[str, Rate] | None = None) -> list[list[str]]:
    """Published shares, as in ``PUBLISHED_COLUMNS``, with our hit rate of the same method, or of the verdict."""
    measured = rates() if measured is None else measured
    rows = []
    for one in PUBLISHED:
        interval = "-" if one.right is None or one.of is None else interval_words(one.right, one.of)
        name, ours = one.method or COMBINED, "-"
        if (rate := measured.get(name)) is not None:
            ours = f"{name}: {rate.hit_rate:.0%} of the sticky found, {rate.false_alarms:.0%} of the others accused"
        rows.append([one.what, f"{one.share:.0%}", interval, one.loops, one.source, one.mark, ours])
    return rows


def _all(methods: Sequence[Method] | None) -> Sequence[Method]:
    if methods is None:
        from stickslip.detect import METHODS

        return METHODS
    return methods


def _card_row(card: Card) -> list[str]:
    return [
        card.name, card.title, card.source, ", ".join(card.signals), ", ".join(card.process).replace("_", "-"),
        "; ".join(card.assumes), card.finds, card.streams, card.cost, "; ".join(card.pros), "; ".join(card.cons),
    ]  # fmt: skip


def _rate_row(name: str, row: ThesisRow | None, rate: Rate | None) -> list[str]:
    shown = [row.number if row else "", name, row.load if row else ""]
    if rate is None:
        return [*shown, "-", "-", "-", "-", "-"]
    delay = "-" if rate.delay is None else f"{rate.delay:.3g}"
    spent = "-" if rate.us_per_sample is None else f"{rate.us_per_sample:.3g}"
    shares = (rate.hit_rate, rate.false_alarms, rate.abstentions)
    return [*shown, *(f"{share:.1%}" for share in shares), delay, spent]
