"""Notes on a run whose steps were bounded, because some of its functions follow the time.

``stickslip.engine.probing`` finds the bounds from a few hundred values of each function; whoever knows better gives
``max_step``.
"""

from collections.abc import Sequence

from stickslip.blocks.block import Block
from stickslip.engine.probing import Bound

MOST = 6  # blocks that a note names


def bounded(blocks: Sequence[Block], bounds: Sequence[Bound]) -> tuple[str, ...]:
    """Return the notes, at most two, on the steps that functions of the time allow: found, and guessed.

    Of several bounds of one block the smallest counts.

    >>> from stickslip.blocks import Step
    >>> bounded([Step("SP", 1.0, name="set point")], [Bound(0, 0.04, False), Bound(0, 0.02, False)])[0][:72]
    'steps are at most 0.02 s, as far as 256 values of set point over the run'
    """
    notes = []
    for guessed in (False, True):
        some = [bound for bound in bounds if bound.guessed is guessed]
        if not some:
            continue
        names = list(dict.fromkeys(blocks[bound.block].name for bound in some))
        text = ", ".join(names[:MOST]) + (f" and {len(names) - MOST} more" if len(names) > MOST else "")
        step = f"steps are at most {min(bound.step for bound in some):.3g} s"
        if guessed:
            notes.append(
                f"{step}, a guess (a thousandth of the run): {text} follows the time, and its values show no scale, "
                "because they are no numbers at the start or change within any interval; "
                "give max_step = a tenth of what is shortest in it [s]"
            )
        else:
            notes.append(
                f"{step}, as far as 256 values of {text} over the run show how fast it follows the time; "
                "if something in it lasts less than a 256th of the run, give max_step = a tenth of that [s]"
            )
    return tuple(notes)
