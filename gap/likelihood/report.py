"""The report of a model and a log by the one likelihood alone, beside ``gap.diagnose`` until its figures stand."""

from collections.abc import Sequence

from diagram.diagram import Diagram
from diagram.progress import Progress
from gap.answers.report import GapReport
from gap.effects import CATALOGUE
from gap.insertion.effect import Effect
from gap.likelihood.diagnosing import MOST_BLOCKS, MOST_STATES, frame_of, outcome
from gap.likelihood.telling import told
from gap.records.model import read
from gap.records.record import GapError
from logs import Log


def likelihood_report(
    diagram: Diagram, log: Log, *, catalogue: Sequence[Effect] = CATALOGUE, seed: int = 0, progress: Progress = None
) -> GapReport:
    """Return what ``gap.diagnose`` returns, by the one likelihood alone.

    It is for a model with a load that nobody measures, of at most 16 blocks.  ``seed`` of the runs that say what is
    usual.

    Raises ``GapError`` if log and model do not fit together, or where no filter follows the model.
    """
    opened, record = read(diagram, log)
    frame = frame_of(opened, record)
    if frame is None:
        raise GapError(
            f"no filter follows this model of {len(diagram.blocks)} blocks: it needs a load (Noise with a correlation "
            f"time), at most {MOST_BLOCKS} blocks and {MOST_STATES} states, and none that runs in Python; "
            "gap.diagnose has other ways"
        )
    return told(outcome(frame, catalogue, seed, progress))
