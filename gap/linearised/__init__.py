"""Residuals of a diagram too large, or with too many integrators, to be replayed between the rows of a log.

``parts`` cuts it at the logged outputs of its controllers, ``between`` says what a logged signal does between two rows,
``kalman`` predicts a linear process from row to row, and ``filtered`` puts them together.
"""
