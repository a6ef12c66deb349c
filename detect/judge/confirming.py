"""The confirming test of a sticky valve as a table: by how much OP is moved, and what each valve answers."""

from stickslip.detect.judge.answer import Amount
from stickslip.logs.two_digits import rounded

COLUMNS = ("step", "move OP by", "then OP is back by", "a sticky valve", "a valve that follows")
STEPS, SHARE, AWAY = 6, 0.25, 2.0  # steps back, each of this share of S, after this many S one way


def confirming_rows(S: Amount) -> list[list[str]]:
    """Rows of text as in ``COLUMNS``, with the steps that ``actions.confirming_steps`` says in words.

    >>> plan = confirming_rows(Amount(4.0, 3.0, 5.0, "% of OP"))
    >>> [row[1:4] for row in plan[:2]]
    [['+8 %', '0', 'follows, at the latest after S'], ['-1 %', '1', 'stands']]
    >>> [row[3] for row in plan[2:]]
    ['stands', 'stands or jumps', 'stands or jumps', 'stands or jumps', 'has jumped']
    """
    size, unit = rounded(SHARE * S.value), S.unit.removesuffix(" of OP")
    rows = [["1", f"+{rounded(AWAY * S.value):g} {unit}", "0", "follows, at the latest after S", "follows"]]
    for k in range(1, STEPS + 1):
        back = k * size
        said = "stands" if back < S.low else "stands or jumps" if back <= S.high else "has jumped"
        rows.append([str(k + 1), f"-{size:g} {unit}", f"{back:.3g}", said, "follows each step"])
    return rows
