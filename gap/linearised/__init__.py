"""Residuals of a diagram too large, or with too many integrators, to be replayed between the rows of a log.

``parts`` cuts it at the logged outputs of its controllers, ``between`` says what a logged signal does between two rows,
``driving`` what valves make of that, ``observer`` foretells the process from row to row, ``gains`` how far each row
sets it right, ``filtered`` puts them together, and ``usual`` says what is left without a gap.
"""
