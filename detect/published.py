"""Published figures: the rows of thesis tables 2.1 and 2.2, and published shares of loops judged rightly.

Every figure says where it stands.  "printed": read there.  "second hand": quoted by a text that we read, not seen
ourselves.  A share is set beside ours with its 90 % interval by Wilson; the sets of loops differ, so that only a wide
gap means anything.
"""

import math
from dataclasses import dataclass
from typing import Literal

Mark = Literal["printed", "second hand"]


@dataclass(frozen=True)
class ThesisRow:
    """One method of the thesis: its number, principle and reference of table 2.1, its load of table 2.2.

    ``methods`` are our modules for it; ``top_five`` whether Horch 2007 has it among his five best, by thesis 6.2.
    """

    number: str
    principle: str
    reference: str
    load: str
    methods: tuple[str, ...]
    top_five: bool = False


THESIS: tuple[ThesisRow, ...] = (
    ThesisRow("i", "Cross correlation", "Horch 1999", "low", ("cross_correlation",)),
    ThesisRow("ii", "Derivative of PV data", "Horch 2000", "low", ("derivative_histogram",)),
    ThesisRow("iii", "Half period integral ratio", "Singhal et al. 2005", "low", ("area_ratio",), top_five=True),
    ThesisRow("iv", "Shapes in PV data using QSA", "Rengaswamy et al. 2001", "high",
              ("qualitative_shapes", "dtw_shapes")),
    ThesisRow("v", "Parallelogram in MV-OP plot", "Kano et al. 2004", "low", ("parallelogram",)),
    ThesisRow("vi", "Shapes in PV data using finite derivatives", "Yamashita 2006", "medium",
              ("qualitative_movements",)),
    ThesisRow("vii", "Fit PV data to stiction shapes", "Rossi and Scali 2004", "medium", ("relay_fit",), top_five=True),
    ThesisRow("viii", "Fit output of first integrator to triangle", "He et al. 2007", "medium", ("curve_fit",)),
    ThesisRow("ix", "NLI and NGI, quantify using PV-OP", "Choudhury et al. 2005", "high", ("bicoherence",)),
    ThesisRow("x", "Predictability of a trend and its surrogates", "Thornhill 2005", "high", ("surrogates",),
              top_five=True),
    ThesisRow("xi", "Multi-model estimation, detection of change", "Stenman et al. 2003", "high", ("segmentation",),
              top_five=True),
    ThesisRow("xii", "Change (or lack of change) in OP and PV", "Kano et al. 2004", "medium", ("change_no_change",)),
    ThesisRow("7", "High-passed and time-shifted PV against OP", "Kvam 2009, chapter 7", "-",
              ("high_passed_pv", "shifted_pv")),
)  # fmt: skip
"""Table 2.1 and the column Load of table 2.2.  The thesis credits xii to Yamashita; its text (2.4) and ours to Kano."""


@dataclass(frozen=True)
class Share:
    """A published share: ``right`` of ``of`` loops (None where only the share is known), of what, by which method.

    ``method`` is our module where we have the method, "" where we have not.
    """

    what: str
    share: float
    right: int | None
    of: int | None
    loops: str
    source: str
    mark: Mark
    method: str = ""


PUBLISHED: tuple[Share, ...] = (
    Share("optimal-transport image, CNN encoder and logistic regression: loops right", 0.90, 18, 20, "20 loops of the "
          "public benchmark", "Damarla 2026, arXiv 2607.22486, repository and model_metadata.json", "printed"),
    Share("the same: sticky loops found", 1.0, 13, 13, "the sticky of these 20", "Damarla 2026", "printed"),
    Share("always saying sticky: loops right", 0.65, 13, 20, "the same 20", "count of the labels", "printed"),
    Share("successive ridge detection: loops right", 0.8846, 23, 26, "26 loops of the benchmark, by the share",
          "quoted in maulanaiskak, ML_PLAN.md", "second hand"),
    Share("the same: loops right", 0.85, 17, 20, "20 industrial loops, by the share",
          "quoted in maulanaiskak, ML_PLAN.md", "second hand"),
    Share("Yamashita's method: sticky loops found", 0.50, None, 200, "about 200 plant records; 'about 50 %'",
          "Manum 2006, abstract", "printed", "qualitative_movements"),
    Share("area ratio of the thesis: pressure loops of the simulated plant right", 0.80, 4, 5,
          "cells of tables 6.1 and 6.2, R clearly above 1 read as sticky", "Kvam 2009", "printed", "area_ratio"),
)  # fmt: skip
"""Published shares that can be set beside ours; see each for its source."""


def wilson(right: int, of: int, z: float = 1.645) -> tuple[float, float]:
    """Interval of a share, 90 % by default (z = 1.645): Wilson, J. Am. Stat. Assoc. 22 (1927) 209.

    Raises ValueError unless 0 <= right <= of and of >= 1.

    >>> [round(end, 2) for end in wilson(18, 20, z=1.96)]
    [0.7, 0.97]
    """
    if not (of >= 1 and 0 <= right <= of):
        raise ValueError(f"{right} of {of}; give 0 <= right <= of and at least one loop")
    share, n = right / of, float(of)
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return max(middle - half, 0.0), min(middle + half, 1.0)
