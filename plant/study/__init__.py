"""Studies: a diagram over many parameters and starts, measured, kept, resumed, drawn.

study                 runs one                    uniform, loguniform, normal   laws of random axes
Subject               what it can rebuild         production_subject            the production plant as one
StudyResult           table and pictures          parse                         an axis as the command line writes it
"""

from plant.study.axes import Law, StudyError, loguniform, normal, parse, uniform
from plant.study.production import production_subject
from plant.study.result import StudyResult
from plant.study.run import study
from plant.study.subject import Subject

__all__ = [
    "Law",
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
