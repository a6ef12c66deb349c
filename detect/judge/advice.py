"""The next action: a table from the verdict or the reason code to a sentence."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from stickslip.detect.verdict import Code, Word

__all__ = ["ADVICE", "advice"]

TEST = "step the OP in manual by 0.5 to 1 % at a time, both ways, and watch for moves that fail to show in PV"
STEM = {True: "see where the logged stem rests while OP moves", False: "log the stem position"}  # is MV logged?

ADVICE: Mapping[Word | Code, str] = {
    "stiction": "To prove it and size it: {stem}, or {test}.",
    "no_stiction": (
        "To separate tight tuning from an outside wave: put the loop in manual for a few periods; "
        "a wave that stays comes from outside."
    ),
    "constant_signal": "Check the transmitter and the historian tag.",
    "signal_missing": "Check the transmitter and the historian tag.",
    "manual_mode": "Log a stretch in automatic.",
    "frozen_pv": "Check the transmitter and the historian tag.",
    "pv_unresponsive": "Check the block valves, the flow and the transmitter.",
    "not_in_charge": "Log the controller's own output and set point, in automatic.",
    "no_valve": "Judge the loop that has the valve: the one whose set point this controller gives.",
    "stale_data": "To settle it: log PV and OP at the controller's scan, without exception or caching.",
    "undersampled": "To settle it: log raw values, uncompressed, at 20 samples per period or more.",
    "compressed": "To settle it: log raw values, uncompressed, at 20 samples per period or more.",
    "not_causal": "To settle it: log faster than the loop moves, at the controller's scan, or log the stem position.",
    "quantised": "To settle it: log raw values, uncompressed, at 20 samples per period or more.",
    "op_saturated": "To settle it: log a stretch with OP away from its limits.",
    "sp_not_constant": "To settle it: hold the set point (or open the cascade) for ten periods.",
    "outside_wave": "To settle it: put the loop in manual for a few periods; a wave that stays comes from outside.",
    "no_oscillation": "A sticky valve need not cycle; to check: {test}.",
    "too_few_cycles": "To settle it: log ten periods at a fixed set point.",
    "inconclusive": (
        "To settle it: {stem} for ten periods; or put the loop in manual for a few periods (a wave that stays comes "
        "from outside), then {test}."
    ),
    "integrating_unknown": "Say whether the process integrates (process=, on the command line --process).",
    "wrong_process_type": "To settle it: {stem} for ten periods, or {test}.",
    "not_applicable": "To settle it: {stem} for ten periods, or {test}.",
}
"""Sentence by verdict or reason code; of several that fit, the first in this order is said."""


def advice(word: Word, codes: Collection[str], stem_logged: bool) -> str:
    """The next step for a verdict, the reason codes of the methods that refused, and whether MV is logged.

    >>> advice("not_applicable", {"manual_mode", "too_few_cycles"}, stem_logged=False)
    'Log a stretch in automatic.'
    """
    fitting = next(sentence for key, sentence in ADVICE.items() if key == word or key in codes)
    return fitting.format(stem=STEM[stem_logged], test=TEST)
