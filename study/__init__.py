"""Studies: simulate a diagram with many parameters and starts, measure every run, keep the table, draw it.

study                 runs one                    uniform, loguniform, normal   laws of random axes
Subject               what it can rebuild         production_subject            the production plant as one
StudyResult           table and pictures          parse                         an axis as the command line writes it
OwnMeasures           other numbers than the usual ones
"""

from stickslip.study.axes import Law, StudyError, loguniform, normal, parse, uniform
from stickslip.study.measures import OwnMeasures
from stickslip.study.production import production_subject
from stickslip.study.result import StudyResult
from stickslip.study.run import study
from stickslip.study.subject import Subject

__all__ = [
    "Law",
    "OwnMeasures",
    "StudyError",
    "StudyResult",
    "Subject",
    "loguniform",
    "normal",
    "parse",
    "production_subject",
    "study",
    "uniform",
]
